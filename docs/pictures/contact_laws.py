"""Draw ``contact_laws.png``: elastic laws of a lobe against finite elements.

Run from the root of the repository: ``PYTHONPATH=. python docs/pictures/contact_laws.py``.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from tests.plane_contact import lobe_in_groove
from toothspace.closures.contact_cylindrical import pereira_force
from toothspace.closures.contact_law import hertz_scale, johnson_scale, logarithmic_law
from toothspace.plotting.style import BLUE, GREEN, INK, ORANGE, styled

STEEL = 206e9 / (2.0 * (1.0 - 0.3**2))
LOBE = 8.5e-3
CASES = ((-9.5e-3, "groove of 9.5 mm"), (-12e-3, "groove of 12 mm"), (-50e-3, "groove of 50 mm"))
DEPTH = np.linspace(0.05e-6, 8e-6, 120)
PROBES = np.array([0.5e-6, 1e-6, 2e-6, 4e-6, 6e-6, 8e-6])


def line_loads(scale: float) -> np.ndarray:
    """Force per length of the logarithmic law over the depth. [N/m]."""
    level = float(np.log(scale))
    return np.array([logarithmic_law(float(depth), level, STEEL)[0] for depth in DEPTH])


@styled
def draw() -> Figure:
    """Draw three grooves side by side."""
    figure, axes = plt.subplots(1, 3, figsize=(10.0, 3.6), sharey=True, layout="constrained")
    for axis, (groove, title) in zip(axes, CASES, strict=True):
        scale = float(hertz_scale(LOBE, groove, LOBE))
        axis.plot(1e6 * DEPTH, 1e-3 * line_loads(scale), color=BLUE, label="hertz_line")
        scale = float(johnson_scale(LOBE, groove))
        axis.plot(1e6 * DEPTH, 1e-3 * line_loads(scale), color=ORANGE, label="johnson")
        if abs(LOBE + groove) <= 10e-3:
            force = pereira_force(DEPTH, abs(LOBE + groove), 1.0, STEEL, True)
            axis.plot(1e6 * DEPTH, 1e-3 * force, color=GREEN, label="pereira")
        oracle = lobe_in_groove(LOBE, groove, (LOBE, LOBE), PROBES)
        axis.plot(1e6 * PROBES, 1e-3 * oracle, "o", color=INK, label="finite elements")
        axis.set_title(title)
        axis.set_xlabel("approach [µm]")
    axes[0].set_ylabel("force per length [N/mm]")
    axes[0].legend()
    return figure


if __name__ == "__main__":
    draw().savefig(Path(__file__).with_suffix(".png"), dpi=110)
