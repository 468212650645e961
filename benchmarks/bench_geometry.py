"""Geometry tables of the 12-tooth motor, and kinematics of many gears without tables."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import toothspace as ts
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
    _designs()


def _designs() -> None:
    rng, case = np.random.default_rng(0), api.load_case(CASE)
    print("Kinematics of gears by closed forms over arrays")
    for count in (1, 100, 10_000, 100_000):
        gears = {
            "machine.gears.tooth_count": rng.integers(9, 19, count),
            "machine.gears.module": rng.uniform(1.8e-3, 3.4e-3, count),
            "machine.gears.profile_shift": rng.uniform(0.0, 0.7, count),
        }
        seconds = []
        for _ in range(3):
            began = time.perf_counter()
            ts.evaluate_designs(case, gears, addendum=1.1)
            seconds.append(time.perf_counter() - began)
        each = min(seconds) / count
        print(f"{count:7d} designs {min(seconds) * 1e3:9.2f} ms {each * 1e6:9.2f} us each")
