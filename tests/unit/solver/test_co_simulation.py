"""Units that are linked to a circuit are stepped at their own points in time."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.toy_machine import toy_system
from toothspace.model.assembly import System
from toothspace.solver.co_simulation import CoSimulation
from toothspace.solver.initial import start_state


class Unit:
    """A unit that neither reads nor sets anything, and notes when it is stepped."""

    def __init__(self, step: float) -> None:
        self.keys = SimpleNamespace(step=step)
        self.told: list[Any] = []
        self.sets: list[Any] = []
        self.times: list[float] = []

    def step(self, time: float, _values: list[float]) -> list[float]:
        self.times.append(time)
        return []

    def close(self) -> None: ...


@pytest.fixture
def system() -> System:
    return toy_system()


def linked(system: System, *units: Unit) -> CoSimulation:
    found = CoSimulation(system)
    found._units = units  # type: ignore[assignment]
    found._steps = [0] * len(units)
    found._running = [*units]  # type: ignore[list-item]
    return found


def test_points_are_those_of_all_units_up_to_the_end(system: System) -> None:
    """The end is one of them, though 0.3 over 0.1 is below 3 in binary numbers."""
    together = linked(system, Unit(0.1), Unit(0.15))
    assert together.until(0.3) == pytest.approx([0.0, 0.1, 0.15, 0.2, 0.3])
    assert together.until(0.29) == pytest.approx([0.0, 0.1, 0.15, 0.2])


def test_units_are_stepped_when_their_time_has_come_and_once(system: System) -> None:
    units = Unit(1.0e-3), Unit(1.05e-3)
    together, state = linked(system, *units), start_state(system)
    for time in together.until(2.1e-3):
        together.meet(time, state)
    assert units[0].times == pytest.approx([0.0, 1e-3, 2e-3])
    assert units[1].times == pytest.approx([0.0, 1.05e-3, 2.1e-3])
    assert together.until(4e-3) == pytest.approx(np.array([3.0, 3.15, 4.0]) * 1e-3)
