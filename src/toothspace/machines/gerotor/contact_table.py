r"""Lobe contacts of two rotors over the angle: gap, direction, arms, curvature, speeds.

Every place where the outlines come closest is a contact. Its gap by the planar displacement and
the rotation of the outer rotor,

.. math::

    g = g_0(\psi) + n_x x + n_y y + (x_b n_y - y_b n_x)\,\delta
        + \tfrac12 \left(\kappa_i u^2 - \frac{(\delta - \kappa_i u)^2}{\kappa_i + \kappa_o}
        - (\mathbf r_b \cdot \mathbf n)\,\delta^2\right),

has the unit normal n from the inner to the outer rotor and the point :math:`\mathbf r_b = (x_b,
y_b)` from the outer rotor's centre. The second order is that of circles with the curvatures
:math:`\kappa_i, \kappa_o` of the outlines, which shift by u along each other: they touch
elsewhere. Angles are those of the outer rotor.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import draft_of
from toothspace.core.recall import recalled
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.geometry.contour import beside_of, nearest_places, seen_from
from toothspace.geometry.curve import turned
from toothspace.machines.gerotor.profiles import Rotors

NODES_PER_PITCH = 120
_FOLLOWED = 0.12
"""Gap up to which a closest place is followed, over the eccentricity. [-]"""

_APART, _FADED = 0.4, 0.04
_RADIUS_RANGE = 0.04, 4000.0
_FLATTEST = 16.0
"""Radius of relative curvature over the eccentricity beyond which the nearest place wanders farther
than the curvatures hold."""
_FADING_NODES = 8
_SPEED_NODES = 2
_MOST_KINDS = 12

COLUMNS = (
    "outer_angle[rad]", "gap[m]", "gap_rate[m/rad]", "normal_x[-]", "normal_y[-]", "point_x[m]",
    "point_y[m]", "lever[m]", "radius_inner[m]", "radius_outer[m]", "sliding[m/rad]",
    "rolling_sum[m/rad]",
)  # fmt: skip
"""Columns of the exported table; angle, rate and speeds per angle of the outer rotor."""
_OUTER_SAMPLES = 260
_BESIDE = 2
"""Places on either side of one that are looked at with it; five divide the samples of a lobe."""
_LOST_NODES = 3
_FARTHEST, _SEARCHED = 0.24, 0.32
"""Step of a closest place, and gap that is looked at, over the eccentricity. [-]"""


@final
@dataclass(frozen=True)
class LobeContact:
    """One kind of contact over the outer rotor's angle; its copies follow one pitch apart."""

    copies: int
    """Contacts of this kind; the period of the table is as many pitches."""
    pitch: float
    """Angle of one tooth of the outer rotor. [rad]"""
    near: BoolArray
    """Whether the contact exists at a node."""
    gap: Array
    gap_rate: Array
    """Gap of the rotors at nominal position and its derivative. [m], [m/rad]"""
    normal: Array
    """Unit normal from the inner to the outer rotor. Shape (nodes, 2). [-]"""
    inner_point: Array
    outer_point: Array
    """Closest points from the outer rotor's centre, not turning. Shape (nodes, 2). [m]"""
    radius_inner: Array
    radius_outer: Array
    """Radii of curvature, concave negative. [m]"""
    sliding: Array
    """Speed of the outer over the inner surface along the normal turned by +90 deg. [m/rad]"""
    rolling_sum: Array
    """Sum of both surface speeds relative to the contact point. [m/rad]"""

    @property
    def period(self) -> float:
        """Angle after which the table repeats. [rad]."""
        return self.copies * self.pitch

    @property
    def lever(self) -> Array:
        """Derivative of the gap by the outer rotor's own rotation. [m/rad]."""
        x, y = self.outer_point.T
        return np.asarray(x * self.normal[:, 1] - y * self.normal[:, 0], dtype=float)

    def second_derivatives(self, eccentricity: float) -> Array:
        """By tangential shift twice, shift and rotation, rotation of the outer rotor twice.

        Shape (nodes, 3), nought where the contact does not exist. [1/m], [-], [m]

        Parameters
        ----------
        eccentricity : float
            Distance of the axes, which gives the scale. [m]
        """
        inner = 1.0 / self.radius_inner
        relative = np.maximum(inner + 1.0 / self.radius_outer, 1.0 / (_FLATTEST * eccentricity))
        arm = np.sum(self.outer_point * self.normal, axis=1)
        columns = [inner - inner**2 / relative, inner / relative, -1.0 / relative - arm]
        return np.where(self.near[:, None], np.column_stack(columns), 0.0)


@recalled(
    4,
    lambda rotors, nodes=NODES_PER_PITCH: (
        *(rotors.inner, rotors.outer, rotors.inner_tooth_count, rotors.eccentricity),
        nodes,
    ),
)
def lobe_contacts(rotors: Rotors, nodes: int = NODES_PER_PITCH) -> tuple[LobeContact, ...]:
    """Find all contacts of two rotors.

    The longest living kind first.

    Raises GeometryError if the outlines are so rough that every bump makes a contact of its own.

    Parameters
    ----------
    rotors : Rotors
        Rotors at nominal position.
    nodes : int
        Angles per pitch of the outer rotor.
    """
    closest = closest_places(rotors, nodes, _FOLLOWED * rotors.eccentricity)
    found = branches(closest, linked(rotors, closest, nodes), nodes)
    lasting = [branch for branch in found if branch.rows.size > 2 * _SPEED_NODES]
    if len(lasting) > _MOST_KINDS:
        found_kinds = f"outlines with {len(lasting)} kinds of contact"
        allowed = f"allowed at most {_MOST_KINDS}: smooth profiles, alike in all teeth"
        raise GeometryError(f"machine.rotors: found {found_kinds}, {allowed}")
    lasting.sort(key=lambda branch: -branch.rows.size)
    return tuple(_contact(rotors, closest, branch, nodes) for branch in lasting)


def _contact(rotors: Rotors, closest: ClosestPoints, branch: Branch, nodes: int) -> LobeContact:
    """Geometry along one branch, spread over a whole number of pitches."""
    alive = branch.rows.size
    copies = alive // nodes if branch.closed else -(-(alive + 1) // nodes)
    number = branch.first + np.arange(alive)
    angle = np.asarray((number % nodes) * (rotors.pitch / nodes), dtype=float)
    # all but the rolling speed, as of :class:`LobeContact`; wrong where lost for a moment
    outer, inner = closest.outer[branch.rows], closest.inner[branch.rows]
    turn = rotors.turns * angle
    tangent = turned(rotors.inner_curve.tangent(inner), turn)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    arm = turned(rotors.inner_curve.point(inner), turn)
    outer_point = turned(rotors.outer_curve.point(outer), angle)
    lever = outer_point[:, 0] * normal[:, 1] - outer_point[:, 1] * normal[:, 0]
    drive_lever = arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]
    columns = {
        "gap": closest.gap[branch.rows],
        "gap_rate": lever - rotors.turns * drive_lever,
        "normal": normal,
        "inner_point": arm + rotors.inner_center,
        "outer_point": outer_point,
        # the outer body lies outside its own outline: a lobe that points inward is convex
        "radius_inner": _radius(rotors.inner_curve.curvature(inner), rotors.eccentricity),
        "radius_outer": _radius(-rotors.outer_curve.curvature(outer), rotors.eccentricity),
        "sliding": np.sum((outer_point - rotors.turns * arm) * normal, axis=1),
    }
    here, known = np.arange(alive), branch.rows >= 0
    for values in columns.values():
        for column in values.reshape(alive, -1).T:
            column[~known] = np.interp(here[~known], here[known], column[known])
    if not branch.closed:
        gap = columns["gap"]
        rate = columns["gap_rate"]
        count = min(_FADING_NODES, gap.size // 2)
        extra, slope, _ = fading(np.arange(1, count + 1), rotors.pitch / nodes, rotors.eccentricity)
        loaded = (_FOLLOWED - _FADED) * rotors.eccentricity
        if gap[-1] < loaded:
            gap[-count:] += extra
            rate[-count:] += slope
        if gap[0] < loaded:
            gap[:count] += extra[::-1]
            rate[:count] -= slope[::-1]
    point, along_normal, reach = columns["outer_point"], columns["normal"], _SPEED_NODES
    padded = np.pad(point, ((reach, reach), (0, 0)), mode="wrap" if branch.closed else "edge")
    moved = (padded[2 * reach :] - padded[: -2 * reach]) / (2 * reach * rotors.pitch / nodes)
    along = -moved[:, 0] * along_normal[:, 1] + moved[:, 1] * along_normal[:, 0]
    on_inner = columns["inner_point"] + [0.0, rotors.eccentricity]
    speeds = np.sum((point + rotors.turns * on_inner) * along_normal, axis=1)
    columns["rolling_sum"] = np.maximum(
        np.abs(speeds - 2.0 * along), _RADIUS_RANGE[0] * rotors.eccentricity
    )
    place, near = number % (copies * nodes), np.zeros(copies * nodes, dtype=bool)
    near[place] = True
    whole = {name: np.repeat(v[-1:], near.size, axis=0) for name, v in columns.items()}
    whole["gap"][:], whole["gap_rate"][:] = _APART * rotors.eccentricity, 0.0
    for name, values in columns.items():
        whole[name][place] = values
    return LobeContact(copies=copies, pitch=rotors.pitch, near=near, **whole)


def _radius(curvature: Array, eccentricity: float) -> Array:
    low, high = (part * eccentricity for part in _RADIUS_RANGE)
    size = np.clip(np.abs(curvature), 1.0 / high, 1.0 / low)
    return np.asarray(np.copysign(1.0 / size, curvature), dtype=float)


def fading(beyond: IntArray, step: float, eccentricity: float) -> tuple[Array, Array, float]:
    """Distance added to a gap over the nodes in which a contact fades out.

    Parameters
    ----------
    beyond : ndarray of int
        Nodes beyond the end of the contact's full life; up to zero it is whole.
    step : float
        Angle between nodes. [rad]
    eccentricity : float
        Distance of the axes, which gives the scale. [m]

    Returns
    -------
    extra, slope : ndarray
        Distance added to the gap, and its growth. [m], [m/rad]
    apart : float
        Gap of a contact that is none, and the distance added once it is over. [m]
    """
    part, apart = np.maximum(beyond, 0) / _FADING_NODES, _APART * eccentricity
    faded = _FADED * eccentricity
    extra = np.where(part > 1.0, apart, faded * part**2)
    return extra, 2.0 * faded * part / (_FADING_NODES * step), apart


def export_contacts(path: Path, contacts: tuple[LobeContact, ...]) -> None:
    """Write the contacts as a text table, one block per kind, SI units.

    Parameters
    ----------
    path : Path
        File to write.
    """
    with draft_of(path) as draft, draft.open("w", encoding="utf-8") as file:
        for number, contact in enumerate(contacts):
            file.write(f"# contact {number}, {contact.copies} copies one pitch apart\n")
            file.write("# " + " ".join(COLUMNS) + "\n")
            angle = np.arange(contact.gap.size) * (contact.period / contact.gap.size)
            columns = [
                angle,
                contact.gap,
                contact.gap_rate,
                contact.normal,
                contact.outer_point,
                contact.lever,
                contact.radius_inner,
                contact.radius_outer,
                contact.sliding,
                contact.rolling_sum,
            ]
            np.savetxt(file, np.column_stack(columns)[contact.near], fmt="%.9e")
            file.write("\n")


@final
@dataclass(frozen=True)
class ClosestPoints:
    """Places where the outlines come closest, one row each."""

    node: IntArray
    """Number of the angle."""
    outer: Array
    inner: Array
    """Arc lengths on the outlines. [m]"""
    gap: Array
    """Distance, negative where they overlap. [m]"""


@final
@dataclass(frozen=True)
class Branch:
    """One closest place over the nodes at which it exists."""

    first: int
    """Node at which it begins, counted from the start of a pitch."""
    rows: IntArray
    """Row of :class:`ClosestPoints` at each following node; -1 where it is lost for a moment."""
    closed: bool
    """It never ends; the last node leads to the first."""


def distance_to_inner(rotors: Rotors, angle: Array, place: Array) -> tuple[Array, Array]:
    """Nearest place on the inner rotor for places on the outer one.

    Parameters
    ----------
    angle : ndarray
        Angles of the outer rotor. [rad]
    place : ndarray
        Arc lengths on the outer outline. [m]

    Returns
    -------
    inner : ndarray
        Arc lengths on the inner outline. [m]
    gap : ndarray
        Distance, negative within the inner rotor. [m]
    """
    seen = seen_from(rotors.turning, angle, rotors.outer_curve.point(place))
    return rotors.inner_curve.nearest(seen)


def closest_places(rotors: Rotors, nodes: int, reach: float) -> ClosestPoints:
    """All local minima of the distance below ``reach`` at angles of one pitch."""
    count = _OUTER_SAMPLES * rotors.outer_tooth_count
    step = rotors.outer_curve.length / count
    angle = np.asarray(np.arange(nodes) * (rotors.pitch / nodes), dtype=float)
    place = np.asarray(step * np.arange(count), dtype=float)
    seen = seen_from(rotors.turning, angle[:, None], rotors.outer_curve.point(place))
    curve, every = rotors.inner_curve, 2 * _BESIDE + 1
    # where the middle of a few neighbours is too far away, none of them is near
    reach_of_middle = _SEARCHED * rotors.eccentricity + _BESIDE * step
    samples = curve.near_samples(seen[:, _BESIDE::every], reach_of_middle)
    _, gap = curve.nearest_from(
        seen, np.repeat(samples, every, axis=1), beside_of(curve, _BESIDE * step)
    )
    least = (gap <= np.roll(gap, 1, axis=1)) & (gap < np.roll(gap, -1, axis=1)) & (gap < reach)
    node, column = np.nonzero(least)
    outer = nearest_place(rotors, angle[node], np.asarray(column * step), step)
    inner, gap = distance_to_inner(rotors, angle[node], outer)
    return ClosestPoints(node.astype(np.int64), outer, inner, gap)


def nearest_place(rotors: Rotors, angle: Array, place: Array, step: float) -> Array:
    """Arc lengths on the outer outline where the distance is least, within a step [m].

    Parameters
    ----------
    angle, place : ndarray
        Angles of the outer rotor [rad] and arc lengths on its outline to begin with. [m]
    step : float
        The least distance is looked for within one step on either side. [m]
    """
    outer, inner = rotors.outer_curve, rotors.inner_curve
    return nearest_places(outer, inner, rotors.turning, angle, place, step)


def linked(rotors: Rotors, closest: ClosestPoints, nodes: int) -> IntArray:
    """Row that continues every row at the next node (or up to three later); -1: none."""
    successor = np.full(closest.node.size, -1, dtype=np.int64)
    tracks: dict[int, _Track] = {}
    # the first round gives the second one its speeds at the start
    for step in range(2 * nodes + _LOST_NODES):
        node = step % nodes
        rows = np.flatnonzero(closest.node == node)
        if node == 0 and step > 0:
            for track in tracks.values():
                track.back_one_tooth(rotors)
        tracks = _advance(rotors, closest, rows, tracks, successor)
    return successor


class _Track:
    """A closest place on its way, with its speed per node. [m]."""

    def __init__(self, row: int, place: Array) -> None:
        self.row, self.place, self.speed, self.lost = row, place, np.zeros(2), 0

    def ahead(self) -> Array:
        """Where it should be at this node."""
        return np.asarray(self.place + self.speed * (1 + self.lost))

    def back_one_tooth(self, rotors: Rotors) -> None:
        """Count from the following tooth on both outlines."""
        inner = rotors.inner_curve.length / rotors.inner_tooth_count
        outer = rotors.outer_curve.length / rotors.outer_tooth_count
        self.place = self.place + np.array([outer, inner])


def _advance(
    rotors: Rotors,
    closest: ClosestPoints,
    rows: IntArray,
    tracks: dict[int, _Track],
    successor: IntArray,
) -> dict[int, _Track]:
    """Match the tracks with the rows of a node; begin new ones, drop lost ones."""
    lengths = np.array([rotors.outer_curve.length, rotors.inner_curve.length])
    places = np.column_stack([closest.outer[rows], closest.inner[rows]])
    old = list(tracks.values())
    following: dict[int, _Track] = {}
    reach = _FARTHEST * rotors.eccentricity
    expected = [track.ahead() for track in old]
    # in the order of their distance, each side used once, none too far
    pairs: dict[int, int] = {}
    if expected and places.size:
        difference = np.array(expected)[:, None, :] - places[None, :, :]
        difference -= lengths * np.round(difference / lengths)
        far = np.hypot(difference[..., 0], difference[..., 1])
        for flat in np.argsort(far, axis=None):
            k, other = divmod(int(flat), places.shape[0])
            if far[k, other] > reach:
                break
            if k not in pairs and other not in pairs.values():
                pairs[k] = other
    for k, track in enumerate(old):
        if k in pairs:
            j = pairs[k]
            step = places[j] - track.place
            step -= lengths * np.round(step / lengths)
            track.speed, track.place = step / (1 + track.lost), places[j]
            successor[track.row] = rows[j]
            track.row, track.lost = int(rows[j]), 0
        else:
            track.lost += 1
        if track.lost < _LOST_NODES:
            following[track.row] = track
    for j in set(range(rows.size)) - set(pairs.values()):
        following[int(rows[j])] = _Track(int(rows[j]), places[j])
    return following


def branches(closest: ClosestPoints, successor: IntArray, nodes: int) -> list[Branch]:
    """Chains of the links: those that begin and end, then those that close on themselves."""
    free = np.ones(closest.node.size, dtype=bool)
    starts = np.setdiff1d(np.arange(closest.node.size), successor)
    found = [_chain(closest, successor, int(row), nodes, free) for row in starts]
    for row in np.flatnonzero(closest.node == 0):
        if free[row]:
            found.append(_chain(closest, successor, int(row), nodes, free))
    return found


def _chain(
    closest: ClosestPoints, successor: IntArray, start: int, nodes: int, free: BoolArray
) -> Branch:
    rows, row, first = [], start, int(closest.node[start])
    while row >= 0 and free[row]:
        free[row] = False
        rows.append(row)
        following = int(successor[row])
        if following >= 0:
            skipped = (closest.node[following] - closest.node[row]) % nodes - 1
            rows.extend([-1] * int(skipped))
        row = following
    return Branch(first, np.array(rows), closed=row == start)
