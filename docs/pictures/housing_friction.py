"""Both friction laws of the housing of a floating bearing."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

from toothspace.floating.housing_friction import HousingFriction
from toothspace.plotting.style import BLUE, ORANGE, new_figure, save_figure, styled

HERE = Path(__file__).resolve().parent


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
