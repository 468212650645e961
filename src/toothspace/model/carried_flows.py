r"""Flows of paths that an iteration carries on, for steps in which pressures alone do not converge.

Wide passages of a slow machine hold their ends at equal pressure to far below the tolerance. Their
flow follows from the mass balance; as a function of the pressure drop it is steep, a square root,
and changes sign with an error of the drop. Newton's method for drops swings there from one side to
the other. With the flow as an unknown of its own [1]_ the law reads

.. math:: \Delta p = \Phi(Q) = \frac{Q}{G} + \frac{\rho}{2 (C A)^2} Q |Q|, \qquad
    Q_{n+1} = Q_n + \frac{\Delta p_{n+1} - \Phi(Q_n)}{\Phi'(Q_n)} .

Flows then balance after the first linear solution, and drops follow them. Which end a flow comes
from follows from the linear solution. The first one begins with that of the last step.
A converged iteration gives the same flows as the law of drops.

References
----------
.. [1] E. Todini and S. Pilati, "A gradient algorithm for the analysis of pipe networks", in
   Computer Applications in Water Supply, vol. 1, Research Studies Press, 1988, 1-20.
"""

from __future__ import annotations

from toothspace.closures.orifice import inertial_laminar_drop
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model.arrays import (
    CARRIED_PRESSURE,
    CONDUCTANCE,
    DENSITY,
    DROP,
    GAS,
    INFLOW_DENSITY,
    LAST_FLOW,
    LINE_DROP,
    LINE_FLOW,
    LINE_SLOPE,
    NODE_A,
    OPENING,
    PRESENT_B,
    PRESSURE,
    PRESSURE_BY_GAS,
    PRESSURE_BY_MASS,
    PRESSURE_BY_VOLUME,
    VOLUME,
    VOLUME_FLOW,
    SystemArrays,
)
from toothspace.numerics.ndf_types import FROM_LAST_STEP, FROM_STATE


@kernel
def carry_flows(s: SystemArrays, origin: int) -> None:
    """Set where the next evaluations take the flows of paths from."""
    s.origin[0] = origin


@kernel
def carries(s: SystemArrays) -> bool:
    """Whether flows are carried on, not found from the drops of pressure."""
    return bool(s.origin[0] != FROM_STATE)


@kernel
def set_quasi_steady_pressures(s: SystemArrays, state: Array) -> None:
    """Move the pressures of the last evaluation linearly with masses; volumes follow."""
    node, size = s.node, s.size
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        node[i, CARRIED_PRESSURE] = node[i, PRESSURE]
        if d < 0:
            continue
        mass = node[i, DENSITY] * node[i, VOLUME]
        by_mass = node[i, PRESSURE_BY_MASS] * (state[size.mass + d] - mass)
        by_gas = node[i, PRESSURE_BY_GAS] * (state[size.gas + d] - node[i, GAS] * mass)
        node[i, CARRIED_PRESSURE] += by_mass + by_gas
        if i < size.chambers:
            node[i, CARRIED_PRESSURE] -= node[i, PRESSURE_BY_VOLUME] * node[i, VOLUME]


@kernel
def carry_volumes(s: SystemArrays) -> None:
    """Move these pressures on with the present volumes of the chambers."""
    node = s.node
    for i in range(s.size.chambers):
        node[i, CARRIED_PRESSURE] += node[i, PRESSURE_BY_VOLUME] * node[i, VOLUME]


@kernel
def carried_flow(s: SystemArrays, j: int, multiplicity: float, drag: float) -> float:
    """Flow of one gap of an open path by the linear equations, or of the last step. [m3/s]."""
    path = s.path[j]
    if s.origin[0] == FROM_LAST_STEP:
        last = path[LAST_FLOW] if path[LAST_FLOW] != 0.0 else path[VOLUME_FLOW]
        return float((last - drag) / multiplicity)
    a, b = s.open_index[j, NODE_A], s.open_index[j, PRESENT_B]
    drop = s.node[a, CARRIED_PRESSURE] - s.node[b, CARRIED_PRESSURE]
    return float(path[LINE_FLOW] + path[LINE_SLOPE] * (drop - path[LINE_DROP]))


@kernel
def line_of_flow(s: SystemArrays, j: int, flow: float) -> tuple[float, float]:
    """Flow of an open path on the tangent at a flow, with its slope by the pressure drop."""
    path = s.path[j]
    drop, slope = inertial_laminar_drop(
        flow, path[CONDUCTANCE], path[OPENING], path[INFLOW_DENSITY]
    )
    return flow + (path[DROP] - drop) / slope, 1.0 / slope
