"""Search for the equilibrium of floating bearings where no film holds them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from toothspace.floating import equilibrium


@pytest.fixture
def undamped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films that have all cavitated: neither stiffness nor damping."""
    nothing = np.zeros((3, 3))
    monkeypatch.setattr(equilibrium, "film_coefficients", lambda *_: (nothing, nothing))
    monkeypatch.setattr(equilibrium, "stop_forces", lambda *_: (np.zeros(3), nothing))


@pytest.mark.usefixtures("undamped")
def test_motion_that_no_film_damps_neither_tips_nor_is_settled() -> None:
    stack = SimpleNamespace(size=3, free=[0, 1, 2], arms=np.ones(3))
    loads = SimpleNamespace(friction=SimpleNamespace(holds=False))
    moving = SimpleNamespace(
        states=(), position=np.zeros(3), velocity=np.array([0.05, 0.0, 0.0]),
        jacobian=(None, np.zeros((3, 3))),
    )  # fmt: skip
    rate, motion = equilibrium.growing_motion(stack, moving, loads, SimpleNamespace(fineness=1e-3))
    assert rate == 0.0
    assert not motion.any()
    assert equilibrium._viscous(stack, moving) == np.inf
    moving.velocity[:] = 0.0
    assert equilibrium._viscous(stack, moving) == 0.0
