"""Involute spur gears: parameters, the lengths that follow from them, and teeth of many at once."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from typing import Any, Generic, TypeVar, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, BoolArray, FloatOrArray, IntArray
from toothspace.geometry.evaluated_designs import DesignReason, marked
from toothspace.numerics.roots import roots_between

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

        Half angle; negative above the point where the flanks cross. [rad]

        Parameters
        ----------
        radius : float or ndarray
            Distance from the centre, at least the base radius. [m]
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


_LEAST_ROOT = 0.05
_LEAST_NECK = 0.1
_NECK_SAMPLES = 200
_COARSE_NECK_SAMPLES = 12
_FILLET_SAMPLES = 24
_ARC_SAMPLES = 4


@final
@dataclass(frozen=True)
class InvoluteGears(RackCutTeeth[Array]):
    """Gears that straight-sided racks cut, as :class:`InvoluteGear`; arrays of one shape (n,)."""

    tooth_count: Array
    """Numbers of teeth."""
    module: Array
    pressure_angle: Array
    profile_shift: Array
    """Rack and its place. [m], [rad], [module]"""
    tip_diameter: Array
    """Outside diameters. [m]"""
    dedendum: Array
    """Depth of the root below the reference line. [module]"""
    tool_tip_radius: Array
    """Radius of the rack's tip corners; NaN for 0.38, or the fully rounded tip. [module]"""
    tip_rounding: Array
    """Radius between flank and tip circle. [m]"""

    @classmethod
    def of(cls, gear: InvoluteGear) -> InvoluteGears:
        """One gear as arrays."""
        tool, given = gear.tool_tip_radius, asdict(gear)
        given["tip_diameter"] = 2.0 * gear.tip_radius
        given["tool_tip_radius"] = np.nan if tool is None else tool
        return cls(**{name: np.array([float(value)]) for name, value in given.items()})

    @property
    def tip_radius(self) -> Array:
        """Radii of the tip circles. [m]."""
        return 0.5 * self.tip_diameter

    @cached_property
    def _corner(self) -> tuple[Array, Array, Array]:
        """Centre of the rack's corner below the rolling line and beside its axis, radius. [m]."""
        sine, cosine = np.sin(self.pressure_angle), np.cos(self.pressure_angle)
        half_width = 0.25 * np.pi - self.dedendum * np.tan(self.pressure_angle)
        largest = half_width * cosine / (1.0 - sine)
        default = np.minimum(DEFAULT_TOOL_TIP_RADIUS, largest)
        radius = np.where(np.isnan(self.tool_tip_radius), default, self.tool_tip_radius)
        side = half_width - radius * (1.0 - sine) / cosine
        depth = self.dedendum - self.profile_shift - radius
        side = np.where(side > 1e-6, side, np.where(radius <= largest + 1e-9, 0.0, np.nan))
        return depth * self.module, side * self.module, radius * self.module

    def fillet(self, tangent: FloatOrArray) -> tuple[Array, Array]:
        """Root fillets over the tangent of the rack's corner angle: radius, angle. [m], [rad]."""
        depth_0, side, rho = self._corner
        depth = depth_0 + rho / np.sqrt(1.0 + np.square(tangent))
        along, across = self.reference_radius - depth, depth * tangent
        roll = (depth_0 * tangent - side) / self.reference_radius
        return np.hypot(along, across), np.asarray(np.arctan2(across, along) - roll)

    @cached_property
    def undercut(self) -> BoolArray:
        """Whether the fillet cuts the involute."""
        depth, _, rho = self._corner
        sine = np.sin(self.pressure_angle)
        return np.asarray(self.reference_radius * sine**2 < depth + rho * sine)

    @cached_property
    def fillet_end(self) -> tuple[Array, Array]:
        """Tangent of the corner angle where the fillet ends, and the form radius there. [m]."""
        sine, cosine = np.sin(self.pressure_angle), np.cos(self.pressure_angle)
        depth, _, rho = self._corner
        last = cosine / sine
        roll = self.reference_radius * sine - (depth + rho * sine) / sine
        radius = np.hypot(self.base_radius, roll)
        if self.undercut.any():
            cut = np.flatnonzero(self.undercut)
            gears = self.chosen(cut)
            latest = last[cut]

            # from where the fillet crosses the base circle on, it may meet the involute
            def height(tangent: Array) -> Array:
                return gears.fillet(tangent)[0] / gears.base_radius - 1.0

            def gap(tangent: Array) -> Array:
                reach, space = gears.fillet(tangent)
                flank = gears.half_angle(np.maximum(reach, gears.base_radius))
                return np.asarray(space + flank - np.pi / gears.tooth_count)

            zero = np.zeros_like(latest)
            start = roots_between(height, zero, latest)
            start = np.where((height(zero) < 0.0) & (height(latest) > 0.0), start, 0.0)
            end = roots_between(gap, start, latest)
            ends = np.where((gap(start) > 0.0) & (gap(latest) < 0.0), end, start)
            last, radius = last.copy(), radius.copy()
            last[cut], radius[cut] = ends, gears.fillet(ends)[0]
        return last, radius

    @property
    def form_radius(self) -> Array:
        """Radii at which the involutes start. [m]."""
        return self.fillet_end[1]

    @cached_property
    def tip_form_radius(self) -> Array:
        """Radii at which the involutes end. [m]."""
        center = self.tip_radius - self.tip_rounding
        return np.hypot(self.base_radius, self.roll_length(center) + self.tip_rounding)

    @cached_property
    def tip_half_angle(self) -> Array:
        """Half of the angle that the tip land covers. [rad]."""
        center = self.tip_radius - self.tip_rounding
        return self.half_angle(center) - self.tip_rounding / self.base_radius

    @property
    def tip_land(self) -> Array:
        """Width of the tip land along the tip circle. [m]."""
        return 2.0 * self.tip_half_angle * self.tip_radius

    @cached_property
    def tooth_area(self) -> Array:
        r"""Area of the section of the gear over its tooth count. [m2].

        Notes
        -----
        The sector :math:`\frac12 \oint r^2 \mathrm d\theta` over tip land, rounding, involute
        (:math:`\rho^3/(6 r_b)` of the roll length :math:`\rho`), fillet and root circle.
        """
        base, tip = self.base_radius, self.tip_radius
        flank = (
            self.roll_length(self.tip_form_radius) ** 3 - self.roll_length(self.form_radius) ** 3
        )
        root = 0.5 * self.root_radius**2 * self._corner[1] / self.reference_radius
        half = 0.5 * tip**2 * self.tip_half_angle + flank / (6.0 * base) + root
        radius, (center, end, turn) = self.tip_rounding, self._rounding
        start = self.tip_radius * np.exp(1j * self.tip_half_angle)
        chord = np.imag(np.conj(center) * (end - start))
        rounding = np.where(radius > 0.0, 0.5 * (radius**2 * turn + chord), 0.0)
        # over t, the tangent of the corner angle: depth d = y + rho c with c = 1/sqrt(1 + t^2)
        depth, _, rho = self._corner
        end, reference = self.fillet_end[0], self.reference_radius
        root = np.sqrt(1.0 + end**2)
        sine, angle = np.arcsinh(end), np.arctan(end)
        first = depth * end + rho * sine
        square = depth**2 * end + 2.0 * depth * rho * sine + rho**2 * angle
        slope = -rho * (sine - end / root)
        lever = depth**2 * end**3 / 3.0 + depth * rho * (end * root - sine)
        lever += rho**2 * (end - angle)
        turning = reference**2 * end - 2.0 * reference * first + square + lever
        sector = reference * first - square + reference * slope - depth / reference * turning
        return 2.0 * (half + rounding + np.asarray(0.5 * sector))

    @cached_property
    def _rounding(self) -> tuple[Any, Any, Array]:
        """Centre and end of the tip rounding as complex numbers [m], angle of its arc [rad]."""
        land = np.exp(1j * self.tip_half_angle)
        center = (self.tip_radius - self.tip_rounding) * land
        end = self.tip_form_radius * np.exp(1j * self.half_angle(self.tip_form_radius))
        return center, end, np.angle((end - center) * np.conj(land))

    @cached_property
    def reasons(self) -> IntArray:
        """Bits of :class:`DesignReason` for which no such tooth exists."""
        depth, side, rho = self._corner
        end, form = self.fillet_end
        center = self.tip_radius - self.tip_rounding
        # the radius falls along the fillet where the trochoid has its loop
        cosine = 1.0 / np.sqrt(1.0 + end**2)
        place = np.clip(np.sqrt(np.maximum(-depth, 0.0) / (3.0 * self.reference_radius)), cosine, 1)
        rise = self.reference_radius * rho * place**3 + depth * (depth + rho * place)
        thin = np.zeros(self.module.shape, dtype=bool)
        for samples, margin in ((_COARSE_NECK_SAMPLES, 2.0), (_NECK_SAMPLES, 1.0)):
            cut = np.flatnonzero(self.undercut if margin > 1.0 else thin)
            if not cut.size:
                break
            gears, thin = self.chosen(cut), np.zeros_like(thin)
            last = np.arctan(self.fillet_end[0][cut])
            share = np.linspace(0.0, 1.0, samples)
            radius, space = gears.fillet(np.tan(share[:, None] * last))
            neck = 2.0 * np.min(
                (np.pi / gears.tooth_count - space) * radius, axis=0, initial=np.inf
            )
            thin[cut] = neck < margin * _LEAST_NECK * gears.module
        return marked(
            self.module.shape,
            {
                DesignReason.TOOL_TIP: np.isnan(side),
                DesignReason.ROOT_CIRCLE: self.root_radius <= _LEAST_ROOT * self.module,
                DesignReason.FILLET: (depth < 0.0) & (rise < 0.0) | thin,
                DesignReason.TIP: ~((center > self.base_radius) & (self.tip_half_angle > 0.0)),
                DesignReason.NO_INVOLUTE: form >= self.tip_form_radius,
            },
        )

    def with_addendum(self, addendum: float) -> InvoluteGears:
        """Gears whose tips stand so many modules above the shifted reference line. [module]."""
        height = self.tooth_count + 2.0 * (self.profile_shift + addendum)
        return replace(self, tip_diameter=self.module * height)

    def chosen(self, which: IntArray) -> InvoluteGears:
        """Gears of some indices."""
        return InvoluteGears(*(getattr(self, one.name)[which] for one in fields(self)))

    def fillet_play(self, mating: InvoluteGears, center_distance: Array) -> Array:
        r"""Arc between the fillets and the mating tips as these pass, with centred backlash.

        Smallest play, negative where a tip cuts into the root; infinite where none reaches the
        fillet. [m]

        Parameters
        ----------
        mating : InvoluteGears
            Gears whose tips enter.
        center_distance : ndarray
            Distances of the centres. [m]

        Notes
        -----
        A point of the mating tip at radius :math:`\varrho` and angle :math:`\beta` from its
        tooth's axis stands at radius :math:`r` of this gear when
        :math:`\cos\psi = (a^2 + \varrho^2 - r^2)/(2 a \varrho)`, at the angle
        :math:`\beta z_2/z_1 + |\chi - \psi z_2/z_1|` from the middle of the space, with the polar
        angles :math:`\psi, \chi` from both centres. Fillet and tip rounding are sampled.
        """
        last = np.arctan(self.fillet_end[0])
        share = np.linspace(0.0, 1.0, _FILLET_SAMPLES)[:, None, None]
        radius, space = self.fillet(np.tan(share * last))
        tip, angle = mating.tip_corner(np.linspace(0.0, 1.0, _ARC_SAMPLES)[None, :, None])
        cosine = (center_distance**2 + tip**2 - radius**2) / (2.0 * center_distance * tip)
        psi = np.arccos(np.minimum(cosine, 1.0))
        chi = np.arctan2(tip * np.sin(psi), center_distance - tip * np.cos(psi))
        ratio = mating.tooth_count / self.tooth_count
        play = radius * (space - angle * ratio - np.abs(chi - psi * ratio))
        return np.asarray(np.min(np.where(cosine < 1.0, play, np.inf), axis=(0, 1)))

    def tip_corner(self, share: Array) -> tuple[Array, Array]:
        """Points on the tip rounding, 0 at the land to 1 at the flank: radius, angle [m], [rad]."""
        center, _, turn = self._rounding
        corner = center + self.tip_rounding * np.exp(1j * (self.tip_half_angle + share * turn))
        return np.abs(corner), np.angle(corner)
