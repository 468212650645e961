"""Temperatures of a result against the range in which the properties of its fluid are known."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.constants import ZERO_CELSIUS
from toothspace.core.finding import Finding

if TYPE_CHECKING:
    from toothspace.results.solution import Solution

_SHOWN = {
    "outlet_temperature_degC": "outlet",
    "drain_temperature_degC": "drain",
    "highest_film_temperature_degC": "hottest film",
}
"""Places whose temperature every steady run has, by the names of the summary."""
_RISE = "lateral_temperature_rise"


def temperatures_beyond(solution: Solution, low: float, high: float) -> Iterator[Finding]:
    """Say which temperatures lie outside the range of the fluid.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    low, high : float
        Temperatures between which the properties of the fluid are known. [K]
    """
    found = temperatures_of(solution)
    outside = {place: t for place, t in found.items() if not low <= t <= high}
    if not outside:
        return
    worst = max(outside, key=lambda place: max(outside[place] - high, low - outside[place]))
    reached = f"{outside[worst] - ZERO_CELSIUS:.4g} °C ({worst})"
    known = f"{low - ZERO_CELSIUS:.4g} to {high - ZERO_CELSIUS:.4g} °C"
    others = ", ".join(place for place in outside if place != worst)
    beside = f", and beyond it in: {others}" if others else ""
    yield Finding(
        "warning",
        f"Temperatures reach {reached}{beside}; the properties of the fluid are known from "
        f"{known} only.",
        quantity="Temperature, range of the fluid",
        found=reached,
        allowed=known,
        severity="serious",
        advice="Let more oil pass where it is hot (wider gaps and bearings, "
        "heat.bearing_flushing), lower speed or pressure, or cool the casing "
        "(heat.housing_conductance); warm films thin with heat.model = 'coupled' alone.",
    )


def temperatures_of(solution: Solution) -> dict[str, float]:
    """Temperatures of a steady run by place. [K]."""
    numbers = solution.summary()
    found = {
        place: float(numbers[name]) + ZERO_CELSIUS
        for name, place in _SHOWN.items()
        if name in numbers
    }
    if "temperature" in solution.data:
        for node, value in zip(
            solution.data["heat_node"].values, solution.data["temperature"].values, strict=True
        ):
            found.setdefault(str(node).replace("_", " "), float(value))
    if _RISE in solution.statistics:
        supply = float(solution.data["fluid_temperature"])
        found["lateral film"] = supply + float(solution.statistics[_RISE])
    return {place: value for place, value in found.items() if np.isfinite(value)}
