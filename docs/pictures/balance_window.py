"""Where the balance ratio of the fuel pump must lie, and both friction laws of the housing.

Run ``python docs/pictures/balance_window.py`` from the root of the repository (some minutes).
The film force is tabulated over the gap for every outlet pressure; the bearing then follows the
pressures with the set-valued law for any balanced area, as the study ``hysteresis`` does with
the implicit solver for one.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from scipy.interpolate import PchipInterpolator

from toothspace.config import load_case
from toothspace.films.lateral_gap.friction import BREAKAWAY_RATIO, HousingFriction
from toothspace.model.lateral_balance import HousingContact
from toothspace.plotting.style import BLUE, GREY, INK, ORANGE, new_figure, save_figure, styled
from toothspace.solver.lateral_gap import lateral_problem
from toothspace.studies.lateral_points import LateralPoints, PointCondition, prepare

HERE = Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"
GAPS = np.array([0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.3, 2.7, 3.2, 4, 5, 7, 10]) * 1e-6
RATIOS = np.linspace(0.94, 1.08, 57)
FINE = np.linspace(GAPS[0], GAPS[-1], 4000)
LIFTED = 10e-6


class Forces(NamedTuple):
    """Opening force of films less springs over the gap at one outlet pressure."""

    difference: float  # outlet less inlet [Pa]
    opening: PchipInterpolator  # [N] over [m]
    coulomb: float  # [N]


def tabulate(name: str) -> tuple[list[Forces], list[int], float]:
    """Forces at every pressure of a case, the order of the points, and the area at the top."""
    case = load_case(CASES / f"{name}.toml")
    study = case.study
    friction = HousingContact(
        friction_coefficient=study.friction_coefficient, breakaway_speed=study.breakaway_speed
    )
    points = prepare(case, friction, "hysteresis")
    levels = sorted(set(study.outlet_pressures))
    found = [forces_at(points, pressure) for pressure in levels]
    order = [levels.index(pressure) for pressure in study.outlet_pressures]
    return [f for f, _ in found], order, found[-1][1]


def forces_at(points: LateralPoints, pressure: float) -> tuple[Forces, float]:
    """Table of one outlet pressure, and the area that plane rigid faces would carry. [m2]."""
    base = points.case.operating_point
    condition = PointCondition(
        label="",
        outlet_pressure=pressure,
        inlet_pressure=base.inlet_pressure,
        shaft_speed=base.shaft_speed,
    )
    data = points.lumped(condition, points.machine.description).data
    machine, settings = points.machine, points.settings
    problem = lateral_problem(machine.description, machine.fluid, data, settings)
    back, bearing = problem.loads.back, problem.stack.balance.floating
    difference = back.high - back.low
    closing = bearing.high_pressure.area * difference
    net = [opening(problem, gap) + closing for gap in GAPS]
    stiff = lateral_problem(
        machine.description, machine.fluid, data, type(settings)(angles=16, deformation="none")
    )
    plane = opening(stiff, 5e-6) + closing + bearing.preload
    table = PchipInterpolator(GAPS, net)
    return Forces(difference, table, problem.loads.friction.coulomb_force), plane / difference


def opening(problem, gap: float) -> float:
    """Mean force on the bearing over a pitch with one gap everywhere. [N]."""
    states = problem.started(gap).states
    force = [s.film_force() + s.back_force(problem.loads.back) for s in states]
    return float(np.mean(force, axis=0)[0])


def follow(forces: list[Forces], order: list[int], area: float, start: float) -> np.ndarray:
    """Gaps of the points in their order: rest below breakaway, else slide to Coulomb force."""
    gap, gaps = start, []
    for k in order:
        one = forces[k]
        net = float(one.opening(np.clip(gap, GAPS[0], GAPS[-1]))) - area * one.difference
        values = one.opening(FINE) - area * one.difference
        if net > BREAKAWAY_RATIO * one.coulomb:
            hit = np.flatnonzero((gap <= FINE) & (values <= one.coulomb))
            gap = FINE[hit[0]] if hit.size else LIFTED
        elif net < -BREAKAWAY_RATIO * one.coulomb:
            hit = np.flatnonzero((gap >= FINE) & (values >= -one.coulomb))
            gap = FINE[hit[-1]] if hit.size else GAPS[0]
        gaps.append(gap)
    return np.array(gaps)


def claims(gaps: np.ndarray) -> tuple[bool, bool, bool]:
    """Rises on the first leg; stays higher on the way down; stays within the film."""
    top = len(gaps) // 2
    up, down = gaps[: top + 1], gaps[top:][::-1]
    tell = 1e-9
    rises = bool(np.all(np.diff(up) >= -tell) and up[-1] > up[0] + tell)
    higher = bool(np.all(down[:-1] >= up[:-1] - tell) and np.any(down[:-1] > up[:-1] + tell))
    return rises, higher, bool(gaps.max() < LIFTED)


@styled
def window(names: tuple[str, ...]):
    """Gaps over the balance ratio, and bars where each claim holds."""
    figure, plane = new_figure(7.2, 3.0 * len(names)), 0.0
    for axes, name in zip(np.ravel(figure.subplots(len(names), 1)), names, strict=True):
        forces, order, own = tabulate(name)
        plane = plane or own
        loops = [follow(forces, order, ratio * plane, 1e-6) for ratio in RATIOS]
        top = len(order) // 2
        for k in range(top + 1):
            up = [1e6 * loop[k] for loop in loops]
            down = [1e6 * loop[len(order) - 1 - k] for loop in loops]
            color = (BLUE, ORANGE, GREY, INK)[k % 4]
            label = f"point {k + 1} and {len(order) - k}" if k < top else f"point {k + 1}"
            axes.plot(RATIOS, up, color=color, label=label)
            axes.plot(RATIOS, down, "--", color=color)
        held = np.array([claims(loop) for loop in loops])
        for row, text in enumerate(("rises", "stays higher", "stays in the film")):
            good = np.where(held[:, row], 0.72 - 0.09 * row, np.nan)
            axes.plot(RATIOS, good, lw=3, color="C2", alpha=0.7, solid_capstyle="butt")
            axes.text(
                RATIOS[0] - 0.002, 0.72 - 0.09 * row, text, fontsize=6, ha="right", va="center"
            )
            print(name, text, RATIOS[held[:, row]].round(4))
        every = RATIOS[held.all(axis=1)]
        print(name, f"plane area {plane * 1e6:.0f} mm2, all claims", every.round(4))
        axes.set_yscale("log")
        axes.set_xlim(RATIOS[0], RATIOS[-1])
        axes.set_ylim(0.5, 12.0)
        axes.set_yticks([1, 2, 5, 10], labels=["1", "2", "5", "10"])
        axes.minorticks_off()
        axes.set_title(load_case(CASES / f"{name}.toml").title)
        axes.set_xlabel("Balanced area over the area that plane films carry")
        axes.set_ylabel("Gap of rigid faces (µm)")
        axes.legend(fontsize=7)
    return figure


@styled
def friction_laws():
    """Force over velocity of both laws."""
    law = HousingFriction(coulomb_force=133.0, breakaway_speed=6.45e-3, holds=False)
    speed = np.linspace(-40e-3, 40e-3, 1601)
    figure = new_figure(7.2, 3.0)
    axes = figure.subplots()
    smooth = [law.force(v)[0] for v in speed]
    axes.plot(speed * 1e3, smooth, color=BLUE, label="stribeck: no force at rest")
    limit = law.breakaway_force
    x = np.array([-40.0, 0.0, 0.0, 0.0, 0.0, 40.0])
    y = np.array([-133.0, -133.0, -limit, limit, 133.0, 133.0])
    axes.plot(x, y, color=ORANGE, label="stick: any force up to breakaway at rest")
    axes.set_xlabel("Velocity of the bearing (mm/s)")
    axes.set_ylabel("Friction in the housing (N)")
    axes.legend()
    return figure


if __name__ == "__main__":
    mpl.use("Agg")
    save_figure(friction_laws(), HERE / "housing_friction.png")
    save_figure(window(("hysteresis_055", "hysteresis_078")), HERE / "balance_window.png")
