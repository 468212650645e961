"""Outlines of continuous contact: conjugate flanks, closed forms, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from toothspace.core.errors import GeometryError
from toothspace.gearing import meshing
from toothspace.gearing.tooth import tooth_curves
from toothspace.geometry.continuous_contact import (
    FAMILIES,
    ContinuousGear,
    Family,
    generate_continuous,
)

SHAPES: dict[Family, dict[str, float]] = {
    "arc_involute_arc": {"pressure_angle": math.radians(22.0), "root_clearance": 0.15e-3},
    "circular_arc": {"tip_diameter": 30.4e-3},
    "sinusoidal": {"tip_diameter": 29.4e-3},
    "cycloidal": {},
}


def gear(family: Family, **changes: float) -> ContinuousGear:
    keys = {**SHAPES[family], **changes}
    return ContinuousGear(family=family, tooth_count=9, module=3e-3, **keys)


def throats(tooth: ContinuousGear, is_left: bool) -> tuple[np.ndarray, np.ndarray]:
    """Roll angles over the path of contact, and the gap of facing flanks there."""
    profile = generate_continuous(tooth)
    teeth = (tooth_curves(profile),) * 2
    mesh = meshing.mesh_at_distance(teeth, 2.0 * tooth.reference_radius)
    angles = np.linspace(0.0, mesh.half_pitch, 103)[1:-1]
    side = meshing.facing_throats(teeth, mesh, is_left, angles if is_left else -angles)
    return angles, side.gap


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("is_left", [True, False])
def test_conjugate_flanks_touch_all_along_their_path(family: Family, is_left: bool) -> None:
    _, gap = throats(gear(family), is_left)
    assert np.abs(gap).max() < 1e-9


@pytest.mark.parametrize("family", FAMILIES)
def test_backlash_is_the_same_along_the_path(family: Family) -> None:
    """Parallel curves of conjugate flanks have the same normals."""
    _, gap = throats(gear(family, backlash=20e-6), is_left=True)
    np.testing.assert_allclose(gap, 10e-6, atol=2e-9)


@pytest.mark.parametrize("family", FAMILIES)
def test_flow_of_a_section_is_that_of_its_contact(family: Family) -> None:
    """Q = b (ra^2 - r^2 - s^2) with the distance s of the contact from the pitch point."""
    tooth = gear(family)
    profile = generate_continuous(tooth)
    teeth = (tooth_curves(profile),) * 2
    mesh = meshing.mesh_at_distance(teeth, 2.0 * tooth.reference_radius)
    gears = meshing.MeshedGears(
        teeth=teeth, root_radii=(profile.root_radius,) * 2, mesh=mesh, face_width=0.02,
        loaded_is_left=True, pair=None,
    )  # fmt: skip
    piece = tooth.pieces()[-1](np.linspace(0.02, 0.98, 25))
    # the space behind the tooth is half a pitch behind its place
    found = meshing.ideal_flow(gears, mesh.half_pitch - piece.roll)
    height = profile.tip_radius**2 - tooth.reference_radius**2
    np.testing.assert_allclose(found, 0.02 * (height - piece.distance**2), rtol=1e-7)


def test_arc_involute_arc_pulsates_a_quarter_of_what_one_flank_would() -> None:
    """Two flanks seal in turn: half the amplitude in s, twice the order, a quarter of s^2."""
    tooth = gear("arc_involute_arc")
    base = tooth.reference_radius * math.cos(math.radians(22.0))
    pitch = 2.0 * math.pi * base / 9
    assert tooth.addendum == pytest.approx(0.25 * pitch, rel=1e-12)
    assert tooth.mean_square_distance() == pytest.approx(tooth.addendum**2 / 3.0, rel=1e-6)
    one_flank = (0.5 * pitch) ** 2
    assert tooth.addendum**2 / one_flank == pytest.approx(0.25, rel=1e-12)


def test_impossible_teeth_are_refused_with_what_helps() -> None:
    with pytest.raises(GeometryError, match="smaller one"):
        generate_continuous(gear("sinusoidal", tip_diameter=30.4e-3))
    with pytest.raises(GeometryError, match="tip_land"):
        generate_continuous(gear("circular_arc", tip_land=5e-3))
