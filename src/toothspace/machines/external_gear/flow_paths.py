"""Flow paths of an external gear machine over the angle."""

from __future__ import annotations

import numpy as np

from toothspace.closures.gap_flow import (
    equal_leakage_height,
    ring_sector_gap,
    tilted_gap_height,
)
from toothspace.core.types import Array, IntArray
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import (
    gap_by_motion,
    relative_radius,
    throat_drag,
    throat_width,
)
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.openings import groove_openings, port_lengths
from toothspace.gearing.spaces import Spaces
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.casing import bore
from toothspace.machines.external_gear.loads import BODIES, groove_polygons
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
TOOTH_TIP = PathCategory("tooth_tip", "tooth tips", "#0072B2", "gap")

_PORTS = {"inlet": INLET_PORT, "outlet": OUTLET_PORT}
_GROOVES = {"inlet": INLET_GROOVE, "outlet": OUTLET_GROOVE}

GEARS = ("drive", "driven")
MOTIONS = 5


def flow_paths(
    assembly: Assembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[FlowPath, ...]:
    """All flow paths of the machine.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    numbering : Numbering
        Phases and nodes.
    spaces : tuple of Spaces
        Tooth spaces of both gears at the table nodes.

    Returns
    -------
    tuple of FlowPath
        Flanks, then per gear tips, ports, grooves, lateral and drain gaps.
    """
    paths = list(flank_paths(assembly, numbering, spaces[0]))
    for gear in (0, 1):
        paths.append(tip_path(assembly, numbering, gear, spaces[0].angles.size))
        paths.extend(port_paths(assembly, numbering, spaces[gear], gear))
        paths.extend(groove_paths(assembly, numbering, spaces[gear], gear))
        paths.append(lateral_path(assembly, numbering, gear))
        paths.append(drain_path(assembly, numbering, gear))
    return tuple(paths)


def flank_paths(
    assembly: Assembly, numbering: Numbering, spaces: Spaces
) -> tuple[FlowPath, FlowPath]:
    """Throats of the drive spaces: ahead to the last driven space, behind to the next one."""
    return (
        _flank_path(assembly, numbering, spaces.right, leading=True),
        _flank_path(assembly, numbering, spaces.left, leading=False),
    )


def _flank_path(
    assembly: Assembly, numbering: Numbering, side: Throats, *, leading: bool
) -> FlowPath:
    met = numbering.met_spaces - (1 if leading else 0)
    nodes_b = numbering.nodes[1][np.mod(met, assembly.counts[1])]
    rounding = min(assembly.spec.drive.tip_rounding, assembly.spec.driven.tip_rounding)
    radius = relative_radius(side, rounding)
    geometry = np.column_stack([side.gap, throat_width(assembly, side), radius])
    return FlowPath(
        name="flank_leading" if leading else "flank_trailing",
        category=FLANK,
        kind="curved_gap",
        nodes_a=numbering.nodes[0],
        nodes_b=nodes_b,
        angle_ratio=1.0,
        phases=numbering.space_phases[0],
        geometry=monotone_table(FULL_TURN, geometry),
        height_by_motion=monotone_table(FULL_TURN, gap_by_motion(assembly, side)),
        drag_speed=monotone_table(FULL_TURN, throat_drag(assembly, side, leading=leading)),
        partner_shift=numbering.partner_shift,
    )


def tip_path(assembly: Assembly, numbering: Numbering, gear: int, nodes: int) -> FlowPath:
    """Gap between tooth tips and casing bore, from the space behind to the space ahead."""
    tooth, own = assembly.teeth[gear], numbering.nodes[gear]
    places = assembly.node_places(gear, nodes)
    width = (assembly.spec.drive, assembly.spec.driven)[gear].face_width
    geometry = np.empty((places.size, 3))
    geometry[:, 0] = bore(assembly, gear).clearance_at(places)
    geometry[:, 1] = width * bore_cover(assembly, gear, places)
    geometry[:, 2] = tooth.land_angle * tooth.tip_radius
    speed = tooth.tip_radius * numbering.ratios[gear]
    return FlowPath(
        name=f"tooth_tip_{GEARS[gear]}",
        category=TOOTH_TIP,
        kind="parallel_gap",
        nodes_a=np.roll(own, -1),
        nodes_b=own,
        angle_ratio=numbering.ratios[gear],
        phases=numbering.tooth_phases[gear],
        geometry=monotone_table(FULL_TURN, geometry),
        height_by_motion=smooth_table(FULL_TURN, _clearance_by_motion(gear, places)),
        drag_speed=monotone_table(FULL_TURN, np.full(places.size, 0.5 * speed)),
        shear_speed=monotone_table(FULL_TURN, np.full(places.size, speed)),
        throat_speed=speed,
        worn_by=BODIES[gear],
    )


def bore_cover(assembly: Assembly, gear: int, places: Array) -> Array:
    """Part of a tooth tip that seals against the bore, 0 where it stands in a port or the mesh.

    It is 1 from the moment the leading tip corner leaves the inlet until the trailing corner
    reaches the outlet, and rises and falls outside over the angle of the tip land.
    """
    tooth, casing = assembly.teeth[gear], bore(assembly, gear)
    land = max(tooth.land_angle, np.deg2rad(0.5))
    ahead, behind = tooth.left.corner_angle, -tooth.right.corner_angle
    if gear == 1:
        ahead, behind = behind, ahead
    round_bore = np.mod(places, FULL_TURN)
    entered = (round_bore + ahead - casing.inlet_angle) / land + 1.0
    left = (FULL_TURN - casing.outlet_angle - round_bore + behind) / land + 1.0
    return _smooth(entered) * _smooth(left)


def _clearance_by_motion(gear: int, places: Array) -> Array:
    columns = np.zeros((places.size, MOTIONS))
    columns[:, 2 * gear] = np.sin(places)
    columns[:, 2 * gear + 1] = np.cos(places) * (-1.0 if gear == 0 else 1.0)
    return columns


def mouth_lengths(assembly: Assembly, spaces: Spaces) -> dict[str, Array]:
    """Length of the mouth of the tooth spaces of a gear that opens to each port. [m]."""
    casing = bore(assembly, 0 if spaces.is_drive else 1)
    lengths = port_lengths(spaces, (casing.inlet_angle, casing.outlet_angle))
    return dict(zip(("inlet", "outlet"), lengths, strict=True))


def grooves_by_port(assembly: Assembly, spaces: Spaces) -> dict[str, Array]:
    """Openings into the relief groove of each port, as of ``groove_openings``; none without."""
    grooves = assembly.spec.grooves
    if grooves is None:
        return {}
    found = groove_openings(spaces, groove_polygons(assembly), grooves.depth)
    return {name.removeprefix("groove_"): table for name, table in found.items()}


def port_paths(
    assembly: Assembly, numbering: Numbering, spaces: Spaces, gear: int
) -> list[FlowPath]:
    """Openings of the tooth spaces along the bore to inlet and outlet."""
    width = (assembly.spec.drive, assembly.spec.driven)[gear].face_width
    found = []
    for port, length in mouth_lengths(assembly, spaces).items():
        diameter = 2.0 * width * length / (width + length)
        table = np.column_stack([width * length, diameter])
        node = numbering.inlet if port == "inlet" else numbering.outlet
        name = f"port_{port}_{GEARS[gear]}"
        found.append(_to_node(name, _PORTS[port], node, table, (numbering, gear)))
    return found


def groove_paths(
    assembly: Assembly, numbering: Numbering, spaces: Spaces, gear: int
) -> list[FlowPath]:
    """Openings of the tooth spaces into the relief grooves of both faces."""
    found = []
    for port, table in grooves_by_port(assembly, spaces).items():
        node = numbering.inlet if port == "inlet" else numbering.outlet
        label = f"groove_{port}_{GEARS[gear]}"
        found.append(_to_node(label, _GROOVES[port], node, table, (numbering, gear), 2.0))
    return found


def _to_node(
    name: str,
    category: PathCategory,
    node: int,
    table: Array,
    place: tuple[Numbering, int],
    multiplicity: float = 1.0,
) -> FlowPath:
    numbering, gear = place
    own = numbering.nodes[gear]
    return FlowPath(
        name=name,
        category=category,
        kind="orifice",
        nodes_a=own,
        nodes_b=_repeated(node, own),
        angle_ratio=numbering.ratios[gear],
        phases=numbering.space_phases[gear],
        geometry=monotone_table(FULL_TURN, table),
        multiplicity=multiplicity,
    )


def lateral_path(assembly: Assembly, numbering: Numbering, gear: int) -> FlowPath:
    """Gaps over the tooth faces, from the space behind to the space ahead."""
    tooth, profile, own = assembly.teeth[gear], assembly.profiles[gear], numbering.nodes[gear]
    height = profile.tip_radius - profile.root_radius
    middle = 0.5 * (profile.tip_radius + profile.root_radius)
    full = np.pi * (profile.tip_radius**2 - profile.root_radius**2) / tooth.tooth_count
    thickness = (full - profile.tooth_space_area) / height
    row = np.array([side_gap(assembly), height, thickness])
    speed = middle * numbering.ratios[gear]
    return FlowPath(
        name=f"lateral_{GEARS[gear]}",
        category=LATERAL,
        kind="parallel_gap",
        nodes_a=np.roll(own, -1),
        nodes_b=own,
        angle_ratio=numbering.ratios[gear],
        phases=numbering.tooth_phases[gear],
        geometry=monotone_table(FULL_TURN, np.tile(row, (4, 1))),
        drag_speed=monotone_table(FULL_TURN, np.full(4, 0.5 * speed)),
        multiplicity=2.0,
    )


def drain_path(assembly: Assembly, numbering: Numbering, gear: int) -> FlowPath:
    """Gaps over the land between tooth root and shaft, to the drain.

    A ring sector leaks like a parallel gap, :func:`~toothspace.closures.gap_flow.ring_sector_gap`,
    of a height that the tilt raises, :func:`~toothspace.closures.gap_flow.tilted_gap_height`.
    """
    profile, own = assembly.profiles[gear], numbering.nodes[gear]
    inner, outer = 0.5 * assembly.spec.journals.diameter, profile.root_radius
    middle = 0.5 * (inner + outer)
    tilt = assembly.spec.lateral.tilt * middle / profile.tip_radius
    height = tilted_gap_height(side_gap(assembly), tilt)
    row = np.array([height, *ring_sector_gap(inner, outer, FULL_TURN / profile.tooth_count)])
    return FlowPath(
        name=f"drain_{GEARS[gear]}",
        category=DRAIN,
        kind="parallel_gap",
        nodes_a=own,
        nodes_b=_repeated(numbering.drain, own),
        angle_ratio=numbering.ratios[gear],
        phases=numbering.space_phases[gear],
        geometry=monotone_table(FULL_TURN, np.tile(row, (4, 1))),
        multiplicity=2.0,
    )


def side_gap(assembly: Assembly) -> float:
    """Height that lets the same leakage through as the gaps of both faces. [m]."""
    lateral = assembly.spec.lateral
    return float(equal_leakage_height(lateral.side_gap_floating, lateral.side_gap_solid))


def _repeated(node: int, like: IntArray) -> IntArray:
    return np.full(like.size, node, dtype=np.int64)


def _smooth(t: Array) -> Array:
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
