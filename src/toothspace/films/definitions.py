"""Walls, grooves and lobes of films: what a case or a program says of them.

Every class is a table of keys as well. Its bounds hold where a case is read; what a solver makes
for itself, such as a groove of width zero, is free of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.keys import Number, QuantityKey, Row, choice, integer, items, number, quantity
from toothspace.core.types import Array

CONTACT_LAWS = ("elastic_plastic", "greenwood_tripp", "kogut_etsion", "table", "none")
"""Laws of the asperity pressure."""


@final
@dataclass(frozen=True, kw_only=True)
class RoughSurfaces:
    """``surfaces``: roughness and contact of the two walls of a film.

    Parameters
    ----------
    moving_roughness, resting_roughness : float
        Root mean square roughness of the walls. [m]
    moving_pattern, resting_pattern : float
        Correlation length along over across the motion. [-]
    correlation_length : float
        Half-height correlation length of the combined surface. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer wall. [Pa]
    boundary_friction : float
        Friction coefficient of touching asperities. [-]
    contact_law : {"elastic_plastic", "greenwood_tripp", "kogut_etsion", "table", "none"}
        Law of the asperity pressure.
    asperity_product, roughness_over_radius : float
        Parameters of Greenwood and Tripp. [-]
    contact_points : tuple of (float, float)
        User's table of gap ratio and asperity pressure, for ``table``; its ends are carried on
        along the logarithm of the pressure, downwards, and without contact, upwards. [-, Pa]
    """

    moving_roughness: float = quantity(
        "um", "Root mean square roughness of the moving wall.", low=0, high=100
    )
    resting_roughness: float = quantity(
        "um", "Root mean square roughness of the resting wall.", low=0, high=100
    )
    moving_pattern: float = number(
        "Correlation length of the moving wall along over across the motion.",
        low=1 / 9,
        high=9,
        default=1.0,
    )
    resting_pattern: float = number("The same of the resting wall.", low=1 / 9, high=9, default=1.0)
    correlation_length: float = quantity(
        "um", "Half-height correlation length, combined.", above=0, high=1000, default=15e-6
    )
    effective_modulus: float = quantity(
        "GPa", "2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2].", above=0, high=2000, default=1.55e11
    )
    hardness: float = quantity(
        "MPa", "Hardness of the softer wall.", above=0, high=100000, default=1e9
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities.", low=0, high=2, default=0.1
    )
    contact_law: str = choice(
        "Law of the asperity pressure.", *CONTACT_LAWS, default="elastic_plastic"
    )
    asperity_product: float = number(
        "Density times radius of the asperities times roughness, of Greenwood and Tripp.",
        above=0,
        high=1,
        default=0.04,
    )
    roughness_over_radius: float = number(
        "Roughness over asperity radius, of Greenwood and Tripp.", above=0, high=1, default=1e-3
    )
    contact_points: tuple[tuple[float, float], ...] = items(
        Row(items=(Number(low=-5, high=20), QuantityKey(unit="MPa", above=0, high=1e6))),
        "Gap over roughness and asperity pressure, for the law 'table'.",
        low=0,
        default=(),
    )

    def __post_init__(self) -> None:
        if not self.roughness > 0.0:
            raise CaseError("moving_roughness", "two smooth walls", "one rough wall or more")
        if self.contact_law not in CONTACT_LAWS:
            raise CaseError("contact_law", repr(self.contact_law), " or ".join(CONTACT_LAWS))
        if self.contact_law != "table":
            return
        ratios, pressures = ([point[k] for point in self.contact_points] for k in range(2))
        growing = all(b > a for a, b in pairwise(ratios))
        falling = all(0.0 < b <= a for a, b in pairwise(pressures))
        if len(ratios) < 2 or not growing or not falling:
            found = f"{len(ratios)} points" if len(ratios) < 2 else "gaps or pressures out of order"
            allowed = "two points or more with a growing gap and a positive, falling pressure"
            raise CaseError("contact_points", found, allowed)

    @property
    def roughness(self) -> float:
        """Combined roughness. [m]."""
        return math.hypot(self.moving_roughness, self.resting_roughness)


@final
@dataclass(frozen=True)
class Groove:
    """One of ``[[bearing.grooves]]``: groove or pocket of the bush at a given pressure.

    Parameters
    ----------
    angle : float
        Position of its centre, from x towards y. [rad]
    width : float
        Angle that it spans. [rad]
    length : float
        Axial length. [m]
    pressure : float
        Absolute pressure in the groove. [Pa]
    position : float
        Axial position of its centre, from the middle of the bush. [m]
    """

    angle: float = quantity("deg", "Centre, from x towards y.", low=-360, high=360)
    width: float = quantity("deg", "Extent along the circumference.", above=0, high=360)
    length: float = quantity("mm", "Axial extent, centred.", above=0, high=1000)
    pressure: float = quantity("bar", "Absolute pressure.", low=0, high=1000)
    position: float = quantity(
        "mm", "Axial position of its centre, from the middle.", low=-1000, high=1000, default=0.0
    )


@final
@dataclass(frozen=True)
class Lobes:
    """``lobes``: bore of equal circular lobes that are moved towards the middle.

    Parameters
    ----------
    count : int
        Number of lobes; two make an ellipse. [-]
    preload : float
        Displacement of the lobes over the radial clearance of their own circle, below 1. [-]
    angle : float
        Middle of the first lobe, from x towards y. [rad]
    """

    count: int = integer("Number of lobes; two make an ellipse.", low=1, high=12)
    preload: float = number(
        "Displacement of the lobes over the radial clearance of their own circle.", low=0, high=0.99
    )
    angle: float = quantity(
        "deg", "Middle of the first lobe, from x towards y.", low=-360, high=360, default=0.0
    )

    def __post_init__(self) -> None:
        if self.count < 1 or not 0.0 <= self.preload < 1.0:
            found = f"{self.count} lobes of preload {self.preload!r}"
            allowed = "1 lobe or more and preloads from 0 to below 1"
            raise CaseError("", found, allowed)

    def narrowing(self, angle: Array) -> Array:
        """Loss of gap height over the radial clearance at angles. [-]."""
        pitch = 2.0 * np.pi / self.count
        away = np.mod(angle - self.angle + 0.5 * pitch, pitch) - 0.5 * pitch
        return np.asarray(self.preload * np.cos(away))
