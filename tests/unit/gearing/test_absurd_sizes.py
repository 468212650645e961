"""Sizes that are numbers of the right unit and nonsense: refused, or warned of by a design rule."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.advice.trapping import in_series
from toothspace.core.errors import CaseError, GeometryError

CASES = Path(__file__).resolve().parents[3] / "cases"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "key", "value", "rule"),
    [
        ("crescent_pump", "relief_grooves.closing_side_offset", "50 mm", "opening of the relief"),
        ("crescent_pump", "relief_grooves.opening_side_offset", "60 mm", "opening of the relief"),
        ("crescent_pump", "relief_grooves.closing_side_offset", "0 mm", "short circuit"),
        ("crescent_pump", "relief_grooves.opening_side_offset", "0.58 mm", "short circuit"),
        ("crescent_pump", "ring.radial_clearance", "800 um", "bearing play"),
        ("crescent_pump", "journal_bearings.radial_clearance", "200 um", "relative clearance"),
        ("egm12_pump", "relief_grooves.opening_side_offset", "34 mm", "opening of the relief"),
        ("egm12_pump", "relief_grooves.radial_extent", "100 mm", "short circuit through the cham"),
        ("egm12_pump", "bearing_blocks.radial_clearance", "250 um", "cut into the casing"),
        ("egm12_pump", "journal_bearings.radial_clearance", "250 um", "bearing play"),
        ("egm12_pump", "journal_bearings.radial_clearance", "80 um", "relative clearance"),
        ("gerotor_trochoidal", "housing.outer_rotor_diameter", "520 mm", "rim of the outer rotor"),
        ("gerotor_trochoidal", "housing.radial_clearance", "500 um", "relative clearance"),
        ("gerotor_trochoidal", "ports.inner_radius", "1.42 mm", "land beside the kidneys"),
        ("gerotor_trochoidal", "ports.outer_radius", "25 mm", "land beside the kidneys"),
    ],
)
def test_nonsense_is_warned_of(name: str, key: str, value: str, rule: str) -> None:
    case = api.load_case(CASES / f"{name}.toml")
    before = {check.name for check in api.describe(case).checks if not check.passed}
    checks = api.describe(case.replace({f"machine.{key}": value})).checks
    failed = {check.name for check in checks if not check.passed} - before
    assert any(name.startswith(rule) for name in failed)


def test_blocks_carry_both_gears_along() -> None:
    """Bores of one block keep their distance: its clearance in the casing closes no root."""
    case = api.load_case(CASES / "egm12_pump.toml")
    wide = case.replace({"machine.bearing_blocks.radial_clearance": "250 um"})
    checks = {check.name: check for check in api.describe(wide).checks}
    play, cut = checks["bearing play of both gears"], checks["cut into the casing"]
    assert play.value == pytest.approx(2.0 * 0.009)
    assert play.passed
    assert cut.value == pytest.approx(250.0 + 9.0 - 35.0)
    assert not cut.passed


@pytest.mark.parametrize(
    ("name", "key", "value", "message"),
    [
        ("trochoidal", "ports.outer_radius", "40 mm", "below 26 mm, the radius of the outer rotor"),
        ("trochoidal", "rotors.roughness", "0 um", "from 0.01 um"),
        ("cycloidal", "rotors.lobe_radius", "8 mm", "leave this key out unless kind"),
    ],
)
def test_what_cannot_be_run_is_refused(name: str, key: str, value: str, message: str) -> None:
    case = api.load_case(CASES / f"gerotor_{name}.toml")
    with pytest.raises((CaseError, GeometryError), match=message):
        api.describe(case.replace({f"machine.{key}": value}))


def test_openings_in_series_pass_less_than_the_narrower_one() -> None:
    """Equal orifices in series share the pressure drop: 1/sqrt(2) of the flow of one."""
    assert in_series(np.array([1.0]), np.array([1.0])) == pytest.approx(np.sqrt(0.5))
    assert in_series(np.array([1.0]), np.array([0.0])) == 0.0
    assert in_series(np.array([0.0]), np.array([0.0])) == 0.0
