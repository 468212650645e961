"""Films beside the faces, reduced to tables over the axial load on the floating bearing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from toothspace.core.compiled import passed_by_address
from toothspace.core.types import Array, IntArray


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LateralTable:
    """Friction and leakage beside the faces over load, pressure and speed.

    Axes rise; one node where nothing depends on the quantity. Every array has one value for each
    force, moment, pressure and slide.
    """

    force_share: Array
    """Axial force that the films carry, positive away from the faces, over the pressure difference
    on the high-pressure area. Shape (n,). [-]
    """
    moment_share: Array
    """Its moment about x through the middle of the face, over that force at the tip radius. Shape
    (m,). [-]
    """
    pressure: Array
    """Pressure difference behind the bearing. Shape (k,). [Pa]"""
    slide: Array
    """Viscosity times shaft speed. Shape (l,). [Pa]"""
    leakage_factor: Array
    """Leakage over that of the closed form; its logarithm is linear between nodes. [-]"""
    shear_share: Array
    """Torque that grows with viscosity and speed, over that of the closed form. [-]"""
    drag_share: Array
    asperity_share: Array
    """Torque of the flow that pressure drives along the faces, and of asperities, over the pressure
    difference on the high-pressure area at the tip radius. [-]
    """
    lag_number: Array
    """Time in which the gap follows the load, squeezing its films, times pressure difference over
    viscosity; its logarithm is linear between nodes. [-]
    """
    seat_factor: float = 1.0
    """Leakage factor of the quasi-static pressures that hold the bearings in position. [-]"""

    @property
    def axes(self) -> tuple[Array, ...]:
        """Nodes of all four quantities."""
        return self.force_share, self.moment_share, self.pressure, self.slide

    def packed(self) -> Array:
        """Values as compiled code reads them, shape (n, m, k, l, columns)."""
        return np.stack(
            [
                np.log(self.leakage_factor),
                self.shear_share,
                self.drag_share,
                self.asperity_share,
                np.log(self.lag_number),
            ],
            axis=-1,
        )


LOAD_STATES = 2
"""States of tabulated films: the force that they carry and its moment, as shares. [-]"""
LEAKAGE, SHEAR, DRAG, ASPERITY, LAG = range(5)
"""Columns of the values of :class:`LateralLookup`; leakage and lag as logarithms."""

(
    HEIGHT_RATIO,
    SHEAR_RATIO,
    DRAG_STRESS,
    ASPERITY_STRESS,
    FORCE_SHARE,
    MOMENT_SHARE,
    LAG_TIME,
    LOAD_SCALE,
    REST_STRESS,
) = range(9)
LATERAL_NOW = 9
"""Columns of what was looked up last: lateral gaps and shear over their closed forms, torque of
drag and of asperities over that of the closed form by viscosity and speed [Pa], load of the
pressures, time in which the gap follows it [s], force of share one [N], and the torque of
asperities at the lowest speed of the table [Pa]."""


@passed_by_address
class LateralLookup(NamedTuple):
    """A table as compiled code reads it; without a table there are no counts."""

    axes: Array
    counts: IntArray
    values: Array
    weights: Array
    scales: Array
    now: Array


def no_lookup() -> LateralLookup:
    """Return what stands for a machine without a table: closed forms as they are."""
    now = np.zeros(LATERAL_NOW)
    now[[HEIGHT_RATIO, SHEAR_RATIO]] = 1.0
    empty = np.zeros((0, 0))
    return LateralLookup(empty, np.zeros(0, np.int64), np.zeros((0,) * 5), empty, np.zeros(0), now)
