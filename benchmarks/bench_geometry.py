"""Geometry tables of the 12-tooth motor: 720 angles, 200 points on each tooth."""

from __future__ import annotations

import time
from pathlib import Path

from toothspace import api
from toothspace.machines.external_gear.assembly import POINTS_PER_TOOTH
from toothspace.machines.external_gear.describe import DEFAULT_NODES

CASE = Path(__file__).resolve().parents[1] / "cases" / "egm12_motor.toml"


def main(repeats: int = 3) -> None:
    """Print the time of the first and of the best warm call; each has gears of its own."""
    seconds = []
    for k in range(repeats + 1):
        case = api.load_case(CASE, [f'machine.gears.face_width="{7.5 + 0.001 * (k + 1)} mm"'])
        began = time.perf_counter()
        api.describe(case)
        seconds.append(time.perf_counter() - began)
    print(f"Geometry tables, {DEFAULT_NODES} angles, {POINTS_PER_TOOTH} points per tooth")
    print(f"{'first call':18s}{seconds[0]:9.3f} s")
    print(f"{'warm':18s}{min(seconds[1:]):9.3f} s")
