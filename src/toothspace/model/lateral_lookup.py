r"""Films beside the faces of bodies, looked up in a table at every instant.

The load on the floating bearing follows from the pressures of the moment. Its gap follows the load
by squeezing the films: the load F that they carry, and its moment alike, obeys

.. math:: \tau\,\dot F = F_z - F

with the time :math:`\tau`, the films' damping over their stiffness. Leakage, friction and that
time are looked up at F, the pressure difference and the speed.
"""

from __future__ import annotations

import math

from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.lateral_table import (
    ASPERITY,
    ASPERITY_STRESS,
    DRAG,
    DRAG_STRESS,
    FORCE_SHARE,
    HEIGHT_RATIO,
    LAG,
    LAG_TIME,
    LEAKAGE,
    LOAD_SCALE,
    MOMENT_SHARE,
    REST_STRESS,
    SHEAR,
    SHEAR_RATIO,
    LateralLookup,
)

LEAST_PRESSURE = 1e5
"""Pressure difference below which loads and friction are those of this one. [Pa]"""
AREA, REACH, PRELOAD, PRELOAD_MOMENT, HIGH, LOW, WARMTH = range(7)


@kernel
def update_lateral_films(s: SystemArrays, state: Array) -> None:
    """Find the load of the present pressures, and the films that carry that of the state."""
    table = s.lateral
    if table.counts.size == 0:
        return
    now, scales = table.now, table.scales
    high, low = s.node[int(scales[HIGH]), col.PRESSURE], s.node[int(scales[LOW]), col.PRESSURE]
    difference = max(high - low, LEAST_PRESSURE)
    force, moment = -scales[PRELOAD], -scales[PRELOAD_MOMENT]
    for i in range(s.size.nodes):
        above = s.node[i, col.PRESSURE] - low
        by_force, by_moment = table.weights[i, 0], table.weights[i, 1]
        if i < s.size.chambers:
            by_force += s.chamber_values[i, col.CHANNEL_MOTION + s.size.motions]
            by_moment += s.chamber_values[i, col.CHANNEL_MOTION + s.size.motions + 1]
        force += by_force * above
        moment += by_moment * above
    unit = scales[AREA] * difference
    now[LOAD_SCALE] = unit
    now[FORCE_SHARE], now[MOMENT_SHARE] = force / unit, moment / (unit * scales[REACH])
    viscosity = s.fluid.dynamic_viscosity * scales[WARMTH]
    at = (
        place(table, 0, state[s.size.film]),
        place(table, 1, state[s.size.film + 1]),
        place(table, 2, difference),
        place(table, 3, viscosity * abs(state[1])),
    )
    now[HEIGHT_RATIO] = math.exp(between(table, at, LEAKAGE) / 3.0)
    now[SHEAR_RATIO] = between(table, at, SHEAR)
    torque = unit * scales[REACH] / s.constant.lateral_torque
    now[DRAG_STRESS] = torque * between(table, at, DRAG)
    now[ASPERITY_STRESS] = torque * between(table, at, ASPERITY)
    now[REST_STRESS] = torque * between(table, (at[0], at[1], at[2], (0, 0.0)), ASPERITY)
    now[LAG_TIME] = math.exp(between(table, at, LAG)) * viscosity / difference


@kernel
def place(table: LateralLookup, axis: int, value: float) -> tuple[int, float]:
    """Node below a value, and the share of the next one; outside the nodes that of the edge."""
    nodes, count = table.axes[axis], table.counts[axis]
    if count == 1 or value <= nodes[0]:
        return 0, 0.0
    k = 0
    while k < count - 2 and value > nodes[k + 1]:
        k += 1
    return k, min((value - nodes[k]) / (nodes[k + 1] - nodes[k]), 1.0)


@kernel
def between(
    table: LateralLookup,
    at: tuple[tuple[int, float], tuple[int, float], tuple[int, float], tuple[int, float]],
    column: int,
) -> float:
    """Value between the nodes, linear along every axis."""
    found = 0.0
    for corner in range(16):
        a, b, c, d = corner & 1, corner >> 1 & 1, corner >> 2 & 1, corner >> 3
        share = at[0][1] if a else 1.0 - at[0][1]
        share *= at[1][1] if b else 1.0 - at[1][1]
        share *= at[2][1] if c else 1.0 - at[2][1]
        share *= at[3][1] if d else 1.0 - at[3][1]
        if share != 0.0:
            i, j, k, m = at[0][0] + a, at[1][0] + b, at[2][0] + c, at[3][0] + d
            found += share * table.values[i, j, k, m, column]
    return found


@kernel
def fill_film_rates(s: SystemArrays, state: Array, rate: Array) -> None:
    """Rates at which the load that the films carry follows that of the pressures."""
    table = s.lateral
    if table.counts.size == 0:
        return
    for k in range(2):
        first, last = table.axes[k, 0], table.axes[k, table.counts[k] - 1]
        missing = table.now[FORCE_SHARE + k] - state[s.size.film + k]
        # the gap stays at the edge of the table
        if missing > 0.0:
            missing *= state[s.size.film + k] < last
        else:
            missing *= state[s.size.film + k] > first
        rate[s.size.film + k] = missing / table.now[LAG_TIME]


@kernel
def fill_film_weights(s: SystemArrays, weight: Array) -> None:
    """Error allowed in the load that the films carry."""
    for k in range(s.size.film, s.size.load):
        weight[k] = s.constant.relative_tolerance


@kernel
def add_film_rates(s: SystemArrays, matrix: Array) -> None:
    """Derivatives of the load that the films carry by itself."""
    for k in range(s.size.film, s.size.load):
        matrix[k, k] -= 1.0 / s.lateral.now[LAG_TIME]
