"""Machine whose bodies share covers, with solved films on their faces and round the rim."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import IntArray
from toothspace.films.journal.rim_film import rim_paths, sector_family, without_film_force
from toothspace.films.plane.conductance import (
    FaceConductance,
    FaceResolution,
    face_conductance,
    shared_paths,
)
from toothspace.model.description import LumpedLateralFilm, MachineDescription
from toothspace.model.film_faces import FacePlaces, SharedFaces
from toothspace.model.operating_point import OperatingCondition

_RESOLUTION = FaceResolution(rows=48, lanes=56, angles=8)


@final
@dataclass(frozen=True, eq=False)
class CoverFilms:
    """Films before every cover of a machine."""

    films: tuple[FaceConductance, ...]
    """Conductances, supporting areas and drag."""
    places: FacePlaces | None = None
    """Where bodies stand that move between the covers."""
    asperity_torque: Mapping[str, float] = field(default_factory=dict)
    """Mean torque of touching asperities on a body. [N m]"""
    shear_speed: float = 0.0
    """Viscosity times shaft speed of the film's shear. [Pa]"""


def with_shared_films(
    description: MachineDescription, solved: CoverFilms | None = None
) -> MachineDescription:
    """Machine whose films at shared covers and round the rim follow from Reynolds equations.

    Parameters
    ----------
    description : MachineDescription
        Machine with ``shared_faces``.
    solved : CoverFilms, optional
        Films of its covers, if they are known already.

    Returns
    -------
    MachineDescription
        The machine with more chambers: those of the rim film stand in the place of the one in
        closed form. Unequal gaps of the covers enter one path with their cubes, and the drag of
        a body with their inverse.
    """
    faces = description.shared_faces
    assert faces is not None
    solved = solved or solved_covers(description)
    ratios = {body.name: body.speed_ratio for body in description.bodies}
    count = faces.face.sector_phases.size
    kept = [path for path in description.paths if path.name not in faces.replaced]
    covers = tuple(
        replace(
            cover,
            recesses=_moved_up(cover.recesses, faces, count),
            inner_node=cover.inner_node + count - 1,
        )
        for cover in faces.covers
    )
    moved = replace(faces, covers=covers)
    height = float(np.mean([cover.gap**3 for cover in faces.covers]) ** (1.0 / 3.0))
    sectors = faces.rim.chamber + np.arange(count)
    return replace(
        description,
        families=(*faces.families, sector_family(description, faces)),
        paths=(
            *(
                replace(
                    path,
                    nodes_a=_moved_up(path.nodes_a, faces, count),
                    nodes_b=_moved_up(path.nodes_b, faces, count),
                )
                for path in kept
            ),
            *shared_paths(moved, solved.films, height),
            *rim_paths(description, moved, sectors),
        ),
        laterals=tuple(
            _film(film, faces, solved, ratios[film.body]) for film in description.laterals
        ),
        journals=tuple(
            without_film_force(j) if j.body == faces.rim.body else j for j in description.journals
        ),
        shared_faces=None,
        face_places=solved.places,
        rings_on_films=True,
    )


def solved_covers(
    description: MachineDescription,
    condition: OperatingCondition | None = None,
    fluid: FluidLaw | None = None,
) -> CoverFilms:
    """Films before every cover of a machine with ``shared_faces``.

    Parameters
    ----------
    condition, fluid : optional
        Where bodies that move between the covers find their places; without these they stand
        parallel in the gaps of the covers.
    """
    faces = description.shared_faces
    assert faces is not None
    if faces.motion == "none" or condition is None or fluid is None:
        return CoverFilms(tuple(face_conductance(cover, _RESOLUTION) for cover in faces.covers))
    # loaded where bodies float between the covers alone
    from toothspace.floating.between_covers import bodies_between_covers

    pitch = faces.face.chambers.pitch
    turn = pitch * np.arange(_RESOLUTION.angles) / _RESOLUTION.angles
    found = bodies_between_covers(description, condition, fluid, turn)
    films = tuple(
        face_conductance(cover, _RESOLUTION, planes)
        for cover, planes in zip(faces.covers, found.planes, strict=True)
    )
    shear_speed = fluid.dynamic_viscosity * condition.shaft_speed
    return CoverFilms(films, found.places, found.asperity_torque, shear_speed)


def _film(
    film: LumpedLateralFilm, faces: SharedFaces, solved: CoverFilms, ratio: float
) -> LumpedLateralFilm:
    """Film of a body with the drag of both covers; asperities count as shear at this speed."""
    if film.body not in [body.name for body in faces.face.bodies]:
        return film
    body = faces.face.body_number(film.body)
    drag = sum(
        float(found.drag[body]) / cover.gap
        for found, cover in zip(solved.films, faces.covers, strict=True)
    )
    torque = solved.asperity_torque.get(film.body, 0.0)
    touching = torque / (solved.shear_speed * abs(ratio)) if torque > 0.0 else 0.0
    return replace(
        film,
        drag=(drag + touching) / film.faces,
        asperity_share=touching / (drag + touching),
    )


def _moved_up(nodes: IntArray, faces: SharedFaces, count: int) -> IntArray:
    """Nodes after the chamber of the rim, which becomes several."""
    return np.where(nodes > faces.rim.chamber, nodes + count - 1, nodes)
