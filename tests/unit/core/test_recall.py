"""Functions that remember what they returned for the same content."""

from __future__ import annotations

import numpy as np

from toothspace.core.recall import recalled


def test_the_same_content_is_not_computed_again() -> None:
    asked: list[float] = []

    @recalled(2)
    def total(values: np.ndarray, factor: float = 1.0) -> float:
        asked.append(factor)
        return float(factor * values.sum())

    values = np.arange(3.0)
    assert [total(values), total(values.copy())] == [3.0, 3.0]
    assert asked == [1.0]
    values[0] = 1.0
    assert total(values) == 4.0
    assert total(values, factor=2.0) == 8.0
    assert total(np.arange(3.0)) == 3.0  # the oldest of three has gone
    assert asked == [1.0, 1.0, 2.0, 1.0]


def test_what_counts_may_be_a_part_of_the_arguments() -> None:
    asked: list[object] = []

    @recalled(4, lambda number, _: number)
    def doubled(number: int, other: object) -> int:
        asked.append(other)
        return 2 * number

    assert [doubled(1, "a"), doubled(1, "b"), doubled(2, "c")] == [2, 2, 4]
    assert asked == ["a", "c"]
