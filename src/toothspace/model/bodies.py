r"""Radial motion of the bodies in their journal bearings.

Each free micro-motion q obeys Newton's law with the generalised pressure force, the journal
films, their touching asperities and an external force:

.. math::

    M \ddot q = \sum_i p_i \frac{\partial V_i}{\partial q} + F_{film}(e, \dot e)
        - F_{asp}(|e|)\, \frac{e}{|e|} + F_{ext}, \qquad e = q - q_{bush} .

Where bearing blocks move in the housing, :math:`q_{bush}` is their own motion: they take the
reaction of the bearings that they carry, and have a film and asperities round them.
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
from toothspace.model.arrays import (
    BEARINGS,
    BOUNDARY_FRICTION,
    BUSH_X,
    BUSH_Y,
    CARRIER_X,
    CARRIER_Y,
    CHANNEL_MOTION,
    CURVE_BOUNDARY,
    CURVE_DECAY,
    CURVE_LINE,
    CURVE_LOAD,
    CURVE_OFFSET,
    CURVE_RISE,
    CURVE_TRANSITION,
    CURVES,
    DIRECTION,
    DRIVEN_FRICTION,
    DRIVEN_SENSE,
    FADE,
    FILM_FORCE,
    FILM_MAP,
    FILM_X,
    FILM_Y,
    JOURNAL_CLEARANCE,
    JOURNAL_VISCOSITY,
    LATERAL_DRAG,
    LENGTH,
    MOTION_RATIO,
    MOTION_X,
    MOTION_Y,
    PRESSURE,
    PRESSURE_FORCE,
    RADIUS,
    ROTATION,
    SPEED_RATIO,
    SystemArrays,
)
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
            force += node[i, PRESSURE] * values[i, CHANNEL_MOTION + k]
        motion[k, PRESSURE_FORCE] = force


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
    journal, size = s.journal, s.size
    viscosity = s.fluid.dynamic_viscosity
    update_lateral_drag(s, state)
    for j in range(size.journals):
        ex, ey = journal_place(s, state, j)
        vx, vy = journal_velocity(s, state, j)
        speed, c = journal[j, SPEED_RATIO] * state[1], journal[j, JOURNAL_CLEARANCE]
        scale = journal[j, BEARINGS] * viscosity * journal[j, JOURNAL_VISCOSITY]
        scale *= journal[j, LENGTH] * (journal[j, RADIUS] / c) ** 3
        nodes = s.film.nodes[int(journal[j, FILM_MAP])]
        film = JournalMap(nodes, s.film.logarithm_step, s.film.length_over_diameter)
        force = journal_force(ex, ey, vx, vy, speed, c, scale, film)
        journal[j, FILM_X] = journal[j, FILM_Y] = 0.0
        add_force(s, j, force[0], force[1])
        add_slopes(s, j, 0, (force[2], force[3], force[6], force[7]))
        add_slopes(s, j, 1, (force[4], force[5], force[8], force[9]))
        add_asperity_force(s, j, ex, ey)
        if journal[j, ROTATION] >= 0.0:
            hold_back(s, state, j, (ex, ey), force)


@kernel
def journal_place(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    """Displacement of a journal from the middle of its bearing. [m]."""
    journal, first = s.journal[j], s.size.position
    ex = state[first + int(journal[MOTION_X])] - journal[BUSH_X]
    ey = state[first + int(journal[MOTION_Y])] - journal[BUSH_Y]
    if journal[CARRIER_X] >= 0.0:
        ex -= state[first + int(journal[CARRIER_X])]
        ey -= state[first + int(journal[CARRIER_Y])]
    return ex, ey


@kernel
def journal_velocity(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    """Velocity of a journal relative to its bearing. [m/s]."""
    journal, first = s.journal[j], s.size.velocity
    vx, vy = state[first + int(journal[MOTION_X])], state[first + int(journal[MOTION_Y])]
    if journal[CARRIER_X] >= 0.0:
        vx -= state[first + int(journal[CARRIER_X])]
        vy -= state[first + int(journal[CARRIER_Y])]
    return vx, vy


@kernel
def add_force(s: SystemArrays, j: int, force_x: float, force_y: float) -> None:
    """Add a force on a journal, and its reaction on what carries the bearing. [N]."""
    journal, motion = s.journal[j], s.motion
    journal[FILM_X] += force_x
    journal[FILM_Y] += force_y
    motion[int(journal[MOTION_X]), FILM_FORCE] += force_x
    motion[int(journal[MOTION_Y]), FILM_FORCE] += force_y
    if journal[CARRIER_X] >= 0.0:
        motion[int(journal[CARRIER_X]), FILM_FORCE] -= force_x
        motion[int(journal[CARRIER_Y]), FILM_FORCE] -= force_y


@kernel
def add_slopes(s: SystemArrays, j: int, order: int, by: tuple[float, float, float, float]) -> None:
    """Add derivatives of a force on a journal: x by x, x by y, y by x, y by y."""
    journal, slopes = s.journal[j], s.film_slopes[order]
    own = int(journal[MOTION_X]), int(journal[MOTION_Y])
    for row in range(2):
        for column in range(2):
            slope = by[2 * row + column]
            slopes[own[row], own[column]] += slope
            if journal[CARRIER_X] >= 0.0:
                carrier = int(journal[CARRIER_X]), int(journal[CARRIER_Y])
                slopes[own[row], carrier[column]] -= slope
                slopes[carrier[row], own[column]] -= slope
                slopes[carrier[row], carrier[column]] += slope


@kernel
def add_torque_slopes(s: SystemArrays, j: int, order: int, by_x: float, by_y: float) -> None:
    """Take derivatives by the place of a journal from the torque on a body that turns alone."""
    journal = s.journal[j]
    row = s.film_slopes[order, int(journal[ROTATION])]
    row[int(journal[MOTION_X])] -= by_x
    row[int(journal[MOTION_Y])] -= by_y
    if journal[CARRIER_X] >= 0.0:
        row[int(journal[CARRIER_X])] += by_x
        row[int(journal[CARRIER_Y])] += by_y


@kernel
def update_lateral_drag(s: SystemArrays, state: Array) -> None:
    """Start the film forces with the torque of the lateral films on bodies free to turn."""
    motion, slopes, size, now = s.motion, s.film_slopes, s.size, s.lateral.now
    stress = s.drive[DIRECTION] * (now[DRAG_STRESS] + now[ASPERITY_STRESS])
    for k in range(size.motions):
        for m in range(size.motions):
            slopes[0, k, m] = slopes[1, k, m] = 0.0
        drag = motion[k, LATERAL_DRAG] * s.fluid.dynamic_viscosity * now[SHEAR_RATIO]
        turning = motion[k, MOTION_RATIO] * state[1] + state[size.velocity + k]
        held = motion[k, LATERAL_DRAG] * motion[k, MOTION_RATIO] * stress
        motion[k, FILM_FORCE] = -drag * turning - held
        slopes[1, k, k] = -drag


@kernel
def add_asperity_force(s: SystemArrays, j: int, ex: float, ey: float) -> None:
    """Push the journal back where asperities touch."""
    c = s.journal[j, JOURNAL_CLEARANCE]
    distance = math.sqrt(ex * ex + ey * ey)
    if distance < SMALL_RATIO * c:
        return
    span = s.constant.asperity_range
    force, slope = asperity_value(s.asperity, j, FORCE, span, distance / c)
    nx, ny = ex / distance, ey / distance
    radial, tangential = slope / c, force / distance
    add_force(s, j, -force * nx, -force * ny)
    xx, yy = radial * nx * nx + tangential * ny * ny, radial * ny * ny + tangential * nx * nx
    xy = (radial - tangential) * nx * ny
    add_slopes(s, j, 0, (-xx, -xy, -xy, -yy))


@kernel
def hold_back(
    s: SystemArrays, state: Array, j: int, place: tuple[float, float], force: tuple[float, ...]
) -> None:
    """Friction torque of one bearing on a body that turns on its own, with derivatives."""
    journal, k = s.journal, int(s.journal[j, ROTATION])
    ex, ey = place
    viscous, asperity = journal_torques(s, state, j)
    turning = np.sign(journal[j, SPEED_RATIO]) * s.drive[DIRECTION]
    s.motion[k, FILM_FORCE] -= turning * (viscous + asperity)
    if journal[j, CURVES] > 0:
        add_curve_slopes(s, state, j, turning)
        return
    c, radius = journal[j, JOURNAL_CLEARANCE], journal[j, RADIUS]
    distance = math.sqrt(ex * ex + ey * ey) + SMALL_RATIO * c
    ratio = distance / c
    _, by_ratio = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    growth = journal[j, BOUNDARY_FRICTION] * radius * by_ratio
    if ratio < HIGHEST_FILM_RATIO:
        shear = viscous - turning * journal_pressure_torque(ex, ey, force[0], force[1])
        solved, rise = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
        growth += shear * (ratio / (1.0 - ratio * ratio) + rise / solved)
    growth *= turning / (c * distance)
    add_torque_slopes(
        s,
        j,
        0,
        growth * ex + 0.5 * (force[1] + ex * force[6] - ey * force[2]),
        growth * ey + 0.5 * (ex * force[7] - ey * force[3] - force[0]),
    )
    add_torque_slopes(
        s, j, 1, 0.5 * (ex * force[8] - ey * force[4]), 0.5 * (ex * force[9] - ey * force[5])
    )


@kernel
def journal_torques(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    r"""Viscous and asperity friction torque on the journals of one body, both positive. [N m].

    Notes
    -----
    :func:`journal_shear_torque` times 1, or times the shear of a solved film over that of the
    full one, plus :func:`journal_pressure_torque`. A bearing with a friction curve has
    :func:`curve_torques` instead.
    """
    journal = s.journal
    if journal[j, CURVES] > 0:
        force = math.sqrt(journal[j, FILM_X] ** 2 + journal[j, FILM_Y] ** 2)
        return curve_torques(s, state, j, force)
    ex, ey = journal_place(s, state, j)
    c, radius = journal[j, JOURNAL_CLEARANCE], journal[j, RADIUS]
    ratio = math.sqrt(ex * ex + ey * ey) / c
    limited = min(ratio, HIGHEST_FILM_RATIO)
    speed = abs(journal[j, SPEED_RATIO] * state[1])
    turning = np.sign(journal[j, SPEED_RATIO]) * s.drive[DIRECTION]
    viscosity = s.fluid.dynamic_viscosity * journal[j, JOURNAL_VISCOSITY]
    shear = journal[j, BEARINGS] * journal_shear_torque(
        limited, speed, viscosity, radius, journal[j, LENGTH], c
    )
    solved, _ = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
    shear *= solved
    moment = turning * journal_pressure_torque(ex, ey, journal[j, FILM_X], journal[j, FILM_Y])
    load, _ = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    return shear + moment, journal[j, BOUNDARY_FRICTION] * load * radius


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
    radius = row[RADIUS]
    speed = abs(row[SPEED_RATIO] * state[1])
    load, clearance = max(force, LEAST_FORCE) / row[BEARINGS], row[JOURNAL_CLEARANCE]
    viscosity = s.fluid.dynamic_viscosity * row[JOURNAL_VISCOSITY]
    number = sommerfeld_number(speed, load, viscosity, radius, row[LENGTH], clearance)
    lower, share = _curve_place(s, j, load)
    film, boundary = 0.0, 0.0
    for k, part in ((lower, 1.0 - share), (lower + 1, share)):
        if part > 0.0:
            curve = s.friction_curves[j, k]
            film += part * film_friction_term(
                number,
                curve[CURVE_RISE],
                curve[CURVE_TRANSITION],
                curve[CURVE_OFFSET],
                curve[CURVE_LINE],
            )
            boundary += part * boundary_friction_term(
                number, curve[CURVE_BOUNDARY], curve[CURVE_DECAY]
            )
    return film * max(force, LEAST_FORCE) * radius, boundary * force * radius


@kernel
def _curve_place(s: SystemArrays, j: int, load: float) -> tuple[int, float]:
    """Friction curve below a load on one bearing [N], and the share of the next one. [-]."""
    curves, last = s.friction_curves, int(s.journal[j, CURVES]) - 1
    wanted = math.log(load)
    if last == 0 or wanted <= curves[j, 0, CURVE_LOAD]:
        return 0, 0.0
    if wanted >= curves[j, last, CURVE_LOAD]:
        return last, 0.0
    k = 0
    while wanted > curves[j, k + 1, CURVE_LOAD]:
        k += 1
    low, high = curves[j, k, CURVE_LOAD], curves[j, k + 1, CURVE_LOAD]
    return k, (wanted - low) / (high - low)


@kernel
def add_curve_slopes(s: SystemArrays, state: Array, j: int, turning: float) -> None:
    """Derivatives of the torque of a friction curve on a body that turns on its own."""
    journal, slopes = s.journal, s.film_slopes
    kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
    fx, fy = journal[j, FILM_X], journal[j, FILM_Y]
    force = max(math.sqrt(fx * fx + fy * fy), LEAST_FORCE)
    step = 1e-4 * force
    film, boundary = curve_torques(s, state, j, force + step)
    less_film, less_boundary = curve_torques(s, state, j, force - step)
    growth = turning * (film + boundary - less_film - less_boundary) / (2.0 * step)
    for order in range(2):
        rise_x = (fx * slopes[order, kx, kx] + fy * slopes[order, ky, kx]) / force
        rise_y = (fx * slopes[order, kx, ky] + fy * slopes[order, ky, ky]) / force
        add_torque_slopes(s, j, order, growth * rise_x, growth * rise_y)


@kernel
def book_journal_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add journal losses to the ledger; return their torque at the shaft. [N m]."""
    journal = s.journal
    total, share = 0.0, s.drive[DIRECTION] * s.drive[FADE]
    s.drive[DRIVEN_FRICTION] = 0.0
    for j in range(s.size.journals):
        viscous, asperity = journal_torques(s, state, j)
        viscous, asperity = share * viscous, share * asperity
        ratio = abs(journal[j, SPEED_RATIO])
        turning = ratio * state[1]
        if journal[j, ROTATION] >= 0.0:
            ahead = state[s.size.velocity + int(journal[j, ROTATION])]
            turning += np.sign(journal[j, SPEED_RATIO]) * ahead
        vx, vy = journal_velocity(s, state, j)
        squeeze = journal[j, FILM_X] * vx + journal[j, FILM_Y] * vy
        s.torque[JOURNAL_VISCOUS] += ratio * viscous
        s.torque[JOURNAL_ASPERITY] += ratio * asperity
        ledger[FRICTION + JOURNAL_VISCOUS] += viscous * turning - squeeze
        ledger[FRICTION + JOURNAL_ASPERITY] += asperity * turning
        total += ratio * (viscous + asperity)
        s.drive[DRIVEN_FRICTION] -= journal[j, DRIVEN_SENSE] * (viscous + asperity)
    return total
