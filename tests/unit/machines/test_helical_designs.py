"""Helical gears among many designs: the same numbers as one machine after the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
from tests.study_cases import case_with_study
from toothspace.core.errors import CaseError

CASES = Path(__file__).resolve().parents[3] / "cases"
ANGLE, WIDTH = "machine.gears.helix_angle", "machine.gears.face_width"
NUMBERS = (
    "displacement_cm3_per_rev", "flow_ripple_percent", "overlap_ratio", "center_distance_mm",
    "normal_backlash_mm", "contact_ratio",
)  # fmt: skip


def test_numbers_are_those_of_the_machines() -> None:
    case = ts.load_case(CASES / "helical_pump.toml")
    angles, widths = np.array([3.0, 5.0, 8.0]), np.array([23.7, 40.0, 55.0])
    found = ts.evaluate_designs(case, {ANGLE: np.radians(angles), WIDTH: 1e-3 * widths})
    for k, (angle, width) in enumerate(zip(angles, widths, strict=True)):
        one = case.replace({ANGLE: f"{angle} deg", WIDTH: f"{width} mm"})
        numbers = ts.describe(one).geometry_summary
        for name in NUMBERS:
            assert found[name][k] == pytest.approx(numbers[name], rel=2e-3), name
        assert found["operating_pressure_angle_deg"][k] == pytest.approx(
            numbers["operating_pressure_angle_deg"], rel=1e-9
        )


def test_whole_overlaps_have_no_ripple() -> None:
    case = ts.load_case(CASES / "helical_pump.toml")
    pitch = np.pi * 2.73954e-3  # of the normal section
    angles = np.full(3, np.radians(5.0))
    widths = np.array([0.25, 0.5, 1.0]) * pitch / np.sin(angles)
    found = ts.evaluate_designs(case, {ANGLE: angles, WIDTH: widths})
    assert found["overlap_ratio"] == pytest.approx([0.25, 0.5, 1.0], rel=1e-12)
    assert found["flow_ripple_percent"][2] < 1e-6
    # with both flanks a half of a pitch is a whole period
    assert found["flow_ripple_dual_percent"][1] < 1e-6


def test_ripple_between_whole_overlaps_is_that_of_many_sections() -> None:
    """With both flanks the square of a saw tooth from -1 to 1, twice a pitch."""
    case = ts.load_case(CASES / "helical_pump.toml")
    overlaps = np.array([0.05, 0.2, 0.33, 0.6, 1.4])
    widths = overlaps * np.pi * 2.73954e-3 / np.sin(np.radians(5.0))
    found = ts.evaluate_designs(case, {ANGLE: np.full(5, np.radians(5.0)), WIDTH: widths})
    saw = (2.0 * (np.arange(20000) % 10000) / 10000 - 1.0) ** 2
    swept = np.concatenate([[0.0], np.cumsum(np.tile(saw, 4))]) / 10000
    expected = []
    for turns in 2.0 * overlaps:
        mean = (swept[round(turns * 10000) :][:10000] - swept[:10000]) / turns
        expected.append(np.ptp(mean))
    ratio = found["flow_ripple_dual_percent"] / np.array(expected)
    np.testing.assert_allclose(ratio, ratio[0], rtol=2e-3)


FAMILY = "machine.gears.family"


@pytest.mark.slow
def test_continuous_contact_has_the_numbers_of_its_machine() -> None:
    case = ts.load_case(CASES / "continuous_pump.toml")
    widths = np.array([30.0, 20.0])
    found = ts.evaluate_designs(case, {WIDTH: 1e-3 * widths})
    names = (*NUMBERS, "tip_diameter_mm", "root_clearance_mm", "tip_land_mm")
    for k, width in enumerate(widths):
        numbers = ts.describe(case.replace({WIDTH: f"{width} mm"})).geometry_summary
        for name in names:
            assert found[name][k] == pytest.approx(numbers[name], rel=1e-3, abs=1e-5), name
    # sections over half a pitch deliver evenly, others do not
    assert found.keeps_rules.tolist() == [True, False]
    assert found.why(1) == ("design rule: overlap ratio",)


def test_families_vary_beside_numbers() -> None:
    case = ts.load_case(CASES / "helical_pump.toml")
    names, angles = ["involute", "arc_involute_arc", "cycloidal"], np.radians([0.0, 6.0])
    grid = {FAMILY: np.array(names)[:, None], ANGLE: angles, "machine.gears.normal_backlash": 0.0}
    found = ts.evaluate_designs(case, grid, displacement="16 cm^3/rev")
    assert found["displacement_cm3_per_rev"] == pytest.approx(np.full((3, 2), 16.0), rel=1e-9)
    alone = ts.evaluate_designs(
        case, {ANGLE: angles, "machine.gears.normal_backlash": 0.0}, displacement="16 cm^3/rev"
    )
    assert found["flow_ripple_percent"][0] == pytest.approx(alone["flow_ripple_percent"])
    # a spur section: the square of the contact's distance falls from that of the tip to zero
    gear = case.machine.gears
    addendum = 0.5 * gear.module
    mean = 0.25 * (found["tip_diameter_mm"][2, 0] * 1e-3) ** 2
    mean -= (0.5 * gear.tooth_count * gear.module) ** 2 + 0.5 * addendum**2
    ripple = 1e-2 * found["flow_ripple_percent"][2, 0]
    assert ripple == pytest.approx(addendum**2 / mean, rel=1e-6)


def test_an_unknown_family_is_refused() -> None:
    with pytest.raises(CaseError, match=r"machine.gears.family: found 'round', allowed arc_inv"):
        ts.evaluate_designs(CASES / "helical_pump.toml", {FAMILY: ["involute", "round"]})


def test_a_scan_finds_the_quietest_family() -> None:
    study = """
kind = "design_scan"
objective = "flow_ripple_percent"
goal = "minimise"
displacement = "16 cm^3/rev"
design_rules = false
sample_count = 128
[study.vary]
"machine.gears.family" = ["involute", "arc_involute_arc", "cycloidal"]
"machine.gears.helix_angle" = {from = "0 deg", to = "3 deg"}
"""
    result = ts.run_study(case_with_study(study, "helical_pump"))
    best = result.numbers["best"]
    assert best[FAMILY] == "cycloidal"
    assert set(result.data[FAMILY].values) == {"involute", "arc_involute_arc", "cycloidal"}
    assert result.plot.names() == ["designs"]
    result.plot.designs()
