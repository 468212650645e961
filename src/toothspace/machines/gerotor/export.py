"""Rotor sections of a machine as CAD or text files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from toothspace.geometry.cad_export import Section, export_section
from toothspace.geometry.curve import polar
from toothspace.machines.gerotor.contact_table import export_contacts, lobe_contacts
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.profiles import rotors_from

_CIRCLE_POINTS = 360


def export_profiles(spec: GerotorParameters, stem: Path, suffix: str) -> list[Path]:
    """Write the sections of both rotors, with their clearance, as in the machine.

    Parameters
    ----------
    stem : Path
        Folder and begin of the file names; ``_inner`` and ``_outer`` follow.
    suffix : str
        ``txt`` (the toothed curves alone, and ``_contacts`` with the table of lobe contacts),
        ``dxf``, ``stl`` or ``step``.

    Returns
    -------
    list of Path
        Files written.

    Raises
    ------
    GeometryError
        If the rotors cannot be built or the format needs a package that is missing.
    """
    rotors = rotors_from(spec.rotors)
    turns = 2.0 * np.pi * np.arange(_CIRCLE_POINTS) / _CIRCLE_POINTS
    shaft, rim = spec.rotors.shaft_diameter, spec.housing.outer_rotor_diameter
    inner, outer = Section(rotors.inner), Section(rotors.outer)
    if suffix != "txt":
        bore = () if shaft is None else (polar(0.5 * shaft, turns),)
        inner = Section(rotors.inner, bore)
        outer = Section(polar(0.5 * rim, turns), (rotors.outer,))
    paths = []
    for name, section in (("inner", inner), ("outer", outer)):
        path = stem.with_name(f"{stem.name}_{name}.{suffix}")
        export_section(section, path, spec.rotors.face_width)
        paths.append(path)
    if suffix == "txt":
        paths.append(stem.with_name(f"{stem.name}_contacts.txt"))
        export_contacts(paths[-1], lobe_contacts(rotors))
    return paths
