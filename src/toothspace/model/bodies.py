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
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.lateral_lookup import REACH
from toothspace.model.lateral_table import ASPERITY_STRESS, DRAG_STRESS, SHEAR_RATIO
from toothspace.model.ledger import FRICTION, JOURNAL_ASPERITY, JOURNAL_VISCOUS
from toothspace.numerics.static_lu import summing_kernel

SMALL_RATIO = 1e-9
HIGHEST_FILM_RATIO = 0.999
FORCE, LOAD, SHEAR = 0, 1, 2
LEAST_FORCE = 1e-3
"""Force on a journal below which its friction is that of this force. [N]"""

CREEP_SPEED, LEAST_CREEP = 1e-3, 1e-6
"""Sliding speeds over which touching surfaces turn their friction round: regularisation. [m/s]"""
SATURATED = 20.0
"""Ratio from which a hyperbolic tangent is one to round-off. [-]"""
CREEP_SHARE = 0.25
"""Most that the first of them may be of the mean sliding speed. [-]"""
CURVE_STEP = 1e-4
"""Share of force and speed, and least speed [rad/s], of the slopes of a friction curve. [-]"""


@summing_kernel
def update_pressure_forces(s: SystemArrays) -> None:
    """Sum the chamber pressures into the generalised force on every free motion."""
    node, values, motion, size = s.node, s.chamber_values, s.motion, s.size
    for k in range(size.motions):
        force = 0.0
        for i in range(size.chambers):
            pressure = node[i, col.PRESSURE] * node[i, col.VOLUME_SHARE]
            force += pressure * values[i, col.CHANNEL_MOTION + k]
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
    journal, size = s.journal, s.size
    viscosity = s.fluid.dynamic_viscosity
    update_lateral_drag(s, state)
    for j in range(size.journals):
        ex, ey = journal_place(s, state, j)
        vx, vy = journal_velocity(s, state, j)
        speed, c = own_speed(s, state, j), journal[j, col.JOURNAL_CLEARANCE]
        scale = journal[j, col.BEARINGS] * viscosity * journal[j, col.JOURNAL_VISCOSITY]
        scale *= journal[j, col.LENGTH] * (journal[j, col.RADIUS] / c) ** 3
        nodes = s.film.nodes[int(journal[j, col.FILM_MAP])]
        film = JournalMap(nodes, s.film.logarithm_step, s.film.length_over_diameter)
        force = journal_force(ex, ey, vx, vy, speed, c, scale, film)
        journal[j, col.FILM_X] = journal[j, col.FILM_Y] = 0.0
        add_force(s, j, force[0], force[1])
        add_slopes(s, j, 0, (force[2], force[3], force[6], force[7]))
        add_slopes(s, j, 1, (force[4], force[5], force[8], force[9]))
        add_asperity_force(s, j, ex, ey)
        if journal[j, col.ROTATION] >= 0.0:
            add_rotor_friction(s, state, j, (ex, ey), force)


@kernel
def journal_place(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    """Displacement of a journal from the middle of its bearing. [m]."""
    journal, first = s.journal[j], s.size.position
    ex = state[first + int(journal[col.MOTION_X])] - journal[col.BUSH_X]
    ey = state[first + int(journal[col.MOTION_Y])] - journal[col.BUSH_Y]
    if journal[col.CARRIER_X] >= 0.0:
        ex -= state[first + int(journal[col.CARRIER_X])]
        ey -= state[first + int(journal[col.CARRIER_Y])]
    return ex, ey


@kernel
def journal_velocity(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    """Velocity of a journal relative to its bearing. [m/s]."""
    journal, first = s.journal[j], s.size.velocity
    vx, vy = state[first + int(journal[col.MOTION_X])], state[first + int(journal[col.MOTION_Y])]
    if journal[col.CARRIER_X] >= 0.0:
        vx -= state[first + int(journal[col.CARRIER_X])]
        vy -= state[first + int(journal[col.CARRIER_Y])]
    return vx, vy


@kernel
def add_force(s: SystemArrays, j: int, force_x: float, force_y: float) -> None:
    """Add a force on a journal, and its reaction on what carries the bearing. [N]."""
    journal, motion = s.journal[j], s.motion
    journal[col.FILM_X] += force_x
    journal[col.FILM_Y] += force_y
    motion[int(journal[col.MOTION_X]), col.FILM_FORCE] += force_x
    motion[int(journal[col.MOTION_Y]), col.FILM_FORCE] += force_y
    if journal[col.CARRIER_X] >= 0.0:
        motion[int(journal[col.CARRIER_X]), col.FILM_FORCE] -= force_x
        motion[int(journal[col.CARRIER_Y]), col.FILM_FORCE] -= force_y


@kernel
def add_slopes(s: SystemArrays, j: int, order: int, by: tuple[float, float, float, float]) -> None:
    """Add derivatives of a force on a journal: x by x, x by y, y by x, y by y."""
    journal, slopes = s.journal[j], s.film_slopes[order]
    own = int(journal[col.MOTION_X]), int(journal[col.MOTION_Y])
    for row in range(2):
        for column in range(2):
            slope = by[2 * row + column]
            slopes[own[row], own[column]] += slope
            if journal[col.CARRIER_X] >= 0.0:
                carrier = int(journal[col.CARRIER_X]), int(journal[col.CARRIER_Y])
                slopes[own[row], carrier[column]] -= slope
                slopes[carrier[row], own[column]] -= slope
                slopes[carrier[row], carrier[column]] += slope


@kernel
def add_torque_slopes(s: SystemArrays, j: int, order: int, by_x: float, by_y: float) -> None:
    """Take derivatives by the place of a journal from the torque on a body that turns alone."""
    journal = s.journal[j]
    row = s.film_slopes[order, int(journal[col.ROTATION])]
    row[int(journal[col.MOTION_X])] -= by_x
    row[int(journal[col.MOTION_Y])] -= by_y
    if journal[col.CARRIER_X] >= 0.0:
        row[int(journal[col.CARRIER_X])] += by_x
        row[int(journal[col.CARRIER_Y])] += by_y


@kernel
def add_speed_slopes(s: SystemArrays, j: int, x_by_speed: float, y_by_speed: float) -> None:
    """Add derivatives of a force on a journal by the speed of a body that turns on its own."""
    journal, slopes = s.journal[j], s.film_slopes[1]
    k = int(journal[col.ROTATION])
    slopes[int(journal[col.MOTION_X]), k] += x_by_speed
    slopes[int(journal[col.MOTION_Y]), k] += y_by_speed
    if journal[col.CARRIER_X] >= 0.0:
        slopes[int(journal[col.CARRIER_X]), k] -= x_by_speed
        slopes[int(journal[col.CARRIER_Y]), k] -= y_by_speed


@kernel
def update_lateral_drag(s: SystemArrays, state: Array) -> None:
    """Start the film forces with the torque of the lateral films on bodies free to turn."""
    motion, slopes, size, now = s.motion, s.film_slopes, s.size, s.lateral.now
    for k in range(size.motions):
        for m in range(size.motions):
            slopes[0, k, m] = slopes[1, k, m] = 0.0
        share, ratio = motion[k, col.LATERAL_DRAG], motion[k, col.MOTION_RATIO]
        drag = share * s.fluid.dynamic_viscosity * now[SHEAR_RATIO]
        turning = ratio * state[1] + state[size.velocity + k]
        # what pressure drives along the faces pulls at them however they turn
        pulled = share * ratio * s.drive[col.DIRECTION] * now[DRAG_STRESS]
        rubbing = share * abs(ratio) * now[ASPERITY_STRESS]
        sense, by_speed = face_sense(s, state, k)
        motion[k, col.FILM_FORCE] = -drag * turning - pulled - rubbing * sense
        slopes[1, k, k] = -drag - rubbing * by_speed


@kernel
def add_asperity_force(s: SystemArrays, j: int, ex: float, ey: float) -> None:
    """Push the journal back where asperities touch."""
    c = s.journal[j, col.JOURNAL_CLEARANCE]
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
def own_speed(s: SystemArrays, state: Array, j: int) -> float:
    """Angular speed of the body in a bearing. [rad/s]."""
    speed, k = s.journal[j, col.SPEED_RATIO] * state[1], int(s.journal[j, col.ROTATION])
    return float(speed + state[s.size.velocity + k]) if k >= 0 else float(speed)


@kernel
def journal_sense(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    """Sense in which the surfaces of a bearing slide, -1 to 1, and its slope by speed. [s/rad]."""
    journal = s.journal[j]
    ratio, radius = journal[col.SPEED_RATIO], journal[col.RADIUS]
    sense = np.sign(ratio) * s.drive[col.DIRECTION]
    if journal[col.ROTATION] < 0.0:
        return sense, 0.0
    return sliding_sense(sense, ratio * state[1], own_speed(s, state, j), radius)


@kernel
def face_sense(s: SystemArrays, state: Array, k: int) -> tuple[float, float]:
    """Sense in which the faces of a body free to turn slide, and its slope by speed. [s/rad]."""
    ratio = s.motion[k, col.MOTION_RATIO]
    sense, mean = np.sign(ratio) * s.drive[col.DIRECTION], ratio * state[1]
    if s.lateral.counts.size == 0 or ratio == 0.0:
        return sense, 0.0
    own = mean + state[s.size.velocity + k]
    return sliding_sense(sense, mean, own, s.lateral.scales[REACH])


@kernel
def sliding_sense(sense: float, mean: float, own: float, radius: float) -> tuple[float, float]:
    r"""Sense in which the surfaces of a body that turns on its own slide, and its slope by speed.

    Sense from -1 to 1 [-], slope [s/rad].

    Parameters
    ----------
    sense : float
        That of the shaft, times the sign of the body's ratio i. [-]
    mean, own : float
        Speed of the shaft times that ratio, and the body's own. [rad/s]
    radius : float
        Where the surfaces slide. [m]

    Notes
    -----
    .. math:: \operatorname{sgn}(i\,\omega) + \tanh\frac{i\,\omega + \dot q}{\omega_c}
        - \tanh\frac{i\,\omega}{\omega_c}

    so that friction brings it to rest, at a creeping speed :math:`\omega_c`, but never turns it
    backwards.
    """
    creep = max(min(CREEP_SPEED / radius, CREEP_SHARE * abs(mean)), LEAST_CREEP / radius)
    if own * mean > 0.0 and min(abs(own), abs(mean)) > SATURATED * creep:
        return sense, 0.0
    now = math.tanh(own / creep)
    sense += now - math.tanh(mean / creep)
    return min(max(sense, -1.0), 1.0), (1.0 - now * now) / creep


@kernel
def add_rotor_friction(
    s: SystemArrays, state: Array, j: int, place: tuple[float, float], force: tuple[float, ...]
) -> None:
    """Friction torque of one bearing on a body that turns on its own, with derivatives."""
    journal, k = s.journal, int(s.journal[j, col.ROTATION])
    ex, ey = place
    # the film is dragged along by the body's own speed
    x_by_speed = 0.5 * (ey * force[4] - ex * force[5])
    y_by_speed = 0.5 * (ey * force[8] - ex * force[9])
    add_speed_slopes(s, j, x_by_speed, y_by_speed)
    sense, by_speed = journal_sense(s, state, j)
    if journal[j, col.CURVES] > 0:
        film, boundary = journal_torques(s, state, j)
        s.motion[k, col.FILM_FORCE] -= film + boundary
        add_curve_slopes(s, state, j, (x_by_speed, y_by_speed), (sense, by_speed))
        return
    c, radius = journal[j, col.JOURNAL_CLEARANCE], journal[j, col.RADIUS]
    distance = math.sqrt(ex * ex + ey * ey) + SMALL_RATIO * c
    ratio = distance / c
    load, by_ratio = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    solved, rise = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
    drag = solved * full_shear_drag(s, j, ratio)
    shear, touching = drag * own_speed(s, state, j), journal[j, col.BOUNDARY_FRICTION] * radius
    moment = journal_pressure_torque(ex, ey, force[0], force[1])
    s.motion[k, col.FILM_FORCE] -= shear + moment + sense * touching * load
    growth = sense * touching * by_ratio
    if ratio < HIGHEST_FILM_RATIO:
        growth += shear * (ratio / (1.0 - ratio * ratio) + rise / solved)
    growth *= 1.0 / (c * distance)
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
    s.film_slopes[1, k, k] -= drag + by_speed * touching * load
    s.film_slopes[1, k, k] -= 0.5 * (ex * y_by_speed - ey * x_by_speed)


@kernel
def full_shear_drag(s: SystemArrays, j: int, ratio: float) -> float:
    """Shear torque over speed of the journals of one body with full films. [N m s/rad]."""
    row = s.journal[j]
    viscosity = s.fluid.dynamic_viscosity * row[col.JOURNAL_VISCOSITY]
    drag = row[col.BEARINGS] * journal_shear_torque(
        min(ratio, HIGHEST_FILM_RATIO),
        1.0,
        viscosity,
        row[col.RADIUS],
        row[col.LENGTH],
        row[col.JOURNAL_CLEARANCE],
    )
    return float(drag)


@kernel
def journal_torques(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    r"""Viscous and asperity friction torque on the journals of one body, against its speed. [N m].

    Notes
    -----
    :func:`journal_shear_torque` times 1, or times the shear of a solved film over that of the
    full one, plus :func:`journal_pressure_torque`; and boundary friction of the load on asperities.
    A bearing with a friction curve has :func:`curve_torques` instead.
    """
    journal = s.journal
    sense, _ = journal_sense(s, state, j)
    if journal[j, col.CURVES] > 0:
        force = math.sqrt(journal[j, col.FILM_X] ** 2 + journal[j, col.FILM_Y] ** 2)
        film, boundary = curve_torques(s, j, abs(own_speed(s, state, j)), force)
        return sense * film, sense * boundary
    ex, ey = journal_place(s, state, j)
    ratio = math.sqrt(ex * ex + ey * ey) / journal[j, col.JOURNAL_CLEARANCE]
    solved, _ = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
    shear = solved * full_shear_drag(s, j, ratio) * own_speed(s, state, j)
    moment = journal_pressure_torque(ex, ey, journal[j, col.FILM_X], journal[j, col.FILM_Y])
    load, _ = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    return shear + moment, sense * journal[j, col.BOUNDARY_FRICTION] * load * journal[j, col.RADIUS]


@kernel
def curve_torques(s: SystemArrays, j: int, speed: float, force: float) -> tuple[float, float]:
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
def add_curve_slopes(
    s: SystemArrays,
    state: Array,
    j: int,
    force_by_speed: tuple[float, float],
    sliding: tuple[float, float],
) -> None:
    """Derivatives of the torque of a friction curve on a body that turns on its own."""
    journal, slopes, own = s.journal, s.film_slopes, own_speed(s, state, j)
    kx, ky = int(journal[j, col.MOTION_X]), int(journal[j, col.MOTION_Y])
    fx, fy = journal[j, col.FILM_X], journal[j, col.FILM_Y]
    force, speed = max(math.sqrt(fx * fx + fy * fy), LEAST_FORCE), abs(own)
    sense, by_speed = sliding
    growth = sense * _curve_slope(s, j, (speed, force), (0.0, CURVE_STEP * force))
    quicker = _curve_slope(s, j, (speed, force), (max(CURVE_STEP * speed, CURVE_STEP), 0.0))
    film, boundary = curve_torques(s, j, speed, force)
    k = int(journal[j, col.ROTATION])
    slopes[1, k, k] -= by_speed * (film + boundary) + sense * np.sign(own) * quicker
    slopes[1, k, k] -= growth * (fx * force_by_speed[0] + fy * force_by_speed[1]) / force
    for order in range(2):
        rise_x = (fx * slopes[order, kx, kx] + fy * slopes[order, ky, kx]) / force
        rise_y = (fx * slopes[order, kx, ky] + fy * slopes[order, ky, ky]) / force
        add_torque_slopes(s, j, order, growth * rise_x, growth * rise_y)


@kernel
def _curve_slope(
    s: SystemArrays, j: int, at: tuple[float, float], step: tuple[float, float]
) -> float:
    """Difference of the torque of a friction curve about a speed and force, over its step."""
    low = max(at[0] - step[0], 0.0)
    film, boundary = curve_torques(s, j, at[0] + step[0], at[1] + step[1])
    less_film, less_boundary = curve_torques(s, j, low, at[1] - step[1])
    span = at[0] - low + step[0] + 2.0 * step[1]
    return (film + boundary - less_film - less_boundary) / span


@kernel
def book_journal_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add journal losses to the ledger; return their torque at the shaft. [N m]."""
    journal = s.journal
    total = 0.0
    s.drive[col.DRIVEN_FRICTION] = 0.0
    for j in range(s.size.journals):
        ratio, rotation = journal[j, col.SPEED_RATIO], int(journal[j, col.ROTATION])
        share = 0.0 if rotation < 0 and s.drive[col.DIRECTION] == 0.0 else s.drive[col.FADE]
        viscous, asperity = journal_torques(s, state, j)
        viscous, asperity = share * viscous, share * asperity
        turning = own_speed(s, state, j)
        vx, vy = journal_velocity(s, state, j)
        squeeze = journal[j, col.FILM_X] * vx + journal[j, col.FILM_Y] * vy
        s.torque[JOURNAL_VISCOUS] += ratio * viscous
        s.torque[JOURNAL_ASPERITY] += ratio * asperity
        ledger[FRICTION + JOURNAL_VISCOUS] += viscous * turning - squeeze
        ledger[FRICTION + JOURNAL_ASPERITY] += asperity * turning
        total += ratio * (viscous + asperity)
        s.drive[col.DRIVEN_FRICTION] -= abs(journal[j, col.DRIVEN_SENSE]) * (viscous + asperity)
    return total
