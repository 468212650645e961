"""CAD files are read in a process of their own, with limits on time and memory.

A damaged STEP file can end the library that reads it, and a large file of any kind can take the
machine's memory. The process gets a request as JSON on its standard input and leaves arrays and a
JSON text in a file; nothing in it is executed. STL, DXF and text files of up to 1 MB are read
without it: what they cost is bounded by their size, and starting the process takes longer.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import keep_arrays, load_arrays
from toothspace.core.processes import run_python
from toothspace.core.types import Array
from toothspace.geometry.body_section import BodySection, SectionRequest

TIME_LIMIT = 180.0
"""Longest time for reading a file. [s]"""
MEMORY_LIMIT = 8 * 2**30
"""Largest address space of the process that reads a file. [B]"""
READ_HERE = 2**20
"""Largest size of a file that is read without a process of its own. [B]"""
REFUSED = 2
"""Exit code of the reader for a file that it refuses with a message."""
_READER = """
import runpy
runpy.run_module("toothspace.geometry.reading_process", run_name="__main__")
"""
"""Program of the process that reads."""
_MOST_KEPT = 500
_READING = ("step_import", "cad_import", "limited_reading", "body_section", "tooth_count")
"""Modules that a section follows from."""


def read_sections(path: Path, unit: float, request: SectionRequest) -> list[BodySection]:
    """Sections of a solid file by a process of its own; see ``cad_import.load_body_sections``."""
    archive = _kept(path, {"unit": unit, "request": asdict(request)})
    found = []
    for number, given in enumerate(json.loads(str(archive["table"]))):
        # JSON makes lists of ranges
        row: dict[str, Any] = {
            name: tuple(x) if isinstance(x, list) else x for name, x in given.items()
        }
        row["axis"] = np.array(row["axis"])
        row["curves"] = [archive[f"curve_{number}_{k}"] for k in range(row["curves"])]
        row["second"] = [archive[f"second_{number}_{k}"] for k in range(row["second"])]
        found.append(BodySection(**row))
    return found


def read_curves(path: Path, unit: float, layer: str | None) -> list[Array]:
    """Curves [m] of a plane file by its own process; see ``cad_import.load_closed_curves``."""
    found = _kept(path, {"unit": unit, "layer": layer})
    return [found[f"curve_{k}"] for k in range(len(found))]


def _kept(path: Path, order: dict[str, Any]) -> Mapping[str, Any]:
    # by content, so that commands and workers read a file once
    from toothspace.core.compiled import cache_root

    digest = hashlib.sha256(path.read_bytes() + json.dumps([path.suffix.lower(), order]).encode())
    for module in _READING:
        digest.update((Path(__file__).parent / f"{module}.py").read_bytes())
    place = cache_root() / "sections" / f"{digest.hexdigest()[:32]}.npz"
    known = load_arrays(place)
    if known is None:
        known = read_in_process(path, order)
        keep_arrays(place, known, _MOST_KEPT)
    return known


def read_in_process(path: Path, order: Mapping[str, Any]) -> dict[str, Any]:
    """What the process finds in a file, as arrays by name, read anew.

    Raises GeometryError for what the reader refuses, and where it fails or takes too long.

    Parameters
    ----------
    order : mapping
        ``unit`` [m], and ``request`` of a solid file or ``layer`` of a plane one.
    """
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "found.npz"
        whole = {"file": str(path.resolve()), "target": str(target), **order}
        try:
            done = run_python(_READER, given=json.dumps(whole), longest=TIME_LIMIT)
        except subprocess.TimeoutExpired as error:
            found = f"a {_format(path)} file that takes more than {TIME_LIMIT:g} s to read"
            raise GeometryError(path, found, "a smaller one") from error
        if done.returncode == REFUSED:
            text = done.stdout.strip().splitlines()[-1]
            raise GeometryError(text.replace(str(path.resolve()), str(path)))
        if done.returncode != 0 or not target.is_file():
            signal = -done.returncode
            ending = f"was ended by signal {signal}" if signal > 0 else "failed"
            raise GeometryError(
                path, f"a damaged {_format(path)} file (its reader {ending})", "a complete one"
            )
        with np.load(target, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}


def _format(path: Path) -> str:
    name = path.suffix.lstrip(".").upper()
    return "STEP" if name == "STP" else name


def packed(sections: list[BodySection]) -> dict[str, Any]:
    """Sections as arrays by name, to be left in a file."""
    arrays: dict[str, Any] = {}
    table = []
    for number, found in enumerate(sections):
        row = {field.name: getattr(found, field.name) for field in fields(found)}
        curves, second, axis = row.pop("curves"), row.pop("second"), row.pop("axis")
        counts = {"curves": len(curves), "second": len(second)}
        table.append({**row, "axis": axis.tolist(), **counts})
        for name, group in (("curve", curves), ("second", second)):
            arrays |= {f"{name}_{number}_{place}": curve for place, curve in enumerate(group)}
    return {"table": np.array(json.dumps(table)), **arrays}
