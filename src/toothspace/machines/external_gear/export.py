"""Gear sections of a machine as CAD or text files."""

from __future__ import annotations

from pathlib import Path

from toothspace.geometry.cad_export import export_gear
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.machines.external_gear.spec import ExternalGearSpec


def export_profiles(spec: ExternalGearSpec, stem: Path, suffix: str) -> list[Path]:
    """Write the sections of both gears, or of one if they are equal; returns their paths.

    Parameters
    ----------
    stem : Path
        Folder and begin of the file names; ``_drive`` and ``_driven`` follow.
    suffix : str
        ``txt``, ``dxf``, ``stl`` or ``step``.

    Raises
    ------
    GeometryError
        If a tooth cannot be built or the format needs a package that is missing.
    """
    gears = {"drive": spec.drive}
    if spec.driven is not spec.drive:
        gears["driven"] = spec.driven
    paths = []
    for name, gear in gears.items():
        path = stem.with_name(f"{stem.name}_{name}.{suffix}")
        tooth = gear.tooth
        profile = generate_profile(tooth) if isinstance(tooth, InvoluteGear) else tooth
        export_gear(profile, path, gear.face_width)
        paths.append(path)
    return paths
