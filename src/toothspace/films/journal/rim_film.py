r"""Film round the rim of a body as a ring of chambers: the Reynolds equation by finite volumes.

Each sector turns with the body and has a pressure of its own; between neighbours flow

.. math:: Q = -\frac{h^3 L}{12\mu}\frac{\partial p}{R\,\partial\theta}
    - \frac{\omega R}{2} h L, \qquad h = c - \mathbf e \cdot \mathbf n,

and a sector's volume follows the displacement of the body. The fluid of the network makes
gas and vapour where pressure would fall below theirs, and conserves mass there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from toothspace.closures.bearing_map import build_journal_map
from toothspace.core.types import Array, IntArray
from toothspace.model.description import (
    ChamberFamily,
    FlowPath,
    LumpedJournalBearing,
    MachineDescription,
    SolvedJournal,
)
from toothspace.model.film_faces import FilmFace, RimFilm, SharedFaces
from toothspace.model.lumped_films import LONG
from toothspace.model.path_category import RIM
from toothspace.numerics.periodic_table import monotone_table, smooth_table

_FULL_TURN = 2.0 * np.pi
_NODES = 360
_END_SHARE = 6.0
"""Width over the length of the way to one open end, of the parabola of pressure along it."""


def sector_family(description: MachineDescription, faces: SharedFaces) -> ChamberFamily:
    """Chambers of the film, in the place of the one that stands for it in closed form."""
    closed, rim, phases = description.families[-1], faces.rim, faces.face.sector_phases
    angle = _angles(faces.face)
    mean = _FULL_TURN * rim.radius * rim.length * rim.clearance / phases.size
    chord = 2.0 * rim.radius * rim.length * np.sin(np.pi / phases.size)
    return replace(
        closed,
        angle_ratio=faces.face.chambers.angle_ratio,
        phases=phases,
        volume=monotone_table(_FULL_TURN, np.full(angle.size, mean)),
        volume_by_motion=smooth_table(_FULL_TURN, chord * _by_motion(description, rim, angle)),
    )


def rim_paths(
    description: MachineDescription, faces: SharedFaces, nodes: IntArray
) -> tuple[FlowPath, ...]:
    """Flow between neighbouring sectors, and through open ends.

    Parameters
    ----------
    faces : SharedFaces
        What its covers share.
    nodes : ndarray of int
        Nodes of the sectors, in the direction of rotation.
    """
    rim, half = faces.rim, np.pi / nodes.size
    speed = -0.5 * rim.radius * faces.face.chambers.angle_ratio
    row = np.array([rim.clearance, rim.length, 2.0 * half * rim.radius])
    phases = faces.face.sector_phases
    angle = _angles(faces.face)
    round_it = FlowPath(
        name="rim_film",
        category=RIM,
        kind="parallel_gap",
        nodes_a=nodes,
        nodes_b=np.roll(nodes, -1),
        angle_ratio=faces.face.chambers.angle_ratio,
        phases=phases + half,
        geometry=monotone_table(_FULL_TURN, np.tile(row, (angle.size, 1))),
        height_by_motion=smooth_table(_FULL_TURN, _by_motion(description, rim, angle)),
        drag_speed=monotone_table(_FULL_TURN, np.full(angle.size, speed)),
        minimum_height=rim.roughness,
    )
    ends: tuple[FlowPath, ...] = ()
    if rim.open_ends:
        gap = [rim.clearance, _FULL_TURN * rim.radius / nodes.size, rim.length / _END_SHARE]
        count = round_it.geometry.values.shape[0]
        through_ends = replace(
            round_it,
            name="film_end",
            nodes_b=np.full(nodes.size, faces.face.inner_node),
            phases=phases,
            geometry=monotone_table(_FULL_TURN, np.tile(np.array(gap), (count, 1))),
            drag_speed=None,
            multiplicity=2.0,
        )
        ends = (through_ends,)
    return (round_it, *ends)


def without_film_force(journal: LumpedJournalBearing) -> LumpedJournalBearing:
    """Bearing whose film acts through chambers: shear, asperities and clearance stay."""
    zero = np.zeros_like(build_journal_map(LONG).nodes)
    return replace(journal, solved=SolvedJournal(zero, np.ones(2)))


def _angles(face: FilmFace) -> Array:
    return np.asarray(np.arange(_NODES) * _FULL_TURN / _NODES + face.chambers.zero_angle)


def _by_motion(description: MachineDescription, rim: RimFilm, angle: Array) -> Array:
    """Derivative of the gap at polar angles by the motions of the machine."""
    columns = np.zeros((angle.size, len(description.motions)))
    columns[:, description.motion_index(rim.body, "x")] = -np.cos(angle)
    columns[:, description.motion_index(rim.body, "y")] = -np.sin(angle)
    return columns
