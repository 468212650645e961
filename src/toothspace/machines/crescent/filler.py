"""The crescent between both tip circles, and the recesses of the covers beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
import shapely

from toothspace.core.types import Array
from toothspace.machines.crescent.assembly import CrescentAssembly

_ARC = 181
_FAR = 10.0


@final
@dataclass(frozen=True)
class FillerEdges:
    """Ends of the filler as one gear sees them, from the mesh side of the centre line."""

    inlet: float
    outlet: float
    """Angles about the centre of the gear. [rad]"""

    @property
    def span(self) -> float:
        """Angle over which the filler seals. [rad]."""
        return 2.0 * np.pi - self.inlet - self.outlet


def filler_edges(assembly: CrescentAssembly, gear: int) -> FillerEdges:
    """Ends of the filler at the tip circle of the pinion (0) or of the ring (1).

    Its end faces point to the centre of the pinion.
    """
    given = assembly.spec.filler.inlet_angle, assembly.spec.filler.outlet_angle
    if gear == 0:
        return FillerEdges(*given)
    return FillerEdges(*(_about_ring(assembly, angle) for angle in given))


def _about_ring(assembly: CrescentAssembly, angle: float) -> float:
    """Angle about the ring's centre of the point where a ray from the pinion meets its tips."""
    distance, radius = -assembly.mesh.center_distance, assembly.tip_radii[1]
    along = -distance * np.cos(angle)
    reach = along + np.sqrt(along**2 + radius**2 - distance**2)
    return float(np.arctan2(reach * np.sin(angle), reach * np.cos(angle) + distance))


def filler_outline(assembly: CrescentAssembly) -> Array:
    """Outline of the filler in the machine frame, counter-clockwise. [m]."""
    filler = assembly.spec.filler
    pinion, ring = (filler_edges(assembly, gear) for gear in (0, 1))
    inner = assembly.tip_radii[0] + filler.pinion_clearance
    outer = assembly.tip_radii[1] - filler.ring_clearance
    turns = np.linspace(ring.inlet, 2.0 * np.pi - ring.outlet, _ARC)
    back = np.linspace(2.0 * np.pi - pinion.outlet, pinion.inlet, _ARC)
    return np.vstack([outer * _direction(turns) + assembly.ring_center, inner * _direction(back)])


def filler_thickness(assembly: CrescentAssembly) -> float:
    """Smallest radial thickness of the filler, at one of its ends. [m]."""
    filler = assembly.spec.filler
    play = filler.pinion_clearance + filler.ring_clearance
    center, found = assembly.ring_center, []
    for angle in (filler.inlet_angle, filler.outlet_angle):
        about = _about_ring(assembly, angle)
        point = assembly.tip_radii[1] * _direction(np.array([about]))[0] + center
        found.append(float(np.hypot(*point)) - assembly.tip_radii[0] - play)
    return min(found)


def _direction(places: Array) -> Array:
    """Unit vectors at places from the mesh side of the centre line along the rotation."""
    return np.column_stack([-np.sin(places), np.cos(places)])


def cover_recesses(assembly: CrescentAssembly) -> dict[str, Array]:
    """Outlines of the recesses at inlet and outlet, named by their port. [m].

    Each lies between the root circles of both gears, from its start near the mesh to the filler.
    """
    ports, filler = assembly.spec.ports, assembly.spec.filler
    spans = {
        "inlet": (ports.inlet_start, filler.inlet_angle),
        "outlet": (-filler.outlet_angle, -ports.outlet_start),
    }
    center = shapely.Point(*assembly.ring_center)
    gears: Any = center.buffer(assembly.root_radius, quad_segs=90).difference(
        shapely.Point(0.0, 0.0).buffer(assembly.pinion.root_radius, quad_segs=90)
    )
    found = {}
    for port, (start, end) in spans.items():
        rays = _FAR * assembly.root_radius * _direction(np.linspace(start, end, 91))
        wedge = shapely.Polygon(np.vstack([np.zeros((1, 2)), rays]))
        found[port] = np.asarray(gears.intersection(wedge).exterior.coords)[:-1]
    return found


def relief_polygons(assembly: CrescentAssembly) -> dict[str, Array]:
    """Outlines of the relief grooves, named by the port that they join. [m]."""
    grooves = assembly.grooves
    return {} if grooves is None else grooves.outlines(assembly.mesh.pitch_radii[0])
