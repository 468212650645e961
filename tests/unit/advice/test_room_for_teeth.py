"""Rings, shafts and rotors that have no room for their teeth are refused before any run."""

from __future__ import annotations

from pathlib import Path

import pytest

from toothspace.api import describe
from toothspace.case import load_case
from toothspace.core.errors import GeometryError

CASES = Path(__file__).resolve().parents[3] / "cases"


@pytest.mark.parametrize(
    ("case", "key", "value", "allowed"),
    [
        ("gerotor_cycloidal", "machine.housing.outer_rotor_diameter", 40, "allowed above"),
        ("gerotor_trochoidal", "machine.housing.outer_rotor_diameter", 30, "allowed above"),
        ("gerotor_trochoidal", "machine.rotors.shaft_diameter", 60, "allowed below the root"),
        ("crescent_pump", "machine.ring.outer_diameter", 60, "allowed above"),
        ("crescent_pump", "machine.journal_bearings.diameter", 90, "allowed below the root"),
    ],
)
def test_a_part_without_room_for_its_teeth_is_refused(
    case: str, key: str, value: float, allowed: str
) -> None:
    spec = load_case(CASES / f"{case}.toml", [f"{key}={value} mm"])
    with pytest.raises(GeometryError, match=f"{key}: found {value} mm, {allowed}"):
        describe(spec)
