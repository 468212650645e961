"""The notch in the filler of a crescent machine: section and hydraulic diameter of its slot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace import api

CASES = Path(__file__).resolve().parents[3] / "cases"


def test_notches_have_the_hydraulic_diameter_of_their_slot() -> None:
    """Four times the section over its circumference, of a rectangle as wide as the notch."""
    case = api.load_case(CASES / "crescent_pump.toml")
    notch = case.machine.filler.notch
    paths = [path for path in api.describe(case).paths if "notch" in path.name]
    assert len(paths) == 2
    for path in paths:
        angles = np.linspace(0.0, path.geometry.period, 400, endpoint=False)
        area, diameter = path.geometry(angles).T[:2]
        open_ = area > 0.05 * notch.width * notch.depth
        assert open_.any()
        depth = area[open_] / notch.width
        assert depth.max() <= notch.depth * (1.0 + 1e-9)
        expected = 4.0 * area[open_] / (2.0 * (notch.width + depth))
        assert diameter[open_] == pytest.approx(expected, rel=2e-2)
