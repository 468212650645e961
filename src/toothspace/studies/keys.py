"""Keys that several studies have: varied keys, limits, speeds and pressures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

from toothspace.core.errors import CaseError
from toothspace.core.keys import Free, KeyTable, Named, QuantityKey, Table, number
from toothspace.core.units import is_quantity

SPEED = QuantityKey(unit="rpm", above=0, high=50000)
PRESSURE = QuantityKey(unit="bar", above=0, high=1000)
_LARGEST_COUNT = 10000
VARY = Named(
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
        allowed = "{from, to, count}, {from, to} or {mean, deviation}"
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
