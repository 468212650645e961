r"""Columns of fluid between the cells of a line: inertia, and friction that remembers.

The volume flow q of a column of length l and area A between two nodes follows

.. math::

    L \dot q = p_a - p_b - R\,\phi(q)\,q - \sum_i g_i (q - z_i), \qquad
    \dot z_i = n_i (q - z_i), \qquad L = \rho l / A

with the laminar resistance R, its growth :math:`\phi` in turbulent flow and the branches
:math:`(n_i, g_i)` of :func:`toothspace.closures.line_friction.memory_branches`. The state of a
column is q, then all z; each branch acts like a spring of mass :math:`g_i/n_i`.
"""

from __future__ import annotations

from toothspace.closures.line_friction import turbulent_growth
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays

FLUID_COLUMN = 4
SMALL_SHARE = 0.03
INERTANCE, RESISTANCE = col.PARAMETER_1, col.PARAMETER_2
CRITICAL_FLOW, STATE = col.PARAMETER_3, col.PARAMETER_4


@kernel
def column_flow(s: SystemArrays, element: Array, state: Array) -> float:
    """Volume flow of a column: a state, which no pressure changes at once. [m3/s]."""
    return state[s.size.column + int(element[STATE])]


@kernel
def _drop_along(s: SystemArrays, element: Array) -> float:
    a, b = int(element[col.ELEMENT_A]), int(element[col.ELEMENT_B])
    return s.node[a, col.PRESSURE] - s.node[b, col.PRESSURE]


@kernel
def fill_column_rates(s: SystemArrays, state: Array, rate: Array) -> None:
    """Rates of the flows and of the memory of all columns."""
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[col.ELEMENT_KIND] != FLUID_COLUMN:
            continue
        place = s.size.column + int(element[STATE])
        first, count = int(element[col.FIRST_KNOT]), int(element[col.KNOTS])
        flow = state[place]
        drop = _drop_along(s, element)
        growth, _ = turbulent_growth(abs(flow) / element[CRITICAL_FLOW])
        drop -= element[RESISTANCE] * growth * flow
        for i in range(count):
            lag = flow - state[place + 1 + i]
            rate[place + 1 + i] = s.schedule[first + i, 0] * lag
            drop -= s.schedule[first + i, 1] * lag
        rate[place] = drop / element[INERTANCE]


@kernel
def fill_column_weights(s: SystemArrays, state: Array, weight: Array) -> None:
    """Error allowed in flows and memory of all columns."""
    tolerance = s.constant.relative_tolerance
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[col.ELEMENT_KIND] != FLUID_COLUMN:
            continue
        place = s.size.column + int(element[STATE])
        allowed = tolerance * (abs(state[place]) + SMALL_SHARE * element[CRITICAL_FLOW])
        for i in range(int(element[col.KNOTS]) + 1):
            weight[place + i] = allowed


@kernel
def column_power(s: SystemArrays, element: Array, state: Array) -> float:
    """Rate at which the kinetic energy of a column grows: work less dissipation. [W]."""
    place = s.size.column + int(element[STATE])
    flow = state[place]
    drop = _drop_along(s, element)
    growth, _ = turbulent_growth(abs(flow) / element[CRITICAL_FLOW])
    power = flow * (drop - element[RESISTANCE] * growth * flow)
    first = int(element[col.FIRST_KNOT])
    for i in range(int(element[col.KNOTS])):
        lag = flow - state[place + 1 + i]
        power -= s.schedule[first + i, 1] * lag * lag
    return power


@kernel
def column_energy(s: SystemArrays, state: Array) -> float:
    """Kinetic energy of all columns. [J]."""
    energy = 0.0
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[col.ELEMENT_KIND] != FLUID_COLUMN:
            continue
        place = s.size.column + int(element[STATE])
        energy += 0.5 * element[INERTANCE] * state[place] ** 2
        first = int(element[col.FIRST_KNOT])
        for i in range(first, first + int(element[col.KNOTS])):
            place += 1
            energy += 0.5 * s.schedule[i, 1] / s.schedule[i, 0] * state[place] ** 2
    return energy


@kernel
def add_column(s: SystemArrays, state: Array, j: int, matrix: Array) -> None:
    """Derivatives of a column's flow and memory, and of what it carries between its nodes."""
    element, size = s.elements[j], s.size
    place = size.column + int(element[STATE])
    growth, slope = turbulent_growth(abs(state[place]) / element[CRITICAL_FLOW])
    slope *= abs(state[place]) / element[CRITICAL_FLOW]
    inertance = element[INERTANCE]
    matrix[place, place] -= element[RESISTANCE] * (growth + slope) / inertance
    first = int(element[col.FIRST_KNOT])
    for i in range(int(element[col.KNOTS])):
        decay, resistance = s.schedule[first + i, 0], s.schedule[first + i, 1]
        memory = place + 1 + i
        matrix[place, place] -= resistance / inertance
        matrix[place, memory] += resistance / inertance
        matrix[memory, place] += decay
        matrix[memory, memory] -= decay
    for i, sign in ((int(element[col.ELEMENT_A]), 1.0), (int(element[col.ELEMENT_B]), -1.0)):
        d = s.dynamic_index[i]
        if d >= 0:
            matrix[place, size.mass + d] += sign * s.node[i, col.PRESSURE_BY_MASS] / inertance
    add_carried(s, j, place, matrix)


@kernel
def add_carried(s: SystemArrays, j: int, column: int, matrix: Array) -> None:
    """Derivatives of the mass and gas that a column carries with respect to its flow."""
    element = s.elements[j]
    a, b = int(element[col.ELEMENT_A]), int(element[col.ELEMENT_B])
    source = a if element[col.ELEMENT_FLOW] >= 0.0 else b
    density, gas = s.node[source, col.DENSITY], s.node[source, col.GAS]
    for i, sign in ((a, -1.0), (b, 1.0)):
        matrix[s.balance[i, 0], column] += sign * density
        matrix[s.balance[i, 1], column] += sign * gas * density
