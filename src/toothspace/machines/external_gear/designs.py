"""Kinematic evaluation of many external gear machines at once, with their keys as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, final

import numpy as np

from toothspace.advice import gear_rules as rules
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.keys import Integer, KeyTable, Number, QuantityKey, Table, keys_of
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.core.units import to_si
from toothspace.gearing.gear_tables import TOOTH_KEYS
from toothspace.gearing.helix import base_helix_angle
from toothspace.geometry.continuous_contact import FAMILIES
from toothspace.geometry.evaluated_designs import DesignReason, EvaluatedDesigns, joined, marked
from toothspace.geometry.gear_pair import (
    LARGEST_OVERLAP,
    ExternalPair,
    Sealing,
    tight_involute,
)
from toothspace.geometry.involute_gear import InvoluteGears
from toothspace.machines.external_gear.spec import SHAPE_KEYS, ExternalGearTables, GearParameters

_ROUNDING = 1e-12
_CHUNK = 8192


@final
@dataclass(frozen=True)
class DesignValues:
    """Values of keys: arrays of one shape (n,) where they vary, else those of the case."""

    machine: KeyTable
    """``[machine]`` of the case."""
    varied: Mapping[str, Array]
    """Values by key path below ``machine``. [SI unit]"""

    @property
    def size(self) -> int:
        """Number of designs."""
        return next(iter(self.varied.values())).size

    def __getitem__(self, path: str) -> Array:
        """Return the values of a key, NaN where the case has none."""
        value = self.varied.get(path)
        if value is None:
            own = self._own(path)
            value = np.full(self.size, np.nan if own is None else own, dtype=float)
        return value

    def _own(self, path: str) -> Any:
        table, _, name = path.partition(".")
        return getattr(getattr(self.machine, table), name, None)

    def given(self, path: str) -> bool:
        """Tell whether a key varies or stands in the case."""
        return path in self.varied or self._own(path) is not None

    def gears(self, table: str, other: InvoluteGears | None = None) -> InvoluteGears:
        """Return the gears of a table; what it leaves out is that of the other gears."""
        names = [name for name in TOOTH_KEYS if self.given(f"{table}.{name}")]
        if other is not None and not names:
            return other
        found = {name: self[f"{table}.{name}"] for name in names}
        # given in the normal section, as on a drawing
        slope = np.cos(self.helix_angle)
        if "pressure_angle" in found:
            found["pressure_angle"] = np.arctan(np.tan(found["pressure_angle"]) / slope)
        if "module" in found:
            found["module"] = found["module"] / slope
        for name in {"profile_shift", "dedendum", "tool_tip_radius"} & found.keys():
            found[name] = found[name] * slope
        rest = [name for name in TOOTH_KEYS if name not in found]
        missing = {
            n: np.full(self.size, np.nan) if other is None else getattr(other, n) for n in rest
        }
        return InvoluteGears(**found, **missing)

    @property
    def helix_angle(self) -> Array:
        """Helix angles at the reference circle, 0 of spur gears. [rad]."""
        return np.nan_to_num(self["gears.helix_angle"])

    def parts(self) -> Iterator[DesignValues]:
        """Parts small enough for the cache of a processor; an empty one where there are none."""
        for start in range(0, max(self.size, 1), _CHUNK):
            chosen = slice(start, start + _CHUNK)
            yield DesignValues(self.machine, {k: v[chosen] for k, v in self.varied.items()})

    def in_range(self, *tables: str) -> BoolArray:
        """Whether all varied values lie in the range of their keys.

        Raises CaseError if a key does not act on the kinematics.
        """
        names = (*TOOTH_KEYS, "helix_angle", "face_width", "normal_backlash", "center_distance")
        found = np.ones(self.size, dtype=bool)
        for path, values in self.varied.items():
            table, _, name = path.partition(".")
            spec = self._keys(table) if table in tables else {}
            if name not in spec or name not in names:
                allowed = [f"{t}.{n}" for t in tables for n in names if n in self._keys(t)]
                raise CaseError(path, "a varied key", f"one of {', '.join(allowed)}")
            key = spec[name][0]
            assert isinstance(key, (Integer, Number, QuantityKey))
            unit = to_si(1.0, key.unit) if isinstance(key, QuantityKey) else 1.0
            low = -np.inf if key.low is None else key.low * unit
            high = np.inf if key.high is None else key.high * unit
            slack = _ROUNDING * np.abs(values)
            inside = np.isfinite(values) & (values >= low - slack) & (values <= high + slack)
            found &= (
                inside & (values == np.rint(values))
                if isinstance(key, Integer)
                else inside
                if key.above is None
                else inside & (values > key.above * unit)
            )
        return found

    def _keys(self, table: str) -> Mapping[str, Any]:
        key = keys_of(type(self.machine))[table][0]
        assert isinstance(key, Table)
        return keys_of(key.spec)


_LARGEST_ANGLE = 1.4
_NEWTON_STEPS = 60
_LARGEST_BACKLASH = 0.5
_LARGEST_DIFFERENCE = 1e-9


@final
@dataclass(frozen=True)
class GearDesigns(ExternalPair[Array]):
    """Pairs of external gears; arrays of one shape (n,)."""

    drive: InvoluteGears
    driven: InvoluteGears
    """Gears."""
    center_distance: Array
    """Distances of the gear centres. [m]"""
    face_width: Array
    """Widths over which the gears mesh. [m]"""
    drives: bool = True
    """Whether the drive gear's flanks push the driven gear (pump) or are pushed (motor)."""
    helix_angle: Array | float = 0.0
    """Helix angles at the reference circle. [rad]"""

    @property
    def overlap_ratio(self) -> Array:
        """Twist of the face width over the pitch angle. [-]."""
        pitch = np.pi * self.drive.module
        return np.asarray(self.face_width * np.tan(self.helix_angle) / pitch)

    @property
    def _backlash_across_teeth(self) -> Array:
        # in the normal section
        base = base_helix_angle(self.helix_angle, self.drive.pressure_angle)
        return np.asarray(self.normal_backlash * np.cos(base))

    def ripple_along_helix(self, flank_sealing: Sealing = "single") -> Array:
        r"""Largest less smallest ideal flow over its mean, over all sections of the width. [-].

        Notes
        -----
        The flow of a section falls with the square of the distance u of its contact from the pitch
        point. Over the part f of the period that the overlap has beyond whole ones, the mean of

        .. math:: \frac{1}{\varepsilon} \int_{f} u^2

        moves; the rest is the same at every angle. It is largest and smallest where the part begins
        or ends at a jump of u, or where u is as large at both of its ends.
        """
        first, last = self.sealing_window(flank_sealing)
        span, period = last - first, 1.0 if flank_sealing == "single" else 0.5
        overlap = self.overlap_ratio / period
        part = np.mod(overlap, 1.0)

        def total(place: Array) -> Array:
            turns = np.floor(place)
            u = first + (place - turns) * span
            return turns * (last**3 - first**3) / 3.0 + (u**3 - first**3) / 3.0

        places = np.stack(
            [
                np.zeros_like(part),
                1.0 - part,
                np.clip(-first / span - 0.5 * part, 0.0, 1.0 - part),
                np.clip(-first / span + 0.5 * (1.0 - part), 1.0 - part, 1.0),
            ]
        )
        swept = total(places + part) - total(places)
        swing = (swept.max(axis=0) - swept.min(axis=0)) / (span * np.maximum(overlap, 1e-12))
        mean = self.displacement_per_radian(1.0, flank_sealing)
        found = 0.5 * (1.0 - self.speed_ratio) * swing / mean
        return np.where(overlap > 1e-6, found, self.flow_ripple(flank_sealing))

    @property
    def forms(self) -> tuple[InvoluteGears, InvoluteGears]:
        """The gears themselves, which know the ends of their involutes."""
        return self.drive, self.driven

    @property
    def tip_radii(self) -> tuple[Array, Array]:
        """Tip circles of drive and driven gears. [m]."""
        return self.drive.tip_radius, self.driven.tip_radius

    def mesh_volume(self, position: Array) -> Array:
        r"""Volume between two contacts of the loaded flanks, backlash open.

        Volume. [m3]

        Parameters
        ----------
        position : ndarray
            Place of the rear contact from the pitch point; the other one is a base pitch ahead.
            [m]

        Notes
        -----
        By Green's theorem round the four-cornered path through both centres and both contacts,

        .. math:: V/b = \tfrac12 p_b (r_{b1} + r_{b2}) - A_1/z_1 - A_2/z_2
                  + \frac{(\rho_1 + p_b)^3 - \rho_1^3}{6 r_{b1}}
                  + \frac{\rho_2^3 - (\rho_2 - p_b)^3}{6 r_{b2}}

        with the areas :math:`A` of both gears and the roll lengths :math:`\rho_{1,2}` of both
        flanks at the rear contact. It is quadratic in the position. Validity: both contacts on
        the involute.
        """
        pitch, bases = self.base_pitch, (self.drive.base_radius, self.driven.base_radius)
        rolls = self.pitch_roll_lengths[0] + position, self.pitch_roll_lengths[1] - position
        area = 0.5 * pitch * (bases[0] + bases[1])
        area -= self.drive.tooth_area + self.driven.tooth_area
        area += ((rolls[0] + pitch) ** 3 - rolls[0] ** 3) / (6.0 * bases[0])
        area += (rolls[1] ** 3 - (rolls[1] - pitch) ** 3) / (6.0 * bases[1])
        return self.face_width * area

    @cached_property
    def trapped_volumes(self) -> tuple[Array, Array, Array]:
        """Volume as the second contact begins, its minimum, and that less the first. [m3]."""
        (start, end), pitch = self.path_of_contact, self.base_pitch
        first, last = (start, end - pitch) if self.drives else (end - pitch, start)
        smallest = np.clip(-0.5 * pitch, np.minimum(first, last), np.maximum(first, last))
        trapped, dead = self.mesh_volume(first), self.mesh_volume(smallest)
        return trapped, dead, trapped - dead

    def numbers(self) -> dict[str, Array]:
        """Numbers of the geometry report by name; the names carry their unit."""
        trapped, dead, change = self.trapped_volumes
        lands = self.drive.tip_land, self.driven.tip_land
        length = self.center_distance + self.drive.tip_radius + self.driven.tip_radius
        height = 2.0 * np.maximum(*self.tip_radii)
        return {
            "displacement_cm3_per_rev": 2e6 * np.pi * self.displacement_per_radian(self.face_width),
            "flow_ripple_percent": 100.0 * self.ripple_along_helix(),
            "flow_ripple_dual_percent": 100.0 * self.ripple_along_helix("dual"),
            "contact_ratio": self.contact_ratio,
            "overlap_ratio": self.overlap_ratio,
            "trapped_volume_mm3": 1e9 * trapped,
            "dead_volume_mm3": 1e9 * dead,
            "trapped_volume_change_mm3": 1e9 * change,
            "tip_land_mm": 1e3 * np.minimum(*lands),
            "root_clearance_mm": 1e3 * np.minimum(*self.root_clearances),
            "center_distance_mm": 1e3 * self.center_distance,
            "normal_backlash_mm": 1e3 * self._backlash_across_teeth,
            "operating_pressure_angle_deg": np.rad2deg(self.operating_pressure_angle),
            "base_diameter_mm": 2e3 * self.drive.base_radius,
            "tip_diameter_mm": 2e3 * self.drive.tip_radius,
            "face_width_mm": 1e3 * self.face_width,
            "envelope_cm3": 1e6 * length * height * self.face_width,
        }

    def evaluated(self) -> EvaluatedDesigns:
        """Numbers of the designs, and what is against them."""
        none = np.zeros(self.face_width.shape, dtype=np.int64)
        return EvaluatedDesigns(self.numbers(), none).refused(self.reasons())

    def reasons(self) -> IntArray:
        """Bits of :class:`DesignReason` of pairs that cannot turn or break a design rule."""
        drive, driven = self.drive, self.driven
        bases = driven.base_radius * drive.tooth_count / (drive.base_radius * driven.tooth_count)
        meets = self.center_distance < drive.tip_radius + driven.tip_radius
        overlap = -self.normal_backlash / np.sin(self.operating_pressure_angle)
        found = (
            drive.reasons
            | driven.reasons
            | marked(
                meets.shape,
                {
                    DesignReason.BASE_PITCH: np.abs(bases - 1.0) > _LARGEST_DIFFERENCE,
                    DesignReason.NO_MESH: ~(meets & np.isfinite(overlap)),
                    DesignReason.OVERLAP: overlap > 2.0 * LARGEST_OVERLAP,
                    DesignReason.ROOT_CLEARANCE: np.minimum(*self.root_clearances) <= 0.0,
                    DesignReason.CONTACT_RATIO: ~(self.contact_ratio >= 1.0),
                },
            )
        )
        which = np.flatnonzero((np.minimum(*self.involute_margins) < 0.0) & (found == 0))
        if which.size:
            # tips that reach below the involute cut the fillet there
            first, second = self.drive.chosen(which), self.driven.chosen(which)
            distance, play = self.center_distance[which], np.full(found.shape, np.inf)
            play[which] = np.minimum(
                first.fillet_play(second, distance), second.fillet_play(first, distance)
            )
            found |= marked(found.shape, {DesignReason.INTERFERENCE: play < -LARGEST_OVERLAP})
        return found | self._broken_rules()

    def _broken_rules(self) -> IntArray:
        drive, driven, module = self.drive, self.driven, self.drive.module
        ratio, backlash = self.contact_ratio, self._backlash_across_teeth
        margins = self.involute_margins
        deep = (margins[0] < 0.0) & ~drive.undercut | (margins[1] < 0.0) & ~driven.undercut
        lands = np.minimum(drive.tip_land / module, driven.tip_land / driven.module)
        rooms = np.minimum(*self.root_clearances) / module
        least = rules.least_normal_backlash(module, self.center_distance)
        return marked(
            module.shape,
            {
                DesignReason.CONTACT_RATIO_RULE: (ratio < rules.MIN_CONTACT_RATIO)
                | (ratio > rules.MAX_SPUR_CONTACT_RATIO),
                DesignReason.TIP_LAND_RULE: lands < rules.MIN_TIP_LAND,
                DesignReason.UNDERCUT_RULE: drive.undercut | driven.undercut,
                DesignReason.INTERFERENCE_RULE: deep,
                DesignReason.ROOT_CLEARANCE_RULE: rooms < rules.MIN_ROOT_CLEARANCE,
                DesignReason.BACKLASH_RULE: (backlash < least)
                | (backlash > rules.MAX_BACKLASH * module),
                DesignReason.TRAPPED_VOLUME_RULE: self.trapped_volumes[2]
                > rules.VENTED_SHARE * self.face_width * module**2,
            },
        )


def distance_of_backlash(
    drive: InvoluteGears, driven: InvoluteGears, normal_backlash: Array
) -> Array:
    """Centre distances that leave a normal backlash; NaN where there is none. [m]."""
    total = drive.base_radius + driven.base_radius
    target = tight_involute(drive, driven) + 0.5 * normal_backlash / total
    allowed = (normal_backlash >= 0.0) & (normal_backlash <= _LARGEST_BACKLASH * drive.module)
    largest = np.tan(_LARGEST_ANGLE) - _LARGEST_ANGLE
    target = np.where(allowed & (target > 0.0) & (target < largest), target, np.nan)
    # from above, Newton's iterates fall towards the root of a convex function
    angle = np.minimum(np.cbrt(3.0 * target), _LARGEST_ANGLE)
    for _ in range(_NEWTON_STEPS):
        tangent = np.tan(angle)
        step = (tangent - angle - target) / tangent**2
        angle = angle - step
        if not np.any(step > 1e-15):
            break
    return np.asarray(total / np.cos(angle))


def evaluate_designs(
    machine: ExternalGearTables,
    varied: Mapping[str, Array],
    addendum: float | None = None,
    displacement: float | None = None,
) -> EvaluatedDesigns:
    """Kinematics of a machine with other gears, as :func:`toothspace.api.evaluate_designs`.

    Key paths of ``varied`` begin below ``machine``.

    Raises
    ------
    CaseError
        If the teeth come from files, or a key does not act on the kinematics.
    """
    own = machine.driven_gear
    if machine.gears.profile is not None or (own is not None and own.profile is not None):
        raise CaseError("gears.profile", "a file", "gears given by parameters")
    varied = dict(varied)
    size = next(iter(varied.values())).size
    families = varied.pop("gears.family", np.full(size, machine.gears.family))
    known = {"involute", *FAMILIES}
    for family in families:
        if str(family) not in known:
            raise CaseError("gears.family", repr(str(family)), ", ".join(sorted(known)))
    # a design with nothing but its family varied
    varied = varied or {"gears.tooth_count": np.full(size, machine.gears.tooth_count, float)}
    values = DesignValues(machine, varied)
    in_range = values.in_range("gears", "driven_gear")
    places, parts = [], []
    with np.errstate(all="ignore"):
        for continuous in (False, True):
            where = np.flatnonzero((families != "involute") == continuous)
            if continuous and where.size == 0:
                continue
            chosen = DesignValues(machine, {path: x[where] for path, x in varied.items()})
            places.append(where)
            parts += (
                [_evaluated(part, addendum, displacement, machine.mode) for part in chosen.parts()]
                if not continuous
                else [_continuous(machine.gears, chosen, families[where], addendum, displacement)]
            )
    outside = marked(in_range.shape, {DesignReason.OUT_OF_RANGE: ~in_range})
    order = np.argsort(np.concatenate(places), kind="stable")
    return joined(parts).chosen(order).refused(outside)


def _continuous(
    own: GearParameters,
    values: DesignValues,
    families: Array,
    addendum: float | None,
    displacement: float | None,
) -> EvaluatedDesigns:
    """Designs of continuous contact, one after the other; keys of other families do not act."""
    rows = [
        _continuous_numbers(
            own,
            str(family),
            {path.partition(".")[2]: x[k] for path, x in values.varied.items()},
            addendum,
            displacement,
        )
        for k, family in enumerate(families)
    ]
    names = dict.fromkeys(name for row, _ in rows for name in row)
    numbers = {name: np.array([row.get(name, np.nan) for row, _ in rows]) for name in names}
    reasons = np.array([bits for _, bits in rows], dtype=np.int64)
    return EvaluatedDesigns(numbers, np.zeros_like(reasons)).refused(reasons)


def _continuous_numbers(
    own: GearParameters,
    family: str,
    varied: Mapping[str, Any],
    addendum: float | None,
    displacement: float | None,
) -> tuple[dict[str, float], int]:
    kept = ("tooth_count", "module", "helix_angle", "face_width", "normal_backlash")
    shape = SHAPE_KEYS.get(family, ())
    given = {name: varied.get(name, getattr(own, name)) for name in (*kept, *shape)}
    given["tooth_count"] = int(given["tooth_count"] or 0)
    try:
        if addendum is not None and "tip_diameter" in shape:
            pitch = given["tooth_count"] * given["module"] / np.cos(given["helix_angle"])
            given["tip_diameter"] = pitch + 2.0 * addendum * given["module"]
        keys = GearParameters(
            family=family,
            tip_land=own.tip_land,
            material=own.material,
            roughness=own.roughness,
            **given,
        )
        gear = keys.continuous_gear()
        gear.check()
    except GeometryError:
        return {}, int(DesignReason.CONTINUOUS)
    except CaseError:
        return {}, int(DesignReason.OUT_OF_RANGE)
    width = given["face_width"]
    if displacement is not None:
        width = displacement / gear.displacement_per_radian(1.0)
    overlap = width * np.tan(given["helix_angle"]) / (np.pi * gear.module)
    ripple = 100.0 * gear.flow_ripple(float(overlap))
    tip, distance = gear.tip_radius, 2.0 * gear.reference_radius
    root = np.hypot(*gear.points(gear.pieces()[0](np.zeros(1)), mate=True)[0])
    numbers = {
        "displacement_cm3_per_rev": 2e6 * np.pi * gear.displacement_per_radian(width),
        "flow_ripple_percent": ripple,
        "flow_ripple_dual_percent": ripple,
        "contact_ratio": 0.5,
        "overlap_ratio": float(overlap),
        "tip_land_mm": 1e3 * gear.tip_land,
        "root_clearance_mm": 1e3 * float(distance - tip - root),
        "center_distance_mm": 1e3 * distance,
        "normal_backlash_mm": 1e3 * given["normal_backlash"],
        "tip_diameter_mm": 2e3 * tip,
        "face_width_mm": 1e3 * width,
        "envelope_cm3": 1e6 * (distance + 2.0 * tip) * 2.0 * tip * width,
    }
    broken = {
        DesignReason.CONTACT_RATIO_RULE: overlap + 0.5 < 1.0 - 1e-9,
        DesignReason.OVERLAP_RULE: rules.overlap_from_whole(overlap) > rules.OVERLAP_TOLERANCE,
        DesignReason.BACKLASH_RULE: gear.backlash > rules.MAX_CONTINUOUS_BACKLASH * gear.module,
        DesignReason.CURVATURE_RULE: gear.smallest_radius < rules.MIN_CURVATURE * gear.module,
    }
    return numbers, sum(int(reason) for reason, found in broken.items() if found)


def _evaluated(
    values: DesignValues, addendum: float | None, displacement: float | None, mode: str
) -> EvaluatedDesigns:
    drive = values.gears("gears")
    driven = values.gears("driven_gear", drive)
    if addendum is not None:
        same = driven is drive
        drive = drive.with_addendum(addendum)
        driven = drive if same else driven.with_addendum(addendum)
    if values.given("gears.center_distance") and "gears.normal_backlash" not in values.varied:
        distance = values["gears.center_distance"]
    else:
        base = base_helix_angle(values.helix_angle, drive.pressure_angle)
        play = values["gears.normal_backlash"] / np.cos(base)
        distance = distance_of_backlash(drive, driven, play)
    width = values["gears.face_width"]
    designs = GearDesigns(drive, driven, distance, width, mode == "pump", values.helix_angle)
    if displacement is not None:
        width = displacement / designs.displacement_per_radian(1.0)
        designs = replace(designs, face_width=width)
    return designs.evaluated()
