"""Flow laws of other programs and publications."""

from __future__ import annotations

import numpy as np


def borutzky_flow_rate(
    drop: np.ndarray, area: float, diameter: float, density: float, viscosity: float
) -> np.ndarray:
    """Orifice with C = 0.7 and a transition Reynolds number of 350, as printed.

    W. Borutzky, B. Barnard, J. Thoma, Simul. Model. Pract. Theory 10, 2002, 141-152.
    """
    speed = 350.0 * viscosity / density / diameter
    root = np.sqrt(1.0 + 8.0 * 0.49 * np.abs(drop) / (density * speed**2))
    return np.sign(drop) * 0.5 * area * speed * (root - 1.0)


def root_flow_rate(
    drop: float, area: float, diameter: float, density: float, viscosity: float
) -> float:
    """Orifice with C = 0.7 and a critical Reynolds number of 12.

    MathWorks, Simscape Fluids reference, Orifice.
    """
    critical = 0.5 * density * (12.0 * viscosity / density / (0.7 * diameter)) ** 2
    root = (drop * drop + critical * critical) ** 0.25
    return float(0.7 * area * np.sqrt(2.0 / density) * drop / root)


def tanh_flow_rate(
    drop: float, area: float, diameter: float, density: float, viscosity: float
) -> float:
    """Orifice with C = 0.7 tanh(2 lambda / 1000), lambda the flow number: of circuit simulators."""
    speed = np.sqrt(2.0 * drop / density)
    coefficient = 0.7 * np.tanh(2.0 * diameter * density / viscosity * speed / 1000.0)
    return float(coefficient * area * speed)
