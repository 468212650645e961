"""Teeth of many involute gears at once, in closed form over arrays."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from typing import Any, final

import numpy as np

from toothspace.core.types import Array, BoolArray, FloatOrArray, IntArray
from toothspace.geometry.evaluated_designs import DesignReason, marked
from toothspace.geometry.involute_gear import DEFAULT_TOOL_TIP_RADIUS, InvoluteGear, RackCutTeeth
from toothspace.numerics.roots import roots_between

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
            ends = gears._undercut_end(last[cut])
            last, radius = last.copy(), radius.copy()
            last[cut], radius[cut] = ends, gears.fillet(ends)[0]
        return last, radius

    def _undercut_end(self, last: Array) -> Array:
        # from where the fillet crosses the base circle on, it may meet the involute
        def height(tangent: Array) -> Array:
            return self.fillet(tangent)[0] / self.base_radius - 1.0

        def gap(tangent: Array) -> Array:
            radius, space = self.fillet(tangent)
            flank = self.half_angle(np.maximum(radius, self.base_radius))
            return np.asarray(space + flank - np.pi / self.tooth_count)

        zero = np.zeros_like(last)
        start = roots_between(height, zero, last)
        start = np.where((height(zero) < 0.0) & (height(last) > 0.0), start, 0.0)
        end = roots_between(gap, start, last)
        return np.where((gap(start) > 0.0) & (gap(last) < 0.0), end, start)

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
        return 2.0 * (half + rounding + self._fillet_sector())

    @cached_property
    def _rounding(self) -> tuple[Any, Any, Array]:
        """Centre and end of the tip rounding as complex numbers [m], angle of its arc [rad]."""
        land = np.exp(1j * self.tip_half_angle)
        center = (self.tip_radius - self.tip_rounding) * land
        end = self.tip_form_radius * np.exp(1j * self.half_angle(self.tip_form_radius))
        return center, end, np.angle((end - center) * np.conj(land))

    def _fillet_sector(self) -> Array:
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
        return np.asarray(0.5 * sector)

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

        Parameters
        ----------
        mating : InvoluteGears
            Gears whose tips enter.
        center_distance : ndarray
            Distances of the centres. [m]

        Returns
        -------
        ndarray
            Smallest play, negative where a tip cuts into the root; infinite where none reaches
            the fillet. [m]

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
