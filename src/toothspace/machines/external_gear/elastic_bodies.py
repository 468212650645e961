"""Elastic bodies of an external gear machine: gears, bearing blocks and plates.

Gears stand in their own frame (centre of the gear, first tooth on the x axis, z = 0 in the
middle of the face width), bearings and plates in the machine frame with z = 0 on their film face.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, final

import numpy as np
import shapely

from toothspace.elasticity.body import ElasticBody, Support, SweptShape
from toothspace.elasticity.loads import AreaPressure, LateralPressure, Load, journal_load
from toothspace.elasticity.mesh import Prism, disc
from toothspace.elasticity.surfaces import PlaneSurface
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.loads import BODIES, groove_polygons
from toothspace.machines.external_gear.spec import Material

BearingSide = Literal["floating", "solid"]

_NAMES = ("drive", "driven")
_SPRING_RADIUS = 0.05
"""Radius of the patch that carries a spring over the tip radius. [-]"""


@final
@dataclass(frozen=True)
class MeshSize:
    """Fineness of an elastic body, over the tip radius of the drive gear.

    Parameters
    ----------
    edge_length : float
        Edge of the plane triangles; quadrilaterals are about 0.4 of it. [-]
    layer_height : float
        Largest height of a layer. [-]
    node_spacing : float
        Distance of the nodes of the film surface. [-]
    """

    edge_length: float = 0.085
    layer_height: float = 0.08
    node_spacing: float = 0.085


FINE = MeshSize(0.056, 0.05, 0.075)
"""About 150 000 elements for a bearing block."""


@final
@dataclass(frozen=True, eq=False)
class BackLoads:
    """What presses on the back of a bearing or plate.

    Parameters
    ----------
    areas : mapping of str to Polygon
        Regions of the back face in the machine frame, by the name of their pressure. [m]
    points : mapping of str to tuple of float
        Places x, y of springs by name; one over a bore rests on its rim. [m]
    lines : mapping of str to LineString
        Lines on which seals press, by name; the load is one newton in all. [m]
    """

    areas: Mapping[str, shapely.Geometry] = field(default_factory=dict)
    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    lines: Mapping[str, shapely.LineString] = field(default_factory=dict)


def gear_body(assembly: Assembly, gear: int, size: MeshSize | None = None) -> ElasticBody:
    """Gear with its shaft stubs, floating.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    gear : int
        0 for the drive gear, 1 for the driven gear.
    size : MeshSize, optional
        Fineness.

    Returns
    -------
    ElasticBody
        Films ``floating`` (z > 0) and ``solid``; loads ``space_0``... (pressure in the tooth
        space after each tooth) and ``journal_floating_x``... (force of a journal film).
    """
    size = size or MeshSize()
    spec, profile = assembly.spec, assembly.profiles[gear]
    own = (spec.drive, spec.driven)[gear]
    unit, half = assembly.profiles[0].tip_radius, 0.5 * own.face_width
    radius, reach = 0.5 * spec.journals.diameter, half + spec.journals.length
    section = shapely.Polygon(profile.closed_polygon())
    face = section.difference(disc(radius))
    parts = (Prism(section, -half, half), Prism(disc(radius), -reach, reach))
    loads: list[Load] = [
        LateralPressure(f"space_{k}", _space(assembly, gear, k), -half, half)
        for k in range(profile.tooth_count)
    ]
    for side, levels in (("floating", (half, reach)), ("solid", (-reach, -half))):
        loads += [
            journal_load(f"journal_{side}_{axis}", radius, levels, angle)
            for axis, angle in (("x", 0.0), ("y", 0.5 * np.pi))
        ]
    return ElasticBody(
        shape=SweptShape(parts, size.edge_length * unit, size.layer_height * unit),
        elastic_modulus=own.material.elastic_modulus,
        poisson_ratio=own.material.poisson_ratio,
        density=own.material.density,
        films=(
            PlaneSurface("floating", "top", face, size.node_spacing * unit),
            PlaneSurface("solid", "bottom", face, size.node_spacing * unit),
        ),
        loads=tuple(loads),
    )


def _space(assembly: Assembly, gear: int, index: int) -> shapely.Polygon:
    """Sector from the middle of a tooth to the middle of the next, outside the shaft."""
    profile = assembly.profiles[gear]
    near = 0.5 * (0.5 * assembly.spec.journals.diameter + profile.root_radius)
    angle = profile.pitch_angle * (index + np.linspace(0.0, 1.0, 33))
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    return shapely.Polygon(np.vstack([1.02 * profile.tip_radius * rim, near * rim[::-1]]))


def bearing_section(assembly: Assembly) -> shapely.Polygon:
    """Section of a bearing block or plate: both tip circles less the shaft bores. [m]."""
    centers = _centers(assembly)
    tips = [profile.tip_radius for profile in assembly.profiles]
    outline = shapely.union_all([disc(r, c) for r, c in zip(tips, centers, strict=True)])
    bore = 0.5 * assembly.spec.journals.diameter
    return shapely.difference(outline, shapely.union_all([disc(bore, c) for c in centers]))


def _centers(assembly: Assembly) -> tuple[tuple[float, float], tuple[float, float]]:
    return (0.0, 0.0), (0.0, assembly.mesh.center_distance)


def bearing_body(
    assembly: Assembly,
    material: Material,
    length: float,
    side: BearingSide = "floating",
    back: BackLoads | None = None,
    size: MeshSize | None = None,
) -> ElasticBody:
    """Bearing block, bushing pair in one piece, or pressure plate.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    material : Material
        Material of the body.
    length : float
        Axial length. [m]
    side : {"floating", "solid"}
        A floating body is free and stands above the gears (z from 0 up); a solid bearing stands
        below and rests with its back on the cover.
    back : BackLoads, optional
        Pressure regions, springs and seals of the back face.
    size : MeshSize, optional
        Fineness.

    Returns
    -------
    ElasticBody
        Film ``face``; loads of the back by their names; ``journal_drive_x``,
        ``journal_driven_y`` and so on for the forces of the journal films on bodies longer than
        half a bearing.
    """
    size, back = size or MeshSize(), back or BackLoads()
    unit, section = assembly.profiles[0].tip_radius, bearing_section(assembly)
    up = 1.0 if side == "floating" else -1.0
    loads = _back_loads(assembly, back, "top" if side == "floating" else "bottom")
    if length > 0.5 * assembly.spec.journals.length:
        loads += _bore_loads(assembly, sorted((0.0, up * length)))
    support = Support("bottom", section)
    return ElasticBody(
        shape=SweptShape(
            _bearing_parts(assembly, section, up * length),
            size.edge_length * unit,
            size.layer_height * unit,
        ),
        elastic_modulus=material.elastic_modulus,
        poisson_ratio=material.poisson_ratio,
        density=material.density,
        films=(
            PlaneSurface(
                "face",
                "bottom" if side == "floating" else "top",
                section,
                size.node_spacing * unit,
            ),
        ),
        loads=tuple(loads),
        supports=() if side == "floating" else (support,),
    )


def _bearing_parts(
    assembly: Assembly, section: shapely.Polygon, height: float
) -> tuple[Prism, ...]:
    """Whole section behind the relief grooves, section less grooves before."""
    grooves = assembly.spec.grooves
    if grooves is None or grooves.depth >= abs(height):
        return (Prism(section, *sorted((0.0, height))),)
    cut = [shapely.Polygon(p) for p in groove_polygons(assembly).values()]
    floor = np.copysign(grooves.depth, height)
    face = section.difference(shapely.union_all(cut))
    return (
        Prism(face, *sorted((0.0, floor))),
        Prism(section, *sorted((floor, height))),
    )


def _back_loads(assembly: Assembly, back: BackLoads, side: Literal["top", "bottom"]) -> list[Load]:
    section = bearing_section(assembly)
    radius = _SPRING_RADIUS * assembly.profiles[0].tip_radius
    loads: list[Load] = [AreaPressure(name, side, area) for name, area in back.areas.items()]
    for name, place in back.points.items():
        patch = _nearest(section, place, radius).buffer(radius)
        loads.append(AreaPressure(name, side, patch, per_area=False))
    for name, line in back.lines.items():
        band = shapely.buffer(line, 0.5 * radius, cap_style="flat")
        loads.append(AreaPressure(name, side, band, per_area=False))
    return loads


def _nearest(section: shapely.Polygon, place: tuple[float, float], radius: float) -> shapely.Point:
    """Place of a patch on the face: a spring over a bore rests on its rim."""
    room = section.buffer(-radius)
    return shapely.line_interpolate_point(shapely.shortest_line(room, shapely.Point(*place)), 0.0)


def _bore_loads(assembly: Assembly, levels: list[float]) -> list[Load]:
    radius = 0.5 * assembly.spec.journals.diameter
    ends = (levels[0], levels[1])
    return [
        journal_load(f"journal_{name}_{axis}", radius, ends, angle, center=center)
        for name, center in zip(_NAMES, _centers(assembly), strict=True)
        for axis, angle in (("x", 0.0), ("y", 0.5 * np.pi))
    ]


COARSE = MeshSize(0.16, 0.16, 0.13)
"""A few thousand elements for each body."""


@final
@dataclass(frozen=True, eq=False)
class PressedBodies:
    """Bearings and gears of a machine with a pressed bearing.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    size : MeshSize
        Fineness of all bodies.
    """

    assembly: Assembly
    size: MeshSize = COARSE

    def __call__(self) -> Mapping[str, object]:
        """Bearings ``floating`` and ``solid``, and the gears by name."""
        assembly, pressed = self.assembly, self.assembly.spec.pressed
        assert pressed is not None
        material, length = pressed.material, pressed.length
        gears = {name: gear_body(assembly, k, self.size) for k, name in enumerate(BODIES)}
        # with two pressed bearings the second floats as well
        free = pressed.arrangement != "asymmetric"
        solid = bearing_body(assembly, material, length, "solid", size=self.size)
        return {
            "floating": bearing_body(
                assembly, material, length, "floating", self._back(), self.size
            ),
            "solid": replace(solid, supports=()) if free else solid,
            **gears,
        }

    def _back(self) -> BackLoads:
        """High-pressure area and springs; the nose where it has an area."""
        spec = self.assembly.spec
        pressed = spec.pressed
        assert pressed is not None
        section = bearing_section(self.assembly)
        areas: dict[str, shapely.Geometry] = {}
        if pressed.high_pressure_contour is not None:
            areas["high"] = shapely.Polygon(pressed.high_pressure_contour).intersection(section)
        elif pressed.seal_line is not None:
            low_x, low_y, high_x, high_y = section.bounds
            near = pressed.seal_line
            pump = spec.mode == "pump"
            half = (near, low_y, high_x, high_y) if pump else (low_x, low_y, -near, high_y)
            areas["high"] = section.intersection(shapely.box(*half))
        points = {f"spring_{k}": (s.x, s.y) for k, s in enumerate(pressed.springs)}
        return BackLoads(areas=areas, points=points)
