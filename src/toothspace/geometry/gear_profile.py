"""One tooth pitch of a gear with identical teeth, the form in which later stages see a gear."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, FloatOrArray
from toothspace.geometry.curve import polar, turned_copies
from toothspace.geometry.involute_gear import Real, plain


@final
@dataclass(frozen=True)
class InvoluteFlank:
    """Involute part of both flanks of a tooth that is centred on the x axis."""

    base_radius: float
    """Radius of the base circle. [m]"""
    base_half_angle: float
    """Half of the tooth's angular thickness on the base circle. [rad]"""
    form_radius: float
    tip_form_radius: float
    """Ends of the involute towards root fillet and tip. [m]"""
    undercut: bool = False
    """Whether the root cuts involute away above the base circle."""
    residual: float = 0.0
    """Root mean square of the normal distance of the points that the involute was fitted to; 0 for
    a generated tooth. [m]
    """

    def half_angle(self, radius: FloatOrArray) -> FloatOrArray:
        """Half of the tooth's angular thickness at a radius of at least the base radius [rad]."""
        cosine = np.minimum(self.base_radius / np.asarray(radius), 1.0)
        angle = np.arccos(cosine)
        return self.base_half_angle - (np.tan(angle) - angle)

    def pressure_angle(self, reference_radius: float) -> float:
        """Pressure angle of the flank at a radius of at least the base radius [rad]."""
        return float(np.arccos(self.base_radius / reference_radius))

    def roll_length(self, radius: Real) -> Real:
        """Length of the tangent from the base circle to the flank at a radius [m]."""
        return plain(np.sqrt(np.maximum(radius**2 - self.base_radius**2, 0.0)))

    def curve(self, outer: float) -> Callable[[Array], Array]:
        """Points from a radius inwards to the form radius over 0 to 1, even in roll length. [m]."""
        base, upper, lower = self.base_radius, *map(self.roll_length, (outer, self.form_radius))

        def points(u: Array) -> Array:
            roll = upper + (lower - upper) * u
            return polar(
                np.hypot(base, roll), self.base_half_angle - (roll / base - np.arctan(roll / base))
            )

        return points

    def scaled(self, factor: float) -> InvoluteFlank:
        """Similar flank with every length multiplied by a positive factor [-]."""
        lengths = ("base_radius", "form_radius", "tip_form_radius", "residual")
        return replace(self, **{name: factor * getattr(self, name) for name in lengths})


@final
@dataclass(frozen=True)
class GearProfile:
    """One tooth pitch of a gear with identical teeth, own frame, centre at the origin.

    The tooth is centred on the +x axis (polar angle 0).
    """

    tooth_count: int
    """Number of identical teeth."""
    points: Array
    """One pitch, shape (n, 2), counter-clockwise, from the middle of a tooth space at polar angle
    ``-pi/tooth_count`` to the middle of the next at ``+pi/tooth_count``. [m]
    """
    tip_start: int
    tip_end: int
    """Index of the first and of the last point on the tip land, where the profile reaches the tip
    circle.
    """
    tip_radius: float
    root_radius: float
    """Largest and smallest distance from the centre. [m]"""
    involute: InvoluteFlank | None = None
    """Involute part of the flanks; None where no involute is known."""
    breaks: tuple[int, ...] = ()
    """Indices, root to root, at which curvature or tangent jumps: a spline through a flank may be
    cut there.
    """

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or len(self.points) < 8:
            raise GeometryError(
                "points", f"an array of shape {self.points.shape}", "(n, 2) with n >= 8"
            )
        if not np.all(np.isfinite(self.points)):
            raise GeometryError("points", "a value that is not finite", "finite numbers")
        if not 0 < self.tip_start <= self.tip_end < len(self.points) - 1:
            raise GeometryError(
                "tip_start, tip_end",
                f"{self.tip_start}, {self.tip_end}",
                f"increasing indices inside 1 to {len(self.points) - 2}",
            )

    @property
    def base_radius(self) -> float | None:
        """Base circle of the involute flanks; None where no involute is known [m]."""
        return None if self.involute is None else self.involute.base_radius

    @property
    def pitch_angle(self) -> float:
        """Angle between neighbouring teeth [rad]."""
        return 2.0 * np.pi / self.tooth_count

    @property
    def right_flank(self) -> Array:
        """Points from root middle to tip corner on the clockwise side of the tooth [m]."""
        return self.points[: self.tip_start + 1]

    @property
    def left_flank(self) -> Array:
        """Points from tip corner to root middle on the counter-clockwise side of the tooth [m]."""
        return self.points[self.tip_end :]

    @property
    def area(self) -> float:
        """Area of the full gear section inside its closed polygon [m2]."""
        x, y = self.points.T
        return float(0.5 * self.tooth_count * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))

    @property
    def tooth_space_area(self) -> float:
        """Area of one tooth space between the profile and the tip circle [m2]."""
        return float(np.pi * self.tip_radius**2 - self.area) / self.tooth_count

    def closed_polygon(
        self, rotation: float = 0.0, center: tuple[float, float] = (0.0, 0.0)
    ) -> Array:
        """Outline of the whole gear.

        Points, shape (tooth_count (n - 1), 2), counter-clockwise, not repeated at the end. [m]

        Parameters
        ----------
        rotation : float
            Angle of the first tooth from the x axis, counter-clockwise. [rad]
        center : tuple of float
            Position of the gear centre. [m]
        """
        angles = rotation + self.pitch_angle * np.arange(self.tooth_count, dtype=float)
        return turned_copies(self.points[:-1], angles) + np.asarray(center, dtype=float)

    def scaled(self, factor: float) -> GearProfile:
        """Similar gear with every length multiplied by a positive factor [-]."""
        return replace(
            self,
            points=self.points * factor,
            tip_radius=self.tip_radius * factor,
            root_radius=self.root_radius * factor,
            involute=self.involute and self.involute.scaled(factor),
        )
