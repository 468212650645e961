"""One film of the stack: its solution, its forces and their exact variation with the gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.status import Status
from toothspace.core.types import Array, BoolArray
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.plane.film import PlaneFilm, PlaneSolution, rigid_change
from toothspace.films.reynolds.equation import FilmGrid, FluidField, GapField, film_balance
from toothspace.films.reynolds.fluid import CAVITATION, FilmFluid
from toothspace.films.reynolds.rough_surfaces import (
    NO_CONTACT,
    SMOOTH,
    ContactTable,
    FlowLaw,
    contact_field,
    contact_table,
    flow_law,
    mean_gap,
)
from toothspace.floating.compliant_film import (
    Accuracy,
    CompliantSolution,
    LocalCompliance,
    compliant_responses,
    deformed_gap,
    solve_compliant,
)
from toothspace.floating.face_grid import FaceGrid, Mask
from toothspace.numerics.complementarity import solve_complementarity
from toothspace.numerics.linear_system import PRESCRIBED

_SHEARED = 1e-9
"""Smallest mean gap that liquid is sheared in, where faces overlap. [m]"""


_SHRINK = 0.3
"""Part to which a step of the faces may shrink a gap. [-]"""
_GROWTH = 3.0
"""Factor by which a step of the faces may open a gap. [-]"""
_OVERLAP = 0.5
"""Overlap of rough walls that a step of the faces may add, over the roughness. [-]"""


class FilmLaw(NamedTuple):
    """Liquid, walls and cavitation of a film."""

    fluid: FilmFluid
    law: FlowLaw
    contact: ContactTable
    roughness: float  # [m]
    boundary_friction: float  # [-]
    cavitation: str
    cavitation_pressure: float  # [Pa]
    accuracy: Accuracy = Accuracy()


def film_law(
    surfaces: RoughSurfaces | None,
    fluid: FilmFluid,
    cavitation: str = "jfo",
    cavitation_pressure: float = 0.0,
) -> FilmLaw:
    """Laws of a film between rough surfaces, or smooth ones for None."""
    if surfaces is None:
        return FilmLaw(fluid, SMOOTH, NO_CONTACT, 0.0, 0.0, cavitation, cavitation_pressure)
    return FilmLaw(
        fluid,
        flow_law(surfaces, 1.0),
        contact_table(surfaces),
        surfaces.roughness,
        surfaces.boundary_friction,
        cavitation,
        cavitation_pressure,
    )


class FaceMotion(NamedTuple):
    """Position and velocity of the upper face: lift [m] and rotations about x and y [rad]."""

    position: Array
    velocity: Array


class FilmBoundary(NamedTuple):
    """What a film meets at one shaft angle."""

    mask: Mask
    node_pressure: Array  # [Pa]
    shaft_speed: float  # [rad/s]
    low_pressure: float  # pressure under which nothing deforms [Pa]


@final
@dataclass(frozen=True)
class FaceFilm:
    """Solved film of one face."""

    grid: FaceGrid
    """Where it is."""
    law: FilmLaw
    """Its laws."""
    boundary: FilmBoundary
    """Its boundaries."""
    solution: CompliantSolution
    """Pressure, film fraction, asperity pressure and linear system."""
    face_motion: FaceMotion
    """Position and velocity of its upper face."""
    compliance: float
    """Local approach of the faces over pressure. [m/Pa]"""

    @property
    def plane(self) -> PlaneSolution:
        """Fields of the film."""
        return self.solution.plane

    @property
    def contact(self) -> Array:
        """Asperity pressure. [Pa]."""
        return self.solution.contact

    @property
    def gap(self) -> Array:
        """Gap height, deformation included. [m]."""
        return self.plane.film.gap.centre

    @property
    def deformation(self) -> Array:
        """Gap above that between undeformed faces. [m]."""
        p = self.grid.points
        return np.asarray(self.gap - _plane(p.x, p.y, self.face_motion.position))

    @property
    def pressure(self) -> Array:
        """Absolute pressure, chambers and grooves included. [Pa]."""
        return self.plane.pressure

    @property
    def total(self) -> Array:
        """Pressure of film, chambers and asperities. [Pa]."""
        return self.plane.pressure + self.contact

    @cached_property
    def covered_load(self) -> Array:
        """Load between body and bearing: lift [N] and rotations [N m] about the own axis."""
        return self.grid.moments(self.total, self.boundary.mask.covered)

    @cached_property
    def open_load(self) -> Array:
        """Load of the chambers on the bearing alone: lift [N] and rotations [N m]."""
        return self.grid.moments(self.pressure, self.boundary.mask.open_face)

    def overstep(self, motion: Array, opening: Array | float) -> float:
        """Step of the gap over the longest that it allows.

        A motion of the upper face [m, rad] and an opening of every cell. [m]
        """
        change = _plane(self.grid.points.x, self.grid.points.y, motion) + opening
        return _overstep(change, self.boundary.mask.film, self.gap, self.law.roughness)

    def coefficients(self, motions: tuple[int, ...]) -> tuple[Array, Array]:
        """Stiffness [N/m] and damping [N s/m] 3x3 of the covered load; zero columns if not asked.

        Minus the derivatives with position and velocity of the upper face.
        """
        places = self.grid.points
        changes = [rigid_change(places, k, rate) for rate in (False, True) for k in motions]
        tables = np.zeros((2, 3, 3))
        for n, total in enumerate(self.pressure_changes(changes)):
            rate, k = divmod(n, len(motions))
            tables[rate, :, motions[k]] = -self.grid.moments(total, self.boundary.mask.film)
        return tables[0], tables[1]

    def rates(self) -> list[GapField]:
        """Motions of the upper face: rates of its lift and rotations."""
        return [rigid_change(self.grid.points, motion, True) for motion in range(3)]

    def pressure_changes(self, changes: Sequence[GapField], accuracy: float = 0.0) -> list[Array]:
        """Change of the pressure of film and asperities with motions of the undeformed gap.

        [Pa per unit] The residual is no smaller than ``accuracy`` of the right-hand side.
        """
        accuracy = max(accuracy, self.law.accuracy.linear)
        if self.solution.found is not None:
            responses = compliant_responses(self.solution, changes, accuracy)
        else:
            responses = self.plane.reduced_responses(changes, accuracy)
        stretch = self.law.fluid.stretch(self.plane.pressure)
        # change of the asperity pressure with an opening of the undeformed gap [Pa/m]
        touch = self.solution.contact_slope * self.solution.gap_slope
        found = []
        for reduced, change in zip(responses, changes, strict=True):
            response = stretch * reduced
            found.append(response + touch * (self.compliance * response + change.centre))
        return found

    @cached_property
    def losses(self) -> FilmLosses:
        """Powers of shear, asperities and flow, and what the boundaries lose."""
        b, fields = self.plane.balance, self.plane.fields
        potential = np.maximum(fields.potential, 0.0)
        speed = self.grid.interface.speed_ratio * self.boundary.shaft_speed
        film, radius = self.boundary.mask.film, self.grid.radius
        height = np.maximum(mean_gap(self.gap, self.law.law), _SHEARED)
        shear = np.where(film, fields.saturation / (self.plane.fluid.fluidity * height), 0.0)
        couette = float((shear * radius**2 * self.grid.area).sum()) * speed**2
        push = float((np.where(film, self.contact, 0.0) * self.grid.area * radius).sum())
        asperity = self.law.boundary_friction * push * abs(speed)
        grid, lowest = self.plane.film.grid, self.plane.film.cavitation_pressure
        drop_x, drop_y = _drops(self.plane.gauge, grid.south - lowest, grid.north - lowest)
        # what drives the flow is the reduced pressure, what it costs is the pressure
        push_x, push_y = _drops(potential, b.south, b.north)
        free = b.mark != PRESCRIBED
        before = np.vstack([free[-1:], free])
        film_x = before | np.vstack([free, free[:1]])
        film_x[-1] = False
        none = np.zeros((free.shape[0], 1), dtype=bool)
        film_y = np.hstack([none, free]) | np.hstack([free, none])
        flow_x, flow_y = (
            np.where(at, flow, 0.0)
            for at, flow in zip((film_x, film_y), self.plane.flows, strict=True)
        )
        total = float((flow_x * drop_x).sum() + (flow_y * drop_y).sum())
        conducted = float((np.where(film_x, b.conductance_x, 0.0) * push_x * drop_x).sum())
        conducted += float((np.where(film_y, b.conductance_y, 0.0) * push_y * drop_y).sum())
        stored = np.where(free, b.storage * fields.saturation, 0.0)
        squeeze = float((stored * self.plane.gauge).sum())
        drag = conducted - total
        return FilmLosses(
            shear=couette + drag,
            drag=drag,
            asperity=asperity,
            pressure=total + squeeze,
            squeeze=squeeze,
            dissipation=couette + conducted,
            bore_flow=-float(flow_y[:, 0].sum()),
        )


class FilmLosses(NamedTuple):
    """Powers of one film [W] and flow into the bore [m3/s]."""

    shear: float  # of the moving face, its drag included
    drag: float  # part of it by the flow that pressure drives along the face
    asperity: float
    pressure: float  # delivered by chambers, grooves, bore and rim
    squeeze: float  # delivered by the film to approaching faces, negative if they approach
    dissipation: float  # of film flow
    bore_flow: float


def _drops(u: Array, south: Array, north: Array) -> tuple[Array, Array]:
    """Drops of a field of a ring over all faces, given what is beyond the second index."""
    drop_x = np.vstack([u[-1:], u]) - np.vstack([u, u[:1]])
    drop_y = np.hstack([south[:, None], u]) - np.hstack([u, north[:, None]])
    return drop_x, drop_y


class FaceDeformation(NamedTuple):
    """How faces deform: a local compliance, and the deformation by distant pressures."""

    local: float  # [m/Pa]
    distant: Array  # [m]
    previous: Array  # deformation at the begin of the step [m]
    frequency: float = 0.0  # inverse of the length of the step, 0 for steady faces [1/s]


def solve_face(
    grid: FaceGrid,
    law: FilmLaw,
    boundary: FilmBoundary,
    face_motion: FaceMotion,
    deformation: FaceDeformation,
    former: FaceFilm | None = None,
) -> FaceFilm:
    """Film at a position and velocity of the upper face.

    Parameters
    ----------
    grid, law, boundary
        Where, of what and between which boundaries.
    face_motion : FaceMotion
        Lift and rotations of the upper face about the own axis, and their rates.
    deformation : FaceDeformation
        How the faces deform.
    former : FaceFilm, optional
        Similar film to begin with.
    """
    p, distant = grid.points, deformation.distant
    centre = _plane(p.x, p.y, face_motion.position)
    along, across = _plane(*p.face_x, face_motion.position), _plane(*p.face_y, face_motion.position)
    rate = _plane(p.x, p.y, face_motion.velocity)
    if deformation.frequency > 0.0:
        rate += deformation.frequency * (distant - deformation.previous)
    rigid = GapField(centre, along, across, rate, np.zeros_like(distant))
    gap = (
        rigid
        if not distant.any()
        else deformed_gap(rigid, distant, np.full_like(along, grid.interface.speed_ratio))
    )
    film = PlaneFilm(
        _film_grid(grid, law, boundary, former),
        gap,
        law.fluid,
        law.cavitation_pressure,
        CAVITATION[law.cavitation],
        law.law,
        points=grid.points,
    )
    density = law.fluid.density(np.full(deformation.distant.shape, law.cavitation_pressure))
    carrier = law.fluid.carrier(density)
    start = former.solution if former is not None else None
    if deformation.local > 0.0:
        reference = boundary.low_pressure - law.cavitation_pressure
        how = LocalCompliance(
            deformation.local,
            reference,
            law.contact,
            law.roughness,
            deformation.frequency,
            law.accuracy,
        )
        start = _stiff(film, carrier, law, None) if start is None else start
        found = solve_compliant(film, carrier, how, start)
        return FaceFilm(grid, law, boundary, found, face_motion, deformation.local)
    return FaceFilm(grid, law, boundary, _stiff(film, carrier, law, start), face_motion, 0.0)


def _film_grid(
    grid: FaceGrid, law: FilmLaw, boundary: FilmBoundary, former: FaceFilm | None
) -> FilmGrid:
    """Grid with its given pressures; that of a former film between the same boundaries."""
    if former is not None:
        old = former.boundary
        same = old.mask is boundary.mask and old.node_pressure is boundary.node_pressure
        if same and old.shaft_speed == boundary.shaft_speed:
            return former.plane.film.grid
    node_pressure = np.maximum(boundary.node_pressure, law.cavitation_pressure)
    return grid.film_grid(boundary.mask, node_pressure, boundary.shaft_speed)


def _stiff(
    film: PlaneFilm, carrier: FluidField, law: FilmLaw, former: CompliantSolution | None
) -> CompliantSolution:
    start = None if former is None else former.plane.fields.kind
    fluid, lowest = law.fluid, law.cavitation_pressure
    grid = fluid.reduced_grid(film.grid)
    balance = film_balance(grid, film.gap, carrier, fluid.reduced_of(lowest), law.law)
    fields = solve_complementarity(balance, film.constraint, start)
    status = Status.DONE if fields.converged else Status.NOT_CONVERGED
    gauge = fluid.gauge(np.maximum(fields.potential, 0.0), lowest)
    plane = PlaneSolution(gauge, fluid.fields(gauge + lowest), balance, fields, status, film)
    contact, slope = contact_field(film.gap.centre, max(law.roughness, 1e-12), law.contact)
    known = film.grid.mark == PRESCRIBED
    contact[known], slope[known] = 0.0, 0.0
    return CompliantSolution(plane, contact, slope, np.ones_like(contact), fields.kind)


@njit(nogil=True)
def _overstep(change: Array, film: BoolArray, gap: Array, roughness: float) -> float:
    most = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            if film[i, j]:
                h = max(gap[i, j], 0.0)
                room = (1.0 - _SHRINK) * h + _OVERLAP * roughness
                if change[i, j] > 0.0:
                    room = (_GROWTH - 1.0) * h + max(roughness, 1e-7)
                most = max(most, abs(change[i, j]) / max(room, 1e-300))
    return most


def _plane(x: Array, y: Array, motion: Array) -> Array:
    """Heights of a plane with a lift and rotations about x and y. [m]."""
    out = np.empty(x.shape)
    fill_plane(x, y, motion, out)
    return out


@njit(nogil=True)
def fill_plane(x: Array, y: Array, motion: Array, out: Array) -> None:
    """Fill the heights of a plane. [m]."""
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            out[i, j] = motion[0] + motion[1] * y[i, j] - motion[2] * x[i, j]
