r"""Jacobian of the right-hand side, assembled from the derivatives of each element.

Flows and forces depend on the mass in a node only through its pressure. The unknowns z of the
iteration are therefore each node's change of pressure, times the slope of mass over pressure, its
gas mass, and the motions; masses follow from them,

.. math::

    \delta m = z + \left.\frac{\partial m}{\partial m_g}\right|_p \delta m_g
               + \sum_k \left.\frac{\partial m}{\partial q_k}\right|_p \delta q_k .

Derivatives by z are those by the mass; those by gas and motions hold at constant pressure and are
mostly zero, so that few entries are filled and factorised.
"""

from __future__ import annotations

from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.circuit import add_elements
from toothspace.model.contacts import by_shift_and_turn
from toothspace.model.drive import add_coupling
from toothspace.model.lateral_lookup import add_film_rates


@kernel
def fill_jacobian(t: float, state: Array, s: SystemArrays, matrix: Array, basis: Array) -> None:
    """Derivatives of all rates by the unknowns at the state last evaluated, and their basis.

    Left out are energy rows, and what changes with the composition at constant pressure, but for
    the gas that flows take out of a node with them, which small spaces change within a step. The
    rows of port masses and port gas stand, so that mass balances close to round-off. Angle and
    speed of a free shaft are left to the iteration: its inertia makes their feedback weak.
    """
    fill_basis(s, basis)
    fill_rates(t, state, s, matrix)


@kernel
def fill_rates(t: float, state: Array, s: SystemArrays, matrix: Array) -> None:
    """Derivatives of all rates by the unknowns."""
    matrix[:, :] = 0.0
    matrix[0, 1] = 1.0
    for j in range(s.paths.open[-1]):
        if s.path[j, col.FLOW] != 0.0:
            add_path(s, j, matrix)
    add_gas_exchange(s, state, matrix)
    add_pressure_forces(s, matrix)
    add_films(s, matrix)
    add_contacts(s, state, matrix)
    add_elements(s, state, t, matrix)
    add_film_rates(s, matrix)
    add_coupling(s, state, matrix)


@kernel
def fill_basis(s: SystemArrays, basis: Array) -> None:
    """Change of mass at constant pressure with the gas mass of a node and with the motions."""
    node, values, size = s.node, s.chamber_values, s.size
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        stiffness = -1.0 / node[i, col.PRESSURE_BY_MASS]
        basis[size.mass + d, size.gas + d] = node[i, col.PRESSURE_BY_GAS] * stiffness
        if i < size.chambers:
            by_volume = node[i, col.PRESSURE_BY_VOLUME] * stiffness
            for k in range(size.motions):
                growth = values[i, col.CHANNEL_MOTION + k]
                basis[size.mass + d, size.position + k] = by_volume * growth


@kernel
def add_flow_change(
    s: SystemArrays, j: int, column: int, mass_change: float, gas_change: float, matrix: Array
) -> None:
    """Add the change of one path's flows with one state to the balances of both its nodes."""
    a, b = s.open_index[j, col.NODE_A], s.open_index[j, col.PRESENT_B]
    matrix[s.balance[a, 0], column] -= mass_change
    matrix[s.balance[b, 0], column] += mass_change
    matrix[s.balance[a, 1], column] -= gas_change
    matrix[s.balance[b, 1], column] += gas_change


@kernel
def add_path(s: SystemArrays, j: int, matrix: Array) -> None:
    """Derivatives of one path's flow through pressures and gap height."""
    node, size = s.node, s.size
    a, b = s.open_index[j, col.NODE_A], s.open_index[j, col.PRESENT_B]
    source = a if s.path[j, col.SENSE] > 0.0 else b
    gas = node[source, col.GAS]
    slope = node[source, col.DENSITY] * s.path[j, col.FLOW_BY_PRESSURE]
    for i, sign in ((a, 1.0), (b, -1.0)):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        change = sign * slope * node[i, col.PRESSURE_BY_MASS]
        add_flow_change(s, j, size.mass + d, change, gas * change, matrix)
    d = s.dynamic_index[source]
    if d >= 0:
        mass = node[source, col.DENSITY] * node[source, col.VOLUME]
        matrix[size.gas + d, size.gas + d] -= abs(s.path[j, col.FLOW]) / mass
    add_path_motions(s, j, gas, matrix)


@kernel
def add_path_motions(s: SystemArrays, j: int, gas: float, matrix: Array) -> None:
    """Derivatives of one path's flow with respect to the micro-motions at constant pressures."""
    by_height = s.path[j, col.FLOW_BY_HEIGHT]
    if by_height == 0.0:
        return
    a, b = s.open_index[j, col.NODE_A], s.open_index[j, col.PRESENT_B]
    by_height *= s.node[a if s.path[j, col.SENSE] > 0.0 else b, col.DENSITY]
    for k in range(s.size.motions):
        change = by_height * s.path_values[j, col.HEIGHT_BY_MOTION + k]
        if change != 0.0:
            add_flow_change(s, j, s.size.position + k, change, gas * change, matrix)


@kernel
def add_gas_exchange(s: SystemArrays, state: Array, matrix: Array) -> None:
    """Derivatives of gas release and absorption in all dynamic nodes."""
    node, size = s.node, s.size
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        row = size.gas + d
        by_pressure = state[size.mass + d] * node[i, col.EXCHANGE_BY_PRESSURE]
        matrix[row, size.mass + d] += by_pressure * node[i, col.PRESSURE_BY_MASS]
        matrix[row, size.gas + d] += node[i, col.EXCHANGE_BY_GAS]


@kernel
def add_pressure_forces(s: SystemArrays, matrix: Array) -> None:
    """Derivatives of the pressure forces on the motions by pressures, and by closing chambers."""
    node, values, size = s.node, s.chamber_values, s.size
    for i in range(size.chambers):
        d, share = s.dynamic_index[i], node[i, col.VOLUME_SHARE]
        for k in range(size.motions):
            area = values[i, col.CHANNEL_MOTION + k] / s.motion[k, col.MOTION_MASS]
            by_mass = area * share * node[i, col.PRESSURE_BY_MASS]
            matrix[size.velocity + k, size.mass + d] += by_mass
            if 0.0 < share < 1.0:
                bend = 0.5 * area * node[i, col.PRESSURE] / node[i, col.LEAST_VOLUME]
                for m in range(size.motions):
                    by_place = bend * values[i, col.CHANNEL_MOTION + m]
                    matrix[size.velocity + k, size.position + m] += by_place
    for k in range(size.motions):
        area = s.motion[k, col.PORT_AREA] / s.motion[k, col.MOTION_MASS]
        for port in range(2):
            i = size.chambers + port
            d = s.dynamic_index[i]
            if area != 0.0 and d >= 0:
                by_mass = (1.0 - 2.0 * port) * area * node[i, col.PRESSURE_BY_MASS]
                matrix[size.velocity + k, size.mass + d] += by_mass


@kernel
def add_films(s: SystemArrays, matrix: Array) -> None:
    """Derivatives of the film forces on the motions."""
    size, slopes = s.size, s.film_slopes
    for k in range(size.motions):
        matrix[size.position + k, size.velocity + k] = 1.0
        mass = s.motion[k, col.MOTION_MASS]
        for m in range(size.motions):
            matrix[size.velocity + k, size.position + m] += slopes[0, k, m] / mass
            matrix[size.velocity + k, size.velocity + m] += slopes[1, k, m] / mass


@kernel
def add_contacts(s: SystemArrays, state: Array, matrix: Array) -> None:
    """Derivatives of normal and friction forces of the compliant contacts on the motions."""
    size, values, displaced = s.size, s.contact_values[col.VALUE], s.contact_values[col.DISPLACED]
    for j in range(size.compliant):
        contact = s.contact[j]
        if contact[col.CONTACT_FORCE] == 0.0:
            continue
        friction_slope = contact[col.FRICTION_BY_FORCE]
        for m in range(size.motions):
            gap = displaced[j, col.GAP_BY_MOTION + m]
            slip = values[j, col.GAP_BY_MOTION + size.motions + m]
            turned = displaced[j, col.GAP_BY_MOTION + size.motions + m]
            by_shift, by_turn = by_shift_and_turn(values, j, slip, contact[col.CONTACT_COLUMNS + m])
            by_place = -contact[col.FORCE_BY_OVERLAP] * gap - contact[col.FORCE_BY_RATE] * turned
            by_speed = -contact[col.FORCE_BY_RATE] * gap
            dragged = friction_slope * by_speed + contact[col.FRICTION_BY_SLIP] * slip
            for k in range(size.motions):
                mass = s.motion[k, col.MOTION_MASS]
                normal = displaced[j, col.GAP_BY_MOTION + k] / mass
                along = values[j, col.GAP_BY_MOTION + size.motions + k] / mass
                about = contact[col.CONTACT_COLUMNS + k] / mass
                row = size.velocity + k
                place, speed = size.position + m, size.velocity + m
                matrix[row, place] += (normal + along * friction_slope) * by_place
                matrix[row, place] += contact[col.CONTACT_FORCE] * (
                    by_shift * along + by_turn * about
                )
                matrix[row, speed] += normal * by_speed + along * dragged
