"""Journal bearing force as a map that compiled code reads in a fraction of a microsecond.

Seen from the frame that turns with half the shaft speed, a plain journal bearing knows only
its eccentricity and the velocity of the journal in that frame. The force is proportional to
that velocity, so two numbers, eccentricity ratio and direction, describe it completely.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from toothspace.core.compiled import inlined, njit, passed_by_address
from toothspace.core.types import Array

_SATURATION_START = 0.997
"""Eccentricity ratio from which the film force stops growing. [-]"""

_SATURATION_WIDTH = 0.002
"""Range of eccentricity ratio over which it stops: 0.999 is never passed. [-]"""

_TINY_SPEED = 1e-12
"""Speed that rounds the force at rest. [m/s]"""


@passed_by_address
class JournalMap(NamedTuple):
    r"""Dimensionless journal force over eccentricity and direction of motion.

    .. math:: F = \mu L (R/c)^3 |V| \, W(\varepsilon, \psi), \qquad
        V = \dot e - \tfrac{\omega}{2} \hat z \times e

    with :math:`\psi` from the eccentricity to V. Stored are both components of
    :math:`(1-\varepsilon)^{3/2} W` with their slopes, for a C1 bicubic interpolation.
    """

    nodes: Array
    """Values, slopes and mixed slopes, shape (eccentricities, directions, 2, 4). [-]"""
    logarithm_step: float
    """Step of -ln(1 - eccentricity ratio). [-]"""
    length_over_diameter: float
    """Bearing length over diameter. [-]"""


@njit
def _axial_integral(short: float, long: float) -> tuple[float, float, float]:
    """Integrate a (1-y2) b / (a (1-y2) + b) over -1..1; also its derivatives by a and b."""
    u = short / (short + long)
    rest = long / (short + long)
    if u < 1e-3:
        shape = u * (2.0 / 3.0 + u * (2.0 / 15.0 + u * 2.0 / 35.0))
        slope = 2.0 / 3.0 + u * (4.0 / 15.0 + u * 6.0 / 35.0)
    else:
        r = np.sqrt(u)
        t = np.log((1.0 + r) / np.sqrt(rest)) / r
        shape = 1.0 - rest * t
        slope = t - 0.5 * shape / u
    value = 2.0 * long * shape
    by_short = 2.0 * rest * rest * slope
    return value, by_short, (value - short * by_short) / long


@inlined
def _clustered_angle(angle: float, cluster: float) -> float:
    """Parameter of an angle that crowds points at the narrowest gap."""
    sine = np.sqrt(1.0 - cluster) * np.sin(0.5 * angle)
    cosine = np.sqrt(1.0 + cluster) * np.cos(0.5 * angle)
    half = np.arctan2(sine, cosine)
    return 2.0 * (half if half >= 0.0 else half + 2.0 * np.pi)


@njit
def _film_pressure(ecc: float, co: float, si: float, heading: Any, slenderness: float) -> Any:
    """Axial integral of the pressure at unit speed, and its change with the direction."""
    cos_dir, sin_dir = heading
    h = 1.0 + ecc * co
    scale = slenderness * slenderness / (h * h * h)
    short = -scale * (cos_dir * co + sin_dir * si)
    squeeze = -co * (1.0 + h) / (h * h)
    wedge = -2.0 * (2.0 + ecc * co) * si / ((2.0 + ecc * ecc) * h * h)
    long = cos_dir * squeeze + sin_dir * wedge
    if short <= 0.0 or long <= 0.0:
        return 0.0, 0.0
    value, by_short, by_long = _axial_integral(short, long)
    turned = by_short * scale * (sin_dir * co - cos_dir * si)
    return value, turned + by_long * (cos_dir * wedge - sin_dir * squeeze)


@njit
def _direction_force(ecc: float, direction: float, slenderness: float, count: int) -> Any:
    """Force along and across the eccentricity at unit speed, and its change with direction.

    The direction is 0 to pi; pressure stands only in the half that the journal moves into.
    """
    heading = (np.cos(direction), np.sin(direction))
    cluster = 0.9 * ecc
    root = np.sqrt(1.0 - cluster * cluster)
    first = _clustered_angle(direction + 0.5 * np.pi, cluster)
    width = (_clustered_angle(direction + 1.5 * np.pi, cluster) - first) / count
    along = across = along_slope = across_slope = 0.0
    for k in range(count):
        gamma = first + width * (k + 0.5)
        weight = 1.0 / (1.0 - cluster * np.cos(gamma))
        co = (np.cos(gamma) - cluster) * weight
        si = root * np.sin(gamma) * weight
        value, slope = _film_pressure(ecc, co, si, heading, slenderness)
        along += value * co * weight
        across += value * si * weight
        along_slope += slope * co * weight
        across_slope += slope * si * weight
    factor = 3.0 * width * root
    return factor * along, factor * across, factor * along_slope, factor * across_slope


@njit
def _sample(slenderness: float, step: float, points: int, samples: Array) -> None:
    """Scaled force and direction slope on the grid, with two extra rows at both ends."""
    rows, columns = samples.shape[:2]
    for i in range(rows):
        rest = np.exp(-(i - 2) * step)
        scale = rest * np.sqrt(rest)
        for j in range(columns // 2 + 1):
            x = 1.0 - 4.0 * j / columns
            y = 1.0 - abs(x)
            length = np.sqrt(x * x + y * y)
            force = _direction_force(1.0 - rest, np.arctan2(y, x), slenderness, points)
            # Slope of the angle over the diamond coordinate, times its step.
            chain = 1.0 / (length * length) * 4.0 / columns
            mirror = (columns - j) % columns
            for side, column in ((-1.0, mirror), (1.0, j)):
                samples[i, column, 0, 0] = scale * force[0]
                samples[i, column, 1, 0] = side * scale * force[1]
                samples[i, column, 0, 1] = side * scale * force[2] * chain
                samples[i, column, 1, 1] = scale * force[3] * chain


def build_journal_map(
    length_over_diameter: float, rows: int = 64, columns: int = 320, points: int = 160
) -> JournalMap:
    r"""Tabulate the force of a finite plain journal bearing, squeeze included.

    Parameters
    ----------
    length_over_diameter : float
        Bearing length over diameter, 0.05 to 2. [-]
    rows : int
        Nodes over -ln(1 - eccentricity ratio), 0 to 7. [-]
    columns : int
        Nodes over the direction of motion, a multiple of 4. [-]
    points : int
        Points of the quadrature over the film. [-]

    Returns
    -------
    JournalMap
        The map. [-]

    Notes
    -----
    At speed V in the half-speed frame, with :math:`h = 1 + \varepsilon\cos\vartheta` from
    the widest gap, wedge :math:`A = -2 \sin\psi` and squeeze :math:`B = \cos\psi`,

    .. math:: \frac{p\, c}{6 \mu (R/c)^2 |V|} &= \frac{p_s p_l}{p_s + p_l}, \qquad
        p_s = \tfrac12 (L/D)^2 (1 - y^2) \frac{A \sin\vartheta - 2 B \cos\vartheta}{h^3}, \\
        p_l &= \frac{A (2 + \varepsilon\cos\vartheta) \sin\vartheta}
        {(2 + \varepsilon^2)\, h^2} + \frac{B}{\varepsilon} \left(\frac{1}{h^2} - 1\right)

    where both are positive: the harmonic sum of the short and the long bearing's pressure, whose
    axial integral is closed. The long film's pressure is free of a starting line, so that the
    force of a centred journal does not depend on the direction of a vanishing eccentricity and
    an opening journal is held back. Validity: laminar, one viscosity, aligned journal, cavity
    and ends at one pressure.

    Accuracy: interpolation within 0.2 % of the quadrature. The closed form against the
    Reynolds equation up to 0.95: steady 1, 3 and 6 %, pure squeeze 4, 6 and 7 % for a length
    over diameter of 1/4, 1/2 and 1 (against Butenschoen's tables).

    References
    ----------
    .. [1] B. R. Reason, I. P. Narang, "Rapid design and performance evaluation of steady-state
       journal bearings", ASLE Trans. 25, 1982, 429-444 (harmonic sum, steady).
    .. [2] H.-J. Butenschoen, *Das hydrodynamische, zylindrische Gleitlager endlicher Breite unter
       instationaerer Belastung*, dissertation, Karlsruhe, 1976.
    """
    step = 7.0 / (rows - 1)
    samples = np.empty((rows + 4, columns, 2, 2))
    _sample(length_over_diameter, step, points, samples)
    nodes = np.empty((rows, columns, 2, 4))
    nodes[..., 0:4:2] = samples[2:-2]
    growth = samples[:-4] - 8.0 * samples[1:-3] + 8.0 * samples[3:-1] - samples[4:]
    nodes[..., 1:4:2] = growth / 12.0
    return JournalMap(np.ascontiguousarray(nodes), step, float(length_over_diameter))


@inlined
def _hermite(x: float) -> tuple[float, float, float, float]:
    """Cubic Hermite weights: value and slope at the left, value and slope at the right."""
    y = 1.0 - x
    right = x * x * (3.0 - 2.0 * x)
    return 1.0 - right, x * y * y, right, -x * x * y


@inlined
def _hermite_slope(x: float) -> tuple[float, float, float, float]:
    """Derivatives of :func:`_hermite`."""
    y = 1.0 - x
    right = 6.0 * x * y
    return -right, y * (1.0 - 3.0 * x), right, x * (3.0 * x - 2.0)


@inlined
def _limited(ecc: float) -> tuple[float, float]:
    """Eccentricity ratio that the film feels, and its slope: never above 0.999."""
    if ecc < _SATURATION_START:
        return ecc, 1.0
    slope = np.exp(-(ecc - _SATURATION_START) / _SATURATION_WIDTH)
    return _SATURATION_START + _SATURATION_WIDTH * (1.0 - slope), slope


@inlined
def _diamond(x: float, y: float) -> tuple[float, float]:
    """Direction of a vector as a number of 0 to 4, and its slope over the angle."""
    size = abs(x) + abs(y) + 1e-300
    turn = 1.0 - x / size if y >= 0.0 else 3.0 + x / size
    return turn, (x / size) ** 2 + (y / size) ** 2


@inlined
def _lookup(journal_map: JournalMap, ecc: float, turn: float) -> Any:
    """Both components of W with slopes over the eccentricity ratio and the turn."""
    nodes = journal_map.nodes
    rest = 1.0 - ecc
    x = -np.log(rest) / journal_map.logarithm_step
    columns = nodes.shape[1]
    y = turn * (0.25 * columns)
    i = min(int(x), nodes.shape[0] - 2)
    j = min(int(y), columns - 1)
    k = j + 1 if j + 1 < columns else 0
    a0, a1, a2, a3 = _hermite(x - i)
    d0, d1, d2, d3 = _hermite_slope(x - i)
    b0, b1, b2, b3 = _hermite(y - j)
    e0, e1, e2, e3 = _hermite_slope(y - j)
    scale = 1.0 / (rest * np.sqrt(rest))
    by_ecc = scale / (rest * journal_map.logarithm_step)
    by_turn = scale * 0.25 * columns
    row = nodes[i]
    nxt = nodes[i + 1]
    out = (0.0, 0.0, 0.0)
    first = out
    for m in range(2):
        p = b0 * row[j, m, 0] + b1 * row[j, m, 2] + b2 * row[k, m, 0] + b3 * row[k, m, 2]
        q = b0 * row[j, m, 1] + b1 * row[j, m, 3] + b2 * row[k, m, 1] + b3 * row[k, m, 3]
        r = b0 * nxt[j, m, 0] + b1 * nxt[j, m, 2] + b2 * nxt[k, m, 0] + b3 * nxt[k, m, 2]
        s = b0 * nxt[j, m, 1] + b1 * nxt[j, m, 3] + b2 * nxt[k, m, 1] + b3 * nxt[k, m, 3]
        pt = e0 * row[j, m, 0] + e1 * row[j, m, 2] + e2 * row[k, m, 0] + e3 * row[k, m, 2]
        qt = e0 * row[j, m, 1] + e1 * row[j, m, 3] + e2 * row[k, m, 1] + e3 * row[k, m, 3]
        rt = e0 * nxt[j, m, 0] + e1 * nxt[j, m, 2] + e2 * nxt[k, m, 0] + e3 * nxt[k, m, 2]
        st = e0 * nxt[j, m, 1] + e1 * nxt[j, m, 3] + e2 * nxt[k, m, 1] + e3 * nxt[k, m, 3]
        value = a0 * p + a1 * q + a2 * r + a3 * s
        growth = d0 * p + d1 * q + d2 * r + d3 * s
        first = out
        out = (
            scale * value,
            by_ecc * growth + 1.5 * scale / rest * value,
            by_turn * (a0 * pt + a1 * qt + a2 * rt + a3 * st),
        )
    return first, out


@inlined
def journal_force(
    ex: float,
    ey: float,
    vx: float,
    vy: float,
    shaft_speed: float,
    radial_clearance: float,
    film_scale: float,
    journal_map: JournalMap,
) -> tuple[float, ...]:
    r"""Force of the film on a journal, with its derivatives.

    Parameters
    ----------
    ex, ey : float
        Eccentricity of the journal in its bush. [m]
    vx, vy : float
        Velocity of the journal relative to the bush. [m/s]
    shaft_speed : float
        Angular speed of the journal, positive from x to y. [rad/s]
    radial_clearance : float
        Radius of the bush minus radius of the journal. [m]
    film_scale : float
        Viscosity times length times cube of radius over clearance, of all bearings that
        share the load. [N s/m]
    journal_map : JournalMap
        Map of :func:`build_journal_map`. [-]

    Returns
    -------
    force_x, force_y : float
        Force on the journal. [N]
    x_by_ex, x_by_ey, x_by_vx, x_by_vy : float
        Derivatives of ``force_x`` with respect to position and velocity. [N/m], [N s/m]
    y_by_ex, y_by_ey, y_by_vx, y_by_vy : float
        Derivatives of ``force_y``. [N/m], [N s/m]

    Notes
    -----
    .. math:: F = \mu L (R/c)^3 |V| W(\varepsilon, \psi), \qquad
        V = \dot e - \tfrac{\omega}{2} \hat z \times e

    Continuous with bounded derivatives everywhere, at rest and centred too. Above an
    eccentricity ratio of 0.997 the film stops growing and stays finite when the journal
    sinks into the bush, where asperities carry. Validity: that of the map; the bush does not
    turn; if it does, or the load turns, the speed is journal + bush - 2 load.

    References
    ----------
    .. [1] D. W. Childs, H. Moes, H. van Leeuwen, "Journal bearing impedance descriptions for
       rotordynamic applications", J. Lubr. Technol. 99, 1977, 198-210.
    """
    half = 0.5 * shaft_speed
    wx, wy = vx + half * ey, vy - half * ex
    size = np.sqrt(ex * ex + ey * ey)
    centred = size < 1e-12 * radial_clearance
    c = 1.0 if centred else ex / size
    s = 0.0 if centred else ey / size
    a, b = wx * c + wy * s, wy * c - wx * s
    speed = np.sqrt(a * a + b * b + _TINY_SPEED * _TINY_SPEED)
    cosine, sine = a / speed, b / speed
    ecc, ecc_slope = _limited(size / radial_clearance)
    turn, turn_slope = _diamond(a, b)
    (we, we_ecc, we_turn), (wp, wp_ecc, wp_turn) = _lookup(journal_map, ecc, turn)
    wed, wpd = we_turn * turn_slope, wp_turn * turn_slope
    # Derivatives by the velocity along and across the eccentricity.
    ea, eb = film_scale * (we * cosine - wed * sine), film_scale * (we * sine + wed * cosine)
    pa, pb = film_scale * (wp * cosine - wpd * sine), film_scale * (wp * sine + wpd * cosine)
    strength = film_scale * speed
    fe, fp = strength * we, strength * wp
    # Derivatives by the eccentricity at fixed V: stretch along it, turn across it.
    stretch = strength * ecc_slope / radial_clearance
    turning = strength * size / (size * size + 1e-6 * radial_clearance * radial_clearance)
    ee, pe = stretch * we_ecc, stretch * wp_ecc
    ep, pp = turning * (-wp - wed), turning * (we - wpd)
    # V itself changes with the eccentricity: dV = half (de across, - de along).
    ee, ep = ee - half * eb, ep + half * ea
    pe, pp = pe - half * pb, pp + half * pa
    xe, xp, ye, yp = c * ee - s * pe, c * ep - s * pp, s * ee + c * pe, s * ep + c * pp
    xa, xb, ya, yb = c * ea - s * pa, c * eb - s * pb, s * ea + c * pa, s * eb + c * pb
    return (
        c * fe - s * fp,
        s * fe + c * fp,
        xe * c - xp * s,
        xe * s + xp * c,
        xa * c - xb * s,
        xa * s + xb * c,
        ye * c - yp * s,
        ye * s + yp * c,
        ya * c - yb * s,
        ya * s + yb * c,
    )
