"""Flow paths of an internal gear machine with crescent over the angle."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import (
    FULL_TURN,
    gap_by_motion,
    relative_radius,
    throat_drag,
    throat_width,
)
from toothspace.gearing.numbering import Numbering
from toothspace.gearing.openings import groove_openings, port_lengths
from toothspace.gearing.spaces import Spaces
from toothspace.machines.crescent.assembly import CrescentAssembly
from toothspace.machines.crescent.filler import cover_recesses, filler_edges, relief_polygons
from toothspace.machines.crescent.loads import BODIES, FACES, MOTIONS
from toothspace.model.description import FlowPath
from toothspace.model.path_category import (
    DRAIN,
    INLET_GROOVE,
    INLET_PORT,
    LATERAL,
    OUTLET_GROOVE,
    OUTLET_PORT,
    PathCategory,
)
from toothspace.numerics.periodic_table import monotone_table, smooth_table

FLANK = PathCategory("flank", "flanks", "#56B4E9", "mesh")
PINION_TIP = PathCategory("pinion_tip", "pinion tips at the filler", "#0072B2", "gap")
RING_TIP = PathCategory("ring_tip", "ring tips at the filler", "#D55E00", "gap")

_TIPS = (PINION_TIP, RING_TIP)
_PORTS = {"inlet": INLET_PORT, "outlet": OUTLET_PORT}
_GROOVES = {"inlet": INLET_GROOVE, "outlet": OUTLET_GROOVE}
_LEAST_LAND = np.deg2rad(0.5)


def flow_paths(
    assembly: CrescentAssembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[FlowPath, ...]:
    """All flow paths of the machine.

    Parameters
    ----------
    assembly : CrescentAssembly
        Gears in mesh.
    numbering : Numbering
        Phases and nodes.
    spaces : tuple of Spaces
        Tooth spaces of both gears at the table nodes.

    Returns
    -------
    tuple of FlowPath
        Flanks, then per gear tips at the filler, ports, recesses, grooves, lateral, drain gaps.
    """
    paths = [
        _flank_path(assembly, numbering, spaces[0].right, leading=True),
        _flank_path(assembly, numbering, spaces[0].left, leading=False),
    ]
    for gear in (0, 1):
        paths.append(tip_path(assembly, numbering, gear, spaces[gear].angles.size))
        paths.extend(_mouth_paths(assembly, numbering, spaces[gear], gear))
        paths.extend(_face_paths(assembly, numbering, spaces[gear], gear))
        paths.append(_lateral_path(assembly, numbering, gear))
        paths.append(_drain_path(assembly, numbering, gear))
    return tuple(paths)


def _flank_path(
    assembly: CrescentAssembly, numbering: Numbering, side: Throats, *, leading: bool
) -> FlowPath:
    met = numbering.met_spaces - (1 if leading else 0)
    radius = relative_radius(side, assembly.spec.pinion.tip_rounding)
    geometry = np.column_stack([side.gap, throat_width(assembly, side), radius])
    return FlowPath(
        name="flank_leading" if leading else "flank_trailing",
        category=FLANK,
        kind="curved_gap",
        nodes_a=numbering.nodes[0],
        nodes_b=numbering.nodes[1][np.mod(met, assembly.counts[1])],
        angle_ratio=1.0,
        phases=numbering.space_phases[0],
        geometry=monotone_table(FULL_TURN, geometry),
        height_by_motion=monotone_table(FULL_TURN, gap_by_motion(assembly, side)),
        drag_speed=monotone_table(FULL_TURN, throat_drag(assembly, side, leading=leading)),
        partner_shift=numbering.partner_shift,
    )


def tip_path(assembly: CrescentAssembly, numbering: Numbering, gear: int, nodes: int) -> FlowPath:
    """Gap between tooth tips and filler, from the space behind to the space ahead.

    A filler in the housing opens and closes the gap as the gear moves; halves that are pressed
    against the teeth follow the gear.
    """
    tooth, own = assembly.teeth[gear], numbering.nodes[gear]
    filler = assembly.spec.filler
    places = -np.pi + FULL_TURN * np.arange(nodes) / nodes
    geometry = np.empty((nodes, 3))
    geometry[:, 0] = (filler.pinion_clearance, filler.ring_clearance)[gear]
    geometry[:, 1] = assembly.face_width * filler_cover(assembly, gear, places)
    geometry[:, 2] = tooth.land_angle * tooth.tip_radius
    speed = assembly.tip_radii[gear] * numbering.ratios[gear]
    follows = filler.compensation == "radial"
    motion = np.zeros((nodes, len(MOTIONS)))
    if not follows:
        sign = 1.0 if gear == 0 else -1.0
        motion[:, 2 * gear] = sign * np.sin(places)
        motion[:, 2 * gear + 1] = -sign * np.cos(places)
    return FlowPath(
        name=f"tip_{BODIES[gear]}",
        category=_TIPS[gear],
        kind="parallel_gap",
        nodes_a=np.roll(own, -1),
        nodes_b=own,
        angle_ratio=numbering.ratios[gear],
        phases=numbering.tooth_phases[gear],
        geometry=monotone_table(FULL_TURN, geometry),
        height_by_motion=smooth_table(FULL_TURN, motion),
        drag_speed=monotone_table(FULL_TURN, np.full(nodes, 0.5 * speed)),
        shear_speed=monotone_table(FULL_TURN, np.full(nodes, speed)),
        throat_speed=speed,
    )


def filler_cover(assembly: CrescentAssembly, gear: int, places: Array) -> Array:
    """Part of a tooth tip that seals against the filler, 0 where it stands before a port.

    It is 1 from the moment the whole land faces the filler until its first corner leaves it.
    """
    half = 0.5 * max(abs(assembly.teeth[gear].land_angle), _LEAST_LAND)
    edges = filler_edges(assembly, gear)
    turned = np.mod(places, FULL_TURN)
    entered = (turned - edges.inlet + half) / (2.0 * half)
    left = (FULL_TURN - edges.outlet - turned + half) / (2.0 * half)
    return _smooth(entered) * _smooth(left)


def _smooth(t: Array) -> Array:
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _mouth_paths(
    assembly: CrescentAssembly, numbering: Numbering, spaces: Spaces, gear: int
) -> list[FlowPath]:
    """Openings of the tooth spaces between mesh and filler, at their tip circle."""
    edges, width = filler_edges(assembly, gear), assembly.face_width
    lengths = port_lengths(spaces, (edges.inlet, edges.outlet))
    found = []
    for port, length in zip(("inlet", "outlet"), lengths, strict=True):
        table = np.column_stack([width * length, 2.0 * width * length / (width + length)])
        name = f"port_{port}_{BODIES[gear]}"
        found.append(_to_port(name, _PORTS[port], port, table, numbering, gear, 1.0))
    return found


def _face_paths(
    assembly: CrescentAssembly, numbering: Numbering, spaces: Spaces, gear: int
) -> list[FlowPath]:
    """Openings of the tooth spaces into recesses and relief grooves of both covers."""
    recesses = groove_openings(spaces, cover_recesses(assembly), assembly.spec.ports.depth)
    found = [
        _to_port(f"recess_{port}_{BODIES[gear]}", _PORTS[port], port, table, numbering, gear, FACES)
        for port, table in recesses.items()
    ]
    grooves = assembly.spec.relief_grooves
    if grooves is None:
        return found
    tables = groove_openings(spaces, relief_polygons(assembly), grooves.depth)
    return found + [
        _to_port(
            f"groove_{port}_{BODIES[gear]}", _GROOVES[port], port, table, numbering, gear, FACES
        )
        for port, table in tables.items()
    ]


def _to_port(
    name: str,
    category: PathCategory,
    port: str,
    table: Array,
    numbering: Numbering,
    gear: int,
    multiplicity: float,
) -> FlowPath:
    own = numbering.nodes[gear]
    return FlowPath(
        name=name,
        category=category,
        kind="orifice",
        nodes_a=own,
        nodes_b=_repeated(numbering.inlet if port == "inlet" else numbering.outlet, own),
        angle_ratio=numbering.ratios[gear],
        phases=numbering.space_phases[gear],
        geometry=monotone_table(FULL_TURN, table),
        multiplicity=multiplicity,
    )


def _radii(assembly: CrescentAssembly, gear: int) -> tuple[float, float]:
    """Tip and root circle of a gear. [m]."""
    root = assembly.pinion.root_radius if gear == 0 else assembly.root_radius
    return assembly.tip_radii[gear], root


def _lateral_path(assembly: CrescentAssembly, numbering: Numbering, gear: int) -> FlowPath:
    """Gaps over the tooth faces, from the space behind to the space ahead."""
    own, count = numbering.nodes[gear], assembly.counts[gear]
    tip, root = _radii(assembly, gear)
    height, middle = abs(tip - root), 0.5 * (tip + root)
    ring = np.pi * abs(tip**2 - root**2) / count
    thickness = (ring - _space_area(assembly, gear)) / height
    row = np.array([assembly.spec.lateral.side_gap, height, thickness])
    speed = middle * numbering.ratios[gear]
    return FlowPath(
        name=f"lateral_{BODIES[gear]}",
        category=LATERAL,
        kind="parallel_gap",
        nodes_a=np.roll(own, -1),
        nodes_b=own,
        angle_ratio=numbering.ratios[gear],
        phases=numbering.tooth_phases[gear],
        geometry=monotone_table(FULL_TURN, np.tile(row, (4, 1))),
        drag_speed=monotone_table(FULL_TURN, np.full(4, 0.5 * speed)),
        multiplicity=FACES,
    )


def _space_area(assembly: CrescentAssembly, gear: int) -> float:
    """Area of a tooth space up to the tip circle, out of mesh. [m2]."""
    if gear == 0:
        return assembly.pinion.tooth_space_area
    x, y = assembly.ring_curve.T
    inside = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    return float(inside - np.pi * assembly.tip_radii[1] ** 2) / assembly.counts[1]


def _drain_path(assembly: CrescentAssembly, numbering: Numbering, gear: int) -> FlowPath:
    """Gaps over the land behind the tooth roots: to the shaft, or to the outside of the ring.

    A ring sector leaks like a parallel gap of its mean radius: width ``2 pi/z r`` and length
    ``r ln(r_o/r_i)``.
    """
    spec, own = assembly.spec, numbering.nodes[gear]
    if gear == 0:
        inner, outer = 0.5 * spec.journal_bearings.diameter, assembly.pinion.root_radius
    else:
        inner, outer = assembly.root_radius, 0.5 * spec.ring.outer_diameter
    middle = 0.5 * (inner + outer)
    width = FULL_TURN / assembly.counts[gear] * middle
    row = np.array([spec.lateral.side_gap, width, middle * np.log(outer / inner)])
    return FlowPath(
        name=f"drain_{BODIES[gear]}",
        category=DRAIN,
        kind="parallel_gap",
        nodes_a=own,
        nodes_b=_repeated(numbering.drain, own),
        angle_ratio=numbering.ratios[gear],
        phases=numbering.space_phases[gear],
        geometry=monotone_table(FULL_TURN, np.tile(row, (4, 1))),
        multiplicity=FACES,
    )


def _repeated(node: int, like: IntArray) -> IntArray:
    return np.full(like.size, node, dtype=np.int64)
