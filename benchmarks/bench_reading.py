"""Reading solids: a gear of 600 000 triangles from STL, a gear and a pump from STEP."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np

from toothspace.geometry import limited_reading
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.cad_export import export_gear
from toothspace.geometry.gear_finder import find_gears
from toothspace.geometry.involute import InvoluteGear, generate_profile

GEAR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3, tip_rounding=1e-4)
WIDTH = 7.5e-3
LAYERS = 125
TARGETS = {"stl": 10.0, "step": 4.0}
"""Aims, from the start of the process that reads on. [s]"""


def main() -> None:
    """Print wall times and the aims."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        triangles = write_fine_stl(folder / "fine.stl")
        export_gear(generate_profile(GEAR), folder / "gear.step", WIDTH)
        print(f"{'file':32s}{'s':>9s}{'aim':>6s}")
        request = SectionRequest(teeth=True)
        seconds = timed(lambda: find_gears(folder / "fine.stl", 1e-3))
        print(f"{f'STL, {triangles} triangles':32s}{seconds:9.2f}{TARGETS['stl']:6.0f}")
        order, path = {"unit": 1e-3, "request": asdict(request)}, folder / "gear.step"
        seconds = timed(lambda: limited_reading.read_in_process(path, order))
        print(f"{'STEP, one gear, with start':32s}{seconds:9.2f}")
        start = timed(start_of_reader)
        print(f"{'the same after start':32s}{seconds - start:9.2f}{TARGETS['step']:6.0f}")


def start_of_reader() -> None:
    """Start a process that loads what reads STEP files, and nothing more."""
    code = "import toothspace.geometry.step_import, OCP.STEPCAFControl, OCP.BRepMesh, scipy.spatial"
    subprocess.run([sys.executable, "-c", code], check=True)


def timed(call: Callable[[], object]) -> float:
    """Wall time of a call. [s]."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def write_fine_stl(path: Path) -> int:
    """Write the gear in many layers; returns the number of its triangles."""
    outline = generate_profile(GEAR, 200).closed_polygon() * 1e3
    count, here = len(outline), np.arange(len(outline))
    ahead = (here + 1) % count
    heights = np.linspace(0.0, WIDTH * 1e3, LAYERS + 1)
    rings = [np.column_stack([outline, np.full(count, height)]) for height in heights]
    corners = np.vstack([*rings, [[0.0, 0.0, 0.0], [0.0, 0.0, heights[-1]]]])
    bottom, top = len(corners) - 2, len(corners) - 1
    faces = [np.column_stack([np.full(count, bottom), ahead, here])]
    for layer in range(LAYERS):
        a, b = layer * count + here, layer * count + ahead
        faces += [np.column_stack([a, b, b + count]), np.column_stack([a, b + count, a + count])]
    last = LAYERS * count
    faces.append(np.column_stack([np.full(count, top), last + here, last + ahead]))
    triangles = corners[np.vstack(faces)].astype("<f4")
    records = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("t", "<f4", (3, 3)), ("a", "<u2")])
    records["t"] = triangles
    path.write_bytes(b" " * 80 + np.uint32(len(triangles)).tobytes() + records.tobytes())
    return len(triangles)
