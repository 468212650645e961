"""Cross-port leakage through chambers that are open to both ports, as a design rule."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.finding import DesignCheck
from toothspace.core.types import Array
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.model.description import ChamberFamily, FlowPath

SHORT_CIRCUIT_LIMIT = 0.01
"""Flow from high to low pressure through joined openings over the ideal flow. [-]"""

DENSITY = 850.0
"""Density of the estimate, mineral oil. [kg/m3]"""

_ANGLES = 48
_PORTS = ("inlet", "outlet")


@final
@dataclass(frozen=True)
class DesignCondition:
    """Condition at which design rules judge; the low-pressure side is at one atmosphere."""

    pressure: float = 200e5
    """Absolute pressure of the high-pressure side. [Pa]"""
    shaft_speed: float = 1500.0 * np.pi / 30.0
    """Shaft speed. [rad/s]"""

    @property
    def pressure_difference(self) -> float:
        """Pressure difference between the ports. [Pa]."""
        return self.pressure - ATMOSPHERIC_PRESSURE

    def __str__(self) -> str:
        """Return the condition in words."""
        return f"at {self.pressure * 1e-5:.4g} bar, {self.shaft_speed * 30.0 / np.pi:.4g} rpm"


TYPICAL = DesignCondition()
"""Condition for machines without one of their own."""


def in_series(first: Array, second: Array) -> Array:
    r"""Area of two openings one behind the other, :math:`A_1 A_2 / \sqrt{A_1^2 + A_2^2}`. [m2]."""
    product, scale = first * second, np.hypot(first, second)
    return np.asarray(product / np.where(scale > 0.0, scale, 1.0), dtype=float)


def joined_area(
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    closed_by: float = 0.0,
) -> float:
    """Area that joins both ports, mean over a pitch of the first family.

    Parameters
    ----------
    families, paths : sequence of ChamberFamily, FlowPath
        Chambers, and all paths of the machine.
    closed_by : float
        Part by which bearing play closes the throats between meshing chambers. [m]

    Returns
    -------
    float
        Orifice for openings of single chambers to both ports, and of two that mesh, in series. [m2]
    """
    first = families[0]
    pitch = 2.0 * np.pi / (first.count * abs(first.angle_ratio))
    angle, rows = pitch * np.arange(_ANGLES) / _ANGLES, np.arange(_ANGLES)[:, None]
    count = sum(family.count for family in families)
    to = {port: np.zeros((_ANGLES, count)) for port in _PORTS}
    for path in paths:
        port = path.category.role.partition("_")[0]
        if path.kind == "orifice" and port in to:
            table = path.geometry(path.phases + path.angle_ratio * angle[:, None])
            np.add.at(to[port], (rows, path.nodes_a[None, :]), path.multiplicity * table[..., 0])
    joined = in_series(to["inlet"], to["outlet"]).sum(axis=1)
    for path in (path for path in paths if path.category.role == "mesh"):
        table = path.geometry(path.phases + path.angle_ratio * angle[:, None])
        # a gap does not contract the flow as the sharp edges of the openings do
        height = np.maximum(table[..., 0] - closed_by, 0.0) / DISCHARGE_COEFFICIENT
        throat = height * table[..., 1]
        here, there = path.nodes_a[None, :], path.partners(angle)
        for port, other in (_PORTS, _PORTS[::-1]):
            through = in_series(to[port][rows, here], to[other][rows, there])
            joined += in_series(throat, through).sum(axis=1)
    return float(joined.mean())


def opening_checks(
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    displacement: float,
    closed_by: float = 0.0,
    condition: DesignCondition = TYPICAL,
) -> tuple[DesignCheck, ...]:
    """Seal between both ports, and relief grooves that chambers meet.

    Parameters
    ----------
    families, paths, closed_by
        See :func:`joined_area`.
    displacement : float
        Displaced volume. [m3/rad]
    condition : DesignCondition
        Pressure and speed of the short circuit.

    Returns
    -------
    tuple of DesignCheck
        Short circuit, and opening of the grooves if there are any.
    """
    velocity = float(np.sqrt(2.0 * condition.pressure_difference / DENSITY))
    flow = DISCHARGE_COEFFICIENT * velocity * joined_area(families, paths, closed_by)
    share = flow / (displacement * condition.shaft_speed)
    short = DesignCheck(
        name="short circuit through the chambers",
        value=100.0 * share,
        unit="%",
        allowed=f"up to {100.0 * SHORT_CIRCUIT_LIMIT:g} % of the ideal flow {condition}",
        passed=share <= SHORT_CIRCUIT_LIMIT,
        reason="While a chamber is open to both ports, by grooves, recesses or the chamber that it "
        "meshes with, fluid at high pressure escapes to the other side.",
    )
    grooves = [
        float(path.geometry(path.geometry.period * np.arange(720) / 720)[:, 0].max())
        for path in paths
        if path.category.role.endswith("_groove")
    ]
    if not grooves:
        return (short,)
    met = DesignCheck(
        name="opening of the relief grooves",
        value=1e6 * min(grooves),
        unit="mm2",
        allowed="above 0 mm2 for every groove and gear",
        passed=min(grooves) > 0.0,
        reason="A groove that no tooth space meets relieves nothing.",
    )
    return short, met
