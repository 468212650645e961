"""One tooth pitch of a gear with identical teeth, the form in which later stages see a gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array


@final
@dataclass(frozen=True)
class GearProfile:
    """One tooth pitch of a gear with identical teeth, own frame, centre at the origin.

    The tooth is centred on the +x axis (polar angle 0).

    Parameters
    ----------
    tooth_count : int
        Number of identical teeth.
    points : ndarray
        One pitch, shape (n, 2), counter-clockwise, from the middle of a tooth space at polar angle
        ``-pi/tooth_count`` to the middle of the next at ``+pi/tooth_count``. [m]
    tip_start, tip_end : int
        Index of the first and of the last point on the tip land, where the profile reaches the tip
        circle.
    tip_radius, root_radius : float
        Largest and smallest distance from the centre. [m]
    base_radius : float or None
        Base circle of the involute flanks; None where no involute is known. [m]
    breaks : tuple of int
        Indices, root to root, at which curvature or tangent jumps: a spline through a flank may be
        cut there.
    """

    tooth_count: int
    points: Array
    tip_start: int
    tip_end: int
    tip_radius: float
    root_radius: float
    base_radius: float | None = None
    breaks: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or len(self.points) < 8:
            raise GeometryError(
                f"points: found an array of shape {self.points.shape}, allowed (n, 2) with n >= 8"
            )
        if not np.all(np.isfinite(self.points)):
            raise GeometryError("points: found a value that is not finite, allowed finite numbers")
        if not 0 < self.tip_start <= self.tip_end < len(self.points) - 1:
            raise GeometryError(
                f"tip_start, tip_end: found {self.tip_start}, {self.tip_end}, allowed increasing "
                f"indices inside 1 to {len(self.points) - 2}"
            )

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

        Parameters
        ----------
        rotation : float
            Angle of the first tooth from the x axis, counter-clockwise. [rad]
        center : tuple of float
            Position of the gear centre. [m]

        Returns
        -------
        ndarray
            Points, shape (tooth_count (n - 1), 2), counter-clockwise, not repeated at the end. [m]
        """
        angles = rotation + self.pitch_angle * np.arange(self.tooth_count)
        phasors = np.exp(1j * angles)[:, None] * (self.points[:-1] @ np.array([1.0, 1j]))[None, :]
        outline = np.column_stack([phasors.real.ravel(), phasors.imag.ravel()])
        return outline + np.asarray(center, dtype=float)

    def scaled(self, factor: float) -> GearProfile:
        """Similar gear with every length multiplied by a positive factor."""
        base = None if self.base_radius is None else self.base_radius * factor
        return GearProfile(
            tooth_count=self.tooth_count,
            points=self.points * factor,
            tip_start=self.tip_start,
            tip_end=self.tip_end,
            tip_radius=self.tip_radius * factor,
            root_radius=self.root_radius * factor,
            base_radius=base,
            breaks=self.breaks,
        )
