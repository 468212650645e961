"""A film whose equations cannot be solved is reported, and leaves finite fields behind."""

from __future__ import annotations

import numpy as np
import pytest

from tests.lateral_stack import HIGH, loads, pressures, ring_stack
from toothspace.floating import compliant_film
from toothspace.floating.motion import StepSettings, advance, state_at


class _Lost:
    """Linear system without a solution."""

    effort = 0

    def solve(self, rhs: np.ndarray, **_: object) -> np.ndarray:
        return np.full_like(rhs, np.nan)


def test_film_without_solution_does_not_converge(monkeypatch: pytest.MonkeyPatch) -> None:
    stack = ring_stack(approach=3e-13)
    snapshots = (stack.snapshot(0.0, pressures(HIGH)),)
    rest = state_at(stack, snapshots, stack.start(3e-6))
    monkeypatch.setattr(compliant_film, "block_system", lambda *_: _Lost())
    found = advance(stack, snapshots, loads(HIGH), rest, 1e-3, StepSettings())
    assert not found.converged
    assert np.isfinite(found.position).all()
    assert all(np.isfinite(film.pressure).all() for film in found.states[0].films)
