"""Acceleration of an iteration whose next value follows from its former ones."""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.core.types import Array

_ROUNDING = 1e-12
"""Part of the largest square below which former changes count as dependent. [-]"""


@final
class Mixing:
    """Anderson's acceleration of a fixed-point iteration.

    Parameters
    ----------
    depth : int
        Number of former changes that are remembered. [-]
    part : float
        Part of the residual that is taken over. [-]

    References
    ----------
    .. [1] D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965)
       547-560.
    .. [2] H. F. Walker, P. Ni, Anderson acceleration for fixed-point iterations, SIAM J. Numer.
       Anal. 49 (2011) 1715-1735.
    """

    def __init__(self, depth: int, part: float = 1.0) -> None:
        self._depth, self._part = depth, part
        self._last: tuple[Array, Array] | None = None
        self._steps, self._bends = np.empty((depth, 0)), np.empty((depth, 0))
        self._square = np.zeros((depth, depth))
        self._count = 0

    def following(self, value: Array, residual: Array) -> Array:
        """Value to try next: that whose residual the former ones predict as least.

        Parameters
        ----------
        value : ndarray
            Value that was tried. [any]
        residual : ndarray
            What the iteration adds to it. [as the value]
        """
        if self._last is None:
            self._steps, self._bends = (np.empty((self._depth, value.size)) for _ in range(2))
        else:
            # keep the last change of the value and of the residual in place of the oldest
            bend = residual - self._last[1]
            place = self._count % self._depth
            self._steps[place], self._bends[place] = value - self._last[0], bend
            self._count += 1
            known = min(self._count, self._depth)
            self._square[place, :known] = self._bends[:known] @ bend
            self._square[:known, place] = self._square[place, :known]
        self._last = value.copy(), residual.copy()
        found = value + self._part * residual
        known = min(self._count, self._depth)
        if known == 0:
            return found
        steps, bends = self._steps[:known], self._bends[:known]
        square, bent = self._square[:known, :known], bends @ residual
        if not (np.isfinite(square).all() and np.isfinite(bent).all()):
            return found  # what is iterated is lost, which its own residual tells
        shares = np.linalg.lstsq(square, bent, rcond=_ROUNDING)[0]
        return np.asarray(found - shares @ steps - self._part * (shares @ bends))
