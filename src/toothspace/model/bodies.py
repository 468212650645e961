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

from toothspace.closures.bearing_map import JournalMap, journal_force
from toothspace.closures.journal_friction import (
    boundary_friction_term,
    film_friction_term,
    journal_pressure_torque,
    journal_shear_torque,
    sommerfeld_number,
)
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.lateral_table import ASPERITY_STRESS, DRAG_STRESS, SHEAR_RATIO
from toothspace.model.ledger import FRICTION, JOURNAL_ASPERITY, JOURNAL_VISCOUS

SMALL_RATIO = 1e-9
HIGHEST_FILM_RATIO = 0.999
FORCE, LOAD, SHEAR = 0, 1, 2
LEAST_FORCE = 1e-3
"""Force on a journal below which its friction is that of this force. [N]"""


@kernel
def update_pressure_forces(s: SystemArrays) -> None:
    """Sum the chamber pressures into the generalised force on every free motion."""
    node, values, motion, size = s.node, s.chamber_values, s.motion, s.size
    for k in range(size.motions):
        force = 0.0
        for i in range(size.chambers):
            force += node[i, col.PRESSURE] * values[i, col.CHANNEL_MOTION + k]
        motion[k, col.PRESSURE_FORCE] = force


@kernel
def asperity_value(
    table: Array, journal: int, quantity: int, table_range: float, ratio: float
) -> tuple[float, float]:
    """Value and slope over the eccentricity ratio: asperity force or load [N], or shear [-]."""
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
    update_lateral_drag(s, state)
    for j in range(size.journals):
        kx, ky = int(journal[j, col.MOTION_X]), int(journal[j, col.MOTION_Y])
        ex = state[size.position + kx] - journal[j, col.BUSH_X]
        ey = state[size.position + ky] - journal[j, col.BUSH_Y]
        vx, vy = state[size.velocity + kx], state[size.velocity + ky]
        speed, c = journal[j, col.SPEED_RATIO] * state[1], journal[j, col.JOURNAL_CLEARANCE]
        scale = journal[j, col.BEARINGS] * viscosity * journal[j, col.JOURNAL_VISCOSITY]
        scale *= journal[j, col.LENGTH] * (journal[j, col.RADIUS] / c) ** 3
        nodes = s.film.nodes[int(journal[j, col.FILM_MAP])]
        film = JournalMap(nodes, s.film.logarithm_step, s.film.length_over_diameter)
        force = journal_force(ex, ey, vx, vy, speed, c, scale, film)
        journal[j, col.FILM_X], journal[j, col.FILM_Y] = force[0], force[1]
        motion[kx, col.FILM_FORCE] += force[0]
        motion[ky, col.FILM_FORCE] += force[1]
        slopes[0, kx, kx] += force[2]
        slopes[0, kx, ky] += force[3]
        slopes[1, kx, kx] += force[4]
        slopes[1, kx, ky] += force[5]
        slopes[0, ky, kx] += force[6]
        slopes[0, ky, ky] += force[7]
        slopes[1, ky, kx] += force[8]
        slopes[1, ky, ky] += force[9]
        add_asperity_force(s, j, ex, ey)
        if journal[j, col.ROTATION] >= 0.0:
            hold_back(s, state, j, (ex, ey), force)


@kernel
def update_lateral_drag(s: SystemArrays, state: Array) -> None:
    """Start the film forces with the torque of the lateral films on bodies free to turn."""
    motion, slopes, size, now = s.motion, s.film_slopes, s.size, s.lateral.now
    stress = s.drive[col.DIRECTION] * (now[DRAG_STRESS] + now[ASPERITY_STRESS])
    for k in range(size.motions):
        for m in range(size.motions):
            slopes[0, k, m] = slopes[1, k, m] = 0.0
        drag = motion[k, col.LATERAL_DRAG] * s.fluid.dynamic_viscosity * now[SHEAR_RATIO]
        turning = motion[k, col.MOTION_RATIO] * state[1] + state[size.velocity + k]
        held = motion[k, col.LATERAL_DRAG] * motion[k, col.MOTION_RATIO] * stress
        motion[k, col.FILM_FORCE] = -drag * turning - held
        slopes[1, k, k] = -drag


@kernel
def add_asperity_force(s: SystemArrays, j: int, ex: float, ey: float) -> None:
    """Push the journal back where asperities touch."""
    journal, motion, slopes = s.journal, s.motion, s.film_slopes
    kx, ky = int(journal[j, col.MOTION_X]), int(journal[j, col.MOTION_Y])
    c = journal[j, col.JOURNAL_CLEARANCE]
    distance = math.sqrt(ex * ex + ey * ey)
    if distance < SMALL_RATIO * c:
        return
    span = s.constant.asperity_range
    force, slope = asperity_value(s.asperity, j, FORCE, span, distance / c)
    nx, ny = ex / distance, ey / distance
    radial, tangential = slope / c, force / distance
    motion[kx, col.FILM_FORCE] -= force * nx
    motion[ky, col.FILM_FORCE] -= force * ny
    journal[j, col.FILM_X] -= force * nx
    journal[j, col.FILM_Y] -= force * ny
    slopes[0, kx, kx] -= radial * nx * nx + tangential * ny * ny
    slopes[0, kx, ky] -= (radial - tangential) * nx * ny
    slopes[0, ky, kx] -= (radial - tangential) * nx * ny
    slopes[0, ky, ky] -= radial * ny * ny + tangential * nx * nx


@kernel
def hold_back(
    s: SystemArrays, state: Array, j: int, place: tuple[float, float], force: tuple[float, ...]
) -> None:
    """Friction torque of one bearing on a body that turns on its own, with derivatives."""
    journal = s.journal
    k, kx = int(journal[j, col.ROTATION]), int(journal[j, col.MOTION_X])
    ky = int(journal[j, col.MOTION_Y])
    ex, ey = place
    viscous, asperity = journal_torques(s, state, j)
    turning = np.sign(journal[j, col.SPEED_RATIO]) * s.drive[col.DIRECTION]
    s.motion[k, col.FILM_FORCE] -= turning * (viscous + asperity)
    if journal[j, col.CURVES] > 0:
        add_curve_slopes(s, state, j, turning)
        return
    c, radius = journal[j, col.JOURNAL_CLEARANCE], journal[j, col.RADIUS]
    distance = math.sqrt(ex * ex + ey * ey) + SMALL_RATIO * c
    ratio = distance / c
    _, by_ratio = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    growth = journal[j, col.BOUNDARY_FRICTION] * radius * by_ratio
    if ratio < HIGHEST_FILM_RATIO:
        shear = viscous - turning * journal_pressure_torque(ex, ey, force[0], force[1])
        solved, rise = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
        growth += shear * (ratio / (1.0 - ratio * ratio) + rise / solved)
    growth *= turning / (c * distance)
    slopes = s.film_slopes
    slopes[0, k, kx] -= growth * ex + 0.5 * (force[1] + ex * force[6] - ey * force[2])
    slopes[0, k, ky] -= growth * ey + 0.5 * (ex * force[7] - ey * force[3] - force[0])
    slopes[1, k, kx] -= 0.5 * (ex * force[8] - ey * force[4])
    slopes[1, k, ky] -= 0.5 * (ex * force[9] - ey * force[5])


@kernel
def journal_torques(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    r"""Viscous and asperity friction torque on the journals of one body, both positive. [N m].

    Notes
    -----
    :func:`journal_shear_torque` times 1, or times the shear of a solved film over that of the
    full one, plus :func:`journal_pressure_torque`. A bearing with a friction curve has
    :func:`curve_torques` instead.
    """
    journal, size = s.journal, s.size
    if journal[j, col.CURVES] > 0:
        force = math.sqrt(journal[j, col.FILM_X] ** 2 + journal[j, col.FILM_Y] ** 2)
        return curve_torques(s, state, j, force)
    kx, ky = int(journal[j, col.MOTION_X]), int(journal[j, col.MOTION_Y])
    ex = state[size.position + kx] - journal[j, col.BUSH_X]
    ey = state[size.position + ky] - journal[j, col.BUSH_Y]
    c, radius = journal[j, col.JOURNAL_CLEARANCE], journal[j, col.RADIUS]
    ratio = math.sqrt(ex * ex + ey * ey) / c
    limited = min(ratio, HIGHEST_FILM_RATIO)
    speed = abs(journal[j, col.SPEED_RATIO] * state[1])
    turning = np.sign(journal[j, col.SPEED_RATIO]) * s.drive[col.DIRECTION]
    viscosity = s.fluid.dynamic_viscosity * journal[j, col.JOURNAL_VISCOSITY]
    shear = journal[j, col.BEARINGS] * journal_shear_torque(
        limited, speed, viscosity, radius, journal[j, col.LENGTH], c
    )
    solved, _ = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
    shear *= solved
    fx, fy = journal[j, col.FILM_X], journal[j, col.FILM_Y]
    moment = turning * journal_pressure_torque(ex, ey, fx, fy)
    load, _ = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    return shear + moment, journal[j, col.BOUNDARY_FRICTION] * load * radius


@kernel
def curve_torques(s: SystemArrays, state: Array, j: int, force: float) -> tuple[float, float]:
    r"""Film and boundary friction torque from a curve over the Sommerfeld number. [N m].

    Notes
    -----
    .. math:: T = \mu(S)\, F R

    with the force of film and asperities on the journals and the :func:`sommerfeld_number` of
    one bearing; the coefficient is linear in the logarithm of the load between two curves. The
    term that fades with S counts as friction of asperities.
    """
    row = s.journal[j]
    radius = row[col.RADIUS]
    speed = abs(row[col.SPEED_RATIO] * state[1])
    load, clearance = max(force, LEAST_FORCE) / row[col.BEARINGS], row[col.JOURNAL_CLEARANCE]
    viscosity = s.fluid.dynamic_viscosity * row[col.JOURNAL_VISCOSITY]
    number = sommerfeld_number(speed, load, viscosity, radius, row[col.LENGTH], clearance)
    lower, share = _curve_place(s, j, load)
    film, boundary = 0.0, 0.0
    for k, part in ((lower, 1.0 - share), (lower + 1, share)):
        if part > 0.0:
            curve = s.friction_curves[j, k]
            film += part * film_friction_term(
                number,
                curve[col.CURVE_RISE],
                curve[col.CURVE_TRANSITION],
                curve[col.CURVE_OFFSET],
                curve[col.CURVE_LINE],
            )
            boundary += part * boundary_friction_term(
                number, curve[col.CURVE_BOUNDARY], curve[col.CURVE_DECAY]
            )
    return film * max(force, LEAST_FORCE) * radius, boundary * force * radius


@kernel
def _curve_place(s: SystemArrays, j: int, load: float) -> tuple[int, float]:
    """Friction curve below a load on one bearing [N], and the share of the next one. [-]."""
    curves, last = s.friction_curves, int(s.journal[j, col.CURVES]) - 1
    wanted = math.log(load)
    if last == 0 or wanted <= curves[j, 0, col.CURVE_LOAD]:
        return 0, 0.0
    if wanted >= curves[j, last, col.CURVE_LOAD]:
        return last, 0.0
    k = 0
    while wanted > curves[j, k + 1, col.CURVE_LOAD]:
        k += 1
    low, high = curves[j, k, col.CURVE_LOAD], curves[j, k + 1, col.CURVE_LOAD]
    return k, (wanted - low) / (high - low)


@kernel
def add_curve_slopes(s: SystemArrays, state: Array, j: int, turning: float) -> None:
    """Derivatives of the torque of a friction curve on a body that turns on its own."""
    journal, slopes = s.journal, s.film_slopes
    k, kx = int(journal[j, col.ROTATION]), int(journal[j, col.MOTION_X])
    ky = int(journal[j, col.MOTION_Y])
    fx, fy = journal[j, col.FILM_X], journal[j, col.FILM_Y]
    force = max(math.sqrt(fx * fx + fy * fy), LEAST_FORCE)
    step = 1e-4 * force
    film, boundary = curve_torques(s, state, j, force + step)
    less_film, less_boundary = curve_torques(s, state, j, force - step)
    growth = turning * (film + boundary - less_film - less_boundary) / (2.0 * step)
    for order in range(2):
        for m in (kx, ky):
            rise = (fx * slopes[order, kx, m] + fy * slopes[order, ky, m]) / force
            slopes[order, k, m] -= growth * rise


@kernel
def book_journal_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add journal losses to the ledger; return their torque at the shaft. [N m]."""
    journal, size = s.journal, s.size
    total, share = 0.0, s.drive[col.DIRECTION] * s.drive[col.FADE]
    s.drive[col.DRIVEN_FRICTION] = 0.0
    for j in range(size.journals):
        viscous, asperity = journal_torques(s, state, j)
        viscous, asperity = share * viscous, share * asperity
        ratio = abs(journal[j, col.SPEED_RATIO])
        turning = ratio * state[1]
        if journal[j, col.ROTATION] >= 0.0:
            ahead = state[size.velocity + int(journal[j, col.ROTATION])]
            turning += np.sign(journal[j, col.SPEED_RATIO]) * ahead
        squeeze = journal[j, col.FILM_X] * state[size.velocity + int(journal[j, col.MOTION_X])]
        squeeze += journal[j, col.FILM_Y] * state[size.velocity + int(journal[j, col.MOTION_Y])]
        s.torque[JOURNAL_VISCOUS] += ratio * viscous
        s.torque[JOURNAL_ASPERITY] += ratio * asperity
        ledger[FRICTION + JOURNAL_VISCOUS] += viscous * turning - squeeze
        ledger[FRICTION + JOURNAL_ASPERITY] += asperity * turning
        total += ratio * (viscous + asperity)
        s.drive[col.DRIVEN_FRICTION] -= journal[j, col.DRIVEN_SENSE] * (viscous + asperity)
    return total
