"""First designs: of the asked size, within the design rules, refused in words."""

from __future__ import annotations

import math

import pytest

import toothspace as ts

TURN = 2e6 * math.pi


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
