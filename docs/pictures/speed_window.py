"""Where speed and nose pressure are secondary for the bearing of the fuel pump, and why.

Run ``python docs/pictures/speed_window.py`` from the root of the repository (some minutes): films
of the three conditions of the nose study are tabulated over the gap, for two starts of the relief
grooves; then the share of the film and of the chambers in what speed changes is printed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import matplotlib as mpl
import numpy as np

from toothspace.case import load_case
from toothspace.model.lateral_balance import HousingContact
from toothspace.plotting.style import BLUE, GREEN, GREY, ORANGE, new_figure, save_figure, styled
from toothspace.simulation.lateral.problem import lateral_problem
from toothspace.studies import StudyContext, balance_sweep
from toothspace.studies.lateral_points import LateralPoints, PointCondition, prepare

HERE = Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"
RELIEFS = ("4.00 mm", "4.50 mm")
RATIOS = np.arange(0.94, 1.1001, 0.0025)
REFERENCE = 2274e-6  # area of the ratio one in the window of the loops [m2]
TELL = 0.05e-6  # difference of gaps that counts [m]
CLAIMS = ("nose matters at OC1", "nose does not at OC3", "speed less than nose")


class Window(NamedTuple):
    """Gaps over ratios and nose pressures by condition, and where each claim holds."""

    gaps: Mapping[str, np.ndarray]
    held: np.ndarray


def case_with(relief: str):
    """Nose study with relief grooves from a distance of the centre line on."""
    place = "machine.relief_grooves"
    sets = [f"{place}.closing_side_offset={relief}", f"{place}.opening_side_offset={relief}"]
    return load_case(CASES / "nose_pressure.toml", sets)


def tables_of(case):
    """Films of every condition of the nose study over the gap."""
    sweep, found = load_case(CASES / "balance_sweep.toml").study, {}
    for one in case.study.conditions:
        point = replace(case.operating_point, shaft_speed=one.shaft_speed)
        asked = replace(sweep, outlet_pressures=(one.outlet_pressure,))
        found[one.name] = balance_sweep.film_tables(
            replace(case, operating_point=point), asked, StudyContext()
        )[0]
    return found


def rest(table, ratio: float, fraction: float, case, nose_area: float) -> float:
    """Gap at which the bearing stays, begun at the gap of the study. [m]."""
    study, low = case.study, table.outlet_pressure - table.difference
    push = nose_area * max(fraction * table.outlet_pressure - low, 0.0)
    pressed = replace(table, opening=table.opening - push)
    load = (ratio * REFERENCE, study.friction_coefficient)
    return float(balance_sweep.follow([pressed], [0], load, study.start_gap)[0])


def window(case, nose_area: float) -> Window:
    """Follow all conditions over ratios and nose pressures."""
    tables, noses = tables_of(case), case.study.nose_pressure_fractions
    gaps = {
        name: np.array([[rest(t, r, f, case, nose_area) for f in noses] for r in RATIOS])
        for name, t in tables.items()
    }
    span = {name: np.ptp(gap, axis=1) for name, gap in gaps.items()}
    speed = np.abs(gaps["OC1"] - gaps["OC2"])[:, 0]
    nose = np.maximum(span["OC1"], span["OC2"])
    held = np.array([span["OC1"] > TELL, span["OC3"] < TELL, speed < nose])
    return Window(gaps, held)


def shares(points: LateralPoints, case) -> None:
    """Print opening forces at 2 um: with chambers of one speed and film of another."""
    machine, settings = points.machine, points.settings
    slow, fast, pressure = 2550.0, 4675.0, case.study.conditions[0].outlet_pressure
    lumped = {
        speed: points.lumped(
            PointCondition(
                label="",
                outlet_pressure=pressure,
                inlet_pressure=case.operating_point.inlet_pressure,
                shaft_speed=speed * np.pi / 30.0,
            )
        ).data
        for speed in (slow, fast)
    }
    for chambers, film in ((slow, slow), (fast, slow), (slow, fast), (fast, fast)):
        data = lumped[chambers].copy()
        data["shaft_speed"] = data["shaft_speed"] * 0.0 + film * np.pi / 30.0
        problem = lateral_problem(machine.description, machine.fluid, data, settings)
        states = problem.started(2e-6).states
        force = np.mean([s.film_force()[0] for s in states])
        print(f"chambers of {chambers:.0f} rpm, film at {film:.0f} rpm: {force:.0f} N")


@styled
def figure_of(found: Mapping[str, Window]):
    """Gaps over the balance ratio with the claims that hold, one panel per relief start."""
    figure = new_figure(7.2, 3.3 * len(found))
    rows = np.ravel(figure.subplots(len(found), 1))
    for axes, (relief, one) in zip(rows, found.items(), strict=True):
        names = ("OC1: low pressure, fast", "OC2: low pressure, slow", "OC3: high pressure, fast")
        for (_, gap), color, label in zip(
            one.gaps.items(), (BLUE, ORANGE, GREY), names, strict=True
        ):
            axes.plot(RATIOS, gap[:, 0] * 1e6, color=color, label=label)
            axes.fill_between(RATIOS, gap.min(1) * 1e6, gap.max(1) * 1e6, color=color, alpha=0.25)
        for k, (held, text) in enumerate(zip(one.held, CLAIMS, strict=True)):
            height = 0.85 * 0.86**k
            axes.plot(RATIOS, np.where(held, height, np.nan), lw=3, color=GREEN)
            axes.text(RATIOS[0], height, f"{text} ", fontsize=6, ha="right", va="center")
        axes.set_yscale("log")
        axes.set_yticks([1, 2, 3, 5, 10, 20], labels=["1", "2", "3", "5", "10", "20"])
        axes.minorticks_off()
        axes.set_xlim(RATIOS[0] - 0.045, RATIOS[-1])
        axes.set_ylim(0.45, 25.0)
        axes.set_title(f"Relief grooves from {relief} on")
        axes.set_xlabel("Balanced area over 2274 mm²")
        axes.set_ylabel("Gap of rigid faces (µm)")
        axes.legend(fontsize=7)
    return figure


if __name__ == "__main__":
    mpl.use("Agg")
    windows = {}
    for start in RELIEFS:
        own = case_with(start)
        machine = prepare(own, HousingContact(friction_coefficient=1.0), "speed_window")
        shares(machine, own)
        windows[start] = window(own, machine.balance.floating.nose.area)
        held = windows[start].held
        for claim, at in zip((*CLAIMS, "all"), (*held, held.all(axis=0)), strict=True):
            print(start, claim, RATIOS[at].round(4))
    save_figure(figure_of(windows), HERE / "speed_window.png")
