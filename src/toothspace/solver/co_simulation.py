"""Units beside a march, of other programs or a drive: when they step, receive values and set them.

At a communication point a unit steps ahead with the values of the run at that point; the run then
follows what the unit gives along a straight line to the next point. So nothing is solved for both
at once, and all that is set is continuous.
"""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.circuit.electric_drive import LinkedDrive, SpeedController
from toothspace.circuit.fmu import Instance, LinkedUnit
from toothspace.circuit.network import FIRST_KNOT
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, node_places
from toothspace.solver.compiled_model import Observation, evaluate_state, observe

Place = tuple[str, int]
"""What is set, and the row of its element; -1 for the shaft."""

_ROUNDED = 1.0 + 1e-12
"""Points in time that differ by less are one. [-]"""


@final
class CoSimulation:
    """Units of a march.

    Parameters
    ----------
    system : System
        Machine and circuit; rows of its schedules follow the units.
    """

    def __init__(self, system: System) -> None:
        circuit = system.condition.circuit
        self._system = system
        self._units: tuple[LinkedUnit | LinkedDrive, ...] = circuit.units if circuit else ()
        self._places = node_places(system.description, system.condition)
        self._steps = [0] * len(self._units)
        self._running: list[Instance | SpeedController] = []
        self._knots: dict[Place, list[tuple[float, float]]] = {}

    def until(self, end: float) -> list[float]:
        """Communication points that are still to come up to a time. [s]."""
        points: set[float] = set()
        for unit, taken in zip(self._units, self._steps, strict=True):
            last = int(end / unit.keys.step * _ROUNDED)
            points.update(unit.keys.step * k for k in range(taken, last + 1))
        # multiples of two steps that meet differ by rounding
        ordered = sorted(points)
        return [b for a, b in zip([-1.0, *ordered], ordered, strict=False) if b > a * _ROUNDED]

    def meet(self, time: float, state: Array) -> None:
        """Step all units whose point this is [s], and set the lines that follow."""
        if not self._units:
            return
        if not self._running:
            for unit in self._units:
                self._running.append(
                    SpeedController(unit.keys) if isinstance(unit, LinkedDrive) else Instance(unit)
                )
        evaluate_state(self._system.arrays, state)
        for k, (unit, instance) in enumerate(zip(self._units, self._running, strict=True)):
            if unit.keys.step * self._steps[k] > time * _ROUNDED:
                continue
            self._steps[k] += 1
            told, nodes = {"speed": state[1], "angle": state[0]}, self._system.arrays.node
            values = [
                nodes[self._places[node], col.PRESSURE] if what == "pressure" else told[what]
                for _, what, node in unit.told
            ]
            found = instance.step(time, [float(value) for value in values])
            until = unit.keys.step * self._steps[k]
            for (_, what, row), value in zip(unit.sets, found, strict=True):
                place = (what, row)
                rows = self._rows(place)
                present = float(np.interp(time, rows[:, 0], rows[:, 1]))
                rows[:] = (time, present), (until, value)
                self._knots.setdefault(place, [(time, present)]).append((until, value))

    def history(self, place: Place, given: Array) -> Array:
        """Time and value of what a unit sets, or what the case gives."""
        knots = self._knots.get(place)
        return np.array(knots) if knots else given

    def forget(self) -> None:
        """Keep of all histories the last line only."""
        for knots in self._knots.values():
            del knots[:-2]

    def observed(self, states: Array, times: Array) -> Observation:
        """Observation of states, each with the lines that the units had set at its time [s]."""
        arrays = self._system.arrays
        if not self._knots:
            return observe(arrays, states, times)
        lines = {place: np.array(knots) for place, knots in self._knots.items()}
        present = arrays.schedule.copy()
        edges = np.unique(np.concatenate([line[:, 0] for line in lines.values()]))
        piece, parts = np.searchsorted(edges, times, "left"), []
        for k in np.unique(piece):
            here = piece == k
            for place, line in lines.items():
                end = int(np.clip(np.searchsorted(line[:, 0], times[here][-1]), 1, len(line) - 1))
                self._rows(place)[:] = line[end - 1 : end + 1]
            parts.append(observe(arrays, states[here], times[here]))
        arrays.schedule[:] = present
        return Observation(*(np.concatenate(values) for values in zip(*parts, strict=True)))

    def close(self) -> None:
        """End all units."""
        for instance in self._running:
            instance.close()
        self._running = []

    def _rows(self, place: Place) -> Array:
        """Two rows of time and value that compiled code reads."""
        arrays, (what, row) = self._system.arrays, place
        column = {"speed": col.SPEED_KNOT, "torque": col.LOAD_KNOT}.get(what, 0)
        first = int(arrays.elements[row, FIRST_KNOT] if row >= 0 else arrays.drive[column])
        return arrays.schedule[first : first + 2]
