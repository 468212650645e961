"""Values over time that stand in a case or in a file, and how compiled code reads them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.compiled import kernel
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    QuantityKey,
    Row,
    file_path,
    forbid,
    items,
    require,
)
from toothspace.core.signals import read_signal
from toothspace.core.types import Array

NO_HISTORY: Array = np.zeros((0, 2))


def no_history() -> Array:
    """Rows of what does not change over time. Shape (0, 2)."""
    return NO_HISTORY


def over_time(value: Any, name: str) -> Any:
    """Key of pairs of time and value."""
    item = Row(items=(QuantityKey(unit="s", low=0, high=1e6), value))
    doc = f"Pairs of time and {name}, joined by straight lines."
    return items(item, doc, low=1, default=None)


def check_history(owner: Any, key: str) -> None:
    """A history stands in the case or in a file, and its times increase."""
    file, rows = getattr(owner, f"{key}_file"), getattr(owner, key)
    if file is not None:
        forbid(owner, f"because {key}_file is given", key)
        return
    require(owner, f"unless {key}_file is given", key)
    times = [row[0] for row in rows]
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise CaseError(key, f"times {times}", "times that increase")


def history(element: Any, name: str, unit: str) -> Array:
    """Time [s] and value of a signal that stands in the case or in a file. [SI]."""
    file = getattr(element, f"{name}_file")
    if file is not None:
        return read_signal(file, name, unit)
    return np.asarray(getattr(element, name), dtype=float)


@dataclass(frozen=True, kw_only=True)
class SpeedHistory(KeyTable):
    """Speed over time, in the case or in a file."""

    speed: tuple[tuple[float, float], ...] | None = over_time(
        QuantityKey(unit="rpm", low=-50000, high=50000), "speed"
    )
    speed_file: Path | None = file_path("Columns time [s] and speed [rpm].", ".csv", ".txt")

    def __post_init__(self) -> None:
        check_history(self, "speed")

    @property
    def speed_over_time(self) -> Array:
        """Time [s] and speed [rad/s]. Shape (knots, 2)."""
        return history(self, "speed", "rpm")


class Tables:
    """Tables of two columns, put on top of each other."""

    def __init__(self) -> None:
        self.rows: Array = NO_HISTORY

    def add(self, rows: Array) -> tuple[int, int]:
        """Add rows; where they begin and how many they are."""
        first = len(self.rows)
        self.rows = np.vstack([self.rows, np.reshape(rows, (-1, 2))])
        return first, len(self.rows) - first


@kernel
def scheduled(schedule: Array, first: int, count: int, time: float) -> float:
    """Value of the schedule in rows first to first + count at a time. Units of its column."""
    last = first + count - 1
    if time <= schedule[first, 0]:
        return schedule[first, 1]
    if time >= schedule[last, 0]:
        return schedule[last, 1]
    low, high = first, last
    while high - low > 1:
        middle = (low + high) // 2
        if schedule[middle, 0] <= time:
            low = middle
        else:
            high = middle
    share = (time - schedule[low, 0]) / (schedule[high, 0] - schedule[low, 0])
    return schedule[low, 1] + share * (schedule[high, 1] - schedule[low, 1])
