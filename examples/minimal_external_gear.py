"""An external gear pump in one file: plain NumPy and SciPy, readable from top to bottom.

The 12-tooth pump of 4.95 cm3/rev with both gears held at their centres, at one speed, between
two constant pressures, with one constant viscosity and a liquid without gas. The laws:

* Teeth: involutes cut by a rack with rounded tip (trochoidal root), sharp tip corners.
* Chambers: the tooth spaces of both gears, inside their tip circles and between the faces. In
  the mesh each is cut off at the *throats*, the shortest distances between facing flanks.
  A throat is born at the cusp of the two tip circles when the first tooth corner passes it,
  is complete when the second corner has passed, and dies in the same way at the other cusp;
  meanwhile, over the elapsed part t, its ends travel from the cusp to the closest points: an end on
  a flank with the smooth step s(t) = 3 t^2 - 2 t^3, an end on a tip circle with s(2 t) to its
  corner and then with s(2 t - 1) along its flank.
* Liquid: rho = rho0 [1 + a p / (1 + b p)].
* Mass of a chamber: d(rho V)/dt = sum of mass flows, with dV/dphi from the moving walls.
* Every path:  dp = Q/G + rho Q |Q| / (2 (C A)^2), rho and mass flow of the upstream end, C = 0.7
  at sharp edges and 1 in throats, plus wall drag Q_d = b h u, u the mean speed of the walls
  relative to the path.
    - opening (port, groove):  G = 2 C^2 A Dh / (mu Re_t), Re_t = 350, Dh = 4 A / perimeter
    - parallel gap (tip, lateral, drain):  G = b h^3 / (12 mu L), A = b h
    - curved gap (throat):  G = 8 b h^2.5 / (36 pi sqrt(2 R) mu), 1/R = 1/R1 + 1/R2, A = b h;
      beyond h = 0.1 R it grows as h^2
* Tip: seals on the bore between the ports, with a smooth step of one tip land outside them.
  Lateral: from space to space over both faces of a tooth. Drain: from the spaces over the land
  between root and shaft, to the inlet.
* Ports: mouth of a space on the tip circles between cusp and port edge, times the face width.
* Relief grooves: overlap of the space's section with a rectangle in each face, in series with
  the groove's own section, depth times the overlap's extent along y: 1/A^2 = 1/Ao^2 + 1/Ag^2.

Frame: drive gear at the origin, driven gear at +y, outlet at +x. A *place* on a gear is an angle
from the line of centres, positive in the gear's own sense of rotation, so that both gears
look alike: in the mesh both move towards -x. Points of the plane are complex numbers x + iy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

# ---------------------------------------------------------------- 1. the machine
TEETH, MODULE, PRESSURE_ANGLE, PROFILE_SHIFT = 12, 2.75e-3, np.radians(20.0), 0.30
DEDENDUM, TOOL_RADIUS = 1.25 * MODULE, 0.38 * MODULE
TIP_RADIUS, WIDTH, BACKLASH = 20.186e-3, 7.5e-3, 0.20e-3
TIP_GAP, SIDE_GAP, SHAFT_RADIUS = 20e-6, 8e-6, 9e-3
INLET_EDGE, OUTLET_EDGE = np.radians(70.0), np.radians(55.0)
GROOVE_EDGE, GROOVE_WIDTH, GROOVE_HALF_HEIGHT, GROOVE_DEPTH = 3.3e-3, 10e-3, 5e-3, 1.5e-3
RESIDUAL_GAP = 1e-6  # roughness keeps touching flanks apart
CORNER_RADIUS = 50e-6  # edge of a tip corner at the end of a throat

SPEED = 1500.0 * np.pi / 30.0
INLET_PRESSURE, OUTLET_PRESSURE = 16e5, 100e5
VISCOSITY, DENSITY, COMPLIANCE, STIFFENING = 0.026, 841.7, 0.6e-9, 1.17e-9
DISCHARGE, THROAT_DISCHARGE, TRANSITION = 0.7, 1.0, 350.0

# ---------------------------------------------------------------- 2. the tooth
PITCH = 2.0 * np.pi / TEETH


def involute(angle):
    return np.tan(angle) - angle


BASE = 0.5 * MODULE * TEETH * np.cos(PRESSURE_ANGLE)
HALF_BASE = (np.pi / 2 + 2 * PROFILE_SHIFT * np.tan(PRESSURE_ANGLE)) / TEETH + involute(
    PRESSURE_ANGLE
)  # half tooth on the base circle
# play of one flank when the teeth are centred: BASE (2 inv(aw) + pi/z - 2 HALF_BASE)
AW = brentq(
    lambda a: BASE * (2 * involute(a) + np.pi / TEETH - 2 * HALF_BASE) - BACKLASH / 2, 0.1, 1.0
)
CENTRES = 2.0 * BASE / np.cos(AW)
ROLL_TIP = np.sqrt((TIP_RADIUS / BASE) ** 2 - 1.0)  # involute roll angle at the tip
CUSP = np.arccos(0.5 * CENTRES / TIP_RADIUS)  # place of the cusps of the tip circles
LAG = 0.5 * BACKLASH / BASE  # the driven gear stays behind until the drive flanks touch


def half_tooth():
    """Radius and half thickness angle from the tip corner to the middle of the space."""
    reference = 0.5 * MODULE * TEETH
    depth = DEDENDUM - PROFILE_SHIFT * MODULE - TOOL_RADIUS  # centre of the rack's tip corner
    aside = MODULE * np.pi / 4 - DEDENDUM * np.tan(PRESSURE_ANGLE)
    aside -= TOOL_RADIUS * (1 - np.sin(PRESSURE_ANGLE)) / np.cos(PRESSURE_ANGLE)
    # the normal at corner angle g passes the pitch point after the rack has moved so far
    g = np.linspace(0.0, np.pi / 2 - PRESSURE_ANGLE, 600)
    rolled = (depth * np.tan(g) - aside) / reference
    below = depth + TOOL_RADIUS * np.cos(g)
    fillet = (reference - below) + 1j * below * np.tan(g)
    fillet_half = np.pi / TEETH - (np.angle(fillet) - rolled)
    roll = np.linspace(np.sqrt((abs(fillet[-1]) / BASE) ** 2 - 1), ROLL_TIP, 2000)[1:]
    root = np.linspace(np.pi / TEETH, fillet_half[0], 50)[:-1]
    radius = [np.full(root.size, abs(fillet[0])), abs(fillet), BASE * np.sqrt(1 + roll**2)]
    half = [root, fillet_half, HALF_BASE - (roll - np.arctan(roll))]
    return np.concatenate(radius)[::-1], np.concatenate(half)[::-1]


RADIUS, HALF = half_tooth()
ROOT_RADIUS, TIP_HALF = RADIUS[-1], HALF[0]
# distance along the flank from the tip corner
ALONG = np.concatenate([[0.0], np.cumsum(abs(np.diff(RADIUS * np.exp(1j * HALF))))])


def point(gear, radius, place):
    height = radius * np.cos(place)
    return -radius * np.sin(place) + 1j * (height if gear == 0 else CENTRES - height)


def arc(gear, start, end):
    count = 2 + int(abs(end - start) / 2e-3)
    return point(gear, TIP_RADIUS, np.linspace(start, end, count))


# ---------------------------------------------------------------- 3. throats
def nearest(curve, target):
    """Distance along a flank, from its corner, of its point closest to a target."""
    k = min(max(int(np.argmin(abs(curve - target))), 1), curve.size - 2)
    best = []
    for i in (k - 1, k):
        edge = curve[i + 1] - curve[i]
        t = np.clip(((target - curve[i]) * edge.conjugate()).real / abs(edge) ** 2, 0, 1)
        best.append((abs(curve[i] + t * edge - target), ALONG[i] + t * (ALONG[i + 1] - ALONG[i])))
    return min(best)[1]


@dataclass
class Throat:
    """One throat; pairs are (drive, driven)."""

    tooth: tuple  # places of the teeth
    flank: tuple  # +1 leading, -1 trailing flank
    corner: tuple  # places of the tip corners
    sign: float  # cusp that counts: -1 outlet side, +1 inlet side
    inward: tuple | None = None  # ends along the flanks, negative on the tip circle
    weight: float = 0.0
    ends: tuple = (0j, 0j)
    gap: float = 0.0
    curve_radius: float = 1.0

    def end_place(self, gear):
        """Place of the end on the tip circle, None where it is on the flank."""
        if self.inward is None:
            return self.sign * CUSP
        if self.inward[gear] >= 0.0:
            return None
        return self.corner[gear] + self.sign * self.inward[gear] / TIP_RADIUS

    def curve(self, gear):
        return point(gear, RADIUS, self.tooth[gear] + self.flank[gear] * HALF)


def smooth_step(t):
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def throat(place, side):
    """Throat of the drive space at a place: behind (side -1) or ahead (+1) of the driven tooth."""
    tooth, flank = (place + side * PITCH / 2, place - LAG), (-side, side)
    corner = tuple(t + f * TIP_HALF for t, f in zip(tooth, flank, strict=True))
    appears, complete = sorted(place - c - CUSP for c in corner)
    leaves, gone = sorted(place - c + CUSP for c in corner)
    found = Throat(tooth, flank, corner, -1.0 if 2 * place < complete + leaves else 1.0)
    cusp = point(0, TIP_RADIUS, found.sign * CUSP)
    if not appears < place < gone:
        found.ends = (cusp, cusp)
        return found
    part = min((place - appears) / (complete - appears), (gone - place) / (gone - leaves), 1.0)
    found.weight = smooth_step(part)
    closest, found.curve_radius = closest_points(found, side)
    found.inward = tuple(inward_end(found, part, g, cusp, closest[g]) for g in (0, 1))
    found.ends = tuple(end_point(found, g) for g in (0, 1))
    found.gap = abs(found.ends[1] - found.ends[0])
    return found


def closest_points(t, side):
    """Closest points as distances from the corners, and their relative radius of curvature."""
    roll = (AW + HALF_BASE - side * t.tooth[0], AW + HALF_BASE + side * t.tooth[1])
    if max(roll) <= ROLL_TIP:  # both on the line of action
        radii = BASE * np.sqrt(1 + np.square(roll))
        along = np.interp(-radii, -RADIUS[:2000], ALONG[:2000])
        return along, 1.0 / sum(1.0 / (BASE * r) for r in roll)
    first, second = t.curve(0), t.curve(1)
    if roll[0] > roll[1]:
        return (0.0, nearest(second, first[0])), CORNER_RADIUS
    return (nearest(first, second[0]), 0.0), CORNER_RADIUS


def inward_end(t, part, gear, cusp, closest):
    excess = t.sign * t.corner[gear] - CUSP
    if part >= 1.0:
        return closest
    if excess > 0.0 and part < 0.5:
        return -excess * TIP_RADIUS * (1.0 - smooth_step(2.0 * part))
    if excess > 0.0:
        return smooth_step(2.0 * part - 1.0) * closest
    outer = nearest(t.curve(gear), cusp)
    return outer + smooth_step(part) * (closest - outer)


def end_point(t, gear):
    place = t.end_place(gear)
    if place is not None:
        return point(gear, TIP_RADIUS, place)
    radius, half = (np.interp(t.inward[gear], ALONG, v) for v in (RADIUS, HALF))
    return point(gear, radius, t.tooth[gear] + t.flank[gear] * half)


# ---------------------------------------------------------------- 4. chambers and openings
def own_wall(t, gear):
    """From a throat's end to the tip corner, where it is on the tip circle, and to the root."""
    place, curve = t.end_place(gear), t.curve(gear)
    if place is not None:
        return np.concatenate([arc(gear, place, t.corner[gear])[:-1], curve])
    return np.concatenate([[t.ends[gear]], curve[t.inward[gear] < ALONG]])


def entering_wall(t, gear):
    """From a throat's end along the flank to the tip circle, and the place reached there."""
    place = t.end_place(gear)
    if place is not None:
        return np.array([point(gear, TIP_RADIUS, place)]), place
    return np.append(t.ends[gear], t.curve(gear)[t.inward[gear] > ALONG][::-1]), t.corner[gear]


def section(gear, behind, ahead):
    """Polygon of a tooth space between the throats behind and ahead of the entering tooth."""
    own = [own_wall(ahead, gear), own_wall(behind, gear)[::-1]]
    if behind.inward is None and ahead.inward is None:
        mouth = arc(gear, behind.corner[gear], ahead.corner[gear])
        return np.concatenate([ahead.curve(gear), behind.curve(gear)[::-1], mouth])
    (first, start), (last, end) = (entering_wall(t, 1 - gear) for t in (behind, ahead))
    return np.concatenate([*own, first, arc(1 - gear, start, end), last[::-1]])


def area_of(polygon):
    return abs(0.5 * np.sum((polygon.conj() * np.roll(polygon, -1)).imag))


def clipped(polygon, origin, inward):
    """Part of a polygon on one side of a line (Sutherland and Hodgman)."""
    depth = ((polygon - origin) * inward.conjugate()).real
    after, depth_after = np.roll(polygon, -1), np.roll(depth, -1)
    crossing = depth * depth_after < 0.0
    t = np.where(crossing, depth / np.where(crossing, depth - depth_after, 1.0), 0.0)
    pairs = np.stack([polygon, polygon + t * (after - polygon)], axis=1)
    return pairs[np.stack([depth >= 0.0, crossing], axis=1)]


def opening(polygon, sign):
    """Area and hydraulic diameter of the opening to the groove at sign * GROOVE_EDGE."""
    middle = 0.5j * CENTRES
    for origin, inward in (
        (sign * GROOVE_EDGE, sign + 0j),
        (sign * (GROOVE_EDGE + GROOVE_WIDTH), -sign + 0j),
        (middle - 1j * GROOVE_HALF_HEIGHT, 1j),
        (middle + 1j * GROOVE_HALF_HEIGHT, -1j),
    ):
        polygon = clipped(polygon, origin, inward)
        if polygon.size < 3:
            return 0.0, 0.0
    area = area_of(polygon)
    channel = GROOVE_DEPTH * np.ptp(polygon.imag)
    diameter = 4.0 * area / np.sum(abs(np.roll(polygon, -1) - polygon))
    return area * channel / max(np.hypot(area, channel), 1e-30), diameter


def mouth(gear, place, behind, ahead):
    """Where a space's mouth begins after the inlet cusp and ends before the outlet cusp, and the
    arcs on the other tip circle that open to inlet and outlet through it."""
    if gear == 1:  # the throat behind the entering drive tooth lies ahead of a driven space
        behind, ahead = ahead, behind
    first, last = behind.corner[gear], ahead.corner[gear]
    ends = [t.end_place(gear) for t in (ahead, behind)]
    inlet_from = max(first, CUSP, last if ends[0] is None else ends[0])
    outlet_to = min(last, -CUSP, first if ends[1] is None else ends[1])
    extra = np.zeros(2)
    for t in (behind, ahead):
        if t.inward is not None:
            end = t.end_place(1 - gear)
            end = t.corner[1 - gear] if end is None else end
            extra += np.maximum([end - CUSP, -CUSP - end], 0.0)
    return inlet_from, outlet_to, *extra


# ---------------------------------------------------------------- 5. tables over the place
def tabulate(nodes=2880):
    """All geometry over the place of a drive or driven space, -pi to pi."""
    places = np.linspace(-np.pi, np.pi, nodes + 1)
    volume = np.empty((2, places.size))
    mouths = np.zeros((2, 4, places.size))
    grooves = np.zeros((2, 2, 2, places.size))  # area | diameter first
    for k, place in enumerate(places):
        for gear in (0, 1):
            at = place if gear == 0 else place + LAG + PITCH / 2
            behind = throat(at, -1)
            ahead = throat(at if gear == 0 else at - PITCH, +1)
            polygon = section(gear, behind, ahead)
            volume[gear, k] = WIDTH * area_of(polygon)
            mouths[gear, :, k] = mouth(gear, place, behind, ahead)
            if abs(place) < 1.2:
                for port, sign in ((0, -1), (1, +1)):
                    grooves[:, gear, port, k] = opening(polygon, sign)
    return places, volume, mouths, grooves


def tabulate_throats(places):
    """Gap, width, curvature radius and drag speed of the throats behind and ahead."""
    table = np.zeros((2, 4, places.size))
    for row, side in enumerate((-1, +1)):
        found = [throat(place, side) for place in places]
        table[row, 0] = [t.gap for t in found]
        table[row, 1] = [WIDTH * smooth_step(t.weight / 0.05) for t in found]
        table[row, 2] = [t.curve_radius for t in found]
        ends = np.array([t.ends for t in found])
        moving = np.gradient(ends.mean(axis=1), places)
        middle = ends.mean(axis=1)
        slip = 0.5 * (1j * middle - 1j * (middle - 1j * CENTRES)) - moving
        normal = throat_normals(found, side)
        outward = -side * -1j * normal  # from the drive space to the driven space
        present = np.array([t.weight > 0.0 for t in found])
        table[row, 3] = np.where(present, (slip * outward.conj()).real, 0.0)
    return table


def throat_normals(found, side):
    """Unit vectors from the drive to the driven flank."""
    action = np.exp(1j * side * AW) * side  # direction of the line of action
    return np.array([(t.ends[1] - t.ends[0]) / t.gap if t.gap > 1e-7 else action for t in found])


def bore_cover(place):
    """Part of a tooth tip that seals against the bore."""
    place = np.mod(place, 2 * np.pi)
    land = 2 * TIP_HALF
    entered = (place + TIP_HALF - INLET_EDGE) / land + 1.0
    left = (2 * np.pi - OUTLET_EDGE - place + TIP_HALF) / land + 1.0
    return smooth_step(entered) * smooth_step(left)


# ---------------------------------------------------------------- 6. the network
def density(p):
    return DENSITY * (1.0 + COMPLIANCE * p / (1.0 + STIFFENING * p))


def density_slope(p):
    return DENSITY * COMPLIANCE / (1.0 + STIFFENING * p) ** 2


def path_flow(p_a, p_b, conductance, area, drag=0.0, discharge=DISCHARGE):
    """Mass flow from a to b."""
    rho_a, rho_b = density(p_a), density(p_b)
    drop = p_a - p_b
    ratio = conductance / (discharge * np.maximum(area, 1e-30))
    root = np.sqrt(1.0 + 2.0 * np.where(drop >= 0, rho_a, rho_b) * ratio**2 * abs(drop))
    volume_flow = 2.0 * conductance * drop / (1.0 + root) + drag
    return volume_flow * np.where(volume_flow > 0, rho_a, rho_b)


def orifice(p_a, p_b, area, diameter):
    conductance = 2.0 * DISCHARGE**2 * area * diameter / (VISCOSITY * TRANSITION)
    return path_flow(p_a, p_b, conductance, area)


def parallel_gap(p_a, p_b, height, width, length, wall_speed):
    conductance = width * height**3 / (12.0 * VISCOSITY * length)
    return path_flow(p_a, p_b, conductance, width * height, width * height * wall_speed)


def curved_gap(p_a, p_b, height, width, radius, wall_speed):
    narrow = np.minimum(height / radius, 0.1)
    conductance = 8.0 * width * height**2 * np.sqrt(narrow / 2) / (36.0 * np.pi * VISCOSITY)
    area = width * height
    return path_flow(p_a, p_b, conductance, area, area * wall_speed, THROAT_DISCHARGE)


class Pump:
    """Geometry tables, and everything that follows from a shaft angle and chamber pressures.

    Pressures have the shape (2, TEETH): drive and driven spaces. Space k + 1 follows space k.
    """

    def __init__(self, nodes=2880):
        places, volume, mouths, grooves = tabulate(nodes)
        spline = CubicSpline(places, closed(volume), axis=1, bc_type="periodic")
        rows = [volume, spline(places, 1), mouths, grooves[0], grooves[1]]
        self.spaces = np.concatenate([r.reshape(2, -1, places.size) for r in rows], axis=1)
        self.throats = tabulate_throats(places)
        self.nodes = nodes
        space_area = volume[0, 0] / WIDTH
        self.tooth_height = TIP_RADIUS - ROOT_RADIUS
        ring = np.pi * (TIP_RADIUS**2 - ROOT_RADIUS**2) / TEETH
        self.tooth_thickness = (ring - space_area) / self.tooth_height
        self.middle_radius = 0.5 * (TIP_RADIUS + ROOT_RADIUS)

    def places(self, angle):
        drive = angle - PITCH * np.arange(TEETH)
        return np.array([drive, drive - LAG - PITCH / 2])

    def look_up(self, table, place):
        position = np.mod(place + np.pi, 2 * np.pi) / (2 * np.pi) * self.nodes
        k = np.minimum(position.astype(int), self.nodes - 1)
        t = position - k
        return table[:, k] * (1 - t) + table[:, k + 1] * t

    def flows(self, angle, p):
        """Mass flows into all chambers by path, volumes, and the torque on the shaft.

        Further axes may stand in front of the two axes of the pressures.
        """
        places = self.places(angle)
        rows = np.array([self.look_up(self.spaces[g], places[g]) for g in (0, 1)])
        volume, slope = rows[:, 0], rows[:, 1]
        ports = []
        for port, pressure in enumerate((INLET_PRESSURE, OUTLET_PRESSURE)):
            length = self.port_length(port, places, rows[:, 2:6])
            diameter = 2 * WIDTH * length / (WIDTH + length)
            mouth_flow = orifice(p, pressure, WIDTH * length, diameter)
            ports.append(
                mouth_flow + 2 * orifice(p, pressure, rows[:, 6 + port], rows[:, 8 + port])
            )
        behind = np.roll(p, -1, axis=-1)  # behind the tooth that follows each space
        tip_width, tip_length = WIDTH * bore_cover(places - PITCH / 2), 2 * TIP_HALF * TIP_RADIUS
        tip_speed = 0.5 * SPEED * TIP_RADIUS
        tip = parallel_gap(behind, p, TIP_GAP, tip_width, tip_length, tip_speed)
        side_speed = 0.5 * SPEED * self.middle_radius
        side = (SIDE_GAP, self.tooth_height, self.tooth_thickness, side_speed)
        lateral = 2 * parallel_gap(behind, p, *side)
        land = 0.5 * (SHAFT_RADIUS + ROOT_RADIUS)
        land_length = land * np.log(ROOT_RADIUS / SHAFT_RADIUS)
        drain = 2 * parallel_gap(p, INLET_PRESSURE, SIDE_GAP, PITCH * land, land_length, 0.0)
        flank, flank_drag = self.flank_flows(places[0], p)
        along = (tip + lateral) - np.roll(tip + lateral, 1, axis=-1)
        wall = tip_width * TIP_GAP * tip_speed + 2 * SIDE_GAP * self.tooth_height * side_speed
        shear = VISCOSITY * SPEED * TIP_RADIUS**2 * tip_width * tip_length / TIP_GAP
        torque = np.sum(-p * slope + wall / SPEED * (p - behind) + shear, axis=(-2, -1))
        return {
            "into": along + flank - drain - ports[0] - ports[1],
            "volume": volume,
            "slope": slope,
            "inlet": ports[0],
            "outlet": ports[1],
            "tip": tip,
            "lateral": lateral,
            "drain": drain,
            "torque": torque + flank_drag,
        }

    def port_length(self, port, places, rows):
        """Mouth of each space between cusp and port edge, on both tip circles."""
        place = np.mod(places + np.pi, 2 * np.pi) - np.pi
        first, last = place - PITCH / 2 + TIP_HALF, place + PITCH / 2 - TIP_HALF
        if port == 0:
            arc_length = np.minimum(last, INLET_EDGE) - rows[:, 0]
        else:
            arc_length = rows[:, 1] - np.maximum(first, -OUTLET_EDGE)
        return TIP_RADIUS * (np.maximum(arc_length, 0.0) + rows[:, 2 + port])

    def flank_flows(self, places, p):
        """Mass flows into all chambers through the throats, and torque of the drag in them."""
        flank, torque = np.zeros(p.shape), 0.0
        for row, shift in ((0, 0), (1, 1)):  # throats behind, ahead: to driven space k, k - 1
            gap, width, radius, drag = self.look_up(self.throats[row], places)
            height = np.maximum(gap, RESIDUAL_GAP)
            drive, driven = p[..., 0, :], np.roll(p[..., 1, :], shift, axis=-1)
            flow = curved_gap(drive, driven, height, width, radius, drag * SPEED)
            flank[..., 0, :] -= flow
            flank[..., 1, :] += np.roll(flow, -shift, axis=-1)
            torque = torque + np.sum(width * height * drag * (driven - drive), axis=-1)
        return flank, torque

    def pressure_rate(self, time, state):
        p = state.T.reshape(-1, 2, TEETH)
        now = self.flows(SPEED * time, p)
        rate = now["into"] - density(p) * SPEED * now["slope"]
        return (rate / (now["volume"] * density_slope(p))).reshape(-1, 2 * TEETH).T

    def cyclic_pitch(self, samples=360, tolerance=1e-5):
        """March pitch by pitch until the pressures repeat with the chambers moved on by one."""
        place = np.mod(self.places(0.0), 2 * np.pi)
        state = np.where(place > np.pi, OUTLET_PRESSURE, INLET_PRESSURE).astype(float)
        period = PITCH / SPEED
        times = np.linspace(0.0, period, samples + 1)
        for _ in range(100):
            run = solve_ivp(
                self.pressure_rate, (0, period), state.ravel(), "BDF", times,
                vectorized=True, rtol=1e-7, atol=5.0,
            )  # fmt: skip
            pressures = run.y.T.reshape(-1, 2, TEETH)
            after = np.roll(pressures[-1], -1, axis=1)  # space k + 1 stands where space k stood
            change = np.max(abs(after - state)) / OUTLET_PRESSURE
            state = after
            if change < tolerance:
                return SPEED * times, pressures
        raise RuntimeError(f"not cyclic: pressures still change by {change:.1e}")


def closed(values):
    values[:, -1] = values[:, 0]
    return values


# ---------------------------------------------------------------- 7. results
def summary(pump, angles, pressures):
    """Mean mass flows, torque and efficiencies over one pitch."""
    rows = [pump.flows(a, p) for a, p in zip(angles[:-1], pressures[:-1], strict=True)]
    mean = {name: float(np.mean([np.sum(row[name]) for row in rows])) for name in rows[0]}
    outlet = mean["outlet"]
    swept = TIP_RADIUS**2 - CENTRES**2 / 4 - (PITCH * BASE) ** 2 / 12
    hydraulic = (OUTLET_PRESSURE - INLET_PRESSURE) * outlet / density(OUTLET_PRESSURE)
    return {
        "displacement_cm3_per_rev": WIDTH * swept * 2 * np.pi * 1e6,
        "outlet_mass_flow_kg_per_s": outlet,
        "inlet_mass_flow_kg_per_s": -mean["inlet"] - mean["drain"],
        "mean_flow_L_per_min": outlet / density(OUTLET_PRESSURE) * 6e4,
        "drain_L_per_min": mean["drain"] / density(INLET_PRESSURE) * 6e4,
        "mean_torque_N_m": mean["torque"],
        "volumetric_efficiency": outlet / (density(INLET_PRESSURE) * WIDTH * swept * SPEED),
        "overall_efficiency": hydraulic / (mean["torque"] * SPEED),
        "max_chamber_pressure_bar": float(pressures.max()) / 1e5,
        "min_chamber_pressure_bar": float(pressures.min()) / 1e5,
    }


if __name__ == "__main__":
    machine = Pump()
    for name, value in summary(machine, *machine.cyclic_pitch()).items():
        print(f"{name:28s} {value:12.5g}")
