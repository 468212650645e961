"""Rotor sections of a machine as CAD or text files, and a first case of rotors in such files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import named_beside
from toothspace.core.units import to_si
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.cad_export import Section, export_section
from toothspace.geometry.cad_import import STEP_SUFFIXES
from toothspace.geometry.curve import polar
from toothspace.machines.gerotor.contact_table import export_contacts, lobe_contacts
from toothspace.machines.gerotor.parameters import GerotorParameters
from toothspace.machines.gerotor.profiles import rotors_from
from toothspace.machines.gerotor.rotor_files import (
    DrawnRotor,
    drawn_eccentricity,
    rotor_pair,
    size_beside,
)
from toothspace.machines.shared_tables import DRAFT, CaseDraft, draft_line

_CIRCLE_POINTS = 360
_RIM = 1.2
"""Outside diameter of the outer rotor over the width across its lobes, where none is drawn. [-]"""


def export_profiles(spec: GerotorParameters, stem: Path, suffix: str) -> list[Path]:
    """Write the sections of both rotors, with their clearance, as in the machine.

    Files written.

    Raises GeometryError if the rotors cannot be built or the format needs a package that is
    missing.

    Parameters
    ----------
    stem : Path
        Folder and begin of the file names; ``_inner`` and ``_outer`` follow.
    suffix : str
        ``txt`` (the toothed curves alone, and ``_contacts`` with the table of lobe contacts),
        ``dxf``, ``stl`` or ``step``.
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


def draft_case(
    files: Sequence[Path], unit: str, _request: SectionRequest, folder: Path
) -> CaseDraft | None:
    """Case file of a gerotor pump with the rotors of CAD files.

    Arguments are those of :func:`toothspace.api.draft_case`.

    What was measured, and what is assumed because files do not hold it; None without rotors.
    """
    for inner_file, outer_file in product(files, repeat=2):
        try:
            inner, outer = rotor_pair(inner_file, outer_file, to_si(1.0, unit))
        except GeometryError:
            continue
        return CaseDraft(_text(inner, outer, unit, folder), 2)
    return None


def _text(inner: DrawnRotor, outer: DrawnRotor, unit: str, folder: Path) -> str:
    files = [rotor.file for rotor in (inner, outer)]
    names = [named_beside(file, folder) for file in files if isinstance(file, Path)]
    bore, rim = size_beside(inner, outside=False), size_beside(outer, outside=True)
    across = 2.0 * float(max(abs(outer.curve - outer.center).max(axis=0)))
    solids = [name for name in names if Path(name).suffix.lower() in STEP_SUFFIXES]
    found = [
        "",
        "[machine.rotors]",
        draft_line("inner_profile", names[0]),
        draft_line("outer_profile", names[1]),
        *([] if len(solids) == 2 else [draft_line("profile_unit", unit)]),
        draft_line("inner_tooth_count", inner.tooth_count),
        _length("eccentricity", drawn_eccentricity(inner, outer), 0.1 * across / inner.tooth_count,
                "give the distance of the rotor centres"),
        _length("face_width", inner.face_width, 10e-3, "plane files have none"),
        draft_line("tip_clearance", "0 um", "taken off in addition to the drawing"),
        *([] if bore is None else [_length("shaft_diameter", bore, bore, "")]),
        "",
        "[machine.housing]",
        _length("outer_rotor_diameter", rim, _RIM * across, "no rim is drawn"),
        draft_line("radial_clearance", "50 um", "assumed"),
        "",
        "[machine.ports]",
        draft_line("timing", "kinematic",
                   "assumed: ports change over at the extremes of the volume"),
    ]  # fmt: skip
    return DRAFT.format(
        files=", ".join(dict.fromkeys(names)), machine="gerotor", found="\n".join(found),
        title=json.dumps(f"Gerotor pump from {Path(names[0]).name}"),
        side_gap="25 um", shaft_speed="2000 rpm", outlet_pressure="20 bar",
    )  # fmt: skip


def _length(name: str, found: float | None, assumed: float, reason: str) -> str:
    if found is not None:
        return draft_line(name, f"{1e3 * found:.6g} mm")
    return draft_line(name, f"{1e3 * assumed:.4g} mm", f"assumed: {reason}")
