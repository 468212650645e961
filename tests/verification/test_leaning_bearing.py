"""Bearings that films push off: they lean on the cover, gears in their journal bearings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.lateral_stack import OUTER, loads, pressures, ring_stack
from toothspace.floating.equilibrium import (
    Equilibrium,
    SearchSettings,
    find_equilibrium,
    snapshots_over_pitch,
)
from toothspace.floating.motion import StepSettings, state_at
from toothspace.floating.stack import Stack, leaning, rim_levers, stop_forces

HIGH = 50e5
PLAY = 100e-6


def _stack(shaft_stiffness: float = 1e5, **changes: float) -> Stack:
    """Ring that far too small a balanced area lets go."""
    stack = ring_stack(
        motion="full",
        approach=1e-12,
        high_share=0.2,
        cells=(24, 6),
        **changes,  # type: ignore[arg-type]
    )
    balance = replace(stack.balance, body_tilts=(5e-4,), shaft_stiffness=shaft_stiffness)
    return replace(stack, balance=balance)


def _settled(stack: Stack, gap: float) -> Equilibrium:
    snapshots = snapshots_over_pitch(stack, lambda _: pressures(HIGH), 1)
    start = state_at(stack, snapshots, stack.start(gap))
    step = StepSettings(max_iterations=25)
    return find_equilibrium(stack, snapshots, loads(HIGH), start, SearchSettings(), step)


def test_bearing_pushed_off_on_one_side_leans_on_its_cover() -> None:
    """High pressure on half of the rim: the far side opens to the cover, the other stays low."""
    stack = _stack(limit=0.0)
    found = _settled(stack, 45e-6)
    q = found.balance.position
    assert found.settled
    assert found.balance.residual < 1e-6
    lift = rim_levers(stack, stack.moving_bearings[0]) @ q[:3]
    # the cover is displaced by the force on it over 1e9 N/m, less than a tenth of the play
    assert PLAY < lift.max() < 1.1 * PLAY
    assert lift.min() < 0.5 * PLAY
    assert leaning(stack, q) == ["the floating bearing has lifted to its cover"]
    state = found.balance.states[0]
    force = state.film_force() + state.back_force(loads(HIGH).back)
    over = lift - PLAY
    assert force[0] == pytest.approx(1e9 * over[over > 0.0].sum(), rel=1e-4)


def test_ring_between_wide_films_tips_unless_its_shaft_is_held() -> None:
    """Wide films do not resist a tilt: forces balance upright, but the equilibrium is unstable."""
    held, free = (_settled(_stack(k, preload_x=4e-3), 49e-6) for k in (1e5, 0.0))
    assert held.settled
    assert held.balance.position[4:6] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert not free.settled
    assert "grows" in free.reason or "journal" in free.reason


def test_forces_of_the_stops_and_their_stiffness() -> None:
    stack = _stack()
    stack = replace(
        stack,
        balance=replace(
            stack.balance, floating=replace(stack.balance.floating, wall_stiffness=1e6)
        ),
    )
    q = np.array([95.3e-6, 3.1e-4, -2.2e-4, 50e-6, -4e-4, 5e-4])
    force, stiffness = stop_forces(stack, q)
    steps = np.diag(np.where(np.arange(6) % 3 == 0, 1e-10, 1e-9))
    for step in steps:
        change = stop_forces(stack, q + step)[0] - stop_forces(stack, q - step)[0]
        assert change == pytest.approx(-2.0 * stiffness @ step, rel=1e-4, abs=1e-6)
    # the shaft leans beyond 0.5 mrad, the cover presses down, and none of both is met before
    assert force[4] > 0.0 > force[5]
    assert force[0] < 0.0
    assert not stop_forces(_stack(0.0), 0.1 * q)[0].any()
    assert 0.1 * OUTER * 5e-4 < PLAY
