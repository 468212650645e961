"""Shear of a journal film: its integrals for a displaced shaft under a pressure wave."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.films.journal.geometry import MotionState, journal_gap, journal_mesh, journal_shear
from toothspace.films.reynolds.rough_surfaces import SMOOTH, FlowLaw, pressure_stress

CLEARANCE, ACROSS, ALONG, LENGTH, PRESSURE = 20e-6, 0.4, 0.5, 15e-3, 3e6
ROWS, LANES = 720, 6
PLACE = np.array([-ACROSS * CLEARANCE, -ALONG * CLEARANCE, 0.0, 0.0])


@pytest.mark.parametrize("half", [False, True])
def test_shear_of_a_displaced_shaft_has_its_closed_forms(half: bool) -> None:
    """Gap c (1 + a cos + b sin) under p sin: 2 pi L / c (1 - a^2 - b^2)^(1/2), pi a c p L / 2."""
    mesh = journal_mesh(LENGTH, (ROWS, LANES), 0.3, half=half)
    gap = journal_gap(mesh, CLEARANCE, MotionState(PLACE, np.zeros(4)))
    lanes = mesh.axial.size
    pressure = np.repeat(PRESSURE * np.sin(mesh.angle)[:, None], lanes, axis=1)
    found = journal_shear(gap, pressure, np.ones((ROWS, lanes)), mesh, SMOOTH)
    length = LENGTH / mesh.weight
    sliding = 2.0 * np.pi * length / (CLEARANCE * np.sqrt(1.0 - ACROSS**2 - ALONG**2))
    pushed = 0.5 * np.pi * ACROSS * CLEARANCE * PRESSURE * length
    assert found == pytest.approx((sliding, 0.0, pushed), rel=1e-4)


def test_pressure_part_of_rough_walls_is_the_law_times_the_drops() -> None:
    mesh = journal_mesh(LENGTH, (ROWS, LANES), 0.0, half=False)
    gap = journal_gap(mesh, CLEARANCE, MotionState(PLACE, np.zeros(4)))
    pressure = np.repeat(PRESSURE * np.sin(mesh.angle)[:, None], LANES, axis=1)
    law: FlowLaw = SMOOTH._replace(roughness=1e-6)
    _, _, pushed = journal_shear(gap, pressure, np.ones((ROWS, LANES)), mesh, law)
    drops = pressure[:, 0] - np.roll(pressure[:, 0], 1)
    halves = [pressure_stress(height, law) for height in gap.face_x[:-1, 0]]
    assert pushed == pytest.approx(LENGTH * np.dot(halves, drops), rel=1e-9)
