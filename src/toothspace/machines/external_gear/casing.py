"""The bore round each gear: where it seals, how far away it is, where the ports begin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.machines.external_gear.assembly import Assembly

_RAYS = 1440
_SEALING_CLEARANCES = 3.0


@final
@dataclass(frozen=True)
class Bore:
    """Casing as one gear sees it."""

    inlet_angle: float
    outlet_angle: float
    """From the mesh side of the centre line to the port edge along the bore. [rad]"""
    places: Array
    """Even places round the gear from the centre line in the sense of rotation, 0 to 2 pi. [rad]"""
    clearance: Array
    """Distance from the tip circle to the bore at the places. [m]"""

    def clearance_at(self, places: Array) -> Array:
        """Clearance at places of any turn. [m]."""
        turn = 2.0 * np.pi
        return np.asarray(np.interp(places, self.places, self.clearance, period=turn), dtype=float)


def bore(assembly: Assembly, gear: int) -> Bore:
    """Bore round the drive gear (0) or the driven gear (1).

    Returns
    -------
    Bore
        From clearance and angles, or from the contour where one is given: the bore reaches from
        the point opposite to the mesh as far as the contour stays within three clearances of
        the tip circle.

    Raises
    ------
    GeometryError
        If a contour does not surround the gear or leaves no sealing bore.
    """
    casing = assembly.spec.keys.casing
    places = 2.0 * np.pi * np.arange(_RAYS) / _RAYS
    contour = assembly.spec.casing_contour
    if contour is None:
        assert casing.inlet_angle is not None
        assert casing.outlet_angle is not None
        clearance = np.full(_RAYS, casing.radial_clearance)
        return Bore(casing.inlet_angle, casing.outlet_angle, places, clearance)
    clearance = _contour_clearance(assembly, gear, contour, places)
    limit = _SEALING_CLEARANCES * casing.radial_clearance
    if clearance.min() <= 0.0 or clearance[_RAYS // 2] > limit:
        raise GeometryError(
            "machine.casing.contour",
            f"{clearance.min() * 1e6:.4g} um from the tip circle and "
            f"{clearance[_RAYS // 2] * 1e6:.4g} um opposite to the mesh",
            f"above 0 um and up to {limit * 1e6:.4g} um",
        )
    edges = _edge_places(assembly, gear, contour, limit)
    before = edges[edges < np.pi].max(initial=0.0)
    after = edges[edges > np.pi].min(initial=2.0 * np.pi)
    return Bore(float(before), float(2.0 * np.pi - after), places, np.minimum(clearance, limit))


def _edge_places(assembly: Assembly, gear: int, contour: Array, limit: float) -> Array:
    # where the contour crosses the circle that bounds the sealing bore
    start = contour - _center(assembly, gear)
    beyond = np.sum(start**2, axis=1) - (assembly.teeth[gear].tip_radius + limit) ** 2
    crossing = np.flatnonzero(beyond * np.roll(beyond, -1) < 0.0)
    step = (np.roll(start, -1, axis=0) - start)[crossing]
    start, beyond = start[crossing], beyond[crossing]
    half, square = np.sum(start * step, axis=1), np.sum(step**2, axis=1)
    root = np.sign(beyond) * np.sqrt(half**2 - square * beyond)
    x, y = (start - ((half + root) / square)[:, None] * step).T
    return np.mod(np.arctan2(-x, y if gear == 0 else -y), 2.0 * np.pi)


def _center(assembly: Assembly, gear: int) -> Array:
    return np.array([0.0, 0.0 if gear == 0 else assembly.mesh.center_distance])


def _contour_clearance(assembly: Assembly, gear: int, contour: Array, places: Array) -> Array:
    center = _center(assembly, gear)
    rise = np.cos(places) if gear == 0 else -np.cos(places)
    directions = np.column_stack([-np.sin(places), rise])
    reach = 2.0 * float(np.max(np.hypot(*(contour - center).T)))
    ends = np.stack([np.broadcast_to(center, directions.shape), center + reach * directions], 1)
    ring = shapely.LinearRing(contour)
    hits = shapely.intersection(shapely.linestrings(ends), ring)
    # a ray that misses the contour counts as touching
    distance = np.nan_to_num(shapely.distance(hits, shapely.Point(*center)))
    return np.asarray(distance - assembly.teeth[gear].tip_radius, dtype=float)
