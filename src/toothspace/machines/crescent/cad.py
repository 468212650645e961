"""Sections of pinion, ring and filler as CAD or text files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from toothspace.geometry.cad_export import Section, export_gear, export_section
from toothspace.geometry.curve import polar
from toothspace.machines.crescent.assembly import assemble, filler_outline
from toothspace.machines.crescent.parameters import CrescentParameters

_CIRCLE_POINTS = 720


def export_profiles(spec: CrescentParameters, stem: Path, suffix: str) -> list[Path]:
    """Write the sections of both gears and of the filler; returns their paths.

    Raises GeometryError if a gear cannot be built or the format needs a package that is missing.

    Parameters
    ----------
    stem : Path
        Folder and begin of the file names; ``_pinion``, ``_ring`` and ``_filler`` follow.
    suffix : str
        ``txt``, ``dxf``, ``stl`` or ``step``.
    """
    assembly, width = assemble(spec), spec.pinion.face_width
    names = ("pinion", "ring", "filler")
    paths = [stem.with_name(f"{stem.name}_{name}.{suffix}") for name in names]
    export_gear(assembly.pinion, paths[0], width)
    turns = 2.0 * np.pi * np.arange(_CIRCLE_POINTS) / _CIRCLE_POINTS
    circle = polar(0.5 * spec.ring.outer_diameter, turns)
    export_section(Section(circle, (assembly.ring_curve,)), paths[1], width)
    export_section(Section(filler_outline(assembly)), paths[2], width)
    return paths
