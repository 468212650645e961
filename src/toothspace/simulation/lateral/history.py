"""What is kept of a march of the lateral films: numbers of every step, fields of the last one."""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.films.lateral.motion import Balance


@final
class LateralTrack:
    """Record of a march, which holds the films of its last step only: those of all fill memory.

    Attributes
    ----------
    positions : list of float
        Position of the floating bearing at its gauge point after every step. [m]
    iterations : list of int
        Film solutions of every step. [-]
    residuals : list of float
        Largest residual force of every step over the balance force. [-]
    converged : bool
        Whether every step was in balance.
    interrupted : bool
        Whether the user stopped the march before its end.
    """

    def __init__(self, shaft_angle: Array) -> None:
        self._shaft_angle = shaft_angle
        self.positions: list[float] = []
        self.iterations: list[int] = []
        self.residuals: list[float] = []
        self.converged = True
        self.interrupted = False
        self._wear = np.zeros(())
        self._last: Balance | None = None

    def take(self, balance: Balance, wear: Array) -> None:
        """Add a step with its wear indicator, shape (films, rows, columns). [W/m2]."""
        self.positions.append(balance.states[0].stack.gauge(balance.position))
        self.iterations.append(balance.iterations)
        self.residuals.append(balance.residual)
        self.converged = self.converged and balance.converged
        self._wear = self._wear + wear
        self._last = balance

    @property
    def shaft_angle(self) -> Array:
        """Angles at the ends of the steps that were made. [rad]."""
        return self._shaft_angle[: len(self.positions)]

    @property
    def last(self) -> Balance:
        """State after the last step."""
        assert self._last is not None
        return self._last

    @property
    def wear(self) -> Array:
        """Wear indicator, mean over all steps. [W/m2]."""
        return np.asarray(self._wear / len(self.positions))
