r"""Mass flows along all flow paths.

Every path obeys one law, laminar at small and inertial at large flow, plus wall drag:

.. math::

    \Delta p = \frac{Q_p}{G} + \frac{\rho}{2 (C A)^2} Q_p |Q_p|, \qquad
    \dot m = \rho_{up} (Q_p + w h\, u\, \omega) .

The fluid carries the density and gas content of the node that it leaves. The power lost in
a path is the drop of enthalpy flow plus the work of the dragging walls against pressure.
"""

from __future__ import annotations

import math

from toothspace.closures.gap_flow import (
    curved_gap_conductance,
    parallel_gap_conductance,
)
from toothspace.closures.orifice import inertial_laminar_flow, orifice_conductance
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.ledger import THROTTLING
from toothspace.model.tables import table_values

ORIFICE, PARALLEL_GAP, CURVED_GAP = 0, 1, 2
GEOMETRY, DRAG, SHEAR, HEIGHT_BY_MOTION = 0, 3, 4, 5
DISCHARGE_COEFFICIENT = 0.7
HEIGHT_SMOOTHING = 1e-7


@njit(cache=True)
def update_path_tables(s: SystemArrays, shaft_angle: float) -> None:
    """Evaluate the geometry of all paths at a shaft angle, and their present partners."""
    for j in range(s.paths.table.size):
        angle = s.paths.phase[j] + s.paths.ratio[j] * shaft_angle
        turns = table_values(s.bank, s.paths.table[j], angle, s.work.path_values[j])
        s.work.path_b[j] = s.paths.node_b[j]
        if s.paths.partner_shift[j] != 0:
            first, count = s.paths.family_first[j], s.paths.family_count[j]
            member = s.paths.node_b[j] - first + turns * s.paths.partner_shift[j]
            s.work.path_b[j] = first + member % count


@njit(cache=True)
def update_gap_height(s: SystemArrays, state: Array, j: int) -> float:
    """Running height of a gap; it keeps its residual height where bodies would touch. [m]."""
    values = s.work.path_values[j]
    height = values[GEOMETRY]
    for k in range(s.size.motions):
        height += values[HEIGHT_BY_MOTION + k] * state[s.size.position + k]
    excess = height - s.paths.minimum_height[j]
    root = math.sqrt(excess * excess + 4.0 * HEIGHT_SMOOTHING * HEIGHT_SMOOTHING)
    s.work.path_height[j] = s.paths.minimum_height[j] + 0.5 * (excess + root)
    return 0.5 * (1.0 + excess / root)


@njit(cache=True)
def clear_path(s: SystemArrays, j: int) -> None:
    """Set all results of a closed path to zero."""
    w = s.work
    w.path_flow[j] = 0.0
    w.path_volume_flow[j] = 0.0
    w.path_by_pressure[j] = 0.0
    w.path_by_height[j] = 0.0
    w.path_drag[j] = 0.0
    w.path_loss[j] = 0.0
    w.path_shear[j] = 0.0
    w.path_height[j] = 0.0


@njit(cache=True)
def gap_conductance(
    kind: int, height: float, width: float, extent: float, viscosity: float
) -> tuple[float, float]:
    """Laminar conductance of a gap and its derivative with respect to the height."""
    if kind == PARALLEL_GAP:
        conductance = parallel_gap_conductance(height, width, extent, viscosity)
        return conductance, 3.0 * conductance / height
    conductance = curved_gap_conductance(height, width, extent, viscosity)
    return conductance, 2.5 * conductance / height


@njit(cache=True)
def update_path(s: SystemArrays, state: Array, j: int) -> None:
    """Flow of one path from its nodes' pressures and its gap, with derivatives."""
    w, paths = s.work, s.paths
    values = w.path_values[j]
    kind = paths.kind[j]
    size = values[0] if kind == ORIFICE else values[1]
    if size <= 1e-12:
        clear_path(s, j)
        return
    a, b = paths.node_a[j], w.path_b[j]
    drop = w.pressure[a] - w.pressure[b]
    density = w.density[a] if drop >= 0.0 else w.density[b]
    viscosity = dynamic_viscosity(0.5 * (w.pressure[a] + w.pressure[b]), s.fluid)
    drag, by_height, drag_by_height = 0.0, 0.0, 0.0
    if kind == ORIFICE:
        conductance = orifice_conductance(size, values[1], viscosity)
        area = size
    else:
        factor = update_gap_height(s, state, j)
        height, width = w.path_height[j], values[1]
        conductance, by_height = gap_conductance(kind, height, width, values[2], viscosity)
        area = width * height
        by_height *= factor
        drag_by_height = width * values[DRAG] * state[1] * factor
        drag = width * height * values[DRAG]
        w.path_shear[j] = paths.multiplicity[j] * viscosity * values[SHEAR] ** 2 * state[1]
        w.path_shear[j] *= width * values[2] / height
    flow, by_pressure, by_conductance = inertial_laminar_flow(
        drop, conductance, DISCHARGE_COEFFICIENT * area, density
    )
    m = paths.multiplicity[j]
    w.path_volume_flow[j] = m * (flow + drag * state[1])
    w.path_by_pressure[j] = m * by_pressure
    w.path_by_height[j] = m * (by_conductance * by_height + drag_by_height)
    w.path_drag[j] = m * drag


@njit(cache=True)
def update_network(s: SystemArrays, state: Array) -> None:
    """Mass and gas flows of all paths, summed into the nodes."""
    w = s.work
    w.mass_rate[:] = 0.0
    w.gas_rate[:] = 0.0
    for j in range(s.paths.table.size):
        update_path(s, state, j)
        flow = w.path_volume_flow[j]
        if flow == 0.0:
            w.path_flow[j] = 0.0
            continue
        a, b = s.paths.node_a[j], w.path_b[j]
        source = a if flow > 0.0 else b
        mass_flow = w.density[source] * flow
        gas_flow = mass_flow * w.gas[source]
        w.path_flow[j] = mass_flow
        w.mass_rate[a] -= mass_flow
        w.mass_rate[b] += mass_flow
        w.gas_rate[a] -= gas_flow
        w.gas_rate[b] += gas_flow


@njit(cache=True)
def book_throttling(s: SystemArrays, speed: float, ledger: Array) -> float:
    """Add the power lost in every path to its category; return the torque of wall drag. [N m]."""
    w = s.work
    torque = 0.0
    for j in range(s.paths.table.size):
        flow = w.path_flow[j]
        if flow == 0.0:
            continue
        a, b = s.paths.node_a[j], w.path_b[j]
        gas = w.gas[a] if flow > 0.0 else w.gas[b]
        drop = (1.0 - gas) * (w.liquid_enthalpy[a] - w.liquid_enthalpy[b])
        drop += gas * (w.gas_enthalpy[a] - w.gas_enthalpy[b])
        wall = w.path_drag[j] * (w.pressure[b] - w.pressure[a])
        w.path_loss[j] = flow * drop + wall * speed
        ledger[THROTTLING + s.paths.category[j]] += w.path_loss[j]
        torque += wall
    return torque
