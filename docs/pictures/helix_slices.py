"""Draw ``helix_slices.png``: pressures of a tooth space in slices, and what its number changes.

Run from the root of the repository: ``PYTHONPATH=. python docs/pictures/helix_slices.py``. Prints
the table of the page.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import toothspace as ts
from toothspace.plotting.style import styled

CASE = ts.load_case(Path(__file__).parents[2] / "cases" / "helical_slices.toml")
SLICES = "machine.gears.axial_slices"
MIDDLE = 180.0
"""Place of a space in the middle of the mesh, from that opposite to it. [deg]"""


def main() -> None:
    """Solve the pump with one pressure and with slices, print the table and draw both."""
    solved = {count: ts.simulate(CASE.replace({SLICES: count})) for count in (None, 3, 6)}
    for count, solution in solved.items():
        found = solution.summary()
        numbers = [
            f"{found['flow_ripple_percent']:.1f} %",
            f"{found['max_chamber_pressure_bar']:.0f} bar",
            f"{found['cavitation_index_W']:.0f} W",
            f"{found['volumetric_efficiency']:.3f}",
            f"{found['hydromechanical_efficiency']:.3f}",
            f"{found['axial_force_N']:.0f} N",
        ]
        print("| " + " | ".join([str(count or 1), *numbers]) + " |")
    draw(solved[None], solved[3]).savefig(Path(__file__).with_name("helix_slices.png"), dpi=130)


def over_turn(solution: ts.Solution, chamber: str) -> tuple[np.ndarray, np.ndarray]:
    """Angle of the space from the middle of the mesh [deg] and its pressure [bar]."""
    data = solution.data
    turned = np.rad2deg(data["shaft_angle"].values)
    angle = np.mod(turned - turned[0] + MIDDLE, 360.0) - MIDDLE
    order = np.argsort(angle)
    return angle[order], 1e-5 * data["chamber_pressure"].sel(chamber=chamber).values[order]


@styled
def draw(one: ts.Solution, three: ts.Solution) -> Figure:
    """Pressures while a drive space passes the mesh: closing on the left, opening on the right."""
    figure, panels = plt.subplots(1, 2, figsize=(10.0, 3.8))
    for axes, span, high in zip(panels, ((-30.0, 5.0), (-2.0, 20.0)), (180.0, 5.0), strict=True):
        axes.plot(*over_turn(one, "drive_gear_0"), color="0.2", lw=2.0, label="one pressure")
        for k, end in enumerate(("lower end", "middle", "upper end, leads")):
            chamber = f"drive_gear_slice_{k}_0"
            axes.plot(*over_turn(three, chamber), lw=1.2, label=f"slice at the {end}")
        axes.set_xlim(span)
        axes.set_ylim(0.0, high)
        axes.set_xlabel("shaft angle from the middle of the mesh [deg]")
        axes.set_ylabel("pressure of a drive space [bar]")
    panels[0].set_title("closing")
    panels[1].set_title("opening")
    panels[1].legend(fontsize=8)
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    main()
