"""Draw ``silent_gears.png``: pumps of one displacement, spur, helical and of continuous contact.

Run from the root of the repository: ``PYTHONPATH=. python docs/pictures/silent_gears.py``. Prints
the table of the page: kinematic ripple, and what a run at 120 bar and 1500 rpm finds.
"""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import toothspace as ts
from toothspace.plotting.style import styled

CASE = ts.load_case(Path(__file__).parents[2] / "cases" / "continuous_pump.toml")
WIDTH = 21.682 / 0.6488
"""Width of the 12-tooth gears of ``egm12_pump`` with that displacement. [mm]"""
WHOLE = math.atan(2.0 * math.pi * 16.5 / 12.0 / WIDTH)
"""Helix angle of an overlap of one pitch. [rad]"""


def involute(helix: float, groove: float, backlash: float = 0.11) -> dict[str, object]:
    """Keys of the transverse section of ``egm12_pump`` at a helix angle [rad], lengths in mm."""
    slope, pressure = math.cos(helix), math.radians(20.0)
    normal = math.atan(math.tan(pressure) * slope)
    base = math.cos(math.atan(math.tan(helix) * math.cos(pressure)))
    gears: dict[str, object] = {
        "family": "involute",
        "tooth_count": 12,
        "module": f"{2.75 * slope:.8f} mm",
        "pressure_angle": f"{math.degrees(normal):.8f} deg",
        "profile_shift": 0.30 / slope,
        "dedendum": 1.25 / slope,
        "tool_tip_radius": 0.38 / slope,
        "tip_diameter": "40.372 mm",
        "face_width": f"{WIDTH:.5f} mm",
        "normal_backlash": f"{backlash * base:.6f} mm",
        "helix_angle": f"{math.degrees(helix):.6f} deg",
        "helix_hand": "right" if helix else None,
    }
    grooves = {f"{side}_side_offset": f"{groove} mm" for side in ("closing", "opening")}
    return {f"machine.gears.{k}": v for k, v in gears.items()} | {
        f"machine.relief_grooves.{k}": v for k, v in grooves.items()
    }


HALF = math.atan(0.5 * math.tan(WHOLE))
PUMPS: dict[str, dict[str, object]] = {
    "spur": involute(0.0, 3.4),
    "spur, both flanks": involute(0.0, 1.9, 0.0),
    "helical, overlap 0.5": involute(HALF, 5.0),
    "helical, overlap 1": involute(WHOLE, 6.0),
    "continuous contact": {},
}
SHOWN = ("spur", "spur, both flanks", "helical, overlap 0.5", "continuous contact")


def main() -> None:
    """Solve all pumps, print the table and draw those that serve."""
    solved = {}
    for name, keys in PUMPS.items():
        case = CASE.replace(keys) if keys else CASE
        sealing = "dual" if name == "spur, both flanks" else "single"
        ideal = ts.simulate(case, run__fidelity="ideal", run__flank_sealing=sealing).summary()
        solved[name] = ts.simulate(case)
        found = solved[name].summary()
        numbers = [
            f"{ideal['flow_ripple_percent']:.2f} %",
            f"{found['flow_ripple_percent']:.1f} %",
            f"{found['pressure_ripple_bar']:.2f} bar",
            f"{found['torque_ripple_percent']:.1f} %",
            f"{found['max_chamber_pressure_bar']:.0f} bar",
            f"{found['cavitation_index_W']:.2f} W",
            f"{found['volumetric_efficiency']:.3f}",
            f"{found['hydromechanical_efficiency']:.3f}",
            f"{found.get('axial_force_N') or 0.0:.0f} N",
        ]
        print("| " + " | ".join([name, *numbers]) + " |")
    draw(solved).savefig(Path(__file__).with_name("silent_gears.png"), dpi=130)


@styled
def draw(solved: dict[str, ts.Solution]) -> Figure:
    """Section of the gears of continuous contact, and outlet pressures over two pitches."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 3.8))
    outlines = ts.describe(CASE).outlines
    distance = float(outlines["casing"][:, 1].max() + outlines["casing"][:, 1].min())
    for body, height in (("drive_gear", 0.0), ("driven_gear", distance)):
        x, y = 1e3 * outlines[body].T
        left.fill(x, y + 1e3 * height, alpha=0.35)
        left.plot(np.append(x, x[0]), np.append(y, y[0]) + 1e3 * height, lw=0.8)
    left.plot(*(1e3 * outlines["casing"].T), color="0.4", lw=0.8)
    left.set_aspect("equal")
    left.set_xlabel("x [mm]")
    left.set_ylabel("y [mm]")
    for name in SHOWN:
        data = solved[name].data
        angle = np.rad2deg(data["shaft_angle"].values)
        right.plot(angle - angle[0], 1e-5 * data["outlet_pressure"].values, label=name)
    right.set_xlim(0.0, 80.0)
    right.set_xlabel("shaft angle [deg]")
    right.set_ylabel("outlet pressure [bar]")
    right.legend(fontsize=8)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    main()
