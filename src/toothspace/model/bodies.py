r"""Radial motion of the bodies in their journal bearings.

Each free micro-motion q obeys Newton's law with the generalised pressure force, the journal
films, their touching asperities and an external force:

.. math::

    M \ddot q = \sum_i p_i \frac{\partial V_i}{\partial q} + F_{film}(e, \dot e)
        - F_{asp}(|e|)\, \frac{e}{|e|} + F_{ext}, \qquad e = q - q_{bush} .
"""

from __future__ import annotations

import math

import numpy as np

from toothspace.closures.bearing_map import journal_force
from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.chambers import CHANNEL_MOTION
from toothspace.model.ledger import FRICTION, JOURNAL_ASPERITY, JOURNAL_VISCOUS

SMALL_RATIO = 1e-9
HIGHEST_FILM_RATIO = 0.999


@njit(cache=True)
def update_pressure_forces(s: SystemArrays) -> None:
    """Sum the chamber pressures into the generalised force on every free motion."""
    w = s.work
    w.pressure_force[:] = 0.0
    for i in range(s.size.chambers):
        p = w.pressure[i]
        for k in range(s.size.motions):
            w.pressure_force[k] += p * w.chamber_values[i, CHANNEL_MOTION + k]


@njit(cache=True)
def asperity_force(table: Array, table_range: float, ratio: float) -> tuple[float, float]:
    """Radial force of touching asperities and its slope over the eccentricity ratio."""
    intervals = table.shape[0]
    position = min(ratio / table_range * intervals, intervals - 1e-9)
    i = int(position)
    t = position - i
    c = table[i]
    value = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
    slope = (c[1] + t * (2.0 * c[2] + 3.0 * t * c[3])) * intervals / table_range
    return value, slope


@njit(cache=True)
def update_journal(s: SystemArrays, state: Array, j: int) -> None:
    """Forces of the bearings of one body on it, with derivatives, and their asperity load."""
    w, bearing = s.work, s.journals
    kx, ky = bearing.motion_x[j], bearing.motion_y[j]
    ex = state[s.size.position + kx] - bearing.bush_x[j]
    ey = state[s.size.position + ky] - bearing.bush_y[j]
    vx, vy = state[s.size.velocity + kx], state[s.size.velocity + ky]
    speed = bearing.speed_ratio[j] * state[1]
    viscosity = s.fluid.dynamic_viscosity
    scale = bearing.bearings[j] * viscosity * bearing.length[j]
    scale *= (bearing.radius[j] / bearing.clearance[j]) ** 3
    force = journal_force(ex, ey, vx, vy, speed, bearing.clearance[j], scale, bearing.film)
    w.film_force[kx], w.film_force[ky] = force[0], force[1]
    w.film_by_position[kx, kx], w.film_by_position[kx, ky] = force[2], force[3]
    w.film_by_velocity[kx, kx], w.film_by_velocity[kx, ky] = force[4], force[5]
    w.film_by_position[ky, kx], w.film_by_position[ky, ky] = force[6], force[7]
    w.film_by_velocity[ky, kx], w.film_by_velocity[ky, ky] = force[8], force[9]
    add_asperity_force(s, j, ex, ey)


@njit(cache=True)
def add_asperity_force(s: SystemArrays, j: int, ex: float, ey: float) -> None:
    """Push the journal back where asperities touch."""
    w, bearing = s.work, s.journals
    kx, ky = bearing.motion_x[j], bearing.motion_y[j]
    c = bearing.clearance[j]
    distance = math.sqrt(ex * ex + ey * ey)
    if distance < SMALL_RATIO * c:
        return
    force, slope = asperity_force(bearing.asperity_force[j], bearing.asperity_range, distance / c)
    nx, ny = ex / distance, ey / distance
    radial, tangential = slope / c, force / distance
    w.film_force[kx] -= force * nx
    w.film_force[ky] -= force * ny
    w.film_by_position[kx, kx] -= radial * nx * nx + tangential * ny * ny
    w.film_by_position[kx, ky] -= (radial - tangential) * nx * ny
    w.film_by_position[ky, kx] -= (radial - tangential) * nx * ny
    w.film_by_position[ky, ky] -= radial * ny * ny + tangential * nx * nx


@njit(cache=True)
def update_film_forces(s: SystemArrays, state: Array) -> None:
    """Forces of all journal bearings on the free motions."""
    s.work.film_force[:] = 0.0
    s.work.film_by_position[:, :] = 0.0
    s.work.film_by_velocity[:, :] = 0.0
    for j in range(s.journals.motion_x.size):
        update_journal(s, state, j)


@njit(cache=True)
def journal_torques(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    r"""Viscous and asperity friction torque on the journals of one body, both positive. [N m].

    Notes
    -----
    Full film all round plus the moment of the film force about the journal centre:

    .. math:: T = \frac{2 \pi \mu \omega L R^3}{c \sqrt{1 - \varepsilon^2}} + \frac12 e F_t .
    """
    bearing = s.journals
    kx, ky = bearing.motion_x[j], bearing.motion_y[j]
    ex = state[s.size.position + kx] - bearing.bush_x[j]
    ey = state[s.size.position + ky] - bearing.bush_y[j]
    c, radius = bearing.clearance[j], bearing.radius[j]
    ratio = math.sqrt(ex * ex + ey * ey) / c
    limited = min(ratio, HIGHEST_FILM_RATIO)
    speed = abs(bearing.speed_ratio[j] * state[1])
    turning = np.sign(bearing.speed_ratio[j])
    shear = 2.0 * math.pi * s.fluid.dynamic_viscosity * speed * bearing.length[j] * radius**3
    shear *= bearing.bearings[j] / (c * math.sqrt(1.0 - limited * limited))
    moment = turning * 0.5 * (ex * s.work.film_force[ky] - ey * s.work.film_force[kx])
    load, _ = asperity_force(bearing.asperity_load[j], bearing.asperity_range, ratio)
    return shear + moment, bearing.boundary_friction[j] * load * radius


@njit(cache=True)
def book_journal_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add journal losses to the ledger; return their torque at the shaft. [N m]."""
    torque = 0.0
    for j in range(s.journals.motion_x.size):
        viscous, asperity = journal_torques(s, state, j)
        ratio = abs(s.journals.speed_ratio[j])
        kx, ky = s.journals.motion_x[j], s.journals.motion_y[j]
        squeeze = s.work.film_force[kx] * state[s.size.velocity + kx]
        squeeze += s.work.film_force[ky] * state[s.size.velocity + ky]
        s.work.torque[JOURNAL_VISCOUS] += ratio * viscous
        s.work.torque[JOURNAL_ASPERITY] += ratio * asperity
        ledger[FRICTION + JOURNAL_VISCOUS] += ratio * viscous * state[1] - squeeze
        ledger[FRICTION + JOURNAL_ASPERITY] += ratio * asperity * state[1]
        torque += ratio * (viscous + asperity)
    return torque
