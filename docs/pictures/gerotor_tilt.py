"""Draw ``gerotor_tilt.png``: films of rotors that lift and tilt between their covers.

Run from the root of the repository: ``PYTHONPATH=. python docs/pictures/gerotor_tilt.py``. Prints
the places, the smallest films and the load on asperities over a pitch.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

from toothspace import api
from toothspace.floating.between_covers import BodiesBetweenCovers, bodies_between_covers
from toothspace.plotting.style import styled
from toothspace.run.condition import condition_of, fluid_of

CASE = Path(__file__).parents[2] / "cases" / "gerotor_cycloidal.toml"
GRID = (126, 20)
RIM = 26e-3
SCALE = LogNorm(1.0, 45.0)
COVERS = {"one": "kidneys in one cover", "both": "recesses opposite"}
OPPOSITE = {"one": "plain side", "both": "recessed side"}


def solved(covers: str) -> BodiesBetweenCovers:
    """Rotors at the condition of the case, with kidneys in one cover or both."""
    given = (
        "machine.lateral.position=free",
        "machine.lateral.side_gap=20 um",
        "machine.rotors.tip_clearance=40 um",
        f"machine.ports.covers={covers}",
    )
    case = api.load_case(CASE, given)
    machine = api.describe(case)
    assert machine.shared_faces is not None
    turn = machine.shared_faces.face.chambers.pitch * np.arange(8) / 8
    condition = condition_of(case, machine)
    return bodies_between_covers(machine, condition, fluid_of(case), turn, GRID)


def report(found: BodiesBetweenCovers) -> None:
    """Print lift and tilt over the pitch, smallest films and the load on asperities."""
    places = found.places.at(np.linspace(0.0, found.places.places.period, 9)[:-1])
    for k, body in enumerate(found.places.bodies):
        lift, about_x, about_y, least = places[:, k].T * 1e6
        tilt = np.hypot(about_x, about_y)
        print(
            f"  {body}: lift {lift.min():.2f} to {lift.max():.2f} um, tilt {tilt.min():.1f} to "
            f"{tilt.max():.1f} urad ({RIM * tilt.max():.2f} um at 26 mm), smallest film "
            f"{least.min():.2f} to {least.max():.2f} um, asperity torque "
            f"{found.asperity_torque[body]:.4f} N m"
        )
    for film in found.last.films:
        touch, lost = float((film.contact * film.grid.area).sum()), film.losses
        print(
            f"  {film.grid.interface.name}: asperities {touch:.1f} N, shear {lost.shear:.2f} W, "
            f"asperities {lost.asperity:.2f} W"
        )
    print(f"  {found.places.warning or 'repeats from pitch to pitch'}")


@styled
def draw() -> plt.Figure:
    """Film heights on both covers, for both designs."""
    figure, panels = plt.subplots(2, 2, figsize=(7.2, 6.6), layout="constrained")
    for row, (covers, title) in zip(panels, COVERS.items(), strict=True):
        found = solved(covers)
        print(title)
        report(found)
        for film in found.last.films:
            grid, column = film.grid, int(film.grid.interface.side == "floating")
            x0, y0 = grid.interface.face.center
            edges = (np.arange(grid.rows + 1) * 2.0 * np.pi / grid.rows)[:, None]
            x, y = x0 + np.cos(edges) * grid.rims, y0 + np.sin(edges) * grid.rims
            height = np.where(film.boundary.mask.film, film.gap * 1e6, np.nan)
            mesh = row[column].pcolormesh(
                1e3 * x, 1e3 * y, height, cmap="viridis", norm=SCALE, rasterized=True
            )
            row[column].set_aspect("equal")
            side = OPPOSITE[covers] if column else "port side"
            row[column].set_title(f"{title}, {side}", fontsize=8)
            row[column].set_xlabel("x [mm]")
            row[column].set_ylabel("y [mm]")
    bar = figure.colorbar(mesh, ax=panels, shrink=0.7, label="Film height (µm)")
    bar.set_ticks([1, 2, 3, 5, 10, 20, 40])
    bar.ax.yaxis.set_major_formatter("{x:g}")
    return figure


if __name__ == "__main__":
    draw().savefig(Path(__file__).with_suffix(".png"), dpi=130)
