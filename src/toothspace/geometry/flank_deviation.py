"""Deviations of flanks as a gear tester names them: profile, pitch, run-out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array


@final
@dataclass(frozen=True)
class ProfileDeviation:
    """Distance of one flank from an involute along its normal, over the roll length.

    References
    ----------
    .. [1] ISO 1328-1:2013, Cylindrical gears, ISO system of flank tolerance classification,
       section 4.4: profile deviations.
    """

    roll_length: Array
    """Length of the tangent from the base circle to each compared point, rising. [m]"""
    deviation: Array
    """Deviation, positive for excess material. [m]"""

    @property
    def total(self) -> float:
        """Total profile deviation F_alpha, peak to peak [m]."""
        return float(np.ptp(self.deviation))

    @property
    def slope(self) -> float:
        """Profile slope deviation f_H_alpha, rise of the mean line over its length [m]."""
        return float(self._mean_line()[-1] - self._mean_line()[0])

    @property
    def form(self) -> float:
        """Profile form deviation f_f_alpha, peak to peak about the mean line [m]."""
        return float(np.ptp(self.deviation - self._mean_line()))

    def _mean_line(self) -> Array:
        if len(self.deviation) < 3:
            return self.deviation
        weight = np.sqrt(np.abs(np.gradient(self.roll_length)))
        line = np.polynomial.Polynomial.fit(self.roll_length, self.deviation, 1, w=weight)
        return np.asarray(line(self.roll_length))


@final
@dataclass(frozen=True)
class PitchDeviation:
    """Places of the teeth on a measuring circle about the centre that fits all teeth.

    References
    ----------
    .. [1] ISO 1328-1:2013, Cylindrical gears, ISO system of flank tolerance classification,
       section 4.3: pitch deviations; annex on run-out.
    """

    left: Array
    right: Array
    """Index deviation of the flanks, arc from the even place, counter-clockwise positive. Shape
    (tooth_count,). [m]
    """
    radial: Array
    """Radial place of a ball in the space after each tooth. Shape (tooth_count,). [m]"""

    @property
    def single(self) -> float:
        """Largest single pitch deviation f_p of both flanks [m]."""
        steps = [np.abs(np.roll(side, -1) - side).max() for side in (self.left, self.right)]
        return float(max(steps))

    @property
    def cumulative(self) -> float:
        """Total cumulative pitch deviation F_p, larger of both flanks [m]."""
        return float(max(np.ptp(self.left), np.ptp(self.right)))

    @property
    def run_out(self) -> float:
        """Run-out F_r of a ball in the tooth spaces [m]."""
        return float(np.ptp(self.radial))
