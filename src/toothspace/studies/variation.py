"""Keys that several studies have, and values of varied keys: lists, spans, distributions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.keys import Free, KeyTable, Named, Number, QuantityKey, Table, number
from toothspace.core.types import Array, BoolArray
from toothspace.core.units import compatible, from_si, is_quantity, split_quantity, to_si

if TYPE_CHECKING:
    from toothspace.case import Case

SPEED = QuantityKey(unit="rpm", above=0, high=50000)
PRESSURE = QuantityKey(unit="bar", above=0, high=1000)
_LARGEST_COUNT = 10000
VARY = Named(
    item=Free(),
    doc="Key paths with a list of values, {from, to, count}, {from, to}, {mean, deviation}, or "
    "{tolerance}: normal round the value of the case, which is six deviations wide and cut there.",
)
ADDENDUM = Number(
    doc="Height of the teeth above the shifted reference line, in modules, from which tip "
    "diameters follow; default those of the case.",
    low=0.5,
    high=2.0,
)
DISPLACEMENT = QuantityKey(
    unit="cm^3/rev",
    doc="Geometric displacement for which the face width of each design is chosen.",
    above=0,
    high=10000,
)
_FORMS = (
    {"tolerance"},
    {"from", "to", "count"},
    {"from", "to"},
    {"mean", "deviation"},
    {"mean", "deviation", "from"},
    {"mean", "deviation", "to"},
    {"mean", "deviation", "from", "to"},
)
_LARGEST_GRID = 1_000_000
_LARGEST_DEVIATION = 6.0
_DEVIATIONS_IN_TOLERANCE = 3.0
"""Deviations from the middle to the edge of a drawing tolerance: an assumption, a capable process
whose index Cp is 1."""


@final
@dataclass(frozen=True, kw_only=True)
class Limit(KeyTable):
    """Allowed range of a result."""

    low: float | None = number("Lowest allowed value, in the unit of the name.", default=None)
    high: float | None = number("Highest allowed value, in the unit of the name.", default=None)

    def __post_init__(self) -> None:
        if self.low is None and self.high is None:
            raise CaseError("", "no limit", "low, high or both")
        if self.low is not None and self.high is not None and self.low > self.high:
            raise CaseError("", f"low = {self.low:g} above high = {self.high:g}", "low <= high")

    def violation(self, value: float) -> float:
        """Return how far a value lies outside, over the size of the limit; NaN counts as 1."""
        if math.isnan(value):
            return 1.0
        low = -math.inf if self.low is None else self.low
        high = math.inf if self.high is None else self.high
        size = max(abs(x) for x in (self.low, self.high) if x is not None) or 1.0
        return max(low - value, value - high, 0.0) / size

    def keeps(self, values: Array) -> BoolArray:
        """Whether values lie inside; NaN does not. [-]."""
        low = -math.inf if self.low is None else self.low
        high = math.inf if self.high is None else self.high
        return np.asarray((values >= low) & (values <= high))


LIMITS = Named(item=Table(spec=Limit), doc="Names of summary numbers with low, high or both.")


def check_vary(vary: Mapping[str, Any]) -> None:
    """Refuse varied keys without values."""
    if not vary:
        raise CaseError("vary", "nothing", "at least one key path with values")
    for path, values in vary.items():
        if isinstance(values, dict):
            check_span(values, f"vary.{path}")
        elif not isinstance(values, tuple) or not all(map(_is_scalar, values)) or not values:
            found = list(values) if isinstance(values, tuple) else values
            allowed = "a list of values, or {from, to, count}"
            raise CaseError(f"vary.{path}", repr(found), allowed)


def check_span(span: Mapping[str, Any], key: str) -> None:
    """Refuse limits that are none, of a key with the path of the message."""
    if set(span) not in _FORMS:
        allowed = "{from, to, count}, {from, to}, {mean, deviation} or {tolerance}"
        raise CaseError(key, repr(span), allowed)
    count = span.get("count", 2)
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= _LARGEST_COUNT:
        allowed = f"a whole number from 2 to {_LARGEST_COUNT}"
        raise CaseError(f"{key}.count", repr(count), allowed)
    limits = [value for name, value in span.items() if name != "count"]
    if not all(is_quantity(x) or (_is_scalar(x) and not isinstance(x, str | bool)) for x in limits):
        allowed = "numbers, or texts with units such as '20 um'"
        raise CaseError(key, repr(span), allowed)


def _is_scalar(value: Any) -> bool:
    return isinstance(value, (str, bool, int)) or (
        isinstance(value, float) and math.isfinite(value)
    )


@final
@dataclass(frozen=True)
class Axis:
    """One varied key."""

    path: str
    """Key path."""
    unit: str = ""
    """Unit of its numbers, empty if it is dimensionless or no number."""
    values: tuple[Any, ...] = ()
    """The values of a list or grid as numbers in the unit (or words); empty otherwise."""
    low: float = math.nan
    high: float = math.nan
    """Limits of a span, infinite for an unlimited normal distribution. [unit]"""
    mean: float = math.nan
    deviation: float = math.nan
    """Of a normal distribution, NaN for a uniform one. [unit]"""
    whole: bool = False
    """Whether only whole numbers are meant."""

    def si(self, numbers: Array) -> Array:
        """Numbers of the axis in SI units."""
        return numbers * (to_si(1.0, self.unit) if self.unit else 1.0)

    def written(self, number: Any) -> Any:
        """Return a value of the axis as it would stand in a case file."""
        if isinstance(number, (str, bool)):
            return number
        if self.whole:
            return round(number)
        return f"{number:.12g} {self.unit}" if self.unit else float(f"{number:.12g}")

    def quantile(self, share: float) -> Any:
        """Return the value below which a share (0 to 1) of the distribution lies. [unit]."""
        if self.values:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        if math.isnan(self.mean):
            if self.whole:
                return min(self.low + math.floor(share * (self.high - self.low + 1)), self.high)
            return self.low + share * (self.high - self.low)
        from scipy.special import ndtr, ndtri

        below, above = (ndtr((x - self.mean) / self.deviation) for x in (self.low, self.high))
        inside = min(max(below + share * (above - below), 1e-12), 1.0 - 1e-12)
        value = self.mean + self.deviation * float(ndtri(inside))
        return min(max(value, self.low), self.high)


def axes_of(
    vary: Mapping[str, Any], label: str, case: Case | None = None, key: str = "study.vary"
) -> tuple[Axis, ...]:
    """Read the varied keys of a study.

    Raises CaseError if units do not fit together or limits are the wrong way round.

    Parameters
    ----------
    vary : mapping of key path to values
        A list; ``{from, to, count}`` (equal steps), ``{from, to}`` (uniform),
        ``{mean, deviation}`` (normal, cut at ``from`` and ``to`` if they are given) or
        ``{tolerance}`` (normal round the value of the case, cut at plus and minus the tolerance,
        which is three deviations).
    label : str
        Name of the case file in messages.
    case : Case, optional
        Where the values stand that a tolerance is round.
    key : str
        Where they stand in the case file, for messages.
    """
    return tuple(
        _axis(path, _round_value(path, given, f"{label}: {key}", case), f"{label}: {key}.{path}")
        for path, given in vary.items()
    )


def _round_value(path: str, given: Any, where: str, case: Case | None) -> Any:
    """Turn a tolerance into the normal distribution round the value of the case."""
    if not isinstance(given, Mapping) or "tolerance" not in given:
        return given
    value = None if case is None else case.value(path)
    if isinstance(value, bool) or not isinstance(value, int | float):
        found = "a tolerance of a key that has no number in the case"
        raise CaseError(f"{where}.{path}", found, "{mean, deviation}")
    tolerance = given["tolerance"]
    number, unit = split_quantity(tolerance) if is_quantity(tolerance) else (float(tolerance), "")
    middle = from_si(float(value), unit) if unit else float(value)
    if number <= 0.0:
        raise CaseError(f"{where}.{path}.tolerance", f"{tolerance!r}", "more than 0")

    def written(x: float) -> Any:
        return f"{x:.12g} {unit}" if unit else x

    return {
        "mean": written(middle),
        "deviation": written(number / _DEVIATIONS_IN_TOLERANCE),
        "from": written(middle - number),
        "to": written(middle + number),
    }


def grid(axes: Sequence[Axis], label: str) -> list[tuple[Any, ...]]:
    """Return all combinations of the values of the axes, the last axis fastest.

    Raises
    ------
    CaseError
        If an axis has no values of its own, or there are far too many points.
    """
    for axis in axes:
        if not axis.values:
            allowed = "a list of values, or {from, to, count}, for a grid"
            raise CaseError(f"study.vary.{axis.path}", "no count", allowed).in_file(label)
    total = math.prod(len(axis.values) for axis in axes)
    if total > _LARGEST_GRID:
        found = f"a grid of {total} points"
        raise CaseError("study.vary", found, f"at most {_LARGEST_GRID}").in_file(label)
    return list(product(*(axis.values for axis in axes)))


def samples(axes: Sequence[Axis], method: str, count: int, seed: int) -> list[tuple[Any, ...]]:
    """Return random points with the distributions of the axes.

    Parameters
    ----------
    method : str
        ``latin_hypercube``, or ``sobol`` for a scrambled Sobol sequence.
    count : int
        Number of points. [-]
    seed : int
        Seed of the random numbers. [-]
    """
    return values_at(axes, unit_samples(len(axes), method, count, seed))


def values_at(axes: Sequence[Axis], shares: Array) -> list[tuple[Any, ...]]:
    """Values of the axes at points of the unit cube, of shape (points, keys). [unit]."""
    rows = shares.tolist()
    return [tuple(a.quantile(s) for a, s in zip(axes, row, strict=True)) for row in rows]


def unit_samples(dimensions: int, method: str, count: int, seed: int) -> Array:
    """Return points of the unit cube, of shape (count, dimensions). [-]."""
    from scipy.stats import qmc

    if method == "latin_hypercube":
        return np.asarray(qmc.LatinHypercube(dimensions, seed=seed).random(count))
    power = max(math.ceil(math.log2(count)), 0)
    return np.asarray(qmc.Sobol(dimensions, seed=seed).random_base2(power))[:count]


def written_values(axes: Sequence[Axis], row: Sequence[Any]) -> dict[str, Any]:
    """Return the values of one point by key path, as they would stand in a case file."""
    return {axis.path: axis.written(value) for axis, value in zip(axes, row, strict=True)}


def number_in(value: Any, unit: str) -> float:
    """Number of a value in a unit: of a text with unit, or a number that is in it already."""
    if not is_quantity(value):
        return float(value)
    number, given = split_quantity(value)
    return number if given == unit else from_si(to_si(number, given), unit)


def _axis(path: str, given: Any, where: str) -> Axis:
    if isinstance(given, tuple):
        numbers, unit = _numbers(given, where)
        return Axis(path, unit, tuple(numbers), whole=_all_whole(given))
    names = [name for name in ("from", "to", "mean", "deviation") if name in given]
    numbers, unit = _numbers([given[name] for name in names], where)
    found = dict(zip(names, numbers, strict=True))
    whole = _all_whole([given[name] for name in names])
    low, high = found.get("from", -math.inf), found.get("to", math.inf)
    if not low < high:
        raise CaseError(where, f"from = {low:g} and to = {high:g}", "from below to")
    if "mean" in found:
        mean, deviation = found["mean"], found["deviation"]
        reach = _LARGEST_DEVIATION * deviation
        if deviation <= 0.0 or low - mean > reach or mean - high > reach:
            text = f"mean = {mean:g} and deviation = {deviation:g}"
            raise CaseError(where, text, "deviation > 0 and limits around the mean")
        return Axis(path, unit, (), low, high, mean, deviation)
    values: tuple[float, ...] = ()
    if "count" in given:
        values = tuple(np.linspace(low, high, given["count"]).tolist())
        whole = whole and all(float(value).is_integer() for value in values)
    return Axis(path, unit, values, low, high, whole=whole)


def _all_whole(given: Sequence[Any]) -> bool:
    return all(isinstance(value, int) and not isinstance(value, bool) for value in given)


def _numbers(given: Sequence[Any], where: str) -> tuple[list[Any], str]:
    """Numbers of texts with units, all in the unit of the first one; words stay words."""
    if not any(is_quantity(value) for value in given):
        return list(given), ""
    if not all(is_quantity(value) for value in given):
        raise CaseError(where, f"{list(given)!r}", "values that all have a unit")
    pairs = [split_quantity(value) for value in given]
    unit = pairs[0][1]
    for value, (_, other) in zip(given, pairs, strict=True):
        if not compatible(other, unit):
            raise CaseError(where, f"{value!r}", f"a value in {unit} or alike")
    return [number_in(value, unit) for value in given], unit
