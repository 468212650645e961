"""Journal and lateral films of a machine solved on grids, as in the ``films`` preset.

Bodies that share covers have films on their faces and round the rim.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.errors import CaseError
from toothspace.core.types import Array, IntArray
from toothspace.films.journal.map import solved_journal
from toothspace.films.journal.rim_film import rim_paths, sector_family, without_film_force
from toothspace.films.plane.conductance import (
    LARGEST,
    FaceConductance,
    FaceResolution,
    face_conductance,
    gap_table,
    over_turn,
    shared_paths,
)
from toothspace.model.description import (
    FlowPath,
    LumpedJournalBearing,
    LumpedLateralFilm,
    MachineDescription,
)
from toothspace.model.film_faces import FacePlaces, FilmFace, SharedFaces
from toothspace.model.lumped_films import lateral_face_torque
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import DRAIN, LATERAL, PathCategory
from toothspace.numerics.periodic_table import monotone_table

SOLVED: Mapping[str, str] = {"journal": "reynolds", "lateral": "reynolds"}
"""Films of both interfaces that can be solved for a machine."""
_RESOLUTION = FaceResolution(rows=60, lanes=48, angles=6)
_FULL_TURN = 2.0 * np.pi
_LEAST = 1e-3
"""Smallest shape conductance between chambers, of a path that needs a length. [-]"""
_COVER_RESOLUTION = FaceResolution(rows=48, lanes=56, angles=8)


def with_solved_films(
    description: MachineDescription,
    condition: OperatingCondition | None = None,
    fluid: FluidLaw | None = None,
    models: Mapping[str, str] = SOLVED,
) -> MachineDescription:
    """Machine whose journal and lateral films follow from solved Reynolds equations.

    The same machine with impedance maps of its journal films, and with the conductances of its
    lateral films between chambers, relief grooves and shaft over the angle.

    Raises CaseError if the machine type does not give the outlines of its faces.

    Parameters
    ----------
    description : MachineDescription
        Machine with closed-form films.
    condition, fluid : optional
        Condition and fluid with which bodies that move between covers find their places.
    models : mapping of str to str
        Model of each interface; those with ``reynolds`` are solved, the others stay.

    Notes
    -----
    Rigid faces, parallel but where bodies find their places between covers; the tilt of a given
    face enters the mean cube of the gap as in the closed form. Tip and flank gaps stay closed: a
    parallel or curved gap is the exact solution there.
    """
    if models["lateral"] == "reynolds":
        if description.shared_faces is not None:
            description = with_shared_films(
                description, solved_covers(description, condition, fluid)
            )
        else:
            winding = description.winding
            section = description if winding is None else winding.section
            if not section.known_faces:
                found = "'reynolds' for a machine that gives the outline of none of its faces"
                raise CaseError("run.interfaces.lateral", found, "'closed_form'")
            faces = {film.body: _faces(section, film) for film in section.laterals if film.face}
            each = [face for ends in faces.values() for face in ends]

            def along(path: FlowPath) -> tuple[FlowPath, ...]:
                return (path,) if winding is None else winding.along(path)

            replaced = {
                path.name
                for face in each
                for own in (face.across, face.inwards)
                for path in along(own)
            }
            kept = [path for path in description.paths if path.name not in replaced]
            solved = [new for face in each for own in face.paths() for new in along(own)]
            description = replace(
                description,
                paths=(*kept, *solved),
                laterals=tuple(
                    _dragged(film, faces[film.body]) if film.body in faces else film
                    for film in description.laterals
                ),
            )
    if models["journal"] == "reynolds":
        journals = tuple(_solved(journal) for journal in description.journals)
        description = replace(description, journals=journals)
    return description


def _solved(journal: LumpedJournalBearing) -> LumpedJournalBearing:
    if journal.solved is not None or journal.end_condition == "no_flow":
        return journal
    rough = journal.roughness > 0.0
    ratio = journal.radial_clearance / journal.roughness if rough else np.inf
    slenderness = round(journal.length / journal.diameter, 9)
    solved = solved_journal(slenderness, round(float(ratio), 3))
    return replace(journal, solved=solved)


class _Face:
    """Faces of one body with their solved conductances, in the section of its middle.

    Both of them, or that at one end of the teeth: 1 of the one that leads, -1 of the one that lags.
    """

    def __init__(self, section: MachineDescription, face: FilmFace, end: float = 0.0) -> None:
        self.face, self._end = face, end
        self.across = _path(section, LATERAL, face.chambers.nodes)
        self.inwards = _path(section, DRAIN, face.chambers.nodes)
        self.height = float(self.inwards.geometry.values[0, 0])
        self.solved = face_conductance(face, _RESOLUTION)

    def paths(self) -> list[FlowPath]:
        """Paths between chambers, from them to recesses and shaft, and from those to the shaft."""
        count = self.face.chambers.nodes.size
        spaces = np.arange(count)
        behind = self._over_turn(self.across, np.roll(spaces, -1), spaces)
        inwards = self._over_turn(self.inwards, spaces, np.full(count, -1))
        # on the nodes of the conductance
        drag_speed, angles = self.across.drag_speed, np.arange(behind.size) * _FULL_TURN
        if drag_speed is not None:
            drag_speed = monotone_table(_FULL_TURN, drag_speed(angles / behind.size))
        conductance = np.clip(behind, _LEAST, LARGEST)
        height, width = self.across.geometry.values[0, :2]
        columns = np.tile([height, width, 0.0], (conductance.size, 1))
        columns[:, 2] = width / conductance
        found = [
            replace(
                self.across,
                geometry=monotone_table(_FULL_TURN, columns),
                drag_speed=drag_speed,
            ),
            replace(self.inwards, geometry=gap_table(self.height, inwards)),
        ]
        for place, node in enumerate(self.face.recesses.tolist(), count):
            shape = self._over_turn(self.inwards, spaces, np.full(count, place))
            from_spaces = replace(
                self.inwards,
                name=f"{self.across.name}_recess_{node}",
                category=LATERAL,
                nodes_b=np.full(count, node),
                geometry=gap_table(self.height, shape),
            )
            over_pitches = np.tile(-self.solved.matrix[:, place, -1], count)
            to_shaft = replace(
                self.inwards,
                name=f"{self.inwards.name}_recess_{node}",
                nodes_a=np.array([node]),
                nodes_b=self.inwards.nodes_b[:1],
                phases=np.zeros(1),
                geometry=gap_table(self.height, over_pitches),
            )
            found += [from_spaces, to_shaft]
        if self._end == 0.0:
            return found
        which = "leading" if self._end > 0.0 else "lagging"
        return [
            replace(own, name=f"{own.name}_{which}", end=self._end, multiplicity=1.0)
            for own in found
        ]

    def _over_turn(self, path: FlowPath, first: IntArray, second: IntArray) -> Array:
        """Conductance between pairs of edges on uniform nodes of the table angle of a path. [-]."""
        values = -self.solved.matrix[:, first, second]
        return over_turn(values, path.phases, self.solved.turn)


def _faces(section: MachineDescription, film: LumpedLateralFilm) -> tuple[_Face, ...]:
    """Faces of a body together, or each where they differ."""
    assert film.face is not None
    if film.lagging_face is None:
        return (_Face(section, film.face.value),)
    ends = (film.face, 1.0), (film.lagging_face, -1.0)
    return tuple(_Face(section, face.value, end) for face, end in ends)


def _dragged(film: LumpedLateralFilm, faces: Sequence[_Face]) -> LumpedLateralFilm:
    """Film with the solved torque; a tilt shears as in the closed form."""
    tilted = lateral_face_torque(film) / lateral_face_torque(replace(film, tilt=0.0))
    drag = sum(face.solved.drag[0] for face in faces) / len(faces)
    return replace(film, drag=drag / film.height * tilted)


def _path(description: MachineDescription, category: PathCategory, nodes: IntArray) -> FlowPath:
    """Closed-form paths of a face: those that begin at its chambers."""
    for path in description.paths:
        if path.category == category and np.isin(path.nodes_a, nodes).all():
            return path
    raise CaseError("run.fidelity", f"'films' without {category.name} paths", "are faces")


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

    The machine with more chambers: those of the rim film stand in the place of the one in closed
    form. Unequal gaps of the covers enter one path with their cubes, and the drag of a body with
    their inverse.

    Parameters
    ----------
    description : MachineDescription
        Machine with ``shared_faces``.
    solved : CoverFilms, optional
        Films of its covers, if they are known already.
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
    laterals = []
    for film in description.laterals:
        if film.body not in [body.name for body in faces.face.bodies]:
            own = film
        else:
            body = faces.face.body_number(film.body)
            drag = sum(
                float(found.drag[body]) / cover.gap
                for found, cover in zip(solved.films, faces.covers, strict=True)
            )
            torque = solved.asperity_torque.get(film.body, 0.0)
            touching = (
                torque / (solved.shear_speed * abs(ratios[film.body])) if torque > 0.0 else 0.0
            )
            own = replace(
                film,
                drag=(drag + touching) / film.faces,
                asperity_share=touching / (drag + touching),
            )
        laterals.append(own)
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
        laterals=tuple(laterals),
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
        return CoverFilms(
            tuple(face_conductance(cover, _COVER_RESOLUTION) for cover in faces.covers)
        )
    # loaded where bodies float between the covers alone
    from toothspace.floating.between_covers import bodies_between_covers

    pitch = faces.face.chambers.pitch
    turn = pitch * np.arange(_COVER_RESOLUTION.angles) / _COVER_RESOLUTION.angles
    found = bodies_between_covers(description, condition, fluid, turn)
    films = tuple(
        face_conductance(cover, _COVER_RESOLUTION, planes)
        for cover, planes in zip(faces.covers, found.planes, strict=True)
    )
    shear_speed = fluid.dynamic_viscosity * condition.shaft_speed
    return CoverFilms(films, found.places, found.asperity_torque, shear_speed)


def _moved_up(nodes: IntArray, faces: SharedFaces, count: int) -> IntArray:
    """Nodes after the chamber of the rim, which becomes several."""
    return np.where(nodes > faces.rim.chamber, nodes + count - 1, nodes)
