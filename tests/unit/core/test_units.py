"""Quantities with units in text; expected numbers by definition of the units."""

from __future__ import annotations

import math
import subprocess
import sys
import time

import pytest

from toothspace.core import units
from toothspace.core.common_units import COMMON_UNITS
from toothspace.core.errors import CaseError
from toothspace.core.units import (
    compatible,
    dimension_name,
    format_si,
    from_si,
    parse_quantity,
    to_si,
)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("2.75 mm", "m", 2.75e-3),
        ("20um", "mm", 20e-6),
        ("20 µm", "mm", 20e-6),
        ("1 in", "mm", 25.4e-3),
        ("200 bar", "Pa", 200e5),
        ("0.6 GPa", "bar", 0.6e9),
        ("1500 rpm", "rad/s", 50.0 * math.pi),
        ("1 rev/s", "rpm", 2.0 * math.pi),
        ("55 deg", "rad", 55.0 * math.pi / 180.0),
        ("50 degC", "degC", 323.15),
        ("122 degF", "degC", 323.15),
        ("50 °C", "degC", 323.15),
        ("122 °F", "degC", 323.15),
        ("55 °", "rad", 55.0 * math.pi / 180.0),
        ("300 K", "degC", 300.0),
        ("50 cm^3", "cm^3", 50e-6),
        ("4.95 cm^3", "cm^3/rev", 4.95e-6 / (2.0 * math.pi)),
        ("4.95 cm^3/rev", "cm^3/rev", 4.95e-6 / (2.0 * math.pi)),
        ("0.0002 N m/rpm", "N m/rpm", 0.0002 * 30.0 / math.pi),
        ("4e-7 N m s^3/rad^3", "N m s^3/rad^3", 4e-7),
        ("0.01 Pa s", "Pa s", 0.01),
        ("10 cP", "Pa s", 0.01),
        ("46 cSt", "m^2/s", 46e-6),
        ("1e-3 kg m^2", "kg m^2", 1e-3),
        ("-5 N", "N", -5.0),
        (" 3.  s ", "s", 3.0),
        ("60 L/min", "L/min", 1e-3),
        ("250 mm²", "mm^2", 250e-6),
    ],
)
def test_quantity_is_converted(text: str, unit: str, expected: float) -> None:
    assert parse_quantity(text, unit) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "unit", "part"),
    [
        ("2.75", "mm", "found '2.75' without a unit, allowed a length"),
        ("2.75 bar", "mm", "found '2.75 bar', a pressure, allowed a length"),
        ("25 Hz", "rpm", "allowed an angular speed"),
        ("25 1/s", "rpm", "allowed an angular speed"),
        ("1 rad", "m", "found '1 rad', an angle"),
        ("nan mm", "mm", "not a finite number"),
        ("inf mm", "mm", "not a finite number"),
        ("1e400 mm", "mm", "not a finite number"),
        ("1e308 km", "mm", "too large"),
        ("mm", "mm", "allowed a length"),
        ("", "mm", "allowed a length"),
        ("2,75 mm", "mm", "found a comma, for a decimal point"),
        ("3 furlong", "mm", "unknown unit 'furlong'"),
        ("3 mm; x", "mm", "unknown unit"),
        ("3 mm mm", "mm", "an area"),
        ("4.95 cm^3/s", "cm^3/rev", "allowed a displacement"),
        ("0x10 mm", "mm", "unknown unit"),
        ("3 __import__('os')", "mm", "unknown unit"),
    ],
)
def test_other_text_is_refused(text: str, unit: str, part: str) -> None:
    with pytest.raises(CaseError, match="found") as caught:
        parse_quantity(text, unit)
    assert part in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "7.5 m**9**9**9",
        "2**2**2**2**2**2 m",
        "1 m^9^9",
        "1 m ^ 9 ** 9",
        "1 ((((9^9)^9)^9)^9) m",
        "1 ((((km/m)^9)^9)^9)^9 m",
        "1 m^99",
        "1 m^1.5",
        "1 " + "m " * 100_000,
        "1 " + " " * 100_000 + "m",
        "1" * 100_000 + " m",
    ],
)
def test_a_text_that_would_take_for_ever_is_refused_at_once(text: str) -> None:
    parse_quantity("1 m", "mm")
    started = time.perf_counter()
    with pytest.raises(CaseError, match="found") as caught:
        parse_quantity(text, "mm")
    assert time.perf_counter() - started < 0.5
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(("text", "expected"), [("2 (m/s)^2", 2.0), ("2 m**2/s**2", 2.0)])
def test_an_exponent_of_one_digit_is_allowed(text: str, expected: float) -> None:
    assert parse_quantity(text, "m^2/s^2") == expected


def test_message_takes_the_range_of_the_key() -> None:
    with pytest.raises(CaseError, match=r"^found '3' without a unit, allowed 1 mm to 2 mm$"):
        parse_quantity("3", "mm", "1 mm to 2 mm")


def test_conversion_and_its_inverse() -> None:
    assert to_si(0.0, "degC") == pytest.approx(273.15, rel=1e-15)
    assert from_si(to_si(37.5, "degF"), "degF") == pytest.approx(37.5, rel=1e-12)
    assert format_si(20e-6, "um") == "20 um"
    assert format_si(323.15, "degC") == "50 degC"


def test_dimensions_have_names() -> None:
    assert compatible("bar", "GPa")
    assert not compatible("rad/s", "Hz")
    assert dimension_name("cm^3/rev") == "a displacement"
    assert dimension_name("N m/rpm") == "a value in N m/rpm"


def test_common_units_are_those_of_the_registry() -> None:
    for unit, known in COMMON_UNITS.items():
        assert units.UnitFacts(*known) == units.registry_facts(unit), unit


def test_a_shipped_case_is_read_without_the_registry() -> None:
    """What stands in every case costs no import of the registry."""
    program = (
        "import sys; from toothspace.case import load_case; load_case('egm12_pump');"
        "load_case('egm12_motor'); sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
