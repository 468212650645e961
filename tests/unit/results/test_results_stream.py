"""Rows of a long run on disk: nothing lost, nothing kept in memory, readable in other processes."""

from __future__ import annotations

import gc
import pickle
import tracemalloc
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from toothspace.core.files import write_whole
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.results import stream
from toothspace.results.ledger import Ledger
from toothspace.results.solution import Solution, load_solution
from toothspace.results.stream import SampleStream
from toothspace.results.variables import dataset_from

CHAMBERS = 24
LABELS = {"chamber": [f"drive_gear_{k}" for k in range(CHAMBERS)]}


def rows(begin: int, end: int) -> Mapping[str, Array]:
    time: Array = np.arange(float(begin), float(end))
    return {
        "time": time,
        "shaft_angle": 2.0 * time,
        "chamber_pressure": time[:, None] + 0.01 * np.arange(CHAMBERS),
    }


def streamed(total: int, part: int) -> Solution:
    stream = SampleStream()
    for begin in range(0, total, part):
        stream.append(rows(begin, min(begin + part, total)))
    data = dataset_from(stream.finish(), LABELS, sample="time")
    return Solution(Status.DONE, data, Ledger(1.0, 1.0, {}, {}))


@pytest.mark.parametrize(("total", "part"), [(1, 50), (512, 512), (1300, 50), (2000, 1999)])
def test_all_rows_come_back_in_order(total: int, part: int) -> None:
    data = streamed(total, part).data
    for name, values in rows(0, total).items():
        np.testing.assert_array_equal(data[name], values)
    assert data["chamber_pressure"].attrs["units"] == "Pa"


def test_memory_does_not_grow_with_the_rows() -> None:
    """200 000 rows of 26 numbers are 42 MB; a tenth of that suffices, times and angles aside."""
    streamed(10, 10)
    gc.collect()
    tracemalloc.start()
    solution = streamed(200_000, 50)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert solution.data.sizes["time"] == 200_000
    assert peak < 6e6


def test_another_process_gets_the_values() -> None:
    copy = pickle.loads(pickle.dumps(streamed(700, 50)))
    np.testing.assert_array_equal(copy.data["chamber_pressure"], rows(0, 700)["chamber_pressure"])


def test_saved_like_any_other_result(tmp_path: object) -> None:
    solution = streamed(700, 50)
    again = load_solution(solution.save(f"{tmp_path}/run.nc"))
    assert again.data.identical(solution.data.compute())


def test_rows_wait_until_a_write_is_worth_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """2000 rows of three variables in parts of 50: no more writes than pieces of 512 rows."""
    writes = []

    def counted(*given: Any) -> None:
        writes.append(given)
        write_whole(*given)

    monkeypatch.setattr(stream, "write_whole", counted)
    assert streamed(2000, 50).data.sizes["time"] == 2000
    assert 3 < len(writes) <= 3 * 4
