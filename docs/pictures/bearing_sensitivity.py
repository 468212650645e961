"""Sensitivity of a floating bearing to area and friction, and both friction laws of the housing.

Run ``python docs/pictures/bearing_sensitivity.py`` from the root of the repository (some minutes):
the study ``balance_sweep`` on the loop of a hysteresis case.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np

from toothspace.case import load_case
from toothspace.films.lateral.housing_friction import HousingFriction
from toothspace.plotting.bearing_figures import area_sensitivity, friction_sensitivity
from toothspace.plotting.style import BLUE, ORANGE, new_figure, save_figure, styled
from toothspace.studies import StudyContext, balance_sweep

HERE = Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"


def swept(name: str):
    """Sweep of the balanced area over the loop of a hysteresis case."""
    loop, sweep = load_case(CASES / f"{name}.toml"), load_case(CASES / "balance_sweep.toml")
    asked = replace(sweep.study, outlet_pressures=loop.study.outlet_pressures)
    result = balance_sweep.run(replace(loop, study=asked), StudyContext())
    print(name, {k: v for k, v in result.numbers.items() if "window" not in k})
    for k, claim in enumerate(balance_sweep.CLAIMS):
        held = result.data["claim_holds"].values[k, 0].astype(bool)
        print(name, claim, result.data["balance_ratio"].values[held].round(4))
    return loop.title, result.data


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
    first = swept("hysteresis_055")
    save_figure(area_sensitivity(first[1]), HERE / "area_sensitivity.png")
    save_figure(friction_sensitivity(first[1]), HERE / "friction_sensitivity.png")
