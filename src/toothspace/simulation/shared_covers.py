"""Machine whose bodies share covers, with solved films on their faces and round the rim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from toothspace.core.types import IntArray
from toothspace.films.journal.rim_film import rim_paths, sector_family, without_film_force
from toothspace.films.lateral.axial_position import balanced_gaps
from toothspace.films.lateral.conductance import FaceConductance, FaceResolution, face_conductance
from toothspace.films.lateral.shared_paths import shared_paths
from toothspace.model.description import FlowPath, LumpedLateralFilm, MachineDescription
from toothspace.model.film_faces import SharedFaces
from toothspace.model.operating_point import OperatingCondition

_RESOLUTION = FaceResolution(rows=48, lanes=56, angles=8)
_PLACINGS = 2
"""Times that places and films of floating bodies are found in turn: films hardly depend on it."""


def with_shared_films(
    description: MachineDescription, films: tuple[FaceConductance, ...] | None = None
) -> MachineDescription:
    """Machine whose films at shared covers and round the rim follow from Reynolds equations.

    Parameters
    ----------
    description : MachineDescription
        Machine with ``shared_faces``.
    films : tuple of FaceConductance, optional
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
    films = films or solved_covers(description)
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
            *(_renumbered(path, faces, count) for path in kept),
            *shared_paths(moved, films, height),
            *rim_paths(description, moved, sectors),
        ),
        laterals=tuple(_film(film, faces, films) for film in description.laterals),
        journals=tuple(
            without_film_force(j) if j.body == faces.rim.body else j for j in description.journals
        ),
        shared_faces=None,
        rings_on_films=True,
    )


def solved_covers(
    description: MachineDescription, condition: OperatingCondition | None = None
) -> tuple[FaceConductance, ...]:
    """Films before every cover of a machine with ``shared_faces``.

    Parameters
    ----------
    condition : OperatingCondition, optional
        Condition at which bodies that float between the covers find their place.
    """
    faces = description.shared_faces
    assert faces is not None
    films = tuple(face_conductance(cover, _RESOLUTION) for cover in faces.covers)
    if not faces.floating or condition is None:
        return films
    for _ in range(_PLACINGS):
        gaps = balanced_gaps(description, films, condition)
        films = tuple(
            face_conductance(cover, _RESOLUTION, gap)
            for cover, gap in zip(faces.covers, gaps, strict=True)
        )
    return films


def _film(
    film: LumpedLateralFilm, faces: SharedFaces, films: tuple[FaceConductance, ...]
) -> LumpedLateralFilm:
    if film.body not in [body.name for body in faces.face.bodies]:
        return film
    body = faces.face.body_number(film.body)
    drag = [solved.drag[body] / solved.gap[body] for solved in films]
    return replace(film, drag=float(sum(drag)) / film.faces)


def _moved_up(nodes: IntArray, faces: SharedFaces, count: int) -> IntArray:
    """Nodes after the chamber of the rim, which becomes several."""
    return np.where(nodes > faces.rim.chamber, nodes + count - 1, nodes)


def _renumbered(path: FlowPath, faces: SharedFaces, count: int) -> FlowPath:
    nodes_a, nodes_b = (_moved_up(nodes, faces, count) for nodes in (path.nodes_a, path.nodes_b))
    return replace(path, nodes_a=nodes_a, nodes_b=nodes_b)
