"""Search for the equilibrium of floating bearings where no film holds them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from tests.lateral_stack import loads, pressures, ring_stack
from toothspace.floating import equilibrium
from toothspace.floating.equilibrium import Equilibrium
from toothspace.floating.problem import LateralProblem, LateralSettings


def test_motion_that_no_film_damps_neither_tips_nor_is_settled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Films that have all cavitated: neither stiffness nor damping."""
    nothing = np.zeros((3, 3))
    monkeypatch.setattr(equilibrium, "stop_forces", lambda *_: (np.zeros(3), nothing))
    stack = SimpleNamespace(size=3, free=[0, 1, 2], arms=np.ones(3))
    loads = SimpleNamespace(decide_slides=False)
    moving = SimpleNamespace(
        states=(), position=np.zeros(3), velocity=np.array([0.05, 0.0, 0.0]),
        jacobian=(nothing, nothing),
    )  # fmt: skip
    rate, motion = equilibrium.growing_motion(stack, moving, loads)
    assert rate == 0.0
    assert not motion.any()
    assert equilibrium._viscous(stack, moving) == np.inf
    moving.velocity[:] = 0.0
    assert equilibrium._viscous(stack, moving) == 0.0


def _settled(
    high: float,
    coulomb: float,
    known: Equilibrium | None = None,
    law: str = "stick",
    dwell: float = 1e3,
) -> Equilibrium:
    """Plain ring between two films that starts at 2 um."""
    stack = ring_stack(approach=3e-13, high_share=0.68, preload=400.0, cells=(12, 8))
    problem = LateralProblem(
        stack,
        (stack.snapshot(0.0, pressures(high)),),
        loads(high, coulomb, law),
        lambda _: pressures(high),
        LateralSettings(dwell=dwell),
    )
    return problem.settle(problem.started(0.8e-6), known)


@pytest.mark.parametrize(("coulomb", "slides"), [(0.0, 0), (60.0, 1), (2000.0, 0)])
def test_a_known_search_shortens_one_at_nearly_the_same_pressure(
    coulomb: float, slides: int
) -> None:
    """It ends where the search without it ends: balanced, after sliding, held at its start."""
    known, alone = _settled(60e5, coulomb), _settled(61e5, coulomb)
    found = _settled(61e5, coulomb, known)
    assert known.settled
    assert found.settled
    assert [abs(own) for own in alone.balance.slides] == [slides]
    assert found.balance.slides == alone.balance.slides
    assert found.balance.position == pytest.approx(alone.balance.position, rel=2e-5, abs=1e-12)
    assert found.steps < alone.steps


def test_a_bearing_that_breaks_away_now_is_not_held_where_it_was_known() -> None:
    """Known at the friction that holds it: with less it slides, as without that knowledge."""
    held, alone = _settled(60e5, 2000.0), _settled(60e5, 60.0)
    found = _settled(60e5, 60.0, held)
    assert held.balance.slides == (0,)
    assert found.balance.position == pytest.approx(alone.balance.position, rel=2e-5, abs=1e-12)


def test_a_creeping_bearing_is_followed_over_its_time() -> None:
    """A smooth law has no place of rest that the sense of sliding would tell."""
    known = _settled(60e5, 60.0)
    alone = _settled(60e5, 60.0, law="stribeck", dwell=0.01)
    found = _settled(60e5, 60.0, known, law="stribeck", dwell=0.01)
    assert found.steps > 3
    assert found.balance.position == pytest.approx(alone.balance.position, rel=1e-3)
