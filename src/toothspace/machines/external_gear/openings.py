"""Openings of tooth spaces to ports along the bore and to relief grooves in the faces."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.chambers import Spaces
from toothspace.machines.external_gear.mesh_split import Throats


def port_lengths(assembly: Assembly, spaces: Spaces) -> tuple[Array, Array]:
    """Length of a tooth space's mouth that opens to inlet and outlet.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh and port edges.
    spaces : Spaces
        Tooth spaces of one gear at the table nodes.

    Returns
    -------
    tuple of ndarray
        Arc length on the tip circles between lens and port edge, to inlet and outlet. [m]
    """
    casing, tip = assembly.spec.casing, spaces.own.tip_radius
    lens = _lens(spaces, own=True)
    # the left flank of a drive space is on the tooth behind, that of a driven space ahead
    sides = (spaces.left, spaces.right) if spaces.is_drive else (spaces.right, spaces.left)
    behind, ahead = (_corner(spaces, side) for side in sides)
    last, first = (_along(spaces, side) for side in sides)
    turn = 2.0 * np.pi
    inlet = _overlap(np.maximum(first, behind), ahead, lens, casing.inlet_angle)
    inlet += _overlap(behind + turn, ahead + turn, lens, casing.inlet_angle)
    outlet = _overlap(behind, np.minimum(last, ahead), -casing.outlet_angle, -lens)
    outlet += _overlap(behind - turn, ahead - turn, -casing.outlet_angle, -lens)
    beyond_in, beyond_out = _beyond_lens(spaces)
    return tip * inlet + beyond_in, tip * outlet + beyond_out


def _beyond_lens(spaces: Spaces) -> tuple[Array, Array]:
    # a throat that ends on the other gear's tip circle leaves its arc up to the lens to this space
    lens, radius = _lens(spaces, own=False), spaces.other.tip_radius
    inlet, outlet = np.zeros(spaces.angles.size), np.zeros(spaces.angles.size)
    for side in (spaces.left, spaces.right):
        along = side.driven_along if spaces.is_drive else side.drive_along
        there = side.weight > 0.0
        inlet += np.where(there, np.maximum(along - lens, 0.0), 0.0)
        outlet += np.where(there, np.maximum(-lens - along, 0.0), 0.0)
    return radius * inlet, radius * outlet


def _lens(spaces: Spaces, *, own: bool) -> float:
    return spaces.mesh.lens_drive if spaces.is_drive == own else spaces.mesh.lens_driven


def _corner(spaces: Spaces, side: Throats) -> Array:
    return side.drive_corner if spaces.is_drive else side.driven_corner


def _along(spaces: Spaces, side: Throats) -> Array:
    return side.drive_along if spaces.is_drive else side.driven_along


def _overlap(start: Array, end: Array, low: float, high: float) -> Array:
    return np.maximum(np.minimum(end, high) - np.maximum(start, low), 0.0)


def groove_openings(assembly: Assembly, spaces: Spaces) -> dict[str, Array]:
    """Areas [m2] and hydraulic diameters [m] of the openings into the grooves of one face."""
    return {}
