"""Order of convergence of masked lateral films on their grid, and of the march in time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from tests.lateral_stack import (
    HIGH,
    HIGH_NODE,
    INNER,
    LOW,
    OUTER,
    VISCOSITY,
    loads,
    pressures,
    ring_stack,
)
from toothspace.floating.equilibrium import march_angles
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.motion import StepSettings, state_at
from toothspace.floating.stack import BackPressure, Stack
from toothspace.model.film_faces import FILM, FaceCells
from toothspace.numerics.complementarity import face_flows

GAP = 5e-6
RIMS = np.linspace(16e-3, 20e-3, 12, endpoint=False)
"""Edges of the land at all places within a cell. [m]"""


@dataclass(frozen=True)
class _Land:
    """Film within a radius, a chamber at high pressure beyond it."""

    radius: float

    def __call__(self, shaft_angle: float, x: np.ndarray, y: np.ndarray) -> FaceCells:
        inside = np.hypot(x, y) <= self.radius
        return FaceCells(np.where(inside, FILM, HIGH_NODE), np.zeros(x.shape, dtype=np.int64))


def _ring(radius: float, lanes: int, root_radius: float) -> Stack:
    stack = ring_stack(rough=False, cells=(8, lanes))
    land = _Land(radius)
    grids = tuple(
        FaceGrid(
            replace(
                grid.interface,
                face=replace(grid.interface.face, face_map=land),
                root_radius=root_radius,
            ),
            8,
            lanes,
        )
        for grid in stack.grids
    )
    return replace(stack, grids=grids)


def _errors(radius: float, lanes: int, root_radius: float = 0.0) -> tuple[float, float]:
    """Relative errors of leakage Q = pi h^3 dp / (6 mu ln r/ri) and load."""
    stack = _ring(radius, lanes, root_radius)
    snapshot = stack.snapshot(0.0, pressures(HIGH))
    flat = [np.zeros((grid.rows, grid.lanes)) for grid in stack.grids]
    still = np.zeros(stack.size)
    film = stack.solve(snapshot, stack.start(GAP), still, None, flat).films[0]
    fall, logarithm = HIGH - LOW, np.log(radius / INNER)
    leakage = np.pi * GAP**3 * fall / (6.0 * VISCOSITY * logarithm)
    ring = radius**2 - (radius**2 - INNER**2) / (2.0 * logarithm)
    load = np.pi * fall * (ring + OUTER**2 - radius**2)
    carried = float(((film.pressure - LOW) * film.grid.area).sum())
    return abs(film.losses.bore_flow / leakage - 1.0), abs(carried / load - 1.0)


def test_film_between_cells_and_edges_converges_with_first_order() -> None:
    """Edges fall anywhere within a cell: means over twelve places of the edge."""
    errors = np.array(
        [np.mean([_errors(rim, lanes) for rim in RIMS], axis=0) for lanes in (10, 20, 40, 80)]
    )
    order = np.log2(errors[0] / errors[-1]) / 3.0
    assert np.all(order > 0.8)
    assert np.all(order < 1.2)
    assert np.all(errors[1] < (0.02, 0.006))


def test_film_whose_edge_lies_between_lanes_converges_with_second_order() -> None:
    """Lanes meet the radius where tooth spaces begin, wherever it is."""
    assert np.any(FaceGrid(_ring(17e-3, 10, 17e-3).grids[0].interface, 8, 10).rims == 17e-3)
    errors = np.array(
        [np.mean([_errors(r, lanes, r) for r in RIMS], axis=0) for lanes in (10, 20, 40)]
    )
    order = np.log2(errors[0] / errors[-1]) / 2.0
    assert np.all(order > 1.7)
    assert np.all(errors[0] < (6e-3, 2e-3))


def _closed(stack: Stack, start: np.ndarray, steps: int) -> float:
    """Position after a step of the pressure behind the bearing, half a radian later. [m]."""
    closing = loads(HIGH)._replace(back=BackPressure(1.05 * HIGH, LOW, LOW))
    rest = state_at(stack, (stack.snapshot(0.0, pressures(HIGH)),), start)
    angles = np.arange(1, steps + 1) / steps
    settings = StepSettings(force_tolerance=1e-9, film_tolerance=1e-7)
    march = list(march_angles(stack, lambda _: pressures(HIGH), closing, rest, angles, settings))
    assert all(balance.converged for balance in march)
    return float(march[-1].position[0])


def test_march_converges_with_first_order_in_time() -> None:
    """Implicit Euler: the error halves with the step."""
    stack = ring_stack(approach=3e-13, high_share=0.72)
    start = stack.start(3.2e-6)
    path = np.array([_closed(stack, start, steps) for steps in (4, 8, 16)])
    # differences of neighbours need no exact solution
    change = np.diff(path)
    order = np.log2(change[:-1] / change[1:])
    assert np.all(np.abs(order - 1.0) < 0.15)


def test_what_flows_into_a_film_widens_it() -> None:
    """Pressure of the chambers rises and falls: faces move, deform and store the liquid."""
    stack = ring_stack(approach=3e-13, rough=False, high_share=0.72)
    angles = np.linspace(0.1, 1.0, 8)

    def beats(angle: float) -> np.ndarray:
        return pressures(HIGH * (1.0 + 0.2 * np.sin(3.0 * angle)))

    rest = state_at(stack, (stack.snapshot(0.0, beats(0.0)),), stack.start(3.2e-6))
    settings = StepSettings(force_tolerance=1e-9, film_tolerance=1e-7)
    march = list(march_angles(stack, beats, loads(HIGH), rest, angles, settings))
    assert all(balance.converged for balance in march)
    duration = (angles[1] - angles[0]) / stack.shaft_speed
    for before, now in pairwise(b.states[0].films[0] for b in march):
        b, fields = now.plane.balance, now.plane.fields
        along, across = face_flows(b, b, fields.potential, fields.saturation)
        net = np.diff(along, axis=0) + np.diff(across, axis=1)
        film = now.boundary.mask.film
        filled = float((now.grid.area * (now.gap - before.gap))[film].sum()) / duration
        rate = float((now.grid.area * now.plane.film.gap.rate)[film].sum())
        assert -float(net[film].sum()) == pytest.approx(filled, rel=1e-5)
        assert rate == pytest.approx(filled, rel=1e-5)
