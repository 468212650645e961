"""Picture of fluids of the library, for the page on fluids.

Run from the root of the repository: ``python docs/pictures/fluids.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from toothspace.core.units import ZERO_CELSIUS
from toothspace.model.fluid import liquid_at, temperature_range
from toothspace.plotting.style import CYCLE, new_figure, save_figure, styled

KNOWN = {
    "iso_vg_46": (40.0, 100.0),
    "hvlp_46": (40.0, 100.0),
    "hees_46": (40.0, 100.0),
    "hfc_46": (40.0, 60.0),
    "engine_oil_15w_40": (40.0, 100.0),
    "mil_prf_5606": (-54.0, 100.0),
    "jet_a1": (-20.0, 40.0),
    "ethylene_glycol_50": (-20.0, 80.0),
}
"""Temperatures between which the viscosity is stated. [degC]"""


@styled
def draw() -> None:
    """Kinematic viscosity and density, dashed where the viscosity is extrapolated."""
    figure = new_figure(7.2, 4.0)
    left, right = figure.subplots(1, 2)
    for (name, known), color in zip(KNOWN.items(), CYCLE, strict=True):
        kelvin = np.linspace(*temperature_range(name), 161)
        liquids = [liquid_at(name, float(t)) for t in kelvin]
        density = np.array([liquid.density for liquid in liquids])
        viscosity = 1e6 * np.array([liquid.dynamic_viscosity for liquid in liquids]) / density
        celsius = kelvin - ZERO_CELSIUS
        inside = (celsius >= known[0] - 0.5) & (celsius <= known[1] + 0.5)
        left.semilogy(celsius, viscosity, "--", color=color, linewidth=0.8)
        left.semilogy(celsius, np.where(inside, viscosity, np.nan), color=color, label=name)
        right.plot(celsius, density, color=color)
    left.set(xlabel="Temperature (°C)", ylabel="Kinematic viscosity (mm²/s)", ylim=(0.5, 5000.0))
    right.set(xlabel="Temperature (°C)", ylabel="Density (kg/m³)")
    figure.legend(loc="outside lower center", ncols=4)
    save_figure(figure, Path(__file__).resolve().parent / "fluids.png")


if __name__ == "__main__":
    draw()
