"""Process that reads one CAD file for :mod:`toothspace.geometry.reading_process` and ends."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.geometry.body_section import BodySection, SectionRequest, cut_bodies
from toothspace.geometry.cad_import import STEP_SUFFIXES, plane_curves
from toothspace.geometry.reading_process import REFUSED

MEMORY_LIMIT = 8 * 2**30
"""Largest address space of the process that reads a file. [B]"""


def main() -> int:
    """Read the request and the file, leave what was found; returns the exit code."""
    _limit_memory()
    order = json.loads(sys.stdin.read())
    try:
        found = _found(Path(order["file"]), order)
    except GeometryError as error:
        sys.stdout.write(f"\n{error}\n")
        return REFUSED
    np.savez(order["target"], **found)
    return 0


def _found(path: Path, order: Mapping[str, Any]) -> dict[str, Any]:
    if "request" not in order:
        curves = plane_curves(path, order["unit"], order["layer"])
        return {f"curve_{k}": curve for k, curve in enumerate(curves)}
    if path.suffix.lower() in STEP_SUFFIXES:
        from toothspace.geometry.step_import import step_bodies

        bodies = step_bodies(path)
    else:
        from toothspace.geometry.solid_import import stl_bodies

        bodies = stl_bodies(path, order["unit"])
    return _packed(cut_bodies(str(path), bodies, SectionRequest(**order["request"])))


def _packed(sections: list[BodySection]) -> dict[str, Any]:
    arrays: dict[str, Any] = {}
    table = []
    for number, found in enumerate(sections):
        table.append(
            {
                "body": found.body,
                "name": found.name,
                "axis": [float(value) for value in found.axis],
                "height": found.height,
                "extent": found.extent,
                "teeth_extent": found.teeth_extent,
                "second_height": found.second_height,
                "layer": found.layer,
                "curves": len(found.curves),
            }
        )
        for place, curve in enumerate(found.curves):
            arrays[f"curve_{number}_{place}"] = curve
        if found.second is not None:
            arrays[f"second_{number}"] = found.second
    return {"table": np.array(json.dumps(table)), **arrays}


def _limit_memory() -> None:
    # absent on systems without resource limits
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    sys.exit(main())
