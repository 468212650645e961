r"""Compliant contacts between bodies: normal force, friction, energy and loss.

The gap of a contact follows the shaft and the micro-motions, and so do its forces:

.. math::

    g = g_0(\theta) + \sum_k g_k(\theta)\, q_k
        + \tfrac12 (A u^2 + 2 B u \delta + C \delta^2), \qquad
    Q_k = F \frac{\partial g}{\partial q_k} + F_t\, t_k, \qquad
    M = -F \frac{\partial g}{\partial \theta} - F_t\, s
        + \left.\frac{\partial U}{\partial \theta}\right|_g

with the tangential shift :math:`u = \sum_k t_k q_k` and the relative rotation :math:`\delta` of
the surfaces, the normal force F, the friction force :math:`F_t = -\mu(v)\, F`, the slip
:math:`v = s\, \omega + \sum_k t_k \dot q_k` and the torque M that the shaft has to give. The
last term is the work that a flank of varying curvature asks for. Work, stored energy
and losses then balance to round-off.
"""

from __future__ import annotations

from toothspace.closures.contact_law import (
    REACH,
    impact_factor,
    logarithmic_law,
    power_law,
    rounded_depth,
    squeeze_damping,
)
from toothspace.closures.traction import FlankSurface, mesh_friction
from toothspace.core.compiled import inlined, kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.ledger import CONTACT_LOSS, FRICTION

FAR = 1e-3
LEAST_IMPACT = 1e-4
"""Smallest speed of an impact: slower surfaces come to rest on each other. [m/s]"""


@kernel
def motion_force(s: SystemArrays, k: int) -> float:
    """Sum of all generalised forces on a free motion. [N] or [N m]."""
    motion = s.motion
    force = motion[k, col.PRESSURE_FORCE] + motion[k, col.FILM_FORCE]
    return force + motion[k, col.CONTACT_LOAD] + outer_force(s, k)


@kernel
def outer_force(s: SystemArrays, k: int) -> float:
    """Force from outside on a free motion: given load and port pressures on blocks. [N]."""
    force = s.motion[k, col.EXTERNAL_FORCE]
    if s.motion[k, col.PORT_AREA] != 0.0:
        inlet = s.size.chambers
        drop = s.node[inlet, col.PRESSURE] - s.node[inlet + 1, col.PRESSURE]
        force += s.motion[k, col.PORT_AREA] * drop
    return force


@kernel
def contact_gap(s: SystemArrays, state: Array, j: int) -> float:
    """Gap of a compliant contact with the present positions of the bodies. [m]."""
    values = s.contact_values[col.VALUE]
    if values[j, col.POSSIBLE] == 0.0:
        return FAR
    gap = values[j, col.GAP]
    for k in range(s.size.motions):
        gap += values[j, col.GAP_BY_MOTION + k] * state[s.size.position + k]
    shift = _shifted(s, values, state, s.size.position, j)
    turn = _turned(s, state, s.size.position, j)
    by_shift, by_turn = by_shift_and_turn(values, j, shift, turn)
    return gap + 0.5 * (by_shift * shift + by_turn * turn)


@inlined
def _shifted(s: SystemArrays, plane: Array, state: Array, first: int, j: int) -> float:
    """Displacement of the surfaces along each other by motions of a state, or its rate."""
    shift, slip = 0.0, col.GAP_BY_MOTION + s.size.motions
    for k in range(s.size.motions):
        shift += plane[j, slip + k] * state[first + k]
    return shift


@inlined
def _turned(s: SystemArrays, state: Array, first: int, j: int) -> float:
    """Relative rotation of the bodies by motions of a state, or its rate."""
    turn = 0.0
    for k in range(s.size.motions):
        turn += s.contact[j, col.CONTACT_COLUMNS + k] * state[first + k]
    return turn


@inlined
def by_shift_and_turn(plane: Array, j: int, shift: float, turn: float) -> tuple[float, float]:
    """Derivatives of the second-order part of a gap by shift and rotation."""
    mixed = plane[j, col.BY_SHIFT_AND_TURN]
    by_shift = plane[j, col.BY_SHIFTS] * shift + mixed * turn
    return by_shift, mixed * shift + plane[j, col.BY_TURNS] * turn


@kernel
def update_contacts(s: SystemArrays, state: Array) -> None:
    """Forces of all compliant contacts and their sums on the free motions."""
    size, contact, motion = s.size, s.contact, s.motion
    values, displaced = s.contact_values[col.VALUE], s.contact_values[col.DISPLACED]
    for k in range(size.motions):
        motion[k, col.CONTACT_LOAD] = 0.0
    for j in range(size.compliant):
        gap = contact_gap(s, state, j)
        if gap >= reach_of(contact[j]):
            contact[j, : col.CONTACT_STATE] = 0.0
            continue
        rate, by_angle, slip = displace_contact(s, state, j)
        add_contact_force(s, j, -gap, -rate)
        add_squeeze_damping(s, j, gap, -rate)
        rub(s, j, slip, values[j, col.ROLLING] * state[1])
        contact[j, col.CONTACT_TORQUE] -= contact[j, col.CONTACT_FORCE] * by_angle
        contact[j, col.CONTACT_TORQUE] -= contact[j, col.CONTACT_FRICTION] * values[j, col.SLIDING]
        for k in range(size.motions):
            load = contact[j, col.CONTACT_FORCE] * displaced[j, col.GAP_BY_MOTION + k]
            along = values[j, col.GAP_BY_MOTION + size.motions + k]
            motion[k, col.CONTACT_LOAD] += load + contact[j, col.CONTACT_FRICTION] * along


@kernel
def note_approach(s: SystemArrays, state: Array) -> None:
    """Set the damping of each open contact by the speed at which its surfaces approach.

    Called for accepted states only, so an impact keeps the speed of the last one before it.
    """
    for j in range(s.size.compliant):
        loss = s.contact[j, col.PAIR_LOSS]
        if loss > 0.0 and contact_gap(s, state, j) >= s.contact[j, col.PAIR_ONSET]:
            rate, _, _ = displace_contact(s, state, j)
            s.contact[j, col.PAIR_DAMPING] = loss / max(-rate, LEAST_IMPACT)


@kernel
def displace_contact(s: SystemArrays, state: Array, j: int) -> tuple[float, float, float]:
    """Derivatives of the gap of a contact where the bodies are, and what they change in time.

    Returns the rate of the gap [m/s], its part by the angle [m/rad] and the slip [m/s].
    """
    size, values, slopes = s.size, s.contact_values[col.VALUE], s.contact_values[col.SLOPE]
    displaced, place, speed = s.contact_values[col.DISPLACED], size.position, size.velocity
    shift, turn = _shifted(s, values, state, place, j), _turned(s, state, place, j)
    drift, slide = _shifted(s, slopes, state, place, j), _shifted(s, values, state, speed, j)
    by_shift, by_turn = by_shift_and_turn(values, j, shift, turn)
    new_by_shift, new_by_turn = by_shift_and_turn(slopes, j, shift, turn)
    by_angle = slopes[j, col.GAP] + 0.5 * (new_by_shift * shift + new_by_turn * turn)
    by_angle += by_shift * drift
    faster_by_shift, faster_by_turn = by_shift_and_turn(
        values, j, slide + drift * state[1], _turned(s, state, speed, j)
    )
    faster_by_shift += new_by_shift * state[1]
    faster_by_turn += new_by_turn * state[1]
    rate = 0.0
    for k in range(size.motions):
        gap, slip = col.GAP_BY_MOTION + k, col.GAP_BY_MOTION + size.motions + k
        along, about = values[j, slip], s.contact[j, col.CONTACT_COLUMNS + k]
        displaced[j, gap] = values[j, gap] + by_shift * along + by_turn * about
        turned = (slopes[j, gap] + by_shift * slopes[j, slip]) * state[1]
        displaced[j, slip] = turned + faster_by_shift * along + faster_by_turn * about
        by_angle += slopes[j, gap] * state[place + k]
        rate += displaced[j, gap] * state[speed + k]
    return rate + by_angle * state[1], by_angle, slide + values[j, col.SLIDING] * state[1]


@kernel
def reach_of(pair: Array) -> float:
    """Gap from which on a contact exerts no force. [m]."""
    if pair[col.PAIR_SQUEEZE] > 0.0:
        return max(REACH * pair[col.PAIR_ROUGHNESS], pair[col.PAIR_ONSET])
    return pair[col.PAIR_ONSET]


@kernel
def add_squeeze_damping(s: SystemArrays, j: int, gap: float, rate: float) -> None:
    """Add the squeeze damping of one contact that closes."""
    contact = s.contact[j]
    if contact[col.PAIR_SQUEEZE] == 0.0 or rate <= 0.0:
        return
    curvature, viscosity = s.contact_values[col.VALUE, j, col.CURVATURE], s.fluid.dynamic_viscosity
    damping, by_gap = squeeze_damping(gap, contact[col.PAIR_ROUGHNESS], curvature, viscosity)
    width = contact[col.PAIR_WIDTH]
    contact[col.CONTACT_FORCE] += width * damping * rate
    contact[col.CONTACT_DAMPING] += width * damping * rate * rate
    contact[col.FORCE_BY_OVERLAP] -= width * by_gap * rate
    contact[col.FORCE_BY_RATE] += width * damping


@kernel
def add_contact_force(s: SystemArrays, j: int, overlap: float, rate: float) -> None:
    """Normal force of one contact, its energy, loss and derivatives."""
    contact = s.contact[j]
    values, slopes = s.contact_values[col.VALUE], s.contact_values[col.SLOPE]
    depth, slope, bend = rounded_depth(overlap, contact[col.PAIR_ONSET])
    if depth == 0.0:
        contact[: col.CONTACT_STATE] = 0.0
        return
    if contact[col.PAIR_POWER_LAW] > 0.0:
        load, stiffness, energy, by_level, by_exponent = power_law(
            depth, values[j, col.LAW_LEVEL], values[j, col.LAW_EXPONENT]
        )
    else:
        load, stiffness, energy, by_level = logarithmic_law(
            depth, values[j, col.LAW_LEVEL], 0.5 * contact[col.PAIR_MODULUS]
        )
        by_exponent = 0.0
    width = contact[col.PAIR_WIDTH]
    elastic = width * load * slope
    factor = impact_factor(rate, contact[col.PAIR_DAMPING])
    contact[col.CONTACT_FORCE] = elastic * factor
    contact[col.CONTACT_ENERGY] = width * energy
    contact[col.CONTACT_DAMPING] = elastic * (factor - 1.0) * rate
    by_angle = by_level * slopes[j, col.LAW_LEVEL] + by_exponent * slopes[j, col.LAW_EXPONENT]
    contact[col.CONTACT_TORQUE] = width * by_angle
    contact[col.FORCE_BY_OVERLAP] = width * (stiffness * slope * slope + load * bend) * factor
    contact[col.FORCE_BY_RATE] = elastic * contact[col.PAIR_DAMPING] if factor > 0.0 else 0.0


@kernel
def rub(s: SystemArrays, j: int, slip: float, rolling: float) -> None:
    """Friction force of one contact on body b along the tangent, and its derivatives."""
    contact, values = s.contact[j], s.contact_values[col.VALUE]
    modulus, roughness = contact[col.PAIR_MODULUS], contact[col.PAIR_ROUGHNESS]
    boundary, limit = contact[col.PAIR_BOUNDARY], contact[col.PAIR_LIMIT]
    surface = FlankSurface(modulus, roughness, boundary, limit)
    force, width = contact[col.CONTACT_FORCE], contact[col.PAIR_WIDTH]
    friction, by_load, by_slip = mesh_friction(
        force / width, 1.0 / values[j, col.CURVATURE], slip, rolling, s.fluid, surface
    )
    contact[col.CONTACT_SLIP] = slip
    contact[col.CONTACT_FRICTION] = -friction * force
    contact[col.FRICTION_BY_FORCE] = -friction - force * by_load / width
    contact[col.FRICTION_BY_SLIP] = -by_slip * force


@kernel
def book_contacts(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add losses of the compliant contacts to the ledger; return their shaft torque. [N m]."""
    contact, torque = s.contact, 0.0
    for j in range(s.size.compliant):
        account = int(contact[j, col.PAIR_ACCOUNT])
        drag = contact[j, col.CONTACT_FRICTION]
        ledger[FRICTION + account] -= drag * contact[j, col.CONTACT_SLIP]
        ledger[CONTACT_LOSS] += contact[j, col.CONTACT_DAMPING]
        s.torque[account] -= drag * s.contact_values[col.VALUE, j, col.SLIDING]
        torque += contact[j, col.CONTACT_TORQUE]
    return torque
