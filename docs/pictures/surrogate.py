"""Picture of a surrogate beside runs that it has not seen, for the page on surrogates.

Run from the root of the repository: ``python docs/pictures/surrogate.py FOLDER``, with the folder
of the finished study ``tolerance_clearances``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import toothspace as ts
from toothspace.plotting.style import BLUE, ORANGE, new_figure, save_figure, styled

AT = {
    "machine.casing.radial_clearance": "21 um",
    "machine.journal_bearings.radial_clearance": "8 um",
    "machine.gears.normal_backlash": "0.12 mm",
    "fluid.temperature": "50 degC",
}
GAP = "machine.lateral.side_gap"
NUMBERS = {
    "volumetric_efficiency": "Volumetric efficiency (-)",
    "hydromechanical_efficiency": "Hydromechanical efficiency (-)",
}


@styled
def draw(folder: str) -> None:
    """Two efficiencies over the side gap: surrogate with two deviations, and runs made since."""
    surrogate = ts.fit_surrogate(folder, list(NUMBERS))
    place = surrogate.keys.index(GAP)
    low, high = surrogate.low[place], surrogate.high[place]
    gaps = np.linspace(low, high, 81)
    found = surrogate.predict({**AT, GAP: gaps.tolist()})
    case = ts.load_case("tolerance_clearances").replace({**AT, "study": None})
    checked = np.linspace(low, high, 5)
    runs = [ts.simulate(case.replace({GAP: f"{gap} um"})).summary() for gap in checked]
    figure = new_figure(7.2, 2.9)
    for axes, (name, title) in zip(figure.subplots(1, 2), NUMBERS.items(), strict=True):
        mean, deviation = found[name].values, found[f"{name}_deviation"].values
        error = found[name].attrs["hold_out_error"]
        axes.fill_between(
            gaps, mean - 2.0 * deviation, mean + 2.0 * deviation, color=BLUE, alpha=0.25, lw=0.0
        )
        axes.plot(gaps, mean, color=BLUE, label=f"surrogate, hold-out error {error:.0e}")
        axes.plot(checked, [run[name] for run in runs], "o", color=ORANGE, ms=4, label="runs")
        axes.set(xlabel="Side gap (µm)", ylabel=title)
        axes.legend()
    save_figure(figure, Path(__file__).resolve().parent / "surrogate.png")


if __name__ == "__main__":
    draw(sys.argv[1])
