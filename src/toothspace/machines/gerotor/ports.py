"""Kidney ports, and what their timing does to a pocket: openings, sealed spans, joined ports."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.recall import recalled
from toothspace.core.types import Array, IntArray
from toothspace.geometry.cad_import import load_polygons
from toothspace.geometry.curve import enclosed, polar
from toothspace.machines.gerotor.parameters import PortContourParameters
from toothspace.machines.gerotor.pockets import FULL_TURN, Pockets

_POLYGON_POINTS = 80
_LEAST_AREA = 1e-12
_CLOSED_AREA = 0.02e-6


@final
@dataclass(frozen=True)
class Ports:
    """Kidneys about the outer rotor's centre, mirrored on the line of centres."""

    land_max_half_angle: float
    land_min_half_angle: float
    """Half of the lands at the largest and smallest pocket. [rad]"""
    contours: dict[str, Array]
    """Closed polygons ``inlet`` and ``outlet`` in the machine frame, the inlet on the side where
    the pockets grow (positive x). By name. [m]
    """
    slot: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Half angle of the radial slot of a cavity [rad], its width and length; zeros without. [m]"""


def throat_place(pocket: Pockets) -> Array:
    """Place of the throats' middles over the place of their lobe. [rad]."""
    x, y = pocket.path.point.T
    beyond = np.arctan2(y, x) + 0.5 * np.pi - pocket.place
    return pocket.place + np.mod(beyond + np.pi, FULL_TURN) - np.pi


def kinematic_lands(pocket: Pockets) -> tuple[float, float]:
    """Half angles of the lands that cut a pocket from one port when it opens to the other.

    At the largest and at the smallest pocket: places of the throats of the pocket that stands
    there. [rad]
    """
    throat, half = throat_place(pocket), pocket.half_pitch_nodes
    opposite = pocket.place.size // 2
    return float(throat[opposite + half] - np.pi), float(throat[half])


def ports_of(parameters: PortContourParameters, pocket: Pockets, rim_radius: float) -> Ports:
    """Kidneys of a case.

    Both kidneys, and the radial slots.

    Raises GeometryError if the radii enclose nothing or a contour file has not exactly one polygon
    per side.

    Parameters
    ----------
    parameters : PortContourParameters
        Keys ``[machine.ports]``; radii left out reach from the inner rotor's roots to the
        floor of the outer rotor's cavities.
    rim_radius : float
        Radius of the outer rotor. [m]
    """
    lands = kinematic_lands(pocket)
    if parameters.land_max_half_angle is not None and parameters.land_min_half_angle is not None:
        lands = parameters.land_max_half_angle, parameters.land_min_half_angle
    inner = parameters.inner_radius or float(np.hypot(*pocket.rotors.inner.T).min())
    outer = parameters.outer_radius or float(np.hypot(*pocket.rotors.outer.T).max())
    if inner >= outer:
        raise GeometryError(
            "machine.ports.inner_radius",
            f"{inner * 1e3:.5g} mm",
            f"below {outer * 1e3:.5g} mm",
        )
    if outer >= rim_radius:
        raise GeometryError(
            "machine.ports.outer_radius",
            f"{outer * 1e3:.5g} mm",
            f"below {rim_radius * 1e3:.5g} mm, the radius of the outer rotor",
        )
    width, length = parameters.radial_slot_width or 0.0, parameters.radial_slot_length or 0.0
    slot = 0.5 * width / rim_radius, width, length
    if parameters.contour is not None:
        path = parameters.contour
        polygons = [] if path is None else load_polygons(path, 1e-3)
        sides = {
            name: [p for p in polygons if sign * shapely.Polygon(p).centroid.x > 0.0]
            for name, sign in (("inlet", 1.0), ("outlet", -1.0))
        }
        if any(len(found) != 1 for found in sides.values()):
            counts = ", ".join(f"{len(found)} for the {name}" for name, found in sides.items())
            raise GeometryError(path, counts, "one closed curve on each side of x")
        return replace(Ports(*lands, {name: found[0] for name, found in sides.items()}), slot=slot)
    angle = np.linspace(lands[1], np.pi - lands[0], _POLYGON_POINTS) - 0.5 * np.pi
    kidney = np.vstack([polar(outer, angle), polar(inner, angle[::-1])])
    mirrored = (kidney * np.array([-1.0, 1.0]))[::-1]
    return Ports(*lands, {"inlet": kidney, "outlet": mirrored}, slot)


def _shape(pocket: Pockets) -> tuple[Any, ...]:
    """What the areas of a pocket follow from."""
    return pocket.rotors.inner, pocket.rotors.outer, pocket.path, pocket.place.size


@recalled(4, lambda ports, pocket, port: (ports, _shape(pocket), port))
def openings(ports: Ports, pocket: Pockets, port: str) -> Array:
    """Opening of a pocket to a port.

    Area [m2] and hydraulic diameter [m] over the place of the pocket, of kidney and radial slot
    together, shape (n, 2).

    Parameters
    ----------
    port : str
        ``inlet`` or ``outlet``.
    """
    kidney = shapely.Polygon(ports.contours[port])
    shapely.prepare(kidney)
    table = np.zeros((pocket.place.size, 2))
    cut = shapely.intersection(kidney, _enclosed_pockets(pocket))
    area = shapely.area(cut)
    table[:, 0] = np.where(area > _LEAST_AREA, area, 0.0)
    there = area > _LEAST_AREA
    table[there, 1] = 4.0 * area[there] / shapely.length(cut[there])
    if ports.slot[0] == 0.0:
        return table
    # kidney and slot side by side
    slot_area, slot_wetted = radial_openings(ports, pocket, port).T
    kidney_area, kidney_diameter = table.T
    none, area = np.zeros(len(table)), kidney_area + slot_area
    wetted = np.divide(4.0 * kidney_area, kidney_diameter, out=none, where=kidney_diameter > 0.0)
    wetted = wetted + np.where(slot_area > 0.0, slot_wetted, 0.0)
    diameter = np.divide(4.0 * area, wetted, out=np.zeros(len(table)), where=wetted > 0.0)
    return np.column_stack([area, diameter])


def radial_openings(ports: Ports, pocket: Pockets, port: str) -> Array:
    """Opening of a cavity's slot to the window of a port in the bore.

    Area [m2] and wetted length [m] over the place of the pocket; the slot stands in its middle,
    shape (n, 2).

    Parameters
    ----------
    ports : Ports
        Kidneys, whose lands the windows share, and slot.
    port : str
        ``inlet`` or ``outlet``.
    """
    half, width, length = ports.slot
    place = pocket.place if port == "inlet" else FULL_TURN - pocket.place
    middle = np.mod(place, FULL_TURN)
    ends = ports.land_min_half_angle, np.pi - ports.land_max_half_angle
    overlap = np.minimum(middle + half, ends[1]) - np.maximum(middle - half, ends[0])
    open_width = np.clip(overlap / (2.0 * half), 0.0, 1.0) * width
    return np.column_stack([open_width * length, 2.0 * (open_width + length)])


@final
@dataclass(frozen=True)
class PocketOutlines:
    """Outlines of all chambers of a gerotor set over the shaft angle."""

    pocket: Pockets
    """Pockets of the set."""
    film: Array
    """Outline of the film round the outer rotor. Shape (n, 2). [m]"""

    def __call__(self, shaft_angle: float) -> list[Array]:
        """Outlines at a shaft angle [rad], pockets, then the film. [m]."""
        size, count = self.pocket.place.size, self.pocket.rotors.outer_tooth_count
        turned_by = size * self.pocket.angle_ratio * shaft_angle / FULL_TURN
        nodes = np.asarray(turned_by + size / count * np.arange(count), dtype=float)
        return [*PocketPolygons(self.pocket)(nodes), self.film]


@final
class PocketPolygons:
    """Outlines of one pocket from throat to throat, at nodes of its place.

    Parameters
    ----------
    pocket : Pockets
        Pockets of the set.
    """

    def __init__(self, pocket: Pockets) -> None:
        self._pocket = pocket
        rotors = pocket.rotors
        self._inner, self._outer = _Arc(rotors.inner), _Arc(rotors.outer)

    def __call__(self, nodes: Array) -> list[Array]:
        """Closed polygons in the machine frame, each of shape (n, 2). [m].

        Parameters
        ----------
        nodes : ndarray
            Numbers of the nodes; throats between two of them are interpolated. [-]
        """
        pocket = self._pocket
        rotors, half = pocket.rotors, pocket.half_pitch_nodes
        turn = FULL_TURN * nodes / pocket.place.size
        inner_turn = turn * rotors.outer_tooth_count / rotors.inner_tooth_count
        behind, ahead = self._walls(nodes - half), self._walls(nodes + half)
        upper, uppers = self._outer.between(turn, behind[1], ahead[1])
        center = rotors.inner_center
        lower, lowers = self._inner.between(inner_turn, behind[0] - center, ahead[0] - center)
        # from the throat behind along the outer rotor to the one ahead, and back along the inner
        ends = np.cumsum(uppers + lowers + 4)
        points, starts = np.empty((int(ends[-1]), 2)), ends - uppers - lowers - 4
        points[starts], points[starts + uppers + 1] = behind[1], ahead[1]
        points[starts + uppers + 2], points[ends - 1] = ahead[0], behind[0]
        points[np.repeat(starts + 1, uppers) + _counted(uppers)] = upper
        points[np.repeat(ends - 2, lowers) - _counted(lowers)] = lower + center
        return np.split(points, ends[:-1])

    def _walls(self, nodes: Array) -> tuple[Array, Array]:
        """Walls of the inner and the outer rotor beside the throats at nodes. Shape (n, 2). [m]."""
        path, size = self._pocket.path, self._pocket.place.size
        first = np.floor(nodes).astype(np.int64)
        share = (nodes - first)[:, None]
        gap, normal, point = (
            (1.0 - share) * values[first % size] + share * values[(first + 1) % size]
            for values in (path.gap[:, None], path.normal, path.point)
        )
        return point - 0.5 * gap * normal, point + 0.5 * gap * normal


@recalled(2, _shape)
def _enclosed_pockets(pocket: Pockets) -> Any:
    """Areas of a pocket at all its places."""
    return enclosed(PocketPolygons(pocket)(np.arange(pocket.place.size, dtype=float)))


def _counted(sizes: IntArray) -> IntArray:
    """Numbers from nought within groups of such sizes, one group after the other."""
    ends = np.cumsum(sizes)
    return np.arange(ends[-1]) - np.repeat(ends - sizes, sizes)


@final
class _Arc:
    """Points of a closed curve in the order of their angle about the origin."""

    def __init__(self, points: Array) -> None:
        angle = np.mod(np.arctan2(points[:, 1], points[:, 0]), FULL_TURN)
        order = np.argsort(angle)
        # twice round, so that no piece is cut in two
        self._angle = np.concatenate([angle[order], angle[order] + FULL_TURN])
        self._points = np.vstack([points[order], points[order]])

    def between(self, turn: Array, first: Array, last: Array) -> tuple[Array, IntArray]:
        """Points of the curve turned by angles between two points, counter-clockwise.

        Parameters
        ----------
        turn : ndarray, shape (n,)
            Angles. [rad]
        first, last : ndarray, shape (n, 2)
            Points where each piece begins and ends. [m]

        Returns
        -------
        points : ndarray, shape (points, 2)
            Those of all pieces, one after the other. [m]
        sizes : ndarray of int, shape (n,)
            Number of points of each piece.
        """
        start, end = (np.arctan2(y, x) - turn for x, y in (first.T, last.T))
        start = start % FULL_TURN
        end = start + (end - start) % FULL_TURN
        low, high = np.searchsorted(self._angle, start, "right"), np.searchsorted(self._angle, end)
        sizes = np.maximum(high - low, 0)
        points = self._points[np.repeat(low, sizes) + _counted(sizes)]
        cosine, sine = np.repeat(np.cos(turn), sizes), np.repeat(np.sin(turn), sizes)
        x, y = points.T
        return np.column_stack([cosine * x - sine * y, sine * x + cosine * y]), sizes


@final
@dataclass(frozen=True)
class Timing:
    """Openings of a pocket over its place."""

    inlet: Array
    outlet: Array
    """Area [m2] and hydraulic diameter [m] of the opening to each port. Shape (n, 2)."""

    @property
    def joined_area(self) -> float:
        """Largest area through which one pocket joins both ports. [m2]."""
        return float(np.minimum(self.inlet[:, 0], self.outlet[:, 0]).max())

    def sealed_spans(self) -> list[slice]:
        """Runs of table nodes at which a pocket is open to neither port.

        Runs in nodes counted from half a turn before the smallest pocket, so that none is cut in
        two.
        """
        half = self.inlet.shape[0] // 2
        closed = (self.inlet[:, 0] < _CLOSED_AREA) & (self.outlet[:, 0] < _CLOSED_AREA)
        # the largest pocket may be sealed as well: begin where a port is wide open
        start = int(np.argmax(self.inlet[:, 0])) - half
        turned = np.roll(closed, -start)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], turned, [False]]).astype(int)))
        return [
            slice(int(a) + start, int(b) + start)
            for a, b in zip(edges[::2], edges[1::2], strict=True)
        ]

    def sealed_angle(self, pocket: Pockets) -> float:
        """Longest shaft angle during which a pocket is open to neither port. [rad]."""
        longest = max((s.stop - s.start - 1 for s in self.sealed_spans()), default=0)
        return longest * FULL_TURN / pocket.place.size / pocket.angle_ratio

    def trapped_area(self, pocket: Pockets) -> float:
        """Largest change of a pocket's area while it is open to neither port. [m2]."""
        nodes = np.arange(pocket.place.size)
        changes = [
            np.ptp(pocket.area[np.take(nodes, np.arange(s.start, s.stop), mode="wrap")])
            for s in self.sealed_spans()
        ]
        return float(max(changes, default=0.0))


def timing_of(ports: Ports, pocket: Pockets) -> Timing:
    """Openings of a pocket to both ports."""
    return Timing(*(openings(ports, pocket, name) for name in ("inlet", "outlet")))
