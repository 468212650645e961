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
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model.arrays import (
    BEARINGS,
    BOUNDARY_FRICTION,
    BUSH_X,
    BUSH_Y,
    CHANNEL_MOTION,
    FILM_FORCE,
    JOURNAL_CLEARANCE,
    LENGTH,
    MOTION_X,
    MOTION_Y,
    PRESSURE,
    PRESSURE_FORCE,
    RADIUS,
    SPEED_RATIO,
    SystemArrays,
)
from toothspace.model.ledger import FRICTION, JOURNAL_ASPERITY, JOURNAL_VISCOUS

SMALL_RATIO = 1e-9
HIGHEST_FILM_RATIO = 0.999
FORCE, LOAD = 0, 1


@kernel
def update_pressure_forces(s: SystemArrays) -> None:
    """Sum the chamber pressures into the generalised force on every free motion."""
    node, values, motion, size = s.node, s.chamber_values, s.motion, s.size
    for k in range(size.motions):
        force = 0.0
        for i in range(size.chambers):
            force += node[i, PRESSURE] * values[i, CHANNEL_MOTION + k]
        motion[k, PRESSURE_FORCE] = force


@kernel
def asperity_value(
    table: Array, journal: int, quantity: int, table_range: float, ratio: float
) -> tuple[float, float]:
    """Force or load of touching asperities and its slope over the eccentricity ratio. [N]."""
    intervals = table.shape[2]
    position = min(ratio / table_range * intervals, intervals - 1e-9)
    i = int(position)
    t = position - i
    c0, c1 = table[journal, quantity, i, 0], table[journal, quantity, i, 1]
    c2, c3 = table[journal, quantity, i, 2], table[journal, quantity, i, 3]
    value = c0 + t * (c1 + t * (c2 + t * c3))
    return value, (c1 + t * (2.0 * c2 + 3.0 * t * c3)) * intervals / table_range


@kernel
def update_film_forces(s: SystemArrays, state: Array) -> None:
    """Forces of all journal bearings on the free motions, with derivatives."""
    journal, motion, slopes, size = s.journal, s.motion, s.film_slopes, s.size
    viscosity = s.fluid.dynamic_viscosity
    for j in range(size.journals):
        kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
        ex = state[size.position + kx] - journal[j, BUSH_X]
        ey = state[size.position + ky] - journal[j, BUSH_Y]
        vx, vy = state[size.velocity + kx], state[size.velocity + ky]
        speed, c = journal[j, SPEED_RATIO] * state[1], journal[j, JOURNAL_CLEARANCE]
        scale = journal[j, BEARINGS] * viscosity * journal[j, LENGTH]
        scale *= (journal[j, RADIUS] / c) ** 3
        force = journal_force(ex, ey, vx, vy, speed, c, scale, s.film)
        motion[kx, FILM_FORCE], motion[ky, FILM_FORCE] = force[0], force[1]
        slopes[0, kx, kx], slopes[0, kx, ky] = force[2], force[3]
        slopes[1, kx, kx], slopes[1, kx, ky] = force[4], force[5]
        slopes[0, ky, kx], slopes[0, ky, ky] = force[6], force[7]
        slopes[1, ky, kx], slopes[1, ky, ky] = force[8], force[9]
        add_asperity_force(s, j, ex, ey)


@kernel
def add_asperity_force(s: SystemArrays, j: int, ex: float, ey: float) -> None:
    """Push the journal back where asperities touch."""
    journal, motion, slopes = s.journal, s.motion, s.film_slopes
    kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
    c = journal[j, JOURNAL_CLEARANCE]
    distance = math.sqrt(ex * ex + ey * ey)
    if distance < SMALL_RATIO * c:
        return
    span = s.constant.asperity_range
    force, slope = asperity_value(s.asperity, j, FORCE, span, distance / c)
    nx, ny = ex / distance, ey / distance
    radial, tangential = slope / c, force / distance
    motion[kx, FILM_FORCE] -= force * nx
    motion[ky, FILM_FORCE] -= force * ny
    slopes[0, kx, kx] -= radial * nx * nx + tangential * ny * ny
    slopes[0, kx, ky] -= (radial - tangential) * nx * ny
    slopes[0, ky, kx] -= (radial - tangential) * nx * ny
    slopes[0, ky, ky] -= radial * ny * ny + tangential * nx * nx


@kernel
def journal_torques(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    r"""Viscous and asperity friction torque on the journals of one body, both positive. [N m].

    Notes
    -----
    Full film all round plus the moment of the film force about the journal centre:

    .. math:: T = \frac{2 \pi \mu \omega L R^3}{c \sqrt{1 - \varepsilon^2}} + \frac12 e F_t .
    """
    journal, motion, size = s.journal, s.motion, s.size
    kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
    ex = state[size.position + kx] - journal[j, BUSH_X]
    ey = state[size.position + ky] - journal[j, BUSH_Y]
    c, radius = journal[j, JOURNAL_CLEARANCE], journal[j, RADIUS]
    ratio = math.sqrt(ex * ex + ey * ey) / c
    limited = min(ratio, HIGHEST_FILM_RATIO)
    speed = abs(journal[j, SPEED_RATIO] * state[1])
    turning = np.sign(journal[j, SPEED_RATIO])
    shear = 2.0 * math.pi * s.fluid.dynamic_viscosity * speed * journal[j, LENGTH] * radius**3
    shear *= journal[j, BEARINGS] / (c * math.sqrt(1.0 - limited * limited))
    moment = 0.5 * turning * (ex * motion[ky, FILM_FORCE] - ey * motion[kx, FILM_FORCE])
    load, _ = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    return shear + moment, journal[j, BOUNDARY_FRICTION] * load * radius


@kernel
def book_journal_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add journal losses to the ledger; return their torque at the shaft. [N m]."""
    journal, motion, size = s.journal, s.motion, s.size
    total = 0.0
    for j in range(size.journals):
        viscous, asperity = journal_torques(s, state, j)
        ratio = abs(journal[j, SPEED_RATIO])
        kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
        squeeze = motion[kx, FILM_FORCE] * state[size.velocity + kx]
        squeeze += motion[ky, FILM_FORCE] * state[size.velocity + ky]
        s.torque[JOURNAL_VISCOUS] += ratio * viscous
        s.torque[JOURNAL_ASPERITY] += ratio * asperity
        ledger[FRICTION + JOURNAL_VISCOUS] += ratio * viscous * state[1] - squeeze
        ledger[FRICTION + JOURNAL_ASPERITY] += ratio * asperity * state[1]
        total += ratio * (viscous + asperity)
    return total
