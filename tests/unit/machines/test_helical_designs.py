"""Helical gears among many designs: the same numbers as one machine after the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
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


def test_gears_of_continuous_contact_are_refused() -> None:
    with pytest.raises(CaseError, match="family"):
        ts.evaluate_designs(ts.load_case(CASES / "continuous_pump.toml"), {WIDTH: np.array([0.03])})
