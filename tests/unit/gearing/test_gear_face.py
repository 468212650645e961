"""Sections of gears before a wall: which points they cover, about any axis."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.external_gear_designs import TWELVE
from toothspace.gearing.gear_face import GearSection
from toothspace.geometry.involute import generate_profile


@pytest.mark.parametrize(("ratio", "angle"), [(1.0, 0.0), (1.0, 0.7), (-0.8, 0.7)])
def test_a_section_covers_the_points_of_its_polygon(ratio: float, angle: float) -> None:
    """A gear off the origin, a tooth at 0.4 from x at first; borders count for little."""
    profile, center = generate_profile(TWELVE, 400), (31e-3, -12e-3)
    section = GearSection(profile, center, 0.4, ratio)
    outline = shapely.Polygon(profile.closed_polygon(0.4 + ratio * angle, center))
    side = np.linspace(-21e-3, 21e-3, 150)
    x, y = np.meshgrid(side + center[0], side + center[1])
    border = shapely.boundary(outline).buffer(20e-6)
    sure = ~shapely.contains_xy(border, x, y)
    wanted = shapely.contains_xy(outline, x, y)
    assert 0.4 < wanted.mean() < 0.7
    assert np.array_equal(section.contains(angle, x, y)[sure], wanted[sure])
