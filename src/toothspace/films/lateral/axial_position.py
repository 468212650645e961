"""Where bodies that float between two covers stand: balance of films and asperities."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from toothspace.closures.contact_rough import asperity_pressure
from toothspace.core.types import Array
from toothspace.films.lateral.conductance import FaceConductance
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import FaceSurfaces
from toothspace.model.lateral_load import chamber_pressures
from toothspace.model.operating_point import OperatingCondition

_NO_FORCE = 1.0
"""Force below which a body counts as balanced: friction of the numbers. [N]"""
_LEAST = 0.05
"""Least gap in units of the roughness. [-]"""


def balanced_gaps(
    description: MachineDescription,
    films: tuple[FaceConductance, ...],
    condition: OperatingCondition,
) -> Array:
    """Gaps of all bodies before both covers, with the play of the covers' gaps together.

    Parameters
    ----------
    description : MachineDescription
        Machine with floating ``shared_faces`` and two covers, the lower z first.
    films : tuple of FaceConductance
        Films before both covers.
    condition : OperatingCondition
        Port pressures; chambers have those of their paths at rest.

    Returns
    -------
    ndarray, shape (covers, bodies)
        Gaps. [m]

    Notes
    -----
    The film between parallel faces pushes alike at any height, so the mean force over a pitch
    finds no balance but at the asperities of the farther cover; without a force the body stands
    in the middle. Squeeze lets it move some micrometres a second: its place is that of the mean.
    """
    faces = description.shared_faces
    assert faces is not None
    surfaces = faces.face.surfaces
    assert surfaces is not None
    play = sum(cover.gap for cover in faces.covers)
    force = axial_forces(description, films, condition)
    area = [film.area.sum(axis=2).mean(axis=0) for film in films]
    first = [
        _lower_gap(float(force[b]), float(area[0][b]), play, surfaces) for b in range(force.size)
    ]
    return np.array([first, [play - gap for gap in first]])


def axial_forces(
    description: MachineDescription,
    films: tuple[FaceConductance, ...],
    condition: OperatingCondition,
) -> Array:
    """Mean force of both films on every body towards higher z. [N]."""
    faces = description.shared_faces
    assert faces is not None
    (lower, higher), face = films, faces.face
    pressures = chamber_pressures(description, condition)
    total = np.zeros(len(face.bodies))
    for k, turn in enumerate(lower.turn):
        angle = float(turn) / face.chambers.angle_ratio
        nodes = pressures(angle)
        sectors = np.full(face.sector_phases.size, nodes[faces.rim.chamber])
        places = (face.chambers.nodes, face.recesses, [face.inner_node])
        edges = np.concatenate([*(nodes[place] for place in places), sectors])
        total += (lower.area[k] - higher.area[k]) @ edges
    return total / lower.turn.size


def _lower_gap(force: float, area: float, play: float, face: FaceSurfaces) -> float:
    """Gap at the lower cover at which asperities of both sides hold a force towards higher z."""

    def carried(gap: float) -> float:
        return area * float(
            asperity_pressure(
                gap, face.roughness, face.correlation_length, face.effective_modulus, face.hardness
            )
        )

    def balance(gap: float) -> float:
        return force + carried(gap) - carried(play - gap)

    if abs(force) < _NO_FORCE:
        return 0.5 * play
    least = min(_LEAST * face.roughness, 0.25 * play)
    if balance(least) <= 0.0:
        return least
    if balance(play - least) >= 0.0:
        return play - least
    found = brentq(balance, least, play - least, xtol=1e-10)
    return float(found)
