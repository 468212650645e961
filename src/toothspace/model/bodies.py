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
from toothspace.model.arrays import (
    BEARINGS,
    BOUNDARY_FRICTION,
    BUSH_X,
    BUSH_Y,
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
    VOLUME_SHARE,
    SystemArrays,
)
from toothspace.model.lateral_table import ASPERITY_STRESS, DRAG_STRESS, SHEAR_RATIO
from toothspace.model.ledger import FRICTION, JOURNAL_ASPERITY, JOURNAL_VISCOUS

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


@kernel
def update_pressure_forces(s: SystemArrays) -> None:
    """Sum the chamber pressures into the generalised force on every free motion."""
    node, values, motion, size = s.node, s.chamber_values, s.motion, s.size
    for k in range(size.motions):
        force = 0.0
        for i in range(size.chambers):
            force += node[i, PRESSURE] * node[i, VOLUME_SHARE] * values[i, CHANNEL_MOTION + k]
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
    journal, motion, slopes, size = s.journal, s.motion, s.film_slopes, s.size
    viscosity = s.fluid.dynamic_viscosity
    update_lateral_drag(s, state)
    for j in range(size.journals):
        kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
        ex = state[size.position + kx] - journal[j, BUSH_X]
        ey = state[size.position + ky] - journal[j, BUSH_Y]
        vx, vy = state[size.velocity + kx], state[size.velocity + ky]
        speed, c = own_speed(s, state, j), journal[j, JOURNAL_CLEARANCE]
        scale = journal[j, BEARINGS] * viscosity * journal[j, JOURNAL_VISCOSITY]
        scale *= journal[j, LENGTH] * (journal[j, RADIUS] / c) ** 3
        nodes = s.film.nodes[int(journal[j, FILM_MAP])]
        film = JournalMap(nodes, s.film.logarithm_step, s.film.length_over_diameter)
        force = journal_force(ex, ey, vx, vy, speed, c, scale, film)
        journal[j, FILM_X], journal[j, FILM_Y] = force[0], force[1]
        motion[kx, FILM_FORCE] += force[0]
        motion[ky, FILM_FORCE] += force[1]
        slopes[0, kx, kx] += force[2]
        slopes[0, kx, ky] += force[3]
        slopes[1, kx, kx] += force[4]
        slopes[1, kx, ky] += force[5]
        slopes[0, ky, kx] += force[6]
        slopes[0, ky, ky] += force[7]
        slopes[1, ky, kx] += force[8]
        slopes[1, ky, ky] += force[9]
        add_asperity_force(s, j, ex, ey)
        if journal[j, ROTATION] >= 0.0:
            hold_back(s, state, j, (ex, ey), force)


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
    journal[j, FILM_X] -= force * nx
    journal[j, FILM_Y] -= force * ny
    slopes[0, kx, kx] -= radial * nx * nx + tangential * ny * ny
    slopes[0, kx, ky] -= (radial - tangential) * nx * ny
    slopes[0, ky, kx] -= (radial - tangential) * nx * ny
    slopes[0, ky, ky] -= radial * ny * ny + tangential * nx * nx


@kernel
def own_speed(s: SystemArrays, state: Array, j: int) -> float:
    """Angular speed of the body in a bearing. [rad/s]."""
    speed, k = s.journal[j, SPEED_RATIO] * state[1], int(s.journal[j, ROTATION])
    return float(speed + state[s.size.velocity + k]) if k >= 0 else float(speed)


@kernel
def sliding_sense(s: SystemArrays, state: Array, j: int) -> tuple[float, float]:
    r"""Sense in which the surfaces of a bearing slide, -1 to 1, and its slope by speed. [s/rad].

    Notes
    -----
    That of the shaft, but for a body that turns on its own with :math:`\dot q`:

    .. math:: \operatorname{sgn}(i\,\omega) + \tanh\frac{i\,\omega + \dot q}{\omega_c}
        - \tanh\frac{i\,\omega}{\omega_c}

    so that friction brings it to rest, at a creeping speed :math:`\omega_c`, but never turns it
    backwards.
    """
    journal = s.journal
    mean, radius = journal[j, SPEED_RATIO] * state[1], journal[j, RADIUS]
    sense = np.sign(journal[j, SPEED_RATIO]) * s.drive[DIRECTION]
    if journal[j, ROTATION] < 0.0:
        return sense, 0.0
    creep = max(min(CREEP_SPEED / radius, CREEP_SHARE * abs(mean)), LEAST_CREEP / radius)
    own = own_speed(s, state, j)
    if own * mean > 0.0 and min(abs(own), abs(mean)) > SATURATED * creep:
        return sense, 0.0
    now = math.tanh(own / creep)
    sense += now - math.tanh(mean / creep)
    return min(max(sense, -1.0), 1.0), (1.0 - now * now) / creep


@kernel
def hold_back(
    s: SystemArrays, state: Array, j: int, place: tuple[float, float], force: tuple[float, ...]
) -> None:
    """Friction torque of one bearing on a body that turns on its own, with derivatives."""
    journal, slopes = s.journal, s.film_slopes
    k, kx, ky = int(journal[j, ROTATION]), int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
    ex, ey = place
    # the film is dragged along by the body's own speed
    x_by_speed = 0.5 * (ey * force[4] - ex * force[5])
    y_by_speed = 0.5 * (ey * force[8] - ex * force[9])
    slopes[1, kx, k] += x_by_speed
    slopes[1, ky, k] += y_by_speed
    sense, by_speed = sliding_sense(s, state, j)
    if journal[j, CURVES] > 0:
        film, boundary = journal_torques(s, state, j)
        s.motion[k, FILM_FORCE] -= film + boundary
        add_curve_slopes(s, state, j, sense, by_speed)
        return
    c, radius = journal[j, JOURNAL_CLEARANCE], journal[j, RADIUS]
    distance = math.sqrt(ex * ex + ey * ey) + SMALL_RATIO * c
    ratio = distance / c
    load, by_ratio = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    solved, rise = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
    drag = solved * full_shear_drag(s, j, ratio)
    shear, touching = drag * own_speed(s, state, j), journal[j, BOUNDARY_FRICTION] * radius
    moment = journal_pressure_torque(ex, ey, force[0], force[1])
    s.motion[k, FILM_FORCE] -= shear + moment + sense * touching * load
    growth = sense * touching * by_ratio
    if ratio < HIGHEST_FILM_RATIO:
        growth += shear * (ratio / (1.0 - ratio * ratio) + rise / solved)
    growth *= 1.0 / (c * distance)
    slopes[0, k, kx] -= growth * ex + 0.5 * (force[1] + ex * force[6] - ey * force[2])
    slopes[0, k, ky] -= growth * ey + 0.5 * (ex * force[7] - ey * force[3] - force[0])
    slopes[1, k, kx] -= 0.5 * (ex * force[8] - ey * force[4])
    slopes[1, k, ky] -= 0.5 * (ex * force[9] - ey * force[5])
    slopes[1, k, k] -= drag + by_speed * touching * load
    slopes[1, k, k] -= 0.5 * (ex * y_by_speed - ey * x_by_speed)


@kernel
def full_shear_drag(s: SystemArrays, j: int, ratio: float) -> float:
    """Shear torque over speed of the journals of one body with full films. [N m s/rad]."""
    row = s.journal[j]
    viscosity = s.fluid.dynamic_viscosity * row[JOURNAL_VISCOSITY]
    drag = row[BEARINGS] * journal_shear_torque(
        min(ratio, HIGHEST_FILM_RATIO),
        1.0,
        viscosity,
        row[RADIUS],
        row[LENGTH],
        row[JOURNAL_CLEARANCE],
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
    journal, size = s.journal, s.size
    sense, _ = sliding_sense(s, state, j)
    if journal[j, CURVES] > 0:
        force = math.sqrt(journal[j, FILM_X] ** 2 + journal[j, FILM_Y] ** 2)
        film, boundary = curve_torques(s, state, j, force)
        return sense * film, sense * boundary
    kx, ky = int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
    ex = state[size.position + kx] - journal[j, BUSH_X]
    ey = state[size.position + ky] - journal[j, BUSH_Y]
    ratio = math.sqrt(ex * ex + ey * ey) / journal[j, JOURNAL_CLEARANCE]
    solved, _ = asperity_value(s.asperity, j, SHEAR, s.constant.asperity_range, ratio)
    shear = solved * full_shear_drag(s, j, ratio) * own_speed(s, state, j)
    moment = journal_pressure_torque(ex, ey, journal[j, FILM_X], journal[j, FILM_Y])
    load, _ = asperity_value(s.asperity, j, LOAD, s.constant.asperity_range, ratio)
    return shear + moment, sense * journal[j, BOUNDARY_FRICTION] * load * journal[j, RADIUS]


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
    speed = abs(own_speed(s, state, j))
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
def add_curve_slopes(s: SystemArrays, state: Array, j: int, sense: float, by_speed: float) -> None:
    """Derivatives of the torque of a friction curve on a body that turns on its own."""
    journal, slopes = s.journal, s.film_slopes
    k, kx, ky = int(journal[j, ROTATION]), int(journal[j, MOTION_X]), int(journal[j, MOTION_Y])
    fx, fy = journal[j, FILM_X], journal[j, FILM_Y]
    force = max(math.sqrt(fx * fx + fy * fy), LEAST_FORCE)
    step = 1e-4 * force
    film, boundary = curve_torques(s, state, j, force + step)
    less_film, less_boundary = curve_torques(s, state, j, force - step)
    growth = sense * (film + boundary - less_film - less_boundary) / (2.0 * step)
    slopes[1, k, k] -= by_speed * (film + boundary)
    for order in range(2):
        for m in (kx, ky):
            rise = (fx * slopes[order, kx, m] + fy * slopes[order, ky, m]) / force
            slopes[order, k, m] -= growth * rise


@kernel
def book_journal_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add journal losses to the ledger; return their torque at the shaft. [N m]."""
    journal, size = s.journal, s.size
    total = 0.0
    s.drive[DRIVEN_FRICTION] = 0.0
    for j in range(size.journals):
        ratio, rotation = journal[j, SPEED_RATIO], int(journal[j, ROTATION])
        share = 0.0 if rotation < 0 and s.drive[DIRECTION] == 0.0 else s.drive[FADE]
        viscous, asperity = journal_torques(s, state, j)
        viscous, asperity = share * viscous, share * asperity
        turning = own_speed(s, state, j)
        squeeze = journal[j, FILM_X] * state[size.velocity + int(journal[j, MOTION_X])]
        squeeze += journal[j, FILM_Y] * state[size.velocity + int(journal[j, MOTION_Y])]
        s.torque[JOURNAL_VISCOUS] += ratio * viscous
        s.torque[JOURNAL_ASPERITY] += ratio * asperity
        ledger[FRICTION + JOURNAL_VISCOUS] += viscous * turning - squeeze
        ledger[FRICTION + JOURNAL_ASPERITY] += asperity * turning
        total += ratio * (viscous + asperity)
        s.drive[DRIVEN_FRICTION] -= abs(journal[j, DRIVEN_SENSE]) * (viscous + asperity)
    return total
