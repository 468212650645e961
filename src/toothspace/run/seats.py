"""Position of bearing blocks under their load while lateral films come from a table."""

from __future__ import annotations

from dataclasses import replace
from typing import final

import numpy as np

from toothspace.core.status import Status
from toothspace.model.description import MachineDescription
from toothspace.numerics.roots import next_change
from toothspace.results.solution import Solution

_RARELY = 0.01
_LONGEST_CHANGE = 4.0
"""Largest change of the logarithm of the leakage that seats the bearings, in one run. [-]"""
_SEAT_ROUNDS, _SEATED = 8, 0.05
"""Most runs, and difference of leakage, until position and load of the bearings agree."""
_BEYOND = (
    "The load on the lateral films is beyond their table in {:.0f} % of the time of turning, and "
    "counts as its edge: make tables over a wider range."
)
_UNSEATED = (
    "Seats and gaps of the bearings do not agree: the lateral films leak {:.2f} times as much as "
    "the gaps that seat the bearings. Make tables with more pressures and speeds about this point, "
    "or solve the films with fidelity 'elastic'."
)


@final
class SeatSearch:
    """Leakage of tabulated lateral films with which the bearing blocks of a machine are seated.

    The blocks take their seats under the pressures that the gaps leave, and the gaps follow from
    the load on the seated blocks; a run with each guess leads to the next one.
    """

    def __init__(self, machine: MachineDescription) -> None:
        self.machine = machine
        """The machine with the present guess."""
        self._tried: list[tuple[float, float]] = []
        self._unsettled = ""

    def agree_with(self, found: Solution) -> bool:
        """Whether seats and gaps of a run agree, or no better guess is to be had; else the next."""
        table = self.machine.lateral_table
        if table is None or found.status is not Status.DONE:
            return True
        more = float(found.data["lateral_leakage_factor"].mean()) / table.seat_factor
        if abs(more - 1.0) < _SEATED:
            return True
        self._tried.append((np.log(table.seat_factor), np.log(more)))
        if len(self._tried) == _SEAT_ROUNDS:
            self._unsettled = _UNSEATED.format(more)
            return True
        seat = table.seat_factor * float(np.exp(next_change(self._tried, _LONGEST_CHANGE)))
        self.machine = replace(self.machine, lateral_table=replace(table, seat_factor=seat))
        return False

    def noted(self, found: Solution) -> Solution:
        """Solution that says so where a table does not reach, or seats and gaps do not agree."""
        if self.machine.lateral_table is None:
            return found
        turning = np.asarray(found.data["shaft_speed"]) != 0.0
        samples = np.asarray(found.data["lateral_load_beyond"])
        beyond = float(samples[turning].mean()) if turning.any() else 0.0
        said = found.with_note(_BEYOND.format(100 * beyond) if beyond > _RARELY else "")
        return said.short_of(self._unsettled)
