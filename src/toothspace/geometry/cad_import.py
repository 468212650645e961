"""Curves and bodies of CAD files and text files of points: the suffix chooses the format."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator
from functools import partial
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import reading
from toothspace.core.frozen import Points
from toothspace.core.lazy import package_of_extra
from toothspace.core.types import Array
from toothspace.geometry.body_section import (
    BodySection,
    SectionRequest,
    SolidBody,
    SurfaceMesh,
    cut_bodies,
    merged,
    section,
    separated,
)
from toothspace.geometry.curve import checked_polygon, signed_area, without_repeats
from toothspace.geometry.limited_reading import READ_HERE, read_curves, read_sections

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

    Curves, shape (n, 2), the first point not repeated, largest area first. [m]

    Raises GeometryError for a missing, empty, damaged or unknown file, an open curve or a body that
    is not closed; the message names the file, what was found and what is allowed.

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
    """
    if isinstance(path, Points):
        curves = [unit * np.asarray(path)]
    else:
        path = _present(path)
        with reading(path, "an intact file"):
            if path.suffix.lower() in SOLID_SUFFIXES:
                cuts = solid_sections(path, unit, SectionRequest())
                curves = [curve for cut in cuts for curve in cut.curves]
            elif path.stat().st_size > _LARGE:
                curves = read_curves(path, unit, layer)
            else:
                curves = plane_curves(path, unit, layer)
    clean = [without_repeats(curve) for curve in curves]
    for curve in clean:
        if len(curve) < 3:
            raise GeometryError(
                path, f"a curve of {len(curve)} points", "at least 3 distinct points"
            )
    if not clean:
        raise GeometryError(path, "no curve", "at least one closed curve")
    return sorted(clean, key=lambda curve: -abs(signed_area(curve)))


def load_polygons(path: Path | Points, unit: float) -> list[Array]:
    """Read the closed curves of a DXF or text file as polygons.

    Polygons, counter-clockwise, largest first. [m]

    Raises GeometryError as ``checked_polygon`` and ``load_closed_curves``.

    Parameters
    ----------
    path : Path or Points
        File with suffix ``.dxf``, ``.txt`` or ``.csv``, or points in place of one.
    unit : float
        Length of one unit of the file. [m]
    """
    return [checked_polygon(curve, path.name) for curve in load_closed_curves(path, unit)]


def load_body_sections(path: Path, unit: float, request: SectionRequest) -> list[BodySection]:
    """Cut the bodies of an STL or STEP file.

    One for each body that the plane meets, largest volume first.

    Raises GeometryError as ``load_closed_curves``.

    Parameters
    ----------
    path : Path
        ``.stl``, ``.step`` or ``.stp``.
    unit : float
        Length of one unit of the file; STEP files carry their own. [m]
    """
    with reading(_present(path), "an intact file"):
        return solid_sections(path, unit, request)


def _present(path: Path) -> Path:
    path = Path(path)
    if not path.is_file():
        raise GeometryError(path, "no such file", "a readable file")
    if path.stat().st_size == 0:
        raise GeometryError(path, "an empty file", "at least one closed curve")
    return path


def plane_curves(path: Path, unit: float, layer: str | None) -> list[Array]:
    """Curves [m] of a text or DXF file, read in this process; see ``load_closed_curves``."""
    suffix = path.suffix.lower()
    if suffix in TEXT_SUFFIXES:
        return read_point_file(path, unit)
    if suffix == ".dxf":
        return read_dxf(path, unit, layer)
    raise GeometryError(path, f"the suffix {suffix or 'none'!r}", ", ".join(SUFFIXES))


def chain_closed(pieces: list[Array], tolerance: float, name: str) -> list[Array]:
    """Join open pieces end to end into closed curves.

    Closed curves, the first point not repeated. [m]

    Raises GeometryError if an end has no partner.

    Parameters
    ----------
    pieces : list of ndarray
        Polylines in any order and direction, each shape (n, 2). [m]
    tolerance : float
        Largest distance between ends that belong together. [m]
    name : str
        File name for error messages.
    """
    remaining, closed = list(pieces), []
    while remaining:
        chain = remaining.pop(0)
        while np.hypot(*(chain[-1] - chain[0])) > tolerance or len(chain) < 3:
            end = chain[-1]
            gaps = [
                min((float(np.hypot(*(piece[side] - end))), index, side) for side in (0, -1))
                for index, piece in enumerate(remaining)
            ]
            nearest = min(gaps, default=(np.inf, 0, 0))
            if nearest[0] > tolerance:
                gap = f"{nearest[0] * 1e3:.3g} mm" if gaps else "no further curve"
                raise GeometryError(
                    name,
                    f"an open curve ending at x = {end[0] * 1e3:.5g} mm, "
                    f"y = {end[1] * 1e3:.5g} mm (next end: {gap})",
                    "closed curves",
                )
            piece = remaining.pop(nearest[1])
            chain = np.vstack([chain, (piece if nearest[2] == 0 else piece[::-1])[1:]])
        closed.append(chain[:-1])
    return closed


_COMMENT = ("#", "%", "//", "!")
# column separator and decimal mark, in order of preference
_STYLES = ((r"\s*;\s*", ","), (r"\s*;\s*", "."), (r"\s*,\s*", "."), (r"\s+", "."), (r"\s+", ","))


def read_point_file(path: Path, unit: float) -> list[Array]:
    """Read curves from columns of numbers.

    Curves in the order of the file, shape (n, 2). [m]

    Raises GeometryError for binary files, other encodings, lines that are not numbers and values
    that are not finite.

    Parameters
    ----------
    path : Path
        Text in UTF-8 or Latin-1: two columns x, y or three columns x, y, z, separated by comma,
        semicolon, tab or blanks, decimal point or comma; header lines before the first number;
        an empty line begins a new curve.
    unit : float
        Length of one unit of the file. [m]
    """
    lines = _decoded(path).splitlines()
    # the style in which most lines are numbers
    sample = [line.strip() for line in lines if line.strip()]
    counts = [sum(_numbers(line, *style) is not None for line in sample) for style in _STYLES]
    best = int(np.argmax(counts))
    if counts[best] == 0:
        raise GeometryError(path, "no line with 2 or 3 numbers", "columns x, y or x, y, z")
    separator, mark = _STYLES[best]
    curves: list[list[list[float]]] = [[]]
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if text.startswith(_COMMENT):
            continue
        if not text:
            curves.append([])
            continue
        row = _numbers(text, separator, mark)
        if row is None and any(curves):
            raise GeometryError(path, f"{text[:40]!r} in line {number}", "2 or 3 numbers")
        if row is not None:
            curves[-1].append(row[:2])
    found = [np.asarray(curve) * unit for curve in curves if curve]
    for curve in found:
        finite = np.all(np.isfinite(curve), axis=1)
        if not np.all(finite):
            told = f"a value that is not finite in point {int(np.argmin(finite)) + 1}"
            raise GeometryError(path, told, "finite numbers")
    return found


def _decoded(path: Path) -> str:
    raw = path.read_bytes()
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise GeometryError(path, "text in UTF-16", "UTF-8 or Latin-1")
    control = sum(byte < 9 or 13 < byte < 32 for byte in raw[:4096])
    if control:
        raise GeometryError(path, "a binary file", "text with columns of numbers")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _numbers(text: str, separator: str, mark: str) -> list[float] | None:
    words = [word for word in re.split(separator, text) if word]
    if mark == ",":
        words = [word.replace(",", ".") for word in words]
    if len(words) not in (2, 3):
        return None
    try:
        return [float(word) for word in words]
    except ValueError:
        return None


_CURVES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")
_MOST_ENTITIES, _DEEPEST_BLOCK = 50_000, 10
_RELATIVE_SAGITTA = 1e-6
_RELATIVE_GAP = 1e-5


def read_dxf(path: Path, unit: float, layer: str | None = None) -> list[Array]:
    """Read the closed curves of a drawing's model space.

    Curves, shape (n, 2): closed polylines with bulges, splines, circles, ellipses, and chains of
    lines, arcs and open pieces that meet within 1e-5 of the drawing's size. [m]

    Raises GeometryError for damaged files, open curves, unknown layers and drawings without curves.

    Parameters
    ----------
    unit : float
        Length of one unit of the drawing. [m]
    layer : str or None
        Layer to read; None for all.
    """
    ezdxf = package_of_extra("ezdxf", "cad", f"{path}: found a DXF file")
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError) as error:
        reason = " ".join(str(error).split())
        raise GeometryError(path, f"no readable DXF ({reason})", "DXF") from error
    drawn = list(islice(_drawn(drawing.modelspace()), _MOST_ENTITIES + 1))
    if len(drawn) > _MOST_ENTITIES:
        raise GeometryError(
            path, f"more than {_MOST_ENTITIES} entities", "a drawing of one machine"
        )
    found = [entity for entity, own in drawn if layer in (None, own)]
    entities = [entity for entity in found if entity.dxftype() in _CURVES]
    if not entities:
        kinds = ", ".join(sorted({entity.dxftype() for entity in found})) or "nothing"
        layers = ", ".join(sorted({own for _, own in drawn}))
        raise GeometryError(
            path,
            f"{kinds} on {('all layers' if layer is None else f'layer {layer!r}')} (layers: "
            f"{layers or 'none'})",
            ", ".join(_CURVES),
        )
    from ezdxf import bbox

    extents = bbox.extents(entities, fast=True)
    size = float(extents.size.magnitude) if extents.has_data else 1.0
    pieces = [_flattened(entity, size * _RELATIVE_SAGITTA, path) for entity in entities]
    pieces = [piece * unit for piece in pieces if len(piece) >= 2]
    return chain_closed(pieces, size * _RELATIVE_GAP * unit, str(path))


def _drawn(entities: Iterable[Any], layer: str = "0", depth: int = 0) -> Iterator[tuple[Any, str]]:
    """Entities with those of inserted blocks in their place, and their layers.

    What a block holds on layer 0 lies on the layer that the block is inserted on.
    """
    for entity in entities:
        own = layer if entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() != "INSERT":
            yield entity, own
        elif depth < _DEEPEST_BLOCK:
            for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _drawn(single.virtual_entities(), own, depth + 1)


def _flattened(entity: Any, sagitta: float, path: Path) -> Array:
    if entity.dxftype() in ("LWPOLYLINE", "POLYLINE"):
        # lines and arcs are flattened one by one, so that bulges stay true arcs
        pieces = [_flattened(part, sagitta, path) for part in entity.virtual_entities()]
        pieces = [piece for piece in pieces if np.ptp(piece, axis=0).max() > 0.0]
        if not pieces:
            return np.zeros((0, 2))
        if len(pieces) == 1:
            first_ahead = True
        else:
            ends = pieces[0 + 1][[0, -1]]
            gap_end = np.min(np.hypot(*(ends - pieces[0][-1]).T))
            gap_start = np.min(np.hypot(*(ends - pieces[0][0]).T))
            first_ahead = bool(gap_end <= gap_start)
        joined = [pieces[0] if first_ahead else pieces[0][::-1]]
        for piece in pieces[1:]:
            ahead = np.hypot(*(piece[0] - joined[-1][-1])) <= np.hypot(
                *(piece[-1] - joined[-1][-1])
            )
            joined.append((piece if ahead else piece[::-1])[1:])
        return np.vstack(joined)
    if entity.dxftype() == "LINE":
        vertices = [entity.dxf.start, entity.dxf.end]
    else:
        vertices = list(entity.flattening(sagitta))
    points = np.array([[vertex.x, vertex.y] for vertex in vertices])
    if not np.all(np.isfinite(points)):
        kind = entity.dxftype()
        raise GeometryError(path, f"a {kind} that is not finite", "numbers")
    return points


_MERGE_TOLERANCES = (0.0, 1e-8, 1e-7, 1e-6)
"""Of the size of a file: distance up to which corners of its triangles are one. [-]"""


def solid_sections(path: Path, unit: float, request: SectionRequest) -> list[BodySection]:
    """Cut the bodies of a solid file.

    Sections, largest body first.

    Raises GeometryError for files that cannot be read within the limits of the reading process,
    truncated files, bodies that are not closed, a plane outside the bodies, or if the optional
    package for the format is missing.

    Parameters
    ----------
    path : Path
        STEP, ASCII or binary STL file.
    unit : float
        Length of one unit of an STL file; STEP files carry their own. [m]
    """
    if path.suffix.lower() == ".stl":
        if path.stat().st_size > READ_HERE:
            return read_sections(path, unit, request)
        return cut_bodies(str(path), stl_bodies(path, unit), request)
    try:
        present = find_spec("OCP.STEPControl") is not None
    except (ImportError, ValueError):
        present = False
    if not present:
        raise GeometryError(
            path,
            "a STEP file but not the package that reads it",
            'after pip install "toothspace[cad]"',
        )
    if not path.read_bytes()[:64].lstrip().startswith(b"ISO-10303-21"):
        raise GeometryError(path, "no STEP header", "a file of ISO-10303-21")
    return read_sections(path, unit, request)


def stl_bodies(path: Path, unit: float) -> list[SolidBody]:
    """Bodies of an STL file in a unit [m], read in this process; see ``solid_sections``."""
    return [SolidBody("", m, partial(_simple_section, m)) for m in _closed_meshes(path, unit)]


def _closed_meshes(path: Path, unit: float) -> list[SurfaceMesh]:
    trimesh = package_of_extra("trimesh", "cad", f"{path}: found an STL file")
    raw = path.read_bytes()
    head = raw[:80].lstrip().lower()
    if head.startswith(b"solid") and b"facet" in raw[:2000].lower():
        if b"endsolid" not in raw[-200:].lower():
            raise GeometryError(path, "a truncated ASCII STL", "one with endsolid")
    else:
        if len(raw) < 84:
            raise GeometryError(path, f"{len(raw)} bytes", "a complete STL file")
        facets = struct.unpack("<I", raw[80:84])[0]
        if len(raw) < 84 + 50 * facets or facets == 0:
            raise GeometryError(
                path,
                f"{len(raw)} bytes for {facets} facets (truncated STL)",
                f"{84 + 50 * max(facets, 4)} bytes or more",
            )
    try:
        with np.errstate(all="ignore"):  # numbers that are none are refused below
            loaded = trimesh.load_mesh(path, file_type="stl", process=False)
            triangles = np.asarray(loaded.triangles, dtype=float) * unit
    except Exception as error:
        raise GeometryError(path, f"no readable STL ({error})", "STL") from error
    if len(triangles) == 0 or not np.all(np.isfinite(triangles)):
        raise GeometryError(path, "no finite triangles", "a closed surface")
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    mesh = merged(triangles, _MERGE_TOLERANCES[0] * size)
    for tolerance in _MERGE_TOLERANCES[1:]:
        if mesh.is_closed:
            break
        mesh = merged(triangles, tolerance * size)
    bodies = separated(mesh)
    for number, body in enumerate(bodies):
        if not body.is_closed:
            raise GeometryError(
                path,
                f"an open surface (body {number} of {len(bodies)} is not watertight)",
                "closed bodies",
            )
    return bodies


def _simple_section(mesh: SurfaceMesh, frame: Array, height: float) -> list[Array]:
    import shapely

    # without the points that triangles leave on straight edges
    found = []
    for curve in section(mesh, frame, height):
        size = float(np.ptp(curve, axis=0).max())
        simple = shapely.simplify(shapely.LinearRing(curve), 1e-7 * size)
        found.append(np.asarray(shapely.get_coordinates(simple))[:-1])
    return found
