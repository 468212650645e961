"""Flow paths of an internal gear machine with crescent over the angle."""

from __future__ import annotations

import numpy as np

from toothspace.closures.smooth import smooth_step
from toothspace.core.types import Array
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.openings import groove_openings
from toothspace.gearing.space_paths import ToothSpaces, flank_paths
from toothspace.gearing.spaces import Spaces
from toothspace.geometry.curve import signed_area
from toothspace.machines.crescent.assembly import (
    CrescentAssembly,
    cover_recesses,
    filler_edges,
    relief_polygons,
)
from toothspace.machines.crescent.gear_bodies import BODIES, MOTIONS
from toothspace.machines.crescent.parameters import NotchParameters
from toothspace.model.description import FlowPath
from toothspace.model.path_category import PathCategory

PINION_TIP = PathCategory("pinion_tip", "pinion tips at the filler", "#0072B2", "gap")
RING_TIP = PathCategory("ring_tip", "ring tips at the filler", "#D55E00", "gap")

_TIPS = (PINION_TIP, RING_TIP)
_LEAST_LAND = np.deg2rad(0.5)


def flow_paths(
    assembly: CrescentAssembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[FlowPath, ...]:
    """All flow paths of the machine.

    Flanks, then per gear tips at the filler, ports, recesses, grooves, lateral, drain gaps.
    """
    spec, grooves = assembly.spec, assembly.grooves
    roughness = spec.pinion.roughness, spec.ring.roughness
    rounding, shaft = spec.pinion.tip_rounding, 0.5 * spec.journal_bearings.diameter
    paths = list(flank_paths(assembly, numbering, spaces[0], rounding, roughness))
    for gear, own in enumerate(tooth_spaces(assembly, numbering, spaces)):
        edges, gap = filler_edges(assembly, gear), spec.lateral.side_gap
        # a filler in the housing opens and closes the gap as the gear moves
        filler, count = spec.filler, own.spaces.angles.size
        places = -np.pi + FULL_TURN * np.arange(count) / count
        clearance = (filler.pinion_clearance, filler.ring_clearance)[gear]
        motion = np.zeros((count, len(MOTIONS)))
        if filler.compensation == "none":
            sign = 1.0 if gear == 0 else -1.0
            motion[:, 2 * gear] = sign * np.sin(places)
            motion[:, 2 * gear + 1] = -sign * np.cos(places)
        cover = filler_cover(assembly, gear, places)
        paths.append(own.tips("tip", _TIPS[gear], clearance, cover, motion, filler.roughness))
        paths.extend(own.port_openings((edges.inlet, edges.outlet)))
        if spec.filler.notch is not None:
            paths.extend(
                own.openings("notch", {"outlet": notch_opening(assembly, own, spec.filler.notch)})
            )
        recesses = groove_openings(own.spaces, cover_recesses(assembly), spec.ports.depth)
        paths.extend(own.openings("recess", recesses))
        if grooves is not None:
            outlines = relief_polygons(assembly)
            paths.extend(
                own.openings("groove", groove_openings(own.spaces, outlines, grooves.depth))
            )
        # area of a space out of mesh; land to the shaft, or to the outside of the ring
        if gear == 0:
            area, land = assembly.pinion.tooth_space_area, (shaft, assembly.pinion.root_radius)
        else:
            tips = np.pi * assembly.tip_radii[1] ** 2
            area = (signed_area(assembly.ring_curve) - tips) / assembly.counts[1]
            land = assembly.root_radius, 0.5 * spec.ring.outer_diameter
        paths += [own.lateral(gap, area), own.drain(gap, land)]
    return tuple(paths)


def tooth_spaces(
    assembly: CrescentAssembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[ToothSpaces, ToothSpaces]:
    """Tooth spaces of pinion and ring as chambers with their paths."""
    pinion, ring = (
        ToothSpaces(assembly, numbering, own, label, assembly.face_width)
        for own, label in zip(spaces, BODIES, strict=True)
    )
    return pinion, ring


def notch_opening(assembly: CrescentAssembly, own: ToothSpaces, notch: NotchParameters) -> Array:
    """Opening of a tooth space to the outlet through the notch in the face of the filler.

    Section of the notch at the leading corner of the space [m2], its hydraulic diameter [m];
    nothing any more once the trailing corner has left the filler, shape (places, 2).

    Parameters
    ----------
    notch : NotchParameters
        Size of the notch. [m]
    """
    tooth, count = own.spaces.own, own.spaces.angles.size
    radius, half = abs(tooth.tip_radius), 0.5 * abs(abs(tooth.pitch_angle) - abs(tooth.land_angle))
    end = FULL_TURN - filler_edges(assembly, own.gear).outlet
    places = np.mod(-np.pi + FULL_TURN * np.arange(count) / count, FULL_TURN)
    reach = np.clip(1.0 + (places + half - end) * radius / notch.length, 0.0, 1.0)
    depth = notch.depth * reach * (1.0 - smooth_step((places - half - end) / half + 1.0))
    return np.column_stack([notch.width * depth, 2.0 * notch.width * depth / (notch.width + depth)])


def filler_cover(assembly: CrescentAssembly, gear: int, places: Array) -> Array:
    """Part of a tooth tip that seals against the filler at places [rad], 0 before a port. [-].

    It is 1 from the moment the whole land faces the filler until its first corner leaves it.
    """
    half = 0.5 * max(abs(assembly.teeth[gear].land_angle), _LEAST_LAND)
    edges = filler_edges(assembly, gear)
    turned = np.mod(places, FULL_TURN)
    entered = (turned - edges.inlet + half) / (2.0 * half)
    left = (FULL_TURN - edges.outlet - turned + half) / (2.0 * half)
    return np.asarray(smooth_step(entered) * smooth_step(left), dtype=float)
