"""Draw ``film_validation.png`` and ``lateral_film.png``: films against published results.

Run from the root of the repository: ``python docs/pictures/film_validation.py``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from toothspace import api
from toothspace.closures.journal_friction import PUBLISHED_CURVE
from toothspace.films import FilmFluid, JournalBearing, LateralFilm
from toothspace.films.plane.ring import FaceSetting, solve_faces
from toothspace.model.operating_point import OperatingCondition
from toothspace.plotting.style import BLUE, GREEN, INK, ORANGE, styled
from toothspace.validation.claim import columns, rows_of
from toothspace.validation.published_films import (
    SPEED,
    bertocchi_pad,
    lund_thomsen_bearing,
    lund_thomsen_load,
    pawar_sweep,
)

ROOT = Path(__file__).parents[2]


def pocket(axis: Any) -> None:
    """Pad with a pocket: pressure along the middle."""
    rows = columns("bertocchi_2013")
    pad = bertocchi_pad()
    film = pad.solve(speed=1.0)
    axis.plot(1e3 * film.x, 1e-6 * film.pressure_centerline, color=BLUE, label="toothspace")
    axis.plot(
        20.0 * rows["x"][::3],
        rows["p_small_pocket"][::3],
        "o",
        color=INK,
        label="Bertocchi et al. 2013",
    )
    axis.set(title="Pad with pocket", xlabel="x [mm]", ylabel="pressure [MPa]")
    axis.legend()


def stiffness(axis: Any) -> None:
    """Four stiffness coefficients of the elliptical bearing."""
    rows = [
        row
        for row in rows_of("lund_thomsen_1978")
        if "elliptical" in row["bearing"] and float(row["L_over_D"]) == 1.0
    ]
    numbers = np.array([float(row["S"]) for row in rows])
    bearing = lund_thomsen_bearing(1.0, elliptical=True, cavitation="jfo")
    found = []
    for S in np.geomspace(numbers.min(), numbers.max(), 9):
        load = lund_thomsen_load(bearing, float(S))
        film = bearing.equilibrium(load=(load, 0.0), shaft_speed=SPEED)
        found.append([S, *(film.stiffness * bearing.radial_clearance / load).ravel()])
    table = np.array(found)
    names = ("Kxx", "Kxy", "Kyx", "Kyy")
    for k, (name, color) in enumerate(zip(names, (BLUE, ORANGE, GREEN, "#7a4fa3"), strict=True)):
        axis.plot(table[:, 0], table[:, k + 1], color=color, label=name)
        axis.plot(numbers, [float(row[name]) for row in rows], "o", color=color)
    axis.set(title="Elliptical bearing", xlabel="Sommerfeld number [-]", ylabel="K c / W [-]")
    axis.legend(ncols=2)


def friction(axis: Any) -> None:
    """Mixed lubrication of the reference motor's bearing."""
    numbers = np.geomspace(0.001, 0.2, 24)
    axis.loglog(numbers, PUBLISHED_CURVE(numbers), "--", color=INK, label="published fit")
    for shaft, bush, color in ((0.1, 0.2, GREEN), (0.13, 0.27, BLUE), (0.15, 0.3, ORANGE)):
        sweep = pawar_sweep(numbers, roughness=(shaft * 1e-6, bush * 1e-6))
        label = f"roughness {shaft}/{bush} µm"
        axis.loglog(numbers, sweep.friction_coefficient, color=color, label=label)
    axis.set(title="Mixed lubrication", xlabel="Sommerfeld number [-]", ylabel="friction [-]")
    axis.legend()


def orders(axis: Any) -> None:
    """Error over the number of cells, with and without a cavity."""
    lanes = np.array([8, 16, 32, 64, 128])
    errors = []
    for count in lanes:
        disc = LateralFilm(
            inner_radius=0.0,
            outer_radius=0.02,
            side_gap=1e-5,
            fluid=FilmFluid(0.02),
            grid=(8, int(count)),
            outer_pressure=0.0,
        )
        exact = 1.5 * np.pi * 0.02 * 0.02**4 * 1e-3 / 1e-15
        errors.append(abs(disc.solve(squeeze_velocity=-1e-3).load[0] / exact - 1.0))
    axis.loglog(lanes, errors, "o-", color=BLUE, label="squeezed disc, exact")
    rows = np.array([24, 48, 96, 192, 768])
    loads = []
    for count in rows:
        bearing = JournalBearing(
            diameter=0.1,
            length=0.08,
            radial_clearance=1.5e-4,
            dynamic_viscosity=0.01,
            grid=(int(count), int(count) // 4),
        )
        loads.append(bearing.solve(eccentricity=(0.6, 0.0), shaft_speed=314.0).load)
    error = np.abs(np.array(loads[:-1]) / loads[-1] - 1.0)
    axis.loglog(rows[:-1] / 4, error, "s-", color=ORANGE, label="cavitated journal, finest grid")
    axis.loglog(lanes, errors[0] * (lanes[0] / lanes) ** 2.0, ":", color=INK, label="order 2")
    axis.set(title="Convergence of the load", xlabel="cells across", ylabel="relative error [-]")
    axis.legend()
    for name, cells, values in (("disc", lanes, np.array(errors)), ("journal", rows[:-1], error)):
        print(name, -np.diff(np.log(values)) / np.diff(np.log(cells)))


@styled
def validation() -> Figure:
    """Draw the four comparisons."""
    figure, axes = plt.subplots(2, 2, figsize=(10.0, 7.2), layout="constrained")
    for axis, draw in zip(axes.flat, (pocket, stiffness, friction, orders), strict=True):
        draw(axis)
    return figure


@styled
def lateral() -> Figure:
    """Draw the pressure of the film on one bushing face of the 12-tooth pump."""
    case = api.load_case(ROOT / "cases" / "egm12_lateral_film.toml")
    keys = case.film
    description = api.describe(case)
    condition = OperatingCondition(
        shaft_speed=keys.shaft_speed,
        inlet_pressure=keys.inlet_pressure,
        outlet_pressure=keys.outlet_pressure,
        drain_pressure=1e5,
    )
    setting = FaceSetting(
        side_gap=keys.side_gap,
        fluid=FilmFluid(0.03),
        shaft_angle=keys.shaft_angle,
        grid=(384, 64),
    )
    faces = solve_faces(description, condition, setting)
    figure, axis = plt.subplots(figsize=(5.4, 7.2), layout="constrained")
    for (x, y), film in zip(faces.centers, faces.films, strict=True):
        rim = np.linspace(9.0, 1e3 * film.lateral.outer_radius, 65)
        angle = np.linspace(0.0, 2.0 * np.pi, 385)
        across = 1e3 * x + np.outer(np.cos(angle), rim)
        up = 1e3 * y + np.outer(np.sin(angle), rim)
        free = np.isnan(film.lateral.given_pressure)
        shown = np.where(free, 1e-5 * film.pressure, np.nan)
        mesh = axis.pcolormesh(across, up, shown, cmap="viridis", vmin=0.0, vmax=200.0)
    figure.colorbar(mesh, ax=axis, label="pressure [bar]", shrink=0.7)
    axis.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    axis.set_title("Film on a bushing face, inlet left")
    return figure


if __name__ == "__main__":
    here = Path(__file__).parent
    validation().savefig(here / "film_validation.png", dpi=100)
    lateral().savefig(here / "lateral_film.png", dpi=100)
