"""STEP files are read in a process of their own, with limits on time and memory.

A damaged STEP file can end the library that reads it. The process gets a request as JSON on its
standard input and leaves arrays and a JSON text in a file; nothing in it is executed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.array_store import keep_arrays, load_arrays
from toothspace.core.errors import GeometryError
from toothspace.geometry.body_section import BodySection, SectionRequest

TIME_LIMIT = 180.0
"""Longest time for reading a STEP file. [s]"""
MEMORY_LIMIT = 8 * 2**30
"""Largest address space of the process that reads a STEP file. [B]"""
_REFUSED = 2
_MOST_KEPT = 500
_CUTTING = ("step_import", "step_process", "body_section", "mesh_section", "chains", "tooth_count")
"""Modules that a section follows from."""


def read_step_sections(path: Path, request: SectionRequest) -> list[BodySection]:
    """Sections of a STEP file by a process of its own; see ``solid_import.step_sections``."""
    if not path.read_bytes()[:64].lstrip().startswith(b"ISO-10303-21"):
        raise GeometryError(f"{path}: found no STEP header, allowed a file of ISO-10303-21")
    kept = _place_of(path, request)
    known = load_arrays(kept)
    if known is None:
        known = read_in_process(path, request)
        keep_arrays(kept, known, _MOST_KEPT)
    return _unpacked(known)


def _place_of(path: Path, request: SectionRequest) -> Path:
    # by content, so that commands and workers cut a file once
    from toothspace.core.compiled import CACHE_FOLDER

    digest = hashlib.sha256(path.read_bytes() + json.dumps(asdict(request)).encode())
    for module in _CUTTING:
        digest.update((Path(__file__).parent / f"{module}.py").read_bytes())
    return CACHE_FOLDER.parent / "sections" / f"{digest.hexdigest()[:32]}.npz"


def read_in_process(path: Path, request: SectionRequest) -> dict[str, Any]:
    """Sections of a STEP file as arrays by name, read anew; see ``solid_import.step_sections``."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "sections.npz"
        order = {"file": str(path.resolve()), "target": str(target), "request": asdict(request)}
        done = _run(path, json.dumps(order))
        if done.returncode == _REFUSED:
            text = done.stdout.strip().splitlines()[-1]
            raise GeometryError(text.replace(str(path.resolve()), str(path)))
        if done.returncode != 0 or not target.is_file():
            signal = -done.returncode
            ending = f"was ended by signal {signal}" if signal > 0 else "failed"
            raise GeometryError(
                f"{path}: found a damaged STEP file (its reader {ending}), allowed a complete one"
            )
        with np.load(target, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}


def _run(path: Path, order: str) -> subprocess.CompletedProcess[str]:
    package = str(Path(__file__).resolve().parents[2])
    search = os.pathsep.join(filter(None, [package, os.environ.get("PYTHONPATH", "")]))
    try:
        return subprocess.run(
            [sys.executable, "-m", "toothspace.geometry.step_process"],
            input=order,
            capture_output=True,
            text=True,
            timeout=TIME_LIMIT,
            env={**os.environ, "PYTHONPATH": search},
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise GeometryError(
            f"{path}: found a STEP file that takes more than {TIME_LIMIT:g} s to read, allowed a "
            f"smaller one"
        ) from error


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


def _unpacked(archive: Mapping[str, Any]) -> list[BodySection]:
    found = []
    for number, row in enumerate(json.loads(str(archive["table"]))):
        teeth, second = row["teeth_extent"], f"second_{number}"
        layer = row["layer"]
        found.append(
            BodySection(
                body=row["body"],
                name=row["name"],
                axis=np.array(row["axis"]),
                height=row["height"],
                extent=(row["extent"][0], row["extent"][1]),
                teeth_extent=None if teeth is None else (teeth[0], teeth[1]),
                curves=[archive[f"curve_{number}_{k}"] for k in range(row["curves"])],
                second_height=row["second_height"],
                second=archive.get(second),
                layer=None if layer is None else (layer[0], layer[1]),
            )
        )
    return found


def _limit_memory() -> None:
    # absent on systems without resource limits
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def main() -> int:
    """Read the request, cut the bodies, leave the result; returns the exit code."""
    _limit_memory()
    order = json.loads(sys.stdin.read())
    path, request = Path(order["file"]), SectionRequest(**order["request"])
    from toothspace.geometry.body_section import cut_bodies
    from toothspace.geometry.step_import import step_bodies

    try:
        sections = cut_bodies(str(path), step_bodies(path), request)
    except GeometryError as error:
        sys.stdout.write(f"\n{error}\n")
        return _REFUSED
    np.savez(order["target"], **_packed(sections))
    return 0


if __name__ == "__main__":
    sys.exit(main())
