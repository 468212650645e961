"""Flow paths of a gerotor machine over the place of its lobes and pockets.

Pocket k stands at the place ``2 pi k / z2`` at shaft angle zero; lobe k is between the pockets k
and k + 1, which is ahead of it. After the pockets comes the film round the outer rotor.
"""

from __future__ import annotations

import numpy as np

from toothspace.closures.gap_flow import ring_sector_gap
from toothspace.core.types import Array
from toothspace.gearing.space_paths import ChamberPaths
from toothspace.geometry.curve import signed_area
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.pockets import FULL_TURN, Pockets
from toothspace.machines.gerotor.ports import Timing
from toothspace.model.description import FlowPath
from toothspace.model.machine_parts import PathKind
from toothspace.model.path_category import (
    DRAIN,
    INLET_PORT,
    LATERAL,
    OUTLET_PORT,
    RIM,
    PathCategory,
)
from toothspace.numerics.periodic_table import monotone_table, smooth_table

TIP_GAPS: dict[str, PathKind] = {"parabolic": "curved_gap", "fitted": "fitted_gap"}
"""Kind of the tip paths for every law of a case."""

TIP = PathCategory("tip", "rotor tips", "#0072B2", "gap")

_FACES = 2.0


def flow_paths(
    parameters: GerotorParameters, pocket: Pockets, timing: Timing, motions: tuple[int, ...]
) -> tuple[FlowPath, ...]:
    """All flow paths of the machine.

    Ports, tips, faces of lobes, land to the shaft, rim to the film round the outer rotor.

    Parameters
    ----------
    motions : tuple of int
        Which of the motions (inner x, y; outer x, y, rotation) are in the description.
    """
    housing, count = parameters.housing, pocket.rotors.outer_tooth_count
    ring, gap = _ring(pocket), side_gap(parameters)
    root = float(np.hypot(*pocket.rotors.inner.T).min())
    floor = float(np.hypot(*pocket.rotors.outer.T).max())
    land = ring_sector_gap(shaft_radius(parameters, pocket), root, FULL_TURN / count)
    rim = ring_sector_gap(floor, 0.5 * housing.outer_rotor_diameter, FULL_TURN / count)
    to_drain, to_film = np.array([gap, *land]), np.array([gap, *rim])
    paths = [
        ring.to_node("port_inlet", INLET_PORT, timing.inlet, count + 1, "orifice"),
        ring.to_node("port_outlet", OUTLET_PORT, timing.outlet, count + 2, "orifice"),
        tip_path(parameters, pocket, motions),
        lateral_path(parameters, pocket),
        ring.to_node("drain", DRAIN, to_drain, count + 3, multiplicity=_FACES),
    ]
    if housing.end_condition != "wall":
        paths.append(ring.to_node("rim", RIM, to_film, count, multiplicity=_FACES))
    if housing.end_condition == "pressure":
        # axial ends of the film round the outer rotor, a chamber of its own, to the drain;
        # mean pressure to either end: a quarter of the width is the mean way out
        around, way = np.pi * housing.outer_rotor_diameter, 0.25 * parameters.rotors.face_width
        row = np.array([housing.radial_clearance, around, way])
        film_end = FlowPath(
            name="film_end",
            category=RIM,
            kind="parallel_gap",
            nodes_a=np.array([count]),
            nodes_b=np.array([count + 3]),
            angle_ratio=1.0,
            phases=np.zeros(1),
            geometry=monotone_table(FULL_TURN, np.tile(row, (4, 1))),
            multiplicity=_FACES,
        )
        paths.append(film_end)
    return tuple(paths)


def pocket_phases(pocket: Pockets) -> Array:
    """Places of the pockets at shaft angle zero. [rad]."""
    count = pocket.rotors.outer_tooth_count
    return FULL_TURN * np.arange(count) / count


def lobe_phases(pocket: Pockets) -> Array:
    """Places of the lobes at shaft angle zero. [rad]."""
    return pocket_phases(pocket) + np.pi / pocket.rotors.outer_tooth_count


def _ring(pocket: Pockets) -> ChamberPaths:
    nodes = np.arange(pocket.rotors.outer_tooth_count, dtype=np.int64)
    return ChamberPaths(
        nodes=nodes,
        behind=nodes,
        ahead=np.roll(nodes, -1),
        angle_ratio=pocket.angle_ratio,
        phases=pocket_phases(pocket),
        land_phases=lobe_phases(pocket),
    )


def tip_path(parameters: GerotorParameters, pocket: Pockets, motions: tuple[int, ...]) -> FlowPath:
    """Gap between a lobe and the inner rotor, from the pocket behind to the pocket ahead.

    The walls drag fluid only through what the motion of the rotors opens: the layers in the
    nominal gap are in the bookkeeping of ``pockets``.
    """
    path = pocket.path
    width = np.full(path.place.size, parameters.rotors.face_width)
    return _ring(pocket).over_lands(
        "tip",
        TIP,
        np.column_stack([path.gap, width, path.relative_radius]),
        TIP_GAPS[parameters.rotors.tip_gap_law],
        height_by_motion=smooth_table(FULL_TURN, gap_by_motion(pocket)[:, motions]),
        drag_speed=smooth_table(FULL_TURN, slip_speed(pocket)),
        drags_opening_only=True,
        minimum_height=parameters.rotors.roughness,
    )


def slip_speed(pocket: Pockets) -> Array:
    r"""Mean speed of both walls ahead, relative to the throat, per shaft speed.

    Over the place of the lobe. [m/rad]

    Notes
    -----
    .. math:: \left[\tfrac12(\mathbf u_1 + \mathbf u_2) - \mathbf V_c\right] \cdot \mathbf t

    with the velocity of the throat's middle from its place, and the tangent that leads ahead.
    """
    point, normal, ratio = pocket.path.point, pocket.path.normal, pocket.angle_ratio
    step = pocket.place[1] - pocket.place[0]
    throat = ratio * (np.roll(point, -1, axis=0) - np.roll(point, 1, axis=0)) / (2.0 * step)
    inner = point - pocket.rotors.inner_center
    walls = 0.5 * (_turned_left(inner) + ratio * _turned_left(point))
    # the outer rotor lies beyond the gap: ahead is to the left of the normal
    return np.asarray(np.sum((walls - throat) * _turned_left(normal), axis=1), dtype=float)


def _turned_left(vectors: Array) -> Array:
    return np.column_stack([-vectors[:, 1], vectors[:, 0]])


def gap_by_motion(pocket: Pockets) -> Array:
    """Derivative of the tip gap by x, y of the inner and x, y, rotation of the outer rotor.

    Over the place of the lobe, shape (n, 5). [-], [m/rad]
    """
    normal, (x, y) = pocket.path.normal, pocket.path.point.T
    lever = x * normal[:, 1] - y * normal[:, 0]
    return np.column_stack([-normal, normal, lever])


def side_gap(parameters: GerotorParameters) -> float:
    """Height that lets the same leakage through as the gaps of both faces. [m]."""
    return parameters.lateral.side_gap or parameters.lateral.leakage_height


def shaft_radius(parameters: GerotorParameters, pocket: Pockets) -> float:
    """Radius at which the land of the inner rotor ends; half of its root without a bore. [m]."""
    if parameters.rotors.shaft_diameter is not None:
        return 0.5 * parameters.rotors.shaft_diameter
    return 0.5 * float(np.hypot(*pocket.rotors.inner.T).min())


def lateral_path(parameters: GerotorParameters, pocket: Pockets) -> FlowPath:
    """Gaps over both faces of a lobe, with the part of an inner tooth that backs it.

    A land as long as the lobe is thick in the middle of its height, and as wide as both
    rotors' teeth are high.
    """
    rotors = pocket.rotors
    outer, inner = np.hypot(*rotors.outer.T), np.hypot(*rotors.inner.T)
    height = float(np.ptp(outer))
    ring = np.pi * (outer.max() ** 2 - outer.min() ** 2)
    cavities = signed_area(rotors.outer) - np.pi * outer.min() ** 2
    thickness = (ring - cavities) / (rotors.outer_tooth_count * height)
    row = np.array([side_gap(parameters), height + float(np.ptp(inner)), thickness])
    return _ring(pocket).over_lands("lateral", LATERAL, row, multiplicity=_FACES)
