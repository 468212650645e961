"""Torque of solved films in the lumped machine, and forces of helical teeth."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from tests.lateral_stack import HIGH, VISCOSITY, loads, pressures, ring_stack
from toothspace.floating.equilibrium import snapshots_over_pitch
from toothspace.floating.problem import LateralProblem, LateralSettings, numbers_of
from toothspace.floating.torque import lumped_torque, with_film_torque
from toothspace.model.description import Body, LumpedLateralFilm
from toothspace.model.floating_bearing import AxialForce
from toothspace.model.lumped_films import lateral_asperity_share, lateral_torque_coefficient

WALL = 2e-3
"""Torque of drag against pressure that the lumped paths ask for already. [N m]"""


def _problem(**changes: Any) -> LateralProblem:
    stack = ring_stack(approach=5e-13, cells=(12, 6), **changes)
    snapshots = snapshots_over_pitch(stack, lambda _: pressures(HIGH), 1)
    settings = LateralSettings(angles=1)
    return LateralProblem(stack, snapshots, loads(HIGH), lambda _: pressures(HIGH), settings)


def _machine() -> Any:
    film = LumpedLateralFilm("ring", 2, 3e-6, 10e-3, 25e-3, 25e-3, 1.0)
    other = replace(film, body="other")
    bodies = (
        Body("ring", (0.0, 0.0), 1.0, 0.5, 1e-4, "shaft"),
        Body("other", (0.0, 0.0), -1.0, 0.5, 1e-4, "driven"),
    )
    return SimpleDescription(bodies=bodies, laterals=(film, other))


class SimpleDescription(SimpleNamespace):
    """Bodies and films of a machine, without the rest."""


def _data(viscous: float, asperity: float) -> xr.Dataset:
    friction = np.array([[viscous, asperity]])
    drag = np.array([[WALL, 0.0]])
    return xr.Dataset(
        {
            "torque_loss": (("sample", "mechanism"), friction),
            "drag_torque": (("sample", "path"), drag),
        },
        coords={"mechanism": ["lateral_viscous", "lateral_asperity"], "path": ["lateral", "drain"]},
    )


def test_lumped_torque_holds_friction_and_drag() -> None:
    assert lumped_torque(_data(0.2, 0.1)) == pytest.approx(0.3 + WALL)


def test_faces_of_the_machine_take_the_torque_of_touching_films(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """High pressure presses asperities together; the films of another body stay as they are."""
    monkeypatch.setattr("toothspace.floating.torque.replace", _replaced)
    problem = _problem(high_share=0.9)
    found = problem.settle(problem.started(2e-6)).balance
    numbers, machine = numbers_of(problem, found), _machine()
    assert numbers.asperity_torque > 0.0
    changed = cast(Any, with_film_torque(machine, VISCOSITY, _data(0.0, 0.0), found))
    ring, other = changed.laterals
    assert other is machine.laterals[1]
    only = SimpleDescription(bodies=machine.bodies[:1], laterals=(ring,))
    torque = lateral_torque_coefficient(cast(Any, only)) * VISCOSITY * problem.stack.shaft_speed
    wanted = numbers.viscous_torque + numbers.asperity_torque
    assert torque + WALL == pytest.approx(wanted)
    share = lateral_asperity_share(cast(Any, only))
    assert share * torque == pytest.approx(numbers.asperity_torque)
    assert ring.height == pytest.approx(numbers.gaps.mean())


def _replaced(thing: Any, **changes: Any) -> Any:
    if isinstance(thing, SimpleDescription):
        return SimpleDescription(**{**vars(thing), **changes})
    return replace(thing, **changes)


def test_half_of_the_faces_touch() -> None:
    film = LumpedLateralFilm(
        "ring", 2, 3e-6, 10e-3, 25e-3, 25e-3, 1.0, drag=1e-5, asperity_share=0.6
    )
    dry = replace(film, body="other", asperity_share=0.0)
    machine = SimpleDescription(bodies=_machine().bodies, laterals=(film, dry))
    assert lateral_asperity_share(cast(Any, machine)) == pytest.approx(0.3)


@pytest.mark.parametrize("motion", ["axial", "full"])
def test_force_of_helical_teeth_lifts_the_gear_off_the_solid_bearing(motion: str) -> None:
    """Positive along z: the film there opens, the floating bearing follows with the same gap."""
    problem = _problem(high_share=0.8, motion=motion)
    pushed = replace(problem.stack.balance, body_forces=(AxialForce(80.0),))
    helical = replace(problem, stack=replace(problem.stack, balance=pushed))
    still, found = (p.settle(p.started(2e-6)) for p in (problem, helical))
    assert found.settled
    before, after = numbers_of(problem, still.balance), numbers_of(helical, found.balance)
    assert after.gaps[0] == pytest.approx(before.gaps[0], rel=1e-4)
    assert after.gaps[1] > 1.05 * before.gaps[1]
    assert after.position - before.position == pytest.approx(
        after.gaps[1] - before.gaps[1], rel=0.2
    )
    assert before.hold_down_force - after.hold_down_force == pytest.approx(80.0, abs=0.1)
