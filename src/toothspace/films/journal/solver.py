"""Film of a journal bearing for a given motion of its shaft, and the loads and flows of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.types import Array, IntArray
from toothspace.films.definitions import Groove
from toothspace.films.journal.definition import JournalDefinition
from toothspace.films.journal.geometry import (
    EndConditions,
    JournalMesh,
    MotionState,
    SurfaceSpeed,
    journal_gap,
    journal_grid,
    journal_load,
    journal_mesh,
    journal_shear,
    lobed,
)
from toothspace.films.reynolds.cavitation import CAVITATION
from toothspace.films.reynolds.equation import FilmGrid, GapField
from toothspace.films.reynolds.rough_surfaces import (
    SMOOTH,
    FlowLaw,
    contact_field,
    contact_table,
    flow_law,
)
from toothspace.films.reynolds.state import FilmHistory, FilmProblem, FilmState, solve_state
from toothspace.numerics.linear_system import PRESCRIBED


@final
@dataclass(frozen=True)
class JournalContact:
    """Asperity pressure of the cells and its derivative with the gap."""

    pressure: Array
    slope: Array


@final
@dataclass(frozen=True)
class JournalField(FilmState):
    """Discrete film and its solution, kept for variations."""

    mesh: JournalMesh
    contact: JournalContact | None


@lru_cache(maxsize=32)
def _metric(
    bearing: JournalDefinition, grooves: tuple[Groove, ...], first_angle: float, half: bool
) -> tuple[JournalMesh, FilmGrid]:
    mesh = journal_mesh(bearing.length, bearing.grid, first_angle, half=half)
    wall = bearing.end_condition == "no_flow"
    ends = EndConditions(bearing.end_pressure, bearing.end_pressure, wall)
    return mesh, journal_grid(mesh, 0.5 * bearing.diameter, grooves, ends)


def _needs_supply(bearing: JournalDefinition, motion: MotionState, surface_speed: float) -> bool:
    if bearing.supply != "auto":
        return bearing.supply == "widest_gap"
    if bearing.grooves:
        return False
    if bearing.end_condition == "no_flow":
        return surface_speed != 0.0 or bool(np.any(motion.speed))
    return surface_speed != 0.0 and bearing.end_pressure <= bearing.cavitation_pressure


def _supplied(
    bearing: JournalDefinition, motion: MotionState, surface_speed: float, *, remembered: bool
) -> tuple[tuple[Groove, ...], float]:
    """Grooves with the supply line, and the angle at which the grid begins."""
    if not _needs_supply(bearing, motion, surface_speed):
        moves = surface_speed != 0.0 or bool(np.any(motion.speed))
        closed = bearing.end_condition == "no_flow" and not bearing.grooves
        if moves and closed and not remembered:
            raise CaseError(
                "bearing.supply",
                "'none' between walls and without grooves",
                "is a supply line, a groove or open ends: the liquid in a closed film is not "
                "determined",
            )
        return bearing.grooves, 0.0
    place = motion.place
    widest = float(np.arctan2(-place[1], -place[0])) if np.any(place[:2]) else np.pi
    line = Groove(widest, 0.0, bearing.length, bearing.end_pressure)
    return (*bearing.grooves, line), widest


def solve_field(
    bearing: JournalDefinition,
    motion: MotionState,
    speed: SurfaceSpeed,
    *,
    half: bool | None = None,
    start: IntArray | None = None,
    history: FilmHistory | None = None,
) -> JournalField:
    """Film of a bearing for a rigid motion of its shaft.

    ``start`` holds the kinds of the cells to begin with. With a history the film fraction is
    transported in time, else it follows the motion without delay.
    """
    radius = 0.5 * bearing.diameter
    surface_speed = 0.5 * (speed.shaft + speed.bush) * radius
    grooves, first_angle = _supplied(bearing, motion, surface_speed, remembered=history is not None)
    if half is None:
        tilted = np.any(motion.place[2:]) or np.any(motion.speed[2:])
        half = not tilted and all(g.position == 0.0 for g in grooves)
    mesh, unit_grid = _metric(bearing, grooves, first_angle, half)
    grid = unit_grid._replace(sweep_x=unit_grid.sweep_x * surface_speed)
    gap = journal_gap(mesh, bearing.radial_clearance, motion)
    if bearing.lobes is not None:
        gap = lobed(gap, mesh, bearing.lobes, bearing.radial_clearance)
    law, contact = _walls(bearing, speed, gap)
    if contact is None:
        lowest = min(float(gap.centre.min()), float(gap.face_x.min()), float(gap.face_y.min()))
        if lowest <= 0.0:
            ratio = float(np.hypot(*motion.place[:2])) / bearing.radial_clearance
            raise CaseError(
                "bearing.eccentricity",
                f"a smallest gap of {lowest:.3g} m at an eccentricity ratio of {ratio:.4g}",
                "are positions without contact",
            )
    film = FilmProblem(
        grid,
        gap,
        bearing.fluid,
        bearing.cavitation_pressure,
        CAVITATION[bearing.cavitation],
        law,
        mesh.weight,
    )
    return JournalField(**vars(solve_state(film, start, history)), mesh=mesh, contact=contact)


def _walls(
    bearing: JournalDefinition, speed: SurfaceSpeed, gap: GapField
) -> tuple[FlowLaw, JournalContact | None]:
    """Average flow law and asperity pressure; smooth walls have none."""
    surfaces = bearing.surfaces
    if surfaces is None:
        return SMOOTH, None
    total = speed.shaft + speed.bush
    law = flow_law(surfaces, (speed.shaft - speed.bush) / total if total != 0.0 else 0.0)
    pressure, slope = contact_field(gap.centre, surfaces.roughness, contact_table(surfaces))
    return law, JournalContact(pressure, slope)


def contact_load(
    bearing: JournalDefinition, speed: SurfaceSpeed, field: JournalField
) -> tuple[Array, float]:
    """Force on the shaft by asperities [N], and the torque by which they brake it [N m]."""
    if field.contact is None or bearing.surfaces is None:
        return np.zeros(2), 0.0
    force = journal_load(field.mesh, field.contact.pressure, field.film.grid.area)[:2]
    normal = field.mesh.weight * float((field.contact.pressure * field.film.grid.area).sum())
    sense = float(np.sign(speed.shaft - speed.bush))
    return force, sense * bearing.surfaces.boundary_friction * normal * 0.5 * bearing.diameter


def friction_torques(
    bearing: JournalDefinition, speed: SurfaceSpeed, field: JournalField
) -> tuple[float, float]:
    """Torques on shaft and bush [N m]; a cavity shears in proportion to its film fraction."""
    radius = 0.5 * bearing.diameter
    thickness = 1.0 / (bearing.dynamic_viscosity * field.fluid.fluidity)
    couette, pattern, pressure = field.mesh.weight * journal_shear(
        field.film.gap, field.gauge, field.fields.saturation * thickness, field.mesh, field.film.law
    )
    scale = bearing.dynamic_viscosity * (speed.shaft - speed.bush) * radius**3
    shaft = -scale * (couette - pattern) - radius * pressure
    return shaft, scale * (couette + pattern) - radius * pressure


def boundary_flows(field: JournalField) -> tuple[float, Array, float]:
    """Supply by prescribed cells, flow out of the two ends [m3/s], error of the balance [-]."""
    weight, b = field.mesh.weight, field.balance
    net, (_, flow_y) = field.residuals, field.flows
    prescribed = b.mark == PRESCRIBED
    supply = weight * float(net[prescribed].sum())
    north = float(flow_y[:, -1].sum())
    south = north if weight > 1.0 else -float(flow_y[:, 0].sum())
    through = max(
        abs(supply), abs(north), abs(south), float(np.abs(b.advection_x).sum(axis=1).max())
    )
    through = max(through, float(np.abs(b.storage - b.source).sum()))
    error = field.relative_error(weight * float(net[~prescribed].sum()), through)
    return supply, np.array([south, north]), error
