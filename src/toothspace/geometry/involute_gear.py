"""Parameters of an involute spur gear and the lengths that follow from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, FloatOrArray

Real = TypeVar("Real", float, Array)

MIN_TOOTH_COUNT = 5
MAX_TOOTH_COUNT = 400
DEFAULT_TOOL_TIP_RADIUS = 0.38


def plain(value: Real) -> Real:
    """Python number of a NumPy scalar; arrays as they are."""
    return value if isinstance(value, np.ndarray) else float(value)


def involute_function(pressure_angle: Real) -> Real:
    """Involute function, tan(a) - a, of a pressure angle in [rad]."""
    return plain(np.tan(pressure_angle) - pressure_angle)


class RackCutTeeth(Generic[Real]):
    """Involute teeth that a straight-sided rack cuts: numbers of one gear, or arrays over many."""

    tooth_count: Any
    module: Real
    pressure_angle: Real
    profile_shift: Real
    dedendum: Real

    @cached_property
    def reference_radius(self) -> Real:
        """Radius at which the rack rolls. [m]."""
        return 0.5 * self.module * self.tooth_count

    @cached_property
    def base_radius(self) -> Real:
        """Radius of the circle that the involute unwinds from. [m]."""
        return plain(self.reference_radius * np.cos(self.pressure_angle))

    @property
    def base_pitch(self) -> Real:
        """Distance of neighbouring flanks along their common normal. [m]."""
        return plain(np.pi * self.module * np.cos(self.pressure_angle))

    @property
    def root_radius(self) -> Real:
        """Radius of the root circle. [m]."""
        return self.reference_radius - (self.dedendum - self.profile_shift) * self.module

    @cached_property
    def base_half_angle(self) -> Real:
        """Half of the tooth's angular thickness on the base circle. [rad]."""
        half = 0.25 * np.pi + self.profile_shift * np.tan(self.pressure_angle)
        return plain(2.0 * half / self.tooth_count + involute_function(self.pressure_angle))

    def half_angle(self, radius: FloatOrArray) -> FloatOrArray:
        """Half of the angular thickness of the unlimited involute tooth.

        Parameters
        ----------
        radius : float or ndarray
            Distance from the centre, at least the base radius. [m]

        Returns
        -------
        float or ndarray
            Half angle; negative above the point where the flanks cross. [rad]
        """
        angle = np.arccos(np.minimum(self.base_radius / np.asarray(radius), 1.0))
        return self.base_half_angle - involute_function(angle)

    def roll_length(self, radius: Real) -> Real:
        """Length of the tangent from a radius [m] to the base circle. [m]."""
        return plain(np.sqrt(np.maximum(radius**2 - self.base_radius**2, 0.0)))


@final
@dataclass(frozen=True)
class InvoluteGear(RackCutTeeth[float]):
    """Parameters of a spur gear that a straight-sided rack with rounded tip would cut.

    Raises
    ------
    GeometryError
        If a value is outside its range; the tooth form is checked by ``tooth_form``.
    """

    tooth_count: int
    """Number of teeth, 5 to 400."""
    module: float
    """Reference diameter over tooth count. [m]"""
    pressure_angle: float = np.deg2rad(20.0)
    """Flank angle of the rack. [rad]"""
    profile_shift: float = 0.0
    """Distance of the rack from its standard place, positive away from the centre. [module]"""
    tip_diameter: float | None = None
    """Outside diameter; None for ``module (tooth_count + 2 + 2 profile_shift)``. [m]"""
    dedendum: float = 1.25
    """Depth of the root below the rack's reference line. [module]"""
    tool_tip_radius: float | None = None
    """Radius of the rack's tip corners; None for 0.38, or for the fully rounded tip where 0.38 does
    not fit. [module]
    """
    tip_rounding: float = 0.0
    """Radius of the arc that joins flank and tip circle tangentially, 0 for a sharp corner. [m]"""

    def __post_init__(self) -> None:
        count = self.tooth_count
        if not (MIN_TOOTH_COUNT <= count <= MAX_TOOTH_COUNT and int(count) == count):
            raise GeometryError(
                "tooth_count", count, f"an integer {MIN_TOOTH_COUNT} to {MAX_TOOTH_COUNT}"
            )
        _check("module", self.module * 1e3, 1e-2, 1e3, "mm")
        _check("pressure_angle", np.rad2deg(self.pressure_angle), 10.0, 35.0, "deg")
        _check("profile_shift", self.profile_shift, -1.5, 2.5, "modules")
        _check("dedendum", self.dedendum, 0.5, 2.0, "modules")
        _check("tip_rounding", self.tip_rounding * 1e3, 0.0, 0.5 * self.module * 1e3, "mm")
        if self.tip_diameter is not None:
            upper = self.module * (self.tooth_count + 8.0)
            _check("tip_diameter", self.tip_diameter * 1e3, 0.0, upper * 1e3, "mm", open_low=True)
        if self._largest_tool_tip_radius < 0.0:
            raise GeometryError(
                "dedendum",
                f"{self.dedendum:g} modules",
                f"up to {0.25 * np.pi / np.tan(self.pressure_angle):.4g} (the rack tooth is "
                "pointed)",
            )
        if self.tool_tip_radius is not None:
            _check("tool_tip_radius", self.tool_tip_radius, 0.0, self._largest_tool_tip_radius,
                   "modules")  # fmt: skip

    @property
    def _largest_tool_tip_radius(self) -> float:
        alpha = self.pressure_angle
        tip_half_width = 0.25 * np.pi - self.dedendum * np.tan(alpha)
        return float(tip_half_width * np.cos(alpha) / (1.0 - np.sin(alpha)))

    @property
    def rack_tip_radius(self) -> float:
        """Radius of the rack's tip corners [m]."""
        radius = self.tool_tip_radius
        if radius is None:
            radius = min(DEFAULT_TOOL_TIP_RADIUS, self._largest_tool_tip_radius)
        return self.module * radius

    @property
    def tip_radius(self) -> float:
        """Radius of the tip circle [m]."""
        if self.tip_diameter is not None:
            return 0.5 * self.tip_diameter
        return self.reference_radius + (1.0 + self.profile_shift) * self.module

    @property
    def smallest_shift_without_undercut(self) -> float:
        """Profile shift below which the rack's tip corner cuts into the involute [module]."""
        alpha = self.pressure_angle
        corner = self.rack_tip_radius / self.module * (1.0 - np.sin(alpha))
        return float(self.dedendum - corner - 0.5 * self.tooth_count * np.sin(alpha) ** 2)


def _check(
    key: str, value: float, low: float, high: float, unit: str, *, open_low: bool = False
) -> None:
    # comparisons are false for NaN
    if not (low < value <= high if open_low else low <= value <= high):
        bounds = f"above {low:g} up to" if open_low else f"from {low:g} to"
        raise GeometryError(key, f"{value:g} {unit}", f"{bounds} {high:.4g} {unit}")
