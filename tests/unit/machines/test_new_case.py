"""First designs: of the asked size, within the design rules, refused in words."""

from __future__ import annotations

import math
import re
import tomllib
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import toothspace as ts
from toothspace.core import units

TURN = 2e6 * math.pi
CASES = Path(__file__).resolve().parents[3] / "cases"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("machine", "volume", "pressure", "speed"),
    [
        ("external_gear", 1.0, 250.0, 600.0),
        ("external_gear", 60.0, 300.0, 3000.0),
        ("external_gear", 200.0, 200.0, 1200.0),
        ("gerotor", 1.0, 60.0, 3000.0),
        ("gerotor", 200.0, 6.0, 700.0),
        ("crescent", 1.0, 250.0, 3000.0),
        ("crescent", 200.0, 205.0, 1000.0),
    ],
)
def test_first_designs_keep_every_rule(
    machine: str, volume: float, pressure: float, speed: float
) -> None:
    text = ts.new_case(machine, f"{volume} cm^3", f"{pressure} bar", f"{speed} rpm")
    case = ts.Case.from_toml(text)
    description = ts.describe(case)
    assert description.displacement * TURN == pytest.approx(volume, rel=2e-3)
    assert case.operating_point is not None
    assert case.operating_point.outlet_pressure == pytest.approx(1e5 * pressure)
    assert (description.running_in is not None) == (machine == "external_gear")
    assert [check.name for check in description.checks if not check.passed] == []


def numbers(machine: str, volume: float, *given: float) -> dict[str, float]:
    """Quantities of a first design in SI units, by key path."""
    text = import_module(f"toothspace.machines.{machine}.new_case").new_case(volume, *given)
    return quantities(tomllib.loads(text)["machine"])


def quantities(tables: dict[str, Any], before: str = "") -> dict[str, float]:
    found: dict[str, float] = {}
    for name, value in tables.items():
        if isinstance(value, dict):
            found |= quantities(value, f"{before}{name}.")
        elif isinstance(value, list):
            found |= {f"{before}{name}[{k}]": to_si(one) for k, one in enumerate(value)}
        elif isinstance(value, float | int) or value[0].isdigit():
            found[before + name] = to_si(value)
    return found


def to_si(value: str | float) -> float:
    return float(units.to_si(*units.split_quantity(value)) if isinstance(value, str) else value)


@pytest.mark.parametrize(
    ("machine", "name", "condition", "free"),
    [
        (
            "external_gear", "egm12_pump", (6.2, 208.0, 1500.0),
            {"gears.face_width", "inlet.volume", "outlet.volume", "floating_bearing.seal_preload"},
        ),
        ("gerotor", "gerotor_trochoidal", (6.16, 60.0, 1500.0), set()),
        ("crescent", "crescent_pump", (100.5, 205.0, 1800.0), set()),
    ],
)  # fmt: skip
def test_a_first_design_of_its_size_is_the_shipped_machine(
    machine: str, name: str, condition: tuple[float, ...], free: set[str]
) -> None:
    shipped = quantities(tomllib.loads((CASES / f"{name}.toml").read_text("utf-8"))["machine"])
    found = numbers(machine, *condition)
    for key in found.keys() & shipped.keys() - free:
        assert found[key] == pytest.approx(shipped[key], rel=0.06), key
    assert len(found.keys() & shipped.keys()) > 10


ROOTS = {
    "bearing_blocks.radial_clearance", "lateral.side_gap", "rotors.tip_clearance",
    "filler.pinion_clearance", "filler.ring_clearance", "pinion.normal_backlash",
}  # fmt: skip
"""Clearances that grow with the root of the size."""
OTHERS = {
    "gears.tip_rounding": 0.0, "gears.tool_tip_radius": 0.0, "rotors.roughness": 0.0,
    "pinion.roughness": 0.0, "ring.roughness": 0.0, "seals.shaft_seal_torque": 1.0,
    "floating_bearing.high_pressure_area.area": 2.0, "inlet.volume": 3.0, "outlet.volume": 3.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("machine", "volume", "length"),
    [
        ("external_gear", 16.0, "gears.module"),
        ("gerotor", 20.0, "rotors.eccentricity"),
        ("crescent", 160.0, "pinion.module"),
    ],
)
def test_first_designs_grow_with_their_displacement(
    machine: str, volume: float, length: str
) -> None:
    """Sections and widths as the module, clearances as its root or as the bearings."""
    small, large = (numbers(machine, k * volume, 210.0, 300.0) for k in (1.0, 8.0))
    size = large[length] / small[length]
    assert size == pytest.approx(2.0, rel=0.15)  # there are tools of some modules only
    widths = [key for key in small if key.endswith("face_width")]
    assert all(large[key] / small[key] == pytest.approx(8.0 / size**2, rel=1e-3) for key in widths)
    apart = {"gears.normal_backlash", "casing.radial_clearance", *widths}
    for key in small.keys() - apart:
        mark = key.rpartition(".")[2]
        plain = "angle" in mark or "count" in mark or "start" in mark or "wear_in" in key
        plain |= mark in {"profile_shift", "dedendum", "seal_preload"}
        power = 0.5 if key in ROOTS else OTHERS.get(key, 0.0 if plain else 1.0)
        grown = 8.0 if power == 3.0 else size**power
        assert large[key] / small[key] == pytest.approx(grown, rel=0.03), key
    if machine == "external_gear":
        for found in (small, large):
            parts = found["bearing_blocks.radial_clearance"]
            parts += found["journal_bearings.radial_clearance"] + 1e-6
            assert found["casing.radial_clearance"] == pytest.approx(parts, abs=1e-6)


@pytest.mark.parametrize("machine", ["external_gear", "crescent"])
def test_bearings_of_first_designs_have_a_thousandth_of_their_radius(machine: str) -> None:
    found = numbers(machine, 40.0, 210.0, 1500.0)
    radius = 0.5 * found["journal_bearings.diameter"]
    clearance = found["journal_bearings.radial_clearance"]
    assert clearance == pytest.approx(1e-3 * radius, abs=0.06e-6)


LEAST_GAPS = {
    "gerotor": {"rotors.tip_clearance": 8, "housing.radial_clearance": 10, "lateral.side_gap": 8},
    "crescent": {
        "pinion.normal_backlash": 40, "ring.radial_clearance": 15, "filler.pinion_clearance": 8,
        "filler.ring_clearance": 8, "journal_bearings.radial_clearance": 4,
    },
    "external_gear": {
        "journal_bearings.radial_clearance": 2, "lateral.side_gap": 3,
    },
}  # fmt: skip
"""Gaps of the smallest first designs, in micrometres."""


@pytest.mark.parametrize("machine", LEAST_GAPS)
def test_the_smallest_designs_keep_gaps_that_can_be_made(machine: str) -> None:
    for volume in (1e-3, 1e-4):
        found = numbers(machine, volume, 200.0, 1500.0)
        gaps = {key: 1e6 * found[key] for key in LEAST_GAPS[machine]}
        assert gaps == pytest.approx(LEAST_GAPS[machine])


def test_harder_squeezed_meshes_get_nearer_and_deeper_grooves() -> None:
    """Speed times four at the same size: 16 times the squeezing, so 2^4."""
    slow, fast = (numbers("external_gear", 12.0, 200.0, speed) for speed in (500.0, 4000.0))
    module = slow["gears.module"]
    squeezed = (4000.0 * module / (1500.0 * 2.75e-3)) ** 2
    assert 1.0 < squeezed < 30.0
    offset = "relief_grooves.closing_side_offset"
    assert slow[offset] / module == pytest.approx(1.2, rel=5e-3)
    assert fast[offset] / module == pytest.approx(1.2 - 0.04 * math.log2(squeezed), rel=5e-3)
    depth, backlash = (
        fast[key] / slow[key] for key in ("relief_grooves.depth", "gears.normal_backlash")
    )
    assert depth == pytest.approx(squeezed**0.25, rel=0.01)
    assert backlash == pytest.approx(squeezed**0.15, rel=0.01)


def test_bearings_of_a_first_design_carry_what_they_may() -> None:
    """0.85 p b d_a on two journals, at the pressure of running-in; remarks say so in numbers."""
    text = ts.new_case("external_gear", "14 cm^3", "210 bar", "600 rpm")
    found = quantities(tomllib.loads(text)["machine"])
    load = 0.85 * 1.25 * 210e5 * found["gears.face_width"] * found["gears.tip_diameter"]
    area = 2.0 * found["journal_bearings.diameter"] * found["journal_bearings.length"]
    said, most = map(float, re.findall(r"specific load ([\d.]+) MPa of ([\d.]+) MPa", text)[0])
    assert 1e6 * said == pytest.approx(load / area, rel=5e-3)
    widest = float(re.findall(r"bearings carry up to ([\d.]+) mm", text)[0])
    # to four fifths of what they may be loaded with
    wanted = 0.8 * most / said * 1e3 * found["gears.face_width"]
    assert widest == pytest.approx(min(wanted, 5e3 * found["gears.module"]), rel=0.01)
    least = float(re.findall(r"10064-2 asks for ([\d.]+) mm", text)[0])
    assert 1e3 * found["gears.normal_backlash"] == pytest.approx(least + 0.003, abs=6e-4)


def test_later_proposals_differ_as_they_say() -> None:
    first, wider = (numbers("gerotor", 6.16, 60.0, 1500.0, share) for share in (1.0, 1.5))
    assert wider["rotors.face_width"] == pytest.approx(1.5 * first["rotors.face_width"])
    larger = numbers("gerotor", 6.16, 60.0, 1500.0, 1.0, 2)
    assert larger["rotors.eccentricity"] == pytest.approx(1.12 * first["rotors.eccentricity"])
    one, two = (numbers("external_gear", 12.0, 200.0, 1000.0, 1.0, step) for step in (0, 5))
    opened = two["relief_grooves.opening_side_offset"] - one["relief_grooves.opening_side_offset"]
    assert opened == pytest.approx(0.1 * one["gears.module"], abs=6e-6)
    modules = [numbers("crescent", 100.5, 205.0, 1000.0, 1.0, k)["pinion.module"] for k in (0, 1)]
    assert modules == pytest.approx([5e-3, 5.5e-3])


def test_first_designs_say_why() -> None:
    text = ts.new_case("external_gear", "14 cm^3/rev", "21 MPa", "1500 rpm")
    remarks = [line for line in text.splitlines() if "# " in line]
    assert len(remarks) > 20
    assert 'outlet_pressure = "210 bar"' in text


@pytest.mark.parametrize(
    ("given", "found"),
    [
        (
            ("vane", "14 cm^3", "210 bar", "1500 rpm"),
            "'vane', allowed 'crescent' or 'external_gear'",
        ),
        (("external_gear", "14 bar", "210 bar", "1500 rpm"), "14 bar"),
        (("external_gear", "14 cm^3", "900 bar", "1500 rpm"), "allowed 2 to 500 bar"),
        (("external_gear", "14 cm^3", "-1 bar", "1500 rpm"), "allowed 2 to 500 bar"),
    ],
)
def test_impossible_ones_are_refused(given: tuple[str, str, str, str], found: str) -> None:
    with pytest.raises(ts.CaseError, match=found):
        ts.new_case(*given)
