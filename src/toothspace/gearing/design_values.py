"""Keys of ``[machine]`` as arrays over many designs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.keys import Integer, KeyTable, Number, QuantityKey, Table, keys_of
from toothspace.core.types import Array, BoolArray
from toothspace.core.units import to_si
from toothspace.gearing.gear_tables import TOOTH_KEYS
from toothspace.geometry.involute_gear import InvoluteGears

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
        rest = [name for name in TOOTH_KEYS if name not in found]
        missing = {
            n: np.full(self.size, np.nan) if other is None else getattr(other, n) for n in rest
        }
        return InvoluteGears(**found, **missing)

    def parts(self) -> Iterator[DesignValues]:
        """Parts small enough for the cache of a processor."""
        for start in range(0, self.size, _CHUNK):
            chosen = slice(start, start + _CHUNK)
            yield DesignValues(self.machine, {k: v[chosen] for k, v in self.varied.items()})

    def in_range(self, *tables: str) -> BoolArray:
        """Whether all varied values lie in the range of their keys.

        Raises CaseError if a key does not act on the kinematics.
        """
        names = (*TOOTH_KEYS, "face_width", "normal_backlash", "center_distance")
        found = np.ones(self.size, dtype=bool)
        for path, values in self.varied.items():
            table, _, name = path.partition(".")
            spec = self._keys(table) if table in tables else {}
            if name not in spec or name not in names:
                allowed = [f"{t}.{n}" for t in tables for n in names if n in self._keys(t)]
                raise CaseError(path, "a varied key", f"one of {', '.join(allowed)}")
            found &= _inside(spec[name][0], values)
        return found

    def _keys(self, table: str) -> Mapping[str, Any]:
        key = keys_of(type(self.machine))[table][0]
        assert isinstance(key, Table)
        return keys_of(key.spec)


def _inside(key: Any, values: Array) -> BoolArray:
    assert isinstance(key, (Integer, Number, QuantityKey))
    unit = to_si(1.0, key.unit) if isinstance(key, QuantityKey) else 1.0
    low = -np.inf if key.low is None else key.low * unit
    high = np.inf if key.high is None else key.high * unit
    slack = _ROUNDING * np.abs(values)
    inside = np.isfinite(values) & (values >= low - slack) & (values <= high + slack)
    if isinstance(key, Integer):
        return inside & (values == np.rint(values))
    return inside if key.above is None else inside & (values > key.above * unit)
