"""Films on one face of every body of a machine, at one shaft angle and rigid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.plane.ring import LateralFilm, LateralSolution
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import FILM, FilmFace
from toothspace.model.lateral_load import chamber_pressures
from toothspace.model.operating_point import OperatingCondition


@final
@dataclass(frozen=True, kw_only=True)
class FaceSetting:
    """Where the opposite face stands, and the liquid between."""

    side_gap: float
    """Gap height at the origin of the machine. [m]"""
    fluid: FilmFluid
    """Liquid."""
    tilt: tuple[float, float] = (0.0, 0.0)
    """Rotation of the face about the x and y axis through the origin. [rad]"""
    shaft_angle: float = 0.0
    """Angle of the drive body. [rad]"""
    surfaces: RoughSurfaces | None = None
    """Roughness and contact."""
    cavitation: str = "jfo"
    """Cavitation model."""
    cavitation_pressure: float = 0.0
    """Absolute pressure in the cavity. [Pa]"""
    grid: tuple[int, int] = (256, 64)
    """Cells round each body and along the radius. [-]"""


@final
@dataclass(frozen=True)
class FaceFilms:
    """Solved films, one for each body with an outline."""

    bodies: tuple[str, ...]
    """Names of the bodies."""
    centers: tuple[tuple[float, float], ...]
    """Their axes. [m]"""
    films: tuple[LateralSolution, ...]
    """Films, each about its own axis."""

    @property
    def status(self) -> Status:
        """Of the films; the first that is not done."""
        return min((film.status for film in self.films), key=lambda status: status.succeeded)

    @property
    def outflow(self) -> float:
        """Flow out of all films. [m3/s]."""
        return sum(film.outflow for film in self.films)

    @property
    def dissipated_power(self) -> float:
        """Power that becomes heat in all films. [W]."""
        return sum(film.dissipated_power for film in self.films)

    @property
    def load(self) -> Array:
        """Force along z [N] and moments about x and y through the origin [N m].

        On the face opposite to the bodies, by the absolute pressure on its ring about each body.
        """
        total = np.zeros(3)
        for (x, y), film in zip(self.centers, self.films, strict=True):
            force = film.load
            total += force + force[0] * np.array([0.0, y, -x])
        return total


def solve_faces(
    description: MachineDescription, condition: OperatingCondition, setting: FaceSetting
) -> FaceFilms:
    """Films between the bodies of a machine and one rigid face.

    Parameters
    ----------
    description : MachineDescription
        Machine with outlines of its faces.
    condition : OperatingCondition
        Shaft speed and port pressures; the chambers have the pressures that their paths hold
        at rest.

    Raises
    ------
    CaseError
        If the machine type gives no outlines.
    """
    known = {film.body: film.face for film in description.laterals if film.face is not None}
    if not known:
        raise CaseError("film.kind", "'lateral'", "is 'pad' for this machine type")
    pressure = chamber_pressures(description, condition)(setting.shaft_angle)
    ratios = {body.name: body.speed_ratio for body in description.bodies}
    found = [
        _ring(face, pressure, setting).solve(shaft_speed=ratios[body] * condition.shaft_speed)
        for body, face in known.items()
    ]
    centers = tuple(face.center for face in known.values())
    return FaceFilms(tuple(known), centers, tuple(found))


def _ring(face: FilmFace, pressure: Array, setting: FaceSetting) -> LateralFilm:
    """Film about one body; the gap is fixed to the opposite face while its edges turn."""
    about_x, about_y = setting.tilt
    x, y = face.center
    polar = (np.arange(setting.grid[0]) + 0.5) * 2.0 * np.pi / setting.grid[0]
    rim = np.linspace(face.inner_radius, face.outer_radius, setting.grid[1] + 1)
    places = face.places(polar, 0.5 * (rim[1:] + rim[:-1]))
    node = face.face_map(setting.shaft_angle, *places).node
    return LateralFilm(
        inner_radius=face.inner_radius,
        outer_radius=face.outer_radius,
        side_gap=setting.side_gap + about_x * y - about_y * x,
        fluid=setting.fluid,
        tilt=setting.tilt,
        grid=setting.grid,
        inner_pressure=float(pressure[face.inner_node]),
        given_pressure=np.where(node == FILM, np.nan, pressure[node]),
        surfaces=setting.surfaces,
        cavitation=setting.cavitation,
        cavitation_pressure=setting.cavitation_pressure,
    )
