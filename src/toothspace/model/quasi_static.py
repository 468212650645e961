"""Pressures that ports and gaps would hold at rest: start values and load directions."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.gap_flow import (
    curved_gap_conductance,
    fitted_gap_conductance,
    parallel_gap_conductance,
)
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition

_OPEN_LENGTH = 1.083e-5
"""Conductance of an opening over its area and the cube root of the displacement. [-]"""

_GAP_LAWS = {
    "curved_gap": curved_gap_conductance,
    "fitted_gap": fitted_gap_conductance,
    "parallel_gap": parallel_gap_conductance,
}
_ANGLES = 24
_ANGLE_STEP = 2.0 * np.pi * 0.381966


def quasi_static_pressures(
    description: MachineDescription, condition: OperatingCondition, shaft_angle: Array | float
) -> Array:
    """Pressures of all chambers when volumes stand still and every path is laminar. [Pa].

    Orifices count as wide open, gaps with their nominal height. The result orders chambers
    between the ports by how well each is sealed from them.

    Parameters
    ----------
    shaft_angle : float or ndarray
        Angles of the shaft. [rad]

    Returns
    -------
    ndarray, shape (..., chambers)
        A row for each angle. [Pa]
    """
    nodes, angle = description.chamber_count + 3, np.asarray(shaft_angle, dtype=float)[..., None]
    matrix = np.zeros((*angle.shape[:-1], nodes, nodes))
    open_length = _OPEN_LENGTH * float(np.cbrt(description.displacement))
    for path in description.paths:
        geometry = path.geometry(path.phases + path.angle_ratio * angle)
        if path.kind == "orifice":
            one = open_length * np.maximum(geometry[..., 0], 0.0)
        else:
            height = np.maximum(geometry[..., 0], path.minimum_height)
            width = np.maximum(geometry[..., 1], 0.0)
            law = _GAP_LAWS[path.kind]
            one = np.asarray(law(height, width, np.maximum(geometry[..., 2], 1e-9), 1.0))
        conductance = path.multiplicity * one
        for ends in (path.nodes_a, path.nodes_b), (path.nodes_b, path.nodes_a):
            cells: Any = (..., *ends)
            np.add.at(matrix, cells, conductance)
    chambers = description.chamber_count
    ports = condition.port_pressures(description.drain)
    inside, outside = matrix[..., :chambers, :chambers], matrix[..., :chambers, chambers:]
    diagonal = (matrix[..., :chambers, :].sum(axis=-1) + 1e-30)[..., None] * np.eye(chambers)
    fed = outside @ ports + 1e-30 * ports.min()
    return np.asarray(np.linalg.solve(diagonal - inside, fed[..., None])[..., 0])


def bush_positions(
    description: MachineDescription,
    condition: OperatingCondition,
    motion_map: Array,
    free: list[int],
) -> dict[str, tuple[float, float]]:
    """Positions of the bearing blocks: at the end of their seat along the mean load. [m].

    A block carries the bearings of all bodies, so that it is their sum that presses it.
    """
    if not free:
        return {}
    force = mean_force(description, condition) @ motion_map
    load, seats = np.zeros(2), {}
    for journal in description.journals:
        places = [description.motion_index(journal.body, axis) for axis in ("x", "y")]
        if places[0] in free:
            load += [force[free.index(place)] for place in places]
            seats[journal.body] = journal.seat_clearance
    size = float(np.hypot(*load))
    x, y = load / size if size > 0.0 else load
    return {body: (clearance * x, clearance * y) for body, clearance in seats.items()}


def mean_force(description: MachineDescription, condition: OperatingCondition) -> Array:
    """Mean generalised force of quasi-static pressures on every micro-motion. [N] or [N m]."""
    shaft_angle = _ANGLE_STEP * np.arange(_ANGLES, dtype=float)
    pressure = quasi_static_pressures(description, condition, shaft_angle)
    total, start = np.zeros(len(description.motions)), 0
    for family in description.families:
        angles = family.phases + family.angle_ratio * shaft_angle[:, None]
        own = pressure[:, start : start + family.count]
        total += np.einsum("ac,acm->m", own, family.volume_by_motion(angles))
        start += family.count
    return total / _ANGLES
