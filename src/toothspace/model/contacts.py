r"""Compliant contacts between bodies: normal force, friction, energy and loss.

The gap of a contact follows the shaft and the micro-motions, and so do its forces:

.. math::

    g = g_0(\theta) + \sum_k g_k(\theta)\, q_k, \qquad
    Q_k = F g_k + F_t\, t_k, \qquad
    M = -F \frac{\partial g}{\partial \theta} - F_t\, s
        + \left.\frac{\partial U}{\partial \theta}\right|_g

with the normal force F, the friction force :math:`F_t = -\mu(v)\, F`, the slip
:math:`v = s\, \omega + \sum_k t_k \dot q_k` and the torque M that the shaft has to give. The
last term is the work that a flank of varying curvature asks for. Work, stored energy
and losses then balance to round-off.
"""

from __future__ import annotations

from toothspace.closures.contact_law import impact_factor, logarithmic_law, power_law, rounded_depth
from toothspace.closures.squeeze_film import REACH, squeeze_damping
from toothspace.closures.traction import FlankSurface, mesh_friction
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model.arrays import (
    CONTACT_DAMPING,
    CONTACT_ENERGY,
    CONTACT_FORCE,
    CONTACT_FRICTION,
    CONTACT_LOAD,
    CONTACT_SLIP,
    CONTACT_STATE,
    CONTACT_TORQUE,
    CURVATURE,
    EXTERNAL_FORCE,
    FILM_FORCE,
    FORCE_BY_OVERLAP,
    FORCE_BY_RATE,
    FRICTION_BY_FORCE,
    FRICTION_BY_SLIP,
    GAP,
    GAP_BY_MOTION,
    LAW_EXPONENT,
    LAW_LEVEL,
    PAIR_ACCOUNT,
    PAIR_BOUNDARY,
    PAIR_DAMPING,
    PAIR_LIMIT,
    PAIR_LOSS,
    PAIR_MODULUS,
    PAIR_ONSET,
    PAIR_POWER_LAW,
    PAIR_ROUGHNESS,
    PAIR_SQUEEZE,
    PAIR_WIDTH,
    PORT_AREA,
    POSSIBLE,
    PRESSURE,
    PRESSURE_FORCE,
    ROLLING,
    SLIDING,
    SLOPE,
    VALUE,
    SystemArrays,
)
from toothspace.model.ledger import CONTACT_LOSS, FRICTION

FAR = 1e-3
LEAST_IMPACT = 1e-4
"""Smallest speed of an impact: slower surfaces come to rest on each other. [m/s]"""


@kernel
def motion_force(s: SystemArrays, k: int) -> float:
    """Sum of all generalised forces on a free motion. [N] or [N m]."""
    motion = s.motion
    force = motion[k, PRESSURE_FORCE] + motion[k, FILM_FORCE]
    return force + motion[k, CONTACT_LOAD] + outer_force(s, k)


@kernel
def outer_force(s: SystemArrays, k: int) -> float:
    """Force from outside on a free motion: given load and port pressures on blocks. [N]."""
    force = s.motion[k, EXTERNAL_FORCE]
    if s.motion[k, PORT_AREA] != 0.0:
        inlet = s.size.chambers
        drop = s.node[inlet, PRESSURE] - s.node[inlet + 1, PRESSURE]
        force += s.motion[k, PORT_AREA] * drop
    return force


@kernel
def contact_gap(s: SystemArrays, state: Array, j: int) -> float:
    """Gap of a compliant contact with the present positions of the bodies. [m]."""
    values = s.contact_values[VALUE]
    if values[j, POSSIBLE] == 0.0:
        return FAR
    gap = values[j, GAP]
    for k in range(s.size.motions):
        gap += values[j, GAP_BY_MOTION + k] * state[s.size.position + k]
    return gap


@kernel
def update_contacts(s: SystemArrays, state: Array) -> None:
    """Forces of all compliant contacts and their sums on the free motions."""
    size, contact, motion = s.size, s.contact, s.motion
    values = s.contact_values[VALUE]
    for k in range(size.motions):
        motion[k, CONTACT_LOAD] = 0.0
    for j in range(size.compliant):
        gap = contact_gap(s, state, j)
        if gap >= reach_of(contact[j]):
            contact[j, :CONTACT_STATE] = 0.0
            continue
        rate, by_angle, slip = _rates(s, state, j)
        press(s, j, -gap, -rate)
        cushion(s, j, gap, -rate)
        rub(s, j, slip, values[j, ROLLING] * state[1])
        contact[j, CONTACT_TORQUE] -= contact[j, CONTACT_FORCE] * by_angle
        contact[j, CONTACT_TORQUE] -= contact[j, CONTACT_FRICTION] * values[j, SLIDING]
        for k in range(size.motions):
            load = contact[j, CONTACT_FORCE] * values[j, GAP_BY_MOTION + k]
            along = values[j, GAP_BY_MOTION + size.motions + k]
            motion[k, CONTACT_LOAD] += load + contact[j, CONTACT_FRICTION] * along


@kernel
def note_approach(s: SystemArrays, state: Array) -> None:
    """Set the damping of each open contact by the speed at which its surfaces approach.

    Called for accepted states only, so an impact keeps the speed of the last one before it.
    """
    for j in range(s.size.compliant):
        loss = s.contact[j, PAIR_LOSS]
        if loss > 0.0 and contact_gap(s, state, j) >= s.contact[j, PAIR_ONSET]:
            rate, _, _ = _rates(s, state, j)
            s.contact[j, PAIR_DAMPING] = loss / max(-rate, LEAST_IMPACT)


@kernel
def _rates(s: SystemArrays, state: Array, j: int) -> tuple[float, float, float]:
    """Rate of the gap [m/s], its part by the angle [m/rad] and the slip [m/s] of a contact."""
    size, values, slopes = s.size, s.contact_values[VALUE], s.contact_values[SLOPE]
    by_angle = slopes[j, GAP]
    slip = values[j, SLIDING] * state[1]
    rate = 0.0
    for k in range(size.motions):
        speed = state[size.velocity + k]
        by_angle += slopes[j, GAP_BY_MOTION + k] * state[size.position + k]
        rate += values[j, GAP_BY_MOTION + k] * speed
        slip += values[j, GAP_BY_MOTION + size.motions + k] * speed
    return rate + by_angle * state[1], by_angle, slip


@kernel
def reach_of(pair: Array) -> float:
    """Gap from which on a contact exerts no force. [m]."""
    if pair[PAIR_SQUEEZE] > 0.0:
        return max(REACH * pair[PAIR_ROUGHNESS], pair[PAIR_ONSET])
    return pair[PAIR_ONSET]


@kernel
def cushion(s: SystemArrays, j: int, gap: float, rate: float) -> None:
    """Add the force of the film that an approach squeezes out of one contact."""
    contact = s.contact[j]
    if contact[PAIR_SQUEEZE] == 0.0 or rate <= 0.0:
        return
    curvature, viscosity = s.contact_values[VALUE, j, CURVATURE], s.fluid.dynamic_viscosity
    damping, by_gap = squeeze_damping(gap, contact[PAIR_ROUGHNESS], curvature, viscosity)
    width = contact[PAIR_WIDTH]
    contact[CONTACT_FORCE] += width * damping * rate
    contact[CONTACT_DAMPING] += width * damping * rate * rate
    contact[FORCE_BY_OVERLAP] -= width * by_gap * rate
    contact[FORCE_BY_RATE] += width * damping


@kernel
def press(s: SystemArrays, j: int, overlap: float, rate: float) -> None:
    """Normal force of one contact, its energy, loss and derivatives."""
    contact = s.contact[j]
    values, slopes = s.contact_values[VALUE], s.contact_values[SLOPE]
    depth, slope, bend = rounded_depth(overlap, contact[PAIR_ONSET])
    if depth == 0.0:
        contact[:CONTACT_STATE] = 0.0
        return
    if contact[PAIR_POWER_LAW] > 0.0:
        load, stiffness, energy, by_level, by_exponent = power_law(
            depth, values[j, LAW_LEVEL], values[j, LAW_EXPONENT]
        )
    else:
        load, stiffness, energy, by_level = logarithmic_law(
            depth, values[j, LAW_LEVEL], 0.5 * contact[PAIR_MODULUS]
        )
        by_exponent = 0.0
    width = contact[PAIR_WIDTH]
    elastic = width * load * slope
    factor = impact_factor(rate, contact[PAIR_DAMPING])
    contact[CONTACT_FORCE] = elastic * factor
    contact[CONTACT_ENERGY] = width * energy
    contact[CONTACT_DAMPING] = elastic * (factor - 1.0) * rate
    by_angle = by_level * slopes[j, LAW_LEVEL] + by_exponent * slopes[j, LAW_EXPONENT]
    contact[CONTACT_TORQUE] = width * by_angle
    contact[FORCE_BY_OVERLAP] = width * (stiffness * slope * slope + load * bend) * factor
    contact[FORCE_BY_RATE] = elastic * contact[PAIR_DAMPING] if factor > 0.0 else 0.0


@kernel
def rub(s: SystemArrays, j: int, slip: float, rolling: float) -> None:
    """Friction force of one contact on body b along the tangent, and its derivatives."""
    contact, values = s.contact[j], s.contact_values[VALUE]
    surface = FlankSurface(
        contact[PAIR_MODULUS], contact[PAIR_ROUGHNESS], contact[PAIR_BOUNDARY], contact[PAIR_LIMIT]
    )
    force, width = contact[CONTACT_FORCE], contact[PAIR_WIDTH]
    friction, by_load, by_slip = mesh_friction(
        force / width, 1.0 / values[j, CURVATURE], slip, rolling, s.fluid, surface
    )
    contact[CONTACT_SLIP] = slip
    contact[CONTACT_FRICTION] = -friction * force
    contact[FRICTION_BY_FORCE] = -friction - force * by_load / width
    contact[FRICTION_BY_SLIP] = -by_slip * force


@kernel
def book_contacts(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add losses of the compliant contacts to the ledger; return their shaft torque. [N m]."""
    contact, torque = s.contact, 0.0
    for j in range(s.size.compliant):
        account = int(contact[j, PAIR_ACCOUNT])
        drag = contact[j, CONTACT_FRICTION]
        ledger[FRICTION + account] -= drag * contact[j, CONTACT_SLIP]
        ledger[CONTACT_LOSS] += contact[j, CONTACT_DAMPING]
        s.torque[account] -= drag * s.contact_values[VALUE, j, SLIDING]
        torque += contact[j, CONTACT_TORQUE]
    return torque
