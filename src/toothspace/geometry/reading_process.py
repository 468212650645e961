"""The process that reads a CAD file: started by ``limited_reading`` with a request on its input."""

from __future__ import annotations

import contextlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.geometry.body_section import SectionRequest, cut_bodies
from toothspace.geometry.cad_import import STEP_SUFFIXES, plane_curves, stl_bodies
from toothspace.geometry.limited_reading import MEMORY_LIMIT, REFUSED, packed


def main() -> int:
    """Read the request and the file, leave what was found; returns the exit code."""
    # absent on systems without resource limits
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    order = json.loads(sys.stdin.read())
    try:
        path = Path(order["file"])
        if "request" not in order:
            curves = plane_curves(path, order["unit"], order["layer"])
            found: dict[str, Any] = {f"curve_{k}": curve for k, curve in enumerate(curves)}
        else:
            if path.suffix.lower() in STEP_SUFFIXES:
                from toothspace.geometry.step_import import step_bodies

                bodies = step_bodies(path)
            else:
                bodies = stl_bodies(path, order["unit"])
            found = packed(cut_bodies(str(path), bodies, SectionRequest(**order["request"])))
    except GeometryError as error:
        sys.stdout.write(f"\n{error}\n")
        return REFUSED
    np.savez(order["target"], **found)
    return 0


if __name__ == "__main__":
    sys.exit(main())
