"""Volume between two contacts of the gears."""

from __future__ import annotations

import numpy as np

from toothspace.gearing.meshing import contact_range
from toothspace.gearing.spaces import Spaces, section_areas
from toothspace.machines.external_gear.assembly import Assembly


def trapped_volumes(assembly: Assembly, spaces: tuple[Spaces, Spaces]) -> tuple[float, float]:
    """Volume between two consecutive loaded contacts when the second one begins, and its minimum.

    Returns
    -------
    tuple of float
        Trapped volume and dead volume, which the mesh carries back. [m3]
    """
    drive, driven = spaces
    mesh, width = assembly.mesh, assembly.face_width
    pitch = 2.0 * mesh.half_pitch
    start, end = contact_range(assembly)
    # throat angle of the contact that lies behind
    behind = np.linspace(start, max(end - pitch, start), 61)
    left = assembly.loaded_is_left
    lag = mesh.turn + 0.5 * assembly.teeth[1].pitch_angle
    place_1 = behind if left else behind + pitch
    place_2 = mesh.ratio * (behind + pitch) - lag
    area = np.interp(place_1, drive.angles, section_areas(drive))
    area += np.interp(place_2, driven.angles, section_areas(driven))
    return float(area[0] * width), float(area.min() * width)
