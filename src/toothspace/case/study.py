"""``[study]``: named studies and their own keys."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, dataclass
from pathlib import Path
from typing import Any, final

from toothspace.core.keys import (
    Free,
    Integer,
    KeyRuleError,
    KeyTable,
    Named,
    Number,
    QuantityKey,
    Row,
    Table,
    choice,
    declare,
    file_path,
    flag,
    forbid,
    grid,
    integer,
    items,
    number,
    quantity,
    require,
    text,
)
from toothspace.core.units import is_quantity

_SPEED = QuantityKey(unit="rpm", above=0, high=50000)
_PRESSURE = QuantityKey(unit="bar", above=0, high=1000)
_LARGEST_COUNT = 10000


@final
@dataclass(frozen=True, kw_only=True)
class StartupStudy(KeyTable):
    """``kind = "startup"``: start-up over plateau speeds and start angles."""

    plateau_speed: tuple[float, ...] | None = grid(
        _SPEED, "Plateau speeds of the supply.", default=None
    )
    start_angle_count: int = integer(
        "Start angles over one tooth pitch.", low=1, high=360, default=1
    )


@final
@dataclass(frozen=True, kw_only=True)
class EfficiencyMapStudy(KeyTable):
    """``kind = "efficiency_map"``: steady points over speed and pressure difference."""

    shaft_speed: tuple[float, ...] = grid(_SPEED, "Shaft speeds.")
    pressure_difference: tuple[float, ...] = grid(_PRESSURE, "High minus low pressure.")
    measured: Path | None = file_path(
        "Rows of operating_point.shaft_speed, one port pressure of operating_point and "
        "mean_torque_N_m or mean_flow_L_per_min, to lay over the results.",
        ".csv",
        default=None,
    )


@final
@dataclass(frozen=True, kw_only=True)
class HysteresisStudy(KeyTable):
    """``kind = "hysteresis"``: pressures up and down with bearing friction."""

    outlet_pressures: tuple[float, ...] = items(_PRESSURE, "Outlet pressures in their order.")
    start_gap: float = quantity("um", "Gap that the first point starts from.", above=0, high=100)
    friction_coefficient: float = number("Friction in the housing.", low=0, high=1)
    breakaway_speed: float = quantity("mm/s", "Speed of the friction peak.", above=0, high=1e4)
    friction_law: str = choice("Set-valued, or smooth.", "stick", "stribeck", default="stick")
    coupling_rounds: int = integer(
        "Most runs of the chambers per point until they agree with the films; 1: as described.",
        low=1,
        high=20,
        default=1,
    )
    measured: Path | None = file_path(
        "Rows of operating_point.outlet_pressure and relative_position_um in the order of the "
        "measurement, to lay over the loop.",
        ".csv",
        default=None,
    )
    sensor_deflection: float | None = quantity(
        "um/bar",
        "Travel of the sensor away from the gears over the outlet pressure, added to measured "
        "positions.",
        low=-10,
        high=10,
        default=None,
    )

    def __post_init__(self) -> None:
        if self.measured is None:
            forbid(self, "or give measured positions", "sensor_deflection")


@final
@dataclass(frozen=True, kw_only=True)
class BearingMapStudy(KeyTable):
    """``kind = "bearing_map"``: equilibrium of a floating bearing over speed and pressure."""

    shaft_speed: tuple[float, ...] = grid(_SPEED, "Shaft speeds.")
    outlet_pressure: tuple[float, ...] = grid(_PRESSURE, "Absolute outlet pressures.")
    start_gap: float = quantity(
        "um", "Gap that every point starts from.", above=0, high=100, default=2e-6
    )
    coupling_rounds: int = integer(
        "Most runs of the chambers per point until they agree with the films; 1: as described.",
        low=1,
        high=20,
        default=6,
    )


@final
@dataclass(frozen=True, kw_only=True)
class BalanceSweepStudy(KeyTable):
    """``kind = "balance_sweep"``: loops of pressure over balanced area and housing friction."""

    balance_ratio: tuple[float, ...] = grid(
        Number(above=0, high=2), "Balanced area over the reference area."
    )
    friction_coefficient: tuple[float, ...] = items(
        Number(low=0, high=1), "Friction in the housing."
    )
    outlet_pressures: tuple[float, ...] = items(
        _PRESSURE, "Outlet pressures in their order, up and down."
    )
    reference_area: float | None = quantity(
        "mm^2",
        "Area of the ratio one; default what plane rigid films carry at the highest pressure.",
        above=0,
        high=1e6,
        default=None,
    )
    start_gap: float = quantity(
        "um", "Gap that the first point starts from.", above=0, high=10, default=1e-6
    )
    lifted_gap: float = quantity(
        "um", "Gap from which the bearing counts as lifted off.", above=1, high=20, default=10e-6
    )


@final
@dataclass(frozen=True, kw_only=True)
class NoseCondition(KeyTable):
    """One of ``conditions``."""

    name: str = text("Label.")
    outlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    shaft_speed: float = quantity("rpm", "Shaft speed.", above=0, high=50000)
    inlet_pressure: float | None = quantity(
        "bar", "Absolute pressure; default that of the operating point.", above=0, high=1000,
        default=None,
    )  # fmt: skip


@final
@dataclass(frozen=True, kw_only=True)
class NosePressureStudy(KeyTable):
    """``kind = "nose_pressure"``: pressure on the nose patch of the floating bearing."""

    nose_pressure_fractions: tuple[float, ...] = items(
        Number(low=0, high=1), "Nose pressure over outlet pressure; 0 means inlet pressure."
    )
    conditions: tuple[NoseCondition, ...] = items(
        Table(spec=NoseCondition), "Operating conditions."
    )
    friction_coefficient: float = number("Friction in the housing.", low=0, high=1, default=0.02)
    breakaway_speed: float = quantity(
        "mm/s", "Speed of the friction peak.", above=0, high=1e4, default=1.6e-3
    )
    friction_law: str = choice("Set-valued, or smooth.", "stick", "stribeck", default="stick")
    start_gap: float = quantity(
        "um", "Gap that every point starts from.", above=0, high=100, default=2e-6
    )

    def __post_init__(self) -> None:
        names = [one.name for one in self.conditions]
        twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
        if twice is not None:
            raise KeyRuleError("conditions", f"{twice!r} twice", "a name of its own for each")


@final
@dataclass(frozen=True, kw_only=True)
class ContactSpanStudy(KeyTable):
    """``kind = "contact_span"``: teeth that carry load over the angle."""

    force_fraction: float = number(
        "Share of the mean total contact force that counts as contact.",
        above=0,
        high=1,
        default=0.01,
    )
    tip_clearance: tuple[float, ...] | None = grid(
        QuantityKey(unit="um", above=0, high=500), "Tip clearances.", default=None
    )
    pressure_difference: tuple[float, ...] | None = grid(
        _PRESSURE, "Outlet minus inlet pressure.", default=None
    )
    measured: Path | None = file_path(
        "Columns time [s], shaft_torque and outlet_pressure to lay over the results.",
        ".csv",
        default=None,
    )


@final
@dataclass(frozen=True, kw_only=True)
class SourceRippleStudy(KeyTable):
    """``kind = "source_ripple"``: source flow and source impedance from lines of two lengths."""

    line_length: tuple[float, ...] = grid(
        QuantityKey(unit="m", above=0, high=1000),
        "Lengths of operating_point.line, at least two; its cells keep their length.",
    )
    harmonics: int = integer(
        "Harmonics of the tooth frequency, ISO 10767-1 asks for ten.", low=1, high=40, default=10
    )

    def __post_init__(self) -> None:
        if len(set(self.line_length)) < 2:
            raise KeyRuleError("line_length", f"{len(self.line_length)} length", "two or more")


@final
@dataclass(frozen=True, kw_only=True)
class CalibrateStudy(KeyTable):
    """``kind = "calibrate"``: fit keys of the case to measured columns."""

    data: Path = file_path("Columns time and names of results.", ".csv", default=MISSING)
    fit: Mapping[str, tuple[Any, Any]] = declare(
        Named(item=Row(items=(Free(), Free())), doc="Key paths with lower and upper bound.")
    )
    hold_out: float = number("Share of the data kept for the check.", low=0, high=0.9, default=0.3)
    fit_rows: tuple[int, ...] | None = items(
        Integer(low=1, high=10**6),
        "Rows of steady points that are fitted, counted from 1, all others held out; a share of "
        "the data if not given.",
        low=1,
        default=None,
    )
    evaluation_count: int = integer(
        "Most sets of values that are tried.", low=2, high=10**6, default=200
    )
    seed: int = integer("Seed of the choice of rows to hold out.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        if not self.fit:
            raise KeyRuleError("fit", "nothing", "at least one key path with two bounds")
        for path, bounds in self.fit.items():
            _check_span(dict(zip(("from", "to"), bounds, strict=True)), f"fit.{path}")


_VARY = Named(
    item=Free(),
    doc="Key paths with a list of values, {from, to, count}, {from, to}, or {mean, deviation}.",
)
_FORMS = (
    {"from", "to", "count"},
    {"from", "to"},
    {"mean", "deviation"},
    {"mean", "deviation", "from"},
    {"mean", "deviation", "to"},
    {"mean", "deviation", "from", "to"},
)


def _check_vary(vary: Mapping[str, Any]) -> None:
    """Refuse varied keys without values."""
    if not vary:
        raise KeyRuleError("vary", "nothing", "at least one key path with values")
    for path, values in vary.items():
        if isinstance(values, dict):
            _check_span(values, f"vary.{path}")
        elif not isinstance(values, tuple) or not all(map(_is_scalar, values)) or not values:
            found = list(values) if isinstance(values, tuple) else values
            allowed = "a list of values, or {from, to, count}"
            raise KeyRuleError(f"vary.{path}", repr(found), allowed)


def _check_span(span: Mapping[str, Any], key: str) -> None:
    if set(span) not in _FORMS:
        allowed = "{from, to, count}, {from, to} or {mean, deviation}"
        raise KeyRuleError(key, repr(span), allowed)
    count = span.get("count", 2)
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= _LARGEST_COUNT:
        allowed = f"a whole number from 2 to {_LARGEST_COUNT}"
        raise KeyRuleError(f"{key}.count", repr(count), allowed)
    limits = [value for name, value in span.items() if name != "count"]
    if not all(is_quantity(x) or (_is_scalar(x) and not isinstance(x, str | bool)) for x in limits):
        allowed = "numbers, or texts with units such as '20 um'"
        raise KeyRuleError(key, repr(span), allowed)


def _is_scalar(value: Any) -> bool:
    return isinstance(value, (str, bool, int)) or (
        isinstance(value, float) and math.isfinite(value)
    )


@final
@dataclass(frozen=True, kw_only=True)
class SweepStudy(KeyTable):
    """``kind = "sweep"``: many cases over varied keys."""

    vary: Mapping[str, Any] = declare(_VARY)
    method: str = choice(
        "How points are placed.", "grid", "latin_hypercube", "sobol", default="grid"
    )
    sample_count: int | None = integer(
        "Points of latin_hypercube and sobol.", low=1, high=10**6, default=None
    )
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        _check_vary(self.vary)
        if self.method == "grid":
            forbid(self, 'because method = "grid" takes the points from vary', "sample_count")
        else:
            require(self, f'with method = "{self.method}"', "sample_count")


@final
@dataclass(frozen=True, kw_only=True)
class Limit(KeyTable):
    """Allowed range of a result."""

    low: float | None = number("Lowest allowed value, in the unit of the name.", default=None)
    high: float | None = number("Highest allowed value, in the unit of the name.", default=None)

    def __post_init__(self) -> None:
        if self.low is None and self.high is None:
            raise KeyRuleError("", "no limit", "low, high or both")
        if self.low is not None and self.high is not None and self.low > self.high:
            raise KeyRuleError("", f"low = {self.low:g} above high = {self.high:g}", "low <= high")

    def violation(self, value: float) -> float:
        """Return how far a value lies outside, over the size of the limit; NaN counts as 1."""
        if math.isnan(value):
            return 1.0
        low = -math.inf if self.low is None else self.low
        high = math.inf if self.high is None else self.high
        size = max(abs(x) for x in (self.low, self.high) if x is not None) or 1.0
        return max(low - value, value - high, 0.0) / size


_LIMITS = Named(item=Table(spec=Limit), doc="Names of summary numbers with low, high or both.")


@final
@dataclass(frozen=True, kw_only=True)
class ToleranceStudy(KeyTable):
    """``kind = "tolerance"``: scatter of results from scatter of dimensions."""

    vary: Mapping[str, Any] = declare(_VARY)
    sample_count: int = integer("Number of samples.", low=2, high=10**6, default=64)
    method: str = choice(
        "How points are placed.", "latin_hypercube", "sobol", default="latin_hypercube"
    )
    sensitivity: str = choice(
        "Rank correlation, or Sobol indices (sample_count times number of keys + 2 runs).",
        "rank_correlation",
        "sobol_indices",
        default="rank_correlation",
    )
    limits: Mapping[str, Limit] | None = declare(_LIMITS, None)
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        _check_vary(self.vary)


@final
@dataclass(frozen=True, kw_only=True)
class OptimiseStudy(KeyTable):
    """``kind = "optimise"``: best values of varied keys."""

    vary: Mapping[str, Any] = declare(_VARY)
    objective: str | None = text("Summary number to be made best.", default=None)
    goal: str = choice("Direction.", "maximise", "minimise", default="maximise")
    targets: Mapping[str, float] | None = declare(
        Named(item=Number(), doc="Summary numbers with wanted values, instead of objective."), None
    )
    constraints: Mapping[str, Limit] | None = declare(_LIMITS, None)
    method: str = choice(
        "Search: over the whole range, or from its middle towards targets.",
        "differential_evolution",
        "least_squares",
        default="differential_evolution",
    )
    evaluation_count: int = integer("Most evaluations.", low=2, high=10**6, default=200)
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        _check_vary(self.vary)
        if self.targets is None:
            require(self, "unless targets are given", "objective")
        else:
            forbid(self, "because targets are given", "objective")
        if self.method == "least_squares":
            require(self, 'with method = "least_squares"', "targets")
            forbid(self, 'with method = "least_squares"', "constraints")


@final
@dataclass(frozen=True, kw_only=True)
class DesignScanStudy(KeyTable):
    """``kind = "design_scan"``: kinematics of very many gears, without runs."""

    vary: Mapping[str, Any] = declare(_VARY)
    objective: str = text("Number of the geometry report to be made best.")
    goal: str = choice("Direction.", "maximise", "minimise", default="maximise")
    constraints: Mapping[str, Limit] | None = declare(_LIMITS, None)
    design_rules: bool = flag(
        "Whether a best design must keep the design rules of the geometry report.", default=True
    )
    addendum: float | None = number(
        "Height of the teeth above the shifted reference line, in modules, from which tip "
        "diameters follow; default those of the case.",
        low=0.5,
        high=2.0,
        default=None,
    )
    displacement: float | None = quantity(
        "cm^3/rev",
        "Geometric displacement for which the face width of each design is chosen.",
        above=0,
        high=10000,
        default=None,
    )
    sample_count: int = integer("Number of designs.", low=2, high=10**7, default=100_000)
    method: str = choice("How points are placed.", "latin_hypercube", "sobol", default="sobol")
    best_count: int = integer("Designs in the table of the best.", low=1, high=1000, default=20)
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        _check_vary(self.vary)


STUDIES: Mapping[str, type] = {
    "startup": StartupStudy,
    "efficiency_map": EfficiencyMapStudy,
    "hysteresis": HysteresisStudy,
    "nose_pressure": NosePressureStudy,
    "bearing_map": BearingMapStudy,
    "balance_sweep": BalanceSweepStudy,
    "contact_span": ContactSpanStudy,
    "source_ripple": SourceRippleStudy,
    "calibrate": CalibrateStudy,
    "tolerance": ToleranceStudy,
    "optimise": OptimiseStudy,
    "design_scan": DesignScanStudy,
    "sweep": SweepStudy,
}
"""Studies by the value of their key ``kind``."""


def study_kind(study: object) -> str:
    """Return the value of ``study.kind`` that a table stands for."""
    return next(name for name, spec in STUDIES.items() if spec is type(study))
