"""Closed curves from CAD files: the format is chosen by the file's suffix."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TypeGuard

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import reading
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.geometry.curve import signed_area, without_repeats

if TYPE_CHECKING:
    from toothspace.geometry.body_section import BodySection, SectionRequest

TEXT_SUFFIXES = (".txt", ".csv", ".dat")
STEP_SUFFIXES = (".step", ".stp")
SOLID_SUFFIXES = (".stl", *STEP_SUFFIXES)
SUFFIXES = (*TEXT_SUFFIXES, ".dxf", *SOLID_SUFFIXES)
_LARGE = 2**20
"""Larger text and DXF files are read in a process of their own, as larger STL files are. [B]"""


def is_solid(source: object) -> TypeGuard[Path]:
    """Whether a section is to be cut from a solid file."""
    return isinstance(source, Path) and source.suffix.lower() in SOLID_SUFFIXES


def load_closed_curves(
    path: Path | Points, unit: float = 1e-3, layer: str | None = None
) -> list[Array]:
    """Read every closed curve of a file, or take the one of given points.

    Parameters
    ----------
    path : Path or Points
        ``.txt``, ``.csv``, ``.dat`` (points), ``.dxf``; ``.stl``, ``.step``, ``.stp`` (section
        across z in the middle of each body, :func:`load_body_sections` cuts elsewhere); or points
        in place of a file.
    unit : float
        Length of one unit of the file; STEP files carry their own. [m]
    layer : str or None
        DXF layer; None for all.

    Returns
    -------
    list of ndarray
        Curves, shape (n, 2), the first point not repeated, largest area first. [m]

    Raises
    ------
    GeometryError
        For a missing, empty, damaged or unknown file, an open curve or a body that is not closed;
        the message names the file, what was found and what is allowed.
    """
    if isinstance(path, Points):
        curves = [unit * np.asarray(path)]
    else:
        path = _present(path)
        with reading(path, "an intact file"):
            curves = _read(path, unit, layer)
    clean = [without_repeats(curve) for curve in curves]
    for curve in clean:
        if len(curve) < 3:
            raise GeometryError(
                path, f"a curve of {len(curve)} points", "at least 3 distinct points"
            )
    if not clean:
        raise GeometryError(path, "no curve", "at least one closed curve")
    return sorted(clean, key=lambda curve: -abs(signed_area(curve)))


def load_body_sections(path: Path, unit: float, request: SectionRequest) -> list[BodySection]:
    """Cut the bodies of an STL or STEP file.

    Parameters
    ----------
    path : Path
        ``.stl``, ``.step`` or ``.stp``.
    unit : float
        Length of one unit of the file; STEP files carry their own. [m]

    Returns
    -------
    list of BodySection
        One for each body that the plane meets, largest volume first.

    Raises
    ------
    GeometryError
        As ``load_closed_curves``.
    """
    from toothspace.geometry.solid_import import solid_sections

    with reading(_present(path), "an intact file"):
        return solid_sections(path, unit, request)


def _present(path: Path) -> Path:
    path = Path(path)
    if not path.is_file():
        raise GeometryError(path, "no such file", "a readable file")
    if path.stat().st_size == 0:
        raise GeometryError(path, "an empty file", "at least one closed curve")
    return path


def _read(path: Path, unit: float, layer: str | None) -> list[Array]:
    # heavy readers are imported for the format at hand only
    if path.suffix.lower() in SOLID_SUFFIXES:
        from toothspace.geometry.body_section import SectionRequest
        from toothspace.geometry.solid_import import solid_sections

        cuts = solid_sections(path, unit, SectionRequest())
        return [curve for cut in cuts for curve in cut.curves]
    if path.stat().st_size > _LARGE:
        from toothspace.geometry.limited_reading import read_curves

        return read_curves(path, unit, layer)
    return plane_curves(path, unit, layer)


def plane_curves(path: Path, unit: float, layer: str | None) -> list[Array]:
    """Curves [m] of a text or DXF file, read in this process; see ``load_closed_curves``."""
    suffix = path.suffix.lower()
    if suffix in TEXT_SUFFIXES:
        from toothspace.geometry.point_file import read_point_file

        return read_point_file(path, unit)
    if suffix == ".dxf":
        from toothspace.geometry.dxf_import import read_dxf

        return read_dxf(path, unit, layer)
    raise GeometryError(path, f"the suffix {suffix or 'none'!r}", ", ".join(SUFFIXES))
