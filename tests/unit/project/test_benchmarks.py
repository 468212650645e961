"""What the benchmarks compile for themselves."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from benchmarks import goals
from benchmarks.bench_films import bandwidth
from benchmarks.bench_lumped import block_of, record_at
from benchmarks.speed import PAGE, Figure, fallen, load
from toothspace.core.compiled import njit, passed_by_address


@passed_by_address
class _Pair(NamedTuple):
    values: np.ndarray
    factor: float


def test_a_record_is_read_from_its_address() -> None:
    pair = _Pair(np.array([1.0, 2.0, 4.0]), 3.0)
    record, block = record_at(numba.typeof(pair)), block_of(pair)

    @njit
    def scaled(address: int, k: int) -> float:
        read = record(address)
        return read.factor * read.values[k]

    assert [scaled(block.ctypes.data, k) for k in range(3)] == [3.0, 6.0, 12.0]
    pair.values[1] = 5.0
    assert scaled(block.ctypes.data, 1) == 15.0


def test_bandwidth_is_plausible() -> None:
    assert 0.01 < bandwidth(1000) < 1e4  # GB/s


def test_a_ratio_that_fell_by_a_fifth_is_flagged() -> None:
    before = [Figure("task", "peer", 1.0, 4.0, ""), Figure("task", "other", 1.0, 2.0, "")]
    same = [Figure("task", "peer", 1.0, 3.3, ""), Figure("task", "other", 3.0, 6.0, "")]
    slower = [Figure("task", "peer", 1.3, 4.0, ""), Figure("new", "other", 1.0, 0.1, "")]
    assert fallen(same, before) == []
    assert fallen(slower, before) == ["task, peer: 3.08, stored 4.00"]


def test_the_speed_page_shows_the_stored_figures() -> None:
    page = PAGE.read_text()
    for figure in load():
        assert f"| {figure.task} | {1e3 * figure.own_seconds:.3g} ms " in page
        assert f"| {figure.peer} | {figure.ratio:.2f} |" in page


def test_the_speed_page_shows_what_was_asked_and_reached() -> None:
    rows = goals.load()
    assert set(rows) == set(goals.PARTS)
    assert goals.as_markdown(list(rows.values())) in PAGE.read_text()
