"""Openings of tooth spaces to ports along the bore and to relief grooves in the faces."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import shapely

from toothspace.core.types import Array
from toothspace.gearing.outlines import space_outlines
from toothspace.gearing.spaces import Spaces, other_end, own_end
from toothspace.gearing.tooth import Tooth
from toothspace.geometry.polygon import enclosed

_LEAST_AREA = 1e-12


def port_lengths(spaces: Spaces, edges: tuple[float, float]) -> tuple[Array, Array]:
    """Length of the port opening of a tooth space at inlet and outlet.

    Parameters
    ----------
    edges : tuple of float
        Angle from the mesh side of the centre line to the edges of inlet and outlet port. [rad]

    Returns
    -------
    tuple of ndarray
        Arc length on the tip circles between lens and port edge, to inlet and outlet. [m]
    """
    (inlet_edge, outlet_edge), tip = edges, abs(spaces.own.tip_radius)
    lens = _lens(spaces, own=True)
    # the left flank of a drive space is on the tooth behind, that of a driven space ahead
    sides = (spaces.left, spaces.right) if spaces.is_drive else (spaces.right, spaces.left)
    near, far = (own_end(spaces, side) for side in sides)
    behind, ahead, last, first = (
        _with_rotation(spaces.own, place)
        for place in (near.corner, far.corner, near.along, far.along)
    )
    turn = 2.0 * np.pi
    inlet = _overlap(np.maximum(first, behind), ahead, lens, inlet_edge)
    inlet += _overlap(behind + turn, ahead + turn, lens, inlet_edge)
    outlet = _overlap(behind, np.minimum(last, ahead), -outlet_edge, -lens)
    outlet += _overlap(behind - turn, ahead - turn, -outlet_edge, -lens)
    beyond_in, beyond_out = _beyond_lens(spaces)
    return tip * inlet + beyond_in, tip * outlet + beyond_out


def _beyond_lens(spaces: Spaces) -> tuple[Array, Array]:
    # a throat that ends on the other gear's tip circle leaves its arc up to the lens to this space
    lens, radius = _lens(spaces, own=False), abs(spaces.other.tip_radius)
    inlet, outlet = np.zeros(spaces.angles.size), np.zeros(spaces.angles.size)
    for side in (spaces.left, spaces.right):
        along = _with_rotation(spaces.other, other_end(spaces, side).along)
        there = side.weight > 0.0
        inlet += np.where(there, np.maximum(along - lens, 0.0), 0.0)
        outlet += np.where(there, np.maximum(-lens - along, 0.0), 0.0)
    return radius * inlet, radius * outlet


def _lens(spaces: Spaces, *, own: bool) -> float:
    return abs(spaces.mesh.lens_drive if spaces.is_drive == own else spaces.mesh.lens_driven)


def _with_rotation(tooth: Tooth, place: Array) -> Array:
    """Place in the sense of rotation: on a ring gear those of the mesh count against it."""
    return np.asarray(np.sign(tooth.tip_radius) * place, dtype=float)


def _overlap(start: Array, end: Array, low: float, high: float) -> Array:
    return np.maximum(np.minimum(end, high) - np.maximum(start, low), 0.0)


def groove_openings(
    spaces: Spaces, polygons: Mapping[str, Array], depth: float
) -> dict[str, Array]:
    r"""Openings of the tooth spaces into the recesses of one face.

    Parameters
    ----------
    polygons : mapping of name to ndarray, shape (n, 2)
        Outlines of the recesses. [m]
    depth : float
        Their depth. [m]

    Returns
    -------
    dict
        For each recess an array of shape (nodes, 2): area [m2] and hydraulic diameter [m].

    Notes
    -----
    Fluid passes the overlap of tooth space and groove along the axis, then the groove's own
    depth sideways; both areas act in series,

    .. math:: A^{-2} = A_o^{-2} + (t\,w)^{-2},

    with the overlap :math:`A_o`, its extent :math:`w` along y and the groove depth :math:`t`.
    The hydraulic diameter is that of the overlap, four times its area over its perimeter.
    """
    if not polygons:
        return {}
    reach = max(_reach(spaces, groove) for groove in polygons.values())
    near = np.flatnonzero(np.abs(spaces.angles) < reach)
    shapes = enclosed(space_outlines(spaces, near))
    found = {}
    for name, groove in polygons.items():
        table = np.zeros((spaces.angles.size, 2))
        overlap = shapely.intersection(shapes, shapely.Polygon(groove))
        bounds = np.nan_to_num(shapely.bounds(overlap))
        there = shapely.area(overlap) > _LEAST_AREA
        area, perimeter = shapely.area(overlap)[there], shapely.length(overlap)[there]
        passage = depth * (bounds[there, 3] - bounds[there, 1])
        series = area * passage / np.hypot(area, passage)
        table[near[there]] = np.column_stack([series, 4.0 * area / perimeter])
        found[name] = table
    return found


def _reach(spaces: Spaces, groove: Array) -> float:
    # largest place of a tooth space that touches the groove
    if shapely.Polygon(groove).buffer(1e-6).contains(shapely.Point(*spaces.center)):
        return float(np.pi)
    x, y = (groove - spaces.center).T
    rise = y if spaces.is_drive or spaces.own.tip_radius < 0.0 else -y
    return float(np.max(np.abs(np.arctan2(x, rise))) + abs(spaces.own.pitch_angle))
