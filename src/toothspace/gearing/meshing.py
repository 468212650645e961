"""Two gears in mesh: throats between facing flanks, contact, ideal flow, gaps over micro-motions.

A ring gear counts as a gear with negative tooth count, radii, centre distance and speed ratio, as
in ISO 21771; every formula then holds for external and internal pairs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from toothspace.closures.smooth import smooth_step
from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.gearing.mesh_split import Mesh, Throats, throats
from toothspace.gearing.spaces import Spaces, drive_spaces, driven_spaces
from toothspace.gearing.tooth import Tooth
from toothspace.geometry.gear_pair import InvolutePair
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table

CONTACT_TOLERANCE = 5.8e-5
"""Gap above that of the touching pair up to which a second pair of flanks that are no involutes
counts as touching, over the pitch radius of the drive gear: 1 um of 17 mm. [-]"""

LARGEST_OVERLAP = 1e-6
"""Overlap of flanks up to which they count as touching. [m]"""

FULL_TURN = 2.0 * np.pi
_PHASE_SAMPLES = 181
_LEAST_RATIO = 1.02
_SAMPLES = 1441
_FLOW_SAMPLES = 1200
_ROUND_OFF = 1e-12
_FADE = 0.25
"""Part of a path of contact on which the load of flanks that touch in turn builds up. [-]"""
_NO_THROAT = 1.0
_RADIUS_RANGE = 2.9e-3, 1.46
"""Relative radii of curvature that count, over the pitch radius of the drive gear. [-]"""

_FLATTEST = 30.0
"""Largest relative radius in contact, over the pitch radius of the drive gear. [-]"""

_LEAST_RADIUS = 5.8e-3
"""Radius of an edge in contact, over the pitch radius of the drive gear. [-]"""


@dataclass(frozen=True, kw_only=True)
class MeshedGears:
    """Two gears in mesh with the loaded flanks in contact."""

    teeth: tuple[Tooth, Tooth]
    """Flanks of drive and driven gear."""
    root_radii: tuple[float, float]
    """Root circles, negative of a ring gear. [m]"""
    mesh: Mesh
    """Relative position."""
    face_width: float
    """Width over which the gears mesh. [m]"""
    loaded_is_left: bool
    """Whether the loaded flanks are the left ones (pump) or the right ones (motor)."""
    pair: InvolutePair[float] | None
    """Involute pair where both gears are given by parameters."""

    @property
    def counts(self) -> tuple[int, int]:
        """Tooth counts of drive and driven gear."""
        drive, driven = self.teeth
        return drive.tooth_count, abs(driven.tooth_count)

    @property
    def root_clearances(self) -> tuple[float, float]:
        """Radial play of the mating tip in the roots of drive and driven gear. [m]."""
        (drive, driven), distance = self.teeth, self.mesh.center_distance
        first, second = self.root_radii
        return distance - first - driven.tip_radius, distance - second - drive.tip_radius

    @property
    def tip_lands(self) -> tuple[float, float]:
        """Width of the tip lands of drive and driven gear. [m]."""
        drive, driven = (abs(tooth.land_angle * tooth.tip_radius) for tooth in self.teeth)
        return drive, driven

    @property
    def flanks_in_turn(self) -> bool:
        """Whether the other flanks touch where the loaded ones do not, with play."""
        return False

    @property
    def exact_path(self) -> tuple[float, float] | None:
        """Throat angles between which flanks touch, None to find them from gaps. [rad]."""
        return None

    def table_places(self, gear: int, nodes: int) -> Array:
        """Places of a gear's table nodes in the sense of rotation, opposite to the mesh first.

        Places; those of the driven gear leave out its turn into contact. [rad]

        Parameters
        ----------
        gear : int
            0 for the drive gear, 1 for the driven gear.
        nodes : int
            About how many nodes the drive gear shall have.

        Notes
        -----
        Both gears have one even number of nodes on a pitch. All chambers are then at the same
        fraction between their nodes, and interpolation errors of neighbours cancel.
        """
        per_pitch = 2 * max(round(0.5 * nodes / self.counts[0]), 2)
        count = per_pitch * self.counts[gear]
        return -np.pi + FULL_TURN * np.arange(count) / count

    def spaces(self, nodes: int) -> tuple[Spaces, Spaces]:
        """Tooth spaces of both gears at their table nodes, about so many on a turn."""
        return self.spaces_at(self.table_places(0, nodes), self.table_places(1, nodes))

    def spaces_at(self, drive_places: Array, driven_places: Array) -> tuple[Spaces, Spaces]:
        """Tooth spaces at places in the sense of rotation [rad], those of the nodes of the tables.

        A ring gear turns with the drive gear, so that its places in the mesh count backwards.
        """
        driven = np.sign(self.mesh.center_distance) * driven_places - self.mesh.turn
        return (
            drive_spaces(*self.teeth, self.mesh, drive_places),
            driven_spaces(*self.teeth, self.mesh, driven),
        )


def lens_angle(own: float, other: float, distance: float) -> float:
    """Half angle of the lens of two tip circles, seen from the centre of the own one. [rad]."""
    return float(np.arccos((distance**2 + own**2 - other**2) / (2.0 * distance * own)))


def mesh_at_distance(teeth: tuple[Tooth, Tooth], distance: float) -> Mesh:
    """Gears with equal backlash on both flanks; the distance of a ring gear is negative. [m]."""
    drive, driven = teeth
    lens_driven = lens_angle(driven.tip_radius, drive.tip_radius, distance)
    return Mesh(
        center_distance=distance,
        ratio=drive.tooth_count / driven.tooth_count,
        half_pitch=np.pi / drive.tooth_count,
        turn=0.0,
        lens_drive=lens_angle(drive.tip_radius, driven.tip_radius, distance),
        lens_driven=lens_driven if distance > 0.0 else -lens_driven,
    )


def facing_throats(teeth: tuple[Tooth, Tooth], mesh: Mesh, is_left: bool, angles: Array) -> Throats:
    """Throats between left flanks or between right flanks at angles [rad]."""
    drive, driven = ((tooth.left if is_left else tooth.right) for tooth in teeth)
    return throats(drive, driven, mesh, angles)


def driven_lever(side: Throats, mesh: Mesh) -> Array:
    """Derivative of the gap with respect to the driven gear's right-handed rotation. [m/rad]."""
    x, y = side.driven.point.T
    return np.asarray(side.normal[:, 1] * x - side.normal[:, 0] * (y - mesh.center_distance))


_LEAST_LEVER = 0.25
"""Lever of a normal about the centre of its gear, over the distance from there. [-]"""


def smallest_gap(teeth: tuple[Tooth, Tooth], mesh: Mesh, is_left: bool) -> tuple[float, float]:
    """Smallest gap of a flank pair over its passage [m], its change by the driven rotation."""
    reach = mesh.lens_drive + 2.0 * mesh.half_pitch
    passage = facing_throats(teeth, mesh, is_left, np.linspace(-reach, reach, _PHASE_SAMPLES))
    # a tip over the root may be nearer than the flanks, but turning does not close that gap
    x, y = passage.drive.point.T
    arms = (
        np.hypot(x, y),
        np.hypot(passage.driven.point[:, 0], passage.driven.point[:, 1] - mesh.center_distance),
    )
    levers = passage.normal[:, 1] * x - passage.normal[:, 0] * y, driven_lever(passage, mesh)
    turned = [np.abs(lever) > _LEAST_LEVER * arm for lever, arm in zip(levers, arms, strict=True)]
    facing = (passage.weight >= 1.0) & turned[0] & turned[1]
    gap = np.where(facing, passage.gap, np.inf)
    best = int(np.argmin(gap))
    return float(gap[best]), float(levers[1][best])


def in_contact(
    teeth: tuple[Tooth, Tooth], mesh: Mesh, is_left: bool, overlap: float = LARGEST_OVERLAP
) -> Mesh:
    """Mesh with the driven gear turned until the loaded flanks touch.

    Raises GeometryError if the other flanks then overlap by more than is allowed. [m]
    """
    for _ in range(4):
        gap, lever = smallest_gap(teeth, mesh, is_left)
        if not np.isfinite(gap):
            raise GeometryError(
                "machine.gears.center_distance",
                f"{mesh.center_distance * 1e3:.5g} mm: the teeth pass without facing one another",
                "a shorter distance",
            )
        mesh = mesh._replace(turn=mesh.turn - gap / lever)
    play, _ = smallest_gap(teeth, mesh, not is_left)
    if play < -overlap:
        raise overlap_error(mesh.center_distance, -play)
    return mesh


def overlap_error(distance: float, overlap: float) -> GeometryError:
    """Refusal of a centre distance at which flanks overlap. [m]."""
    return GeometryError(
        "machine.gears.center_distance",
        f"{distance * 1e3:.5g} mm: the flanks overlap by {overlap * 1e3:.4g} mm",
        "a distance with backlash",
    )


def loaded_throats(gears: MeshedGears, spaces: Spaces) -> Throats:
    """Throats of the drive spaces at the flanks that carry the load."""
    return spaces.left if gears.loaded_is_left else spaces.right


def contact_range(gears: MeshedGears) -> tuple[float, float]:
    """Throat angles at which the loaded flank pair begins and ends to touch.

    Range, at least 1.02 pitches long, so that the load can be handed over. [rad]
    """
    start, end = path_of_contact(gears)
    missing = max(_LEAST_RATIO * 2.0 * gears.mesh.half_pitch - (end - start), 0.0)
    return start - 0.5 * missing, end + 0.5 * missing


def path_of_contact(gears: MeshedGears) -> tuple[float, float]:
    """Throat angles between which the loaded flank pair touches.

    Begin and end: in closed form for involutes; other flanks touch where their gap is no larger
    than that of the neighbouring pairs, but for ``CONTACT_TOLERANCE``. [rad]
    """
    exact = gears.exact_path
    if exact is not None:
        return exact
    mesh = gears.mesh
    pitch = 2.0 * mesh.half_pitch
    reach = mesh.lens_drive + 2.0 * pitch
    angles = np.linspace(-reach, reach, _SAMPLES)
    sides = [
        facing_throats(gears.teeth, mesh, gears.loaded_is_left, angles + shift)
        for shift in (0.0, -pitch, pitch)
    ]
    gap, *neighbours = (np.where(side.weight >= 1.0, side.gap, _NO_THROAT) for side in sides)
    least = np.minimum(gap, np.minimum(*neighbours))
    tolerance = CONTACT_TOLERANCE * abs(mesh.pitch_radii[0])
    touching = angles[(gap < _NO_THROAT) & (gap <= least + tolerance)]
    return float(touching[0]), float(touching[-1])


def load_share(gears: MeshedGears, angles: Array) -> Array:
    """Share of the contact force that a flank pair carries.

    Share, 0 out of contact and smooth in between; the shares of pairs one pitch apart sum to 1 at
    every angle. Where flanks touch in turn a pair carries its load alone, while it touches. [-]

    Parameters
    ----------
    angles : ndarray
        Throat angles. [rad]
    """
    pitch = 2.0 * gears.mesh.half_pitch
    if gears.flanks_in_turn:
        start, end = path_of_contact(gears)
        turns = np.mod(angles - 0.5 * (start + end) + np.pi, FULL_TURN) - np.pi
        inside = smooth_step((0.5 * (end - start) - np.abs(turns)) / (_FADE * (end - start)))
        return np.asarray(inside, dtype=float)
    start, end = contact_range(gears)
    ramp = min(end - start - pitch, 0.5 * (end - start))
    places = [angles + shift * pitch for shift in range(-3, 4)]
    pairs = [smooth_step(np.minimum(place - start, end - place) / ramp) for place in places]
    own = pairs[3]
    return np.asarray(own / np.where(own > 0.0, sum(pairs), 1.0), dtype=float)


def ideal_flow(gears: MeshedGears, angles: Array) -> Array:
    r"""Volume delivered per radian while a throat at given angles seals inlet from outlet.

    Flow rate over shaft speed. [m3/rad]

    Parameters
    ----------
    angles : ndarray
        Throat angles of the loaded flanks. [rad]

    Notes
    -----
    .. math:: \frac{Q}{\omega} = \frac{b}{2}\left[r_{a1}^2 - r_1^2
              + \frac{z_1}{z_2} (r_{a2}^2 - r_2^2)\right]

    with the distances :math:`r_1, r_2` of the throat's middle from the centres.
    """
    side = facing_throats(gears.teeth, gears.mesh, gears.loaded_is_left, angles)
    drive, driven = gears.teeth
    center = np.array([0.0, gears.mesh.center_distance])
    near = drive.tip_radius**2 - np.sum(side.middle**2, axis=1)
    far = driven.tip_radius**2 - np.sum((side.middle - center) ** 2, axis=1)
    return np.asarray(0.5 * gears.face_width * (near + gears.mesh.ratio * far), dtype=float)


def flow_over_pitch(gears: MeshedGears) -> Array:
    """Ideal flow over one pitch, sealed by the contact nearest to the pitch point. [m3/rad]."""
    pitch = 2.0 * gears.mesh.half_pitch
    steps = pitch * np.arange(_FLOW_SAMPLES) / _FLOW_SAMPLES
    if gears.flanks_in_turn:
        sides = [replace(gears, loaded_is_left=is_left) for is_left in (True, False)]
        paths = [path_of_contact(side) for side in sides]
    else:
        sides, paths = [gears], [contact_range(gears)]
    angles = 0.5 * sum(paths[0]) + steps[:, None] + pitch * np.arange(-2, 2)[None, :]
    found = []
    for side, (start, end) in zip(sides, paths, strict=True):
        flow = ideal_flow(side, angles.ravel()).reshape(angles.shape)
        within = (angles >= start - _ROUND_OFF) & (angles <= end + _ROUND_OFF)
        found.append(np.where(within, flow, 0.0))
    return np.asarray(np.max(found, axis=(0, 2)), dtype=float)


def displacement(gears: MeshedGears) -> float:
    """Geometric displacement per radian, single flank: closed form for involutes. [m3/rad]."""
    if gears.pair is not None:
        return gears.pair.displacement_per_radian(gears.face_width)
    return float(np.mean(flow_over_pitch(gears)))


def flow_ripple(gears: MeshedGears) -> float:
    """Largest less smallest ideal flow over its mean: closed form for involutes. [-]."""
    if gears.pair is not None:
        return gears.pair.flow_ripple()
    flow = flow_over_pitch(gears)
    return float((flow.max() - flow.min()) / flow.mean())


def contact_ratio(gears: MeshedGears) -> float:
    """Mean number of tooth pairs in contact. [-]."""
    if gears.pair is not None:
        return gears.pair.contact_ratio
    start, end = path_of_contact(gears)
    return (end - start) / (2.0 * gears.mesh.half_pitch)


def relative_radius(mesh: Mesh, side: Throats, tip_rounding: float) -> Array:
    """Relative radius of curvature of a throat; a sharp corner counts with its edge. [m]."""
    low, high = (part * mesh.pitch_radii[0] for part in _RADIUS_RANGE)
    edge = max(tip_rounding, low)
    curvature = side.drive.curvature + side.driven.curvature
    curvature = np.where(side.at_corner, np.maximum(curvature, 1.0 / edge), curvature)
    return np.asarray(1.0 / np.clip(curvature, 1.0 / high, 1.0 / low), dtype=float)


def gap_by_motion(gears: MeshedGears, side: Throats) -> Array:
    """Derivative of the flank gap with respect to the five micro-motions. [-], [m/rad]."""
    lever = driven_lever(side, gears.mesh)
    weight = (side.weight > 0.0)[:, None]
    return np.where(weight, np.column_stack([-side.normal, side.normal, lever]), 0.0)


def throat_drag(gears: MeshedGears, side: Throats, *, leading: bool) -> Array:
    """Mean speed of both walls less that of the throat, from the drive space on. [m/rad].

    Half of the throat moves with each gear, as in the forces of the chamber pressures.
    """
    near = 0.75 * side.drive.point + 0.25 * side.driven.point
    far = 0.25 * side.drive.point + 0.75 * side.driven.point
    far = far - np.array([0.0, gears.mesh.center_distance])
    drive = np.column_stack([-near[:, 1], near[:, 0]])
    driven = gears.mesh.ratio * np.column_stack([far[:, 1], -far[:, 0]])
    throat = 0.5 * (side.drive.velocity + side.driven.velocity)
    slip = 0.5 * (drive + driven) - throat
    along = slip[:, 0] * side.normal[:, 1] - slip[:, 1] * side.normal[:, 0]
    return np.where(side.weight > 0.0, -along if leading else along, 0.0)


def flank_geometry(gears: MeshedGears, side: Throats, share: Array) -> PeriodicTable:
    """Gap [m], share [-], radii [m], levers of sliding and rolling [m] of a flank contact.

    The slope of the gap is exact, so conjugate flanks stay so.
    """
    ahead, follows = _along_normal(gears, side)
    ratio = gears.mesh.ratio
    # of involutes the distances from both centres along the normal, negative on the concave flanks
    # of a ring gear; at a tip corner the edge counts as rounded
    edge = _LEAST_RADIUS * gears.mesh.pitch_radii[0]
    drive, driven = (
        np.where(end.curvature > 0.2 / edge, edge, sign * np.maximum(np.abs(part), edge))
        for end, part, sign in (
            (side.drive, ahead, 1.0),
            (side.driven, follows, np.sign(ratio)),
        )
    )
    if ratio < 0.0:
        # an edge of the ring counts at the drive gear, so that radii never change their sign, and
        # a concave flank is flatter than the one in it, but for waves of a drawn outline
        sharp = side.driven.curvature > 0.2 / edge
        drive = np.where(sharp, edge, drive)
        driven = np.where(sharp, -np.maximum(np.abs(follows), edge), driven)
        flatter = drive / (1.0 - drive / (_FLATTEST * gears.mesh.pitch_radii[0]))
        driven = np.minimum(driven, -flatter)
    complete = side.weight >= 1.0
    # flanks that do not face one another in the lens are apart
    gap = np.where(complete, side.gap, side.gap[complete].max())
    rolling = np.abs(ahead) + abs(ratio) * np.abs(follows)
    columns = [gap, share, drive, driven, -ratio * follows - ahead, rolling]
    table = monotone_table(FULL_TURN, np.column_stack(columns))
    x, y = side.drive.point.T
    lever = -side.normal[:, 0] * y + side.normal[:, 1] * x
    rate = np.where(complete, -lever - ratio * driven_lever(side, gears.mesh), 0.0)
    # held to three times the smaller secant where the curvature jumps
    secant = (np.roll(gap, -1) - gap) * (gap.size / FULL_TURN)
    limit = 3.0 * np.minimum(np.abs(secant), np.abs(np.roll(secant, 1)))
    table.slopes[:, 0] = np.clip(rate, -limit, limit)
    return table


def _along_normal(gears: MeshedGears, side: Throats) -> tuple[Array, Array]:
    """Distances of the throat's ends from both centres along the normal, signed. [m]."""
    center = np.array([0.0, gears.mesh.center_distance])
    drive = np.sum(side.drive.point * side.normal, axis=1)
    driven = np.sum((side.driven.point - center) * side.normal, axis=1)
    return drive, driven


def slip_by_motion(gears: MeshedGears, side: Throats) -> Array:
    """Derivative of the slip of the driven flank by every micro-motion. [-], [m/rad]."""
    tangent = np.column_stack([-side.normal[:, 1], side.normal[:, 0]])
    _, follows = _along_normal(gears, side)
    weight = (side.weight > 0.0)[:, None]
    return np.where(weight, np.column_stack([-tangent, tangent, follows]), 0.0)
