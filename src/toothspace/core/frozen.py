"""Values that cannot be changed and are compared by content: mappings, curves, tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NoReturn, final

import numpy as np

from toothspace.core.types import Array


@final
class FrozenDict(dict[str, Any]):
    """A dictionary that refuses changes."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("a case cannot be changed in place; case.replace({...}) makes another one")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return FrozenDict, (dict(self),)

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))


@final
class Points:
    """Points of one closed curve.

    Parameters
    ----------
    rows : array_like, shape (points, 2)
        At least three points; a shape of another kind or a value that is not finite is refused
        with a ValueError. The unit is that of the key beside it, such as ``profile_unit``.
    """

    def __init__(self, rows: Any) -> None:
        values = np.array(rows, dtype=float)
        if values.ndim != 2 or values.shape[0] < 3 or values.shape[1] != 2:
            raise ValueError(f"found an array of shape {values.shape}, allowed (points, 2)")
        if not np.all(np.isfinite(values)):
            raise ValueError("found points that are not finite")
        values.setflags(write=False)
        self._values: Array = values

    @property
    def name(self) -> str:
        """What stands in place of a file name in messages."""
        return repr(self)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.array(self._values, dtype=dtype)

    def tolist(self) -> list[list[float]]:
        """Return the points as lists, as they stand in a case file."""
        return self._values.tolist()

    def __len__(self) -> int:
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Points) and np.array_equal(self._values, other._values)

    def __hash__(self) -> int:
        return hash(self._values.tobytes())

    def __repr__(self) -> str:
        return f"<{len(self)} points>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Points, (self.tolist(),)


@final
@dataclass(frozen=True)
class Columns:
    """Columns of a table that stand in place of a CSV file.

    Parameters
    ----------
    columns : mapping of str to array_like, shape (rows,)
        Values by heading, as in the first line of the file: ``temperature [degC]``.
    """

    columns: Mapping[str, tuple[float, ...]]

    def __post_init__(self) -> None:
        values = {str(name): np.array(one, dtype=float) for name, one in self.columns.items()}
        if not values or any(one.ndim != 1 for one in values.values()):
            raise ValueError("found no columns of numbers")
        if len({one.size for one in values.values()}) != 1:
            raise ValueError("found columns of different length")
        tuples = {name: tuple(one.tolist()) for name, one in values.items()}
        object.__setattr__(self, "columns", FrozenDict(tuples))

    @property
    def name(self) -> str:
        """What stands in place of a file name in messages."""
        return repr(self)

    def lines(self) -> list[list[str]]:
        """Return heading and rows as the texts of a file."""
        rows = zip(*self.columns.values(), strict=True)
        return [list(self.columns), *([repr(value) for value in row] for row in rows)]

    def __repr__(self) -> str:
        return f"<table of {', '.join(self.columns)}>"
