"""Spaces that the mesh cuts in two: what opens them to the inlet between two fillings."""

from __future__ import annotations

from dataclasses import make_dataclass
from math import pi

import numpy as np
import pytest

from toothspace.gearing.mesh_cut import _BREATHER, CutSpaces
from toothspace.model.description import FlowPath
from toothspace.model.path_category import LATERAL
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table, smooth_table

WIDTH = 0.02
Path = make_dataclass("Path", ["geometry"])


def test_a_breather_opens_smoothly_between_two_fillings_and_no_farther() -> None:
    cut = CutSpaces(tooth_count=9, twist=0.5)
    shut = Path(monotone_table(cut.period, np.zeros((4 * 720, 3))))
    table = cut.breather(shut, WIDTH).geometry  # type: ignore[arg-type]
    angle = cut.period * np.arange(4 * 720) / (4 * 720)
    area, most = table.values[:, 0], _BREATHER * WIDTH * WIDTH
    begin, end = 2.0 * pi + 0.25, cut.period - 0.25
    assert np.all(area[(angle < begin) | (angle > end)] == 0.0)
    middle = np.abs(angle - 0.5 * (begin + end)) < 0.24 * (end - begin)
    assert area[middle] == pytest.approx(most)
    assert area.max() == pytest.approx(most)
    # half way up it is half open, and steepest
    rise = (angle - begin) / (0.25 * (end - begin))
    assert np.interp(0.5, rise, area) == pytest.approx(0.5 * most, rel=1e-3)


@pytest.mark.parametrize("rows", [2, 72])
def test_paths_of_fillings_are_those_of_the_section_however_coarse_its_tables(rows: int) -> None:
    """Half a turn on, from the middle of the mesh; what varies goes on varying."""
    cut, teeth = CutSpaces(tooth_count=9, twist=0.5), 9
    nodes = np.arange(teeth)
    angle = 2.0 * pi * np.arange(360) / 360
    wave = 0.3 + 0.1 * np.sin(angle[:, None])
    constant = np.tile([20e-6, WIDTH, 1e-3], (rows, 1))
    land = FlowPath(
        "land", LATERAL, "parallel_gap", nodes, np.full(teeth, 2 * teeth + 2), 1.0,
        -2.0 * pi * nodes / teeth, PeriodicTable(2.0 * pi, constant, np.zeros_like(constant)),
        drag_speed=smooth_table(2.0 * pi, wave),
    )  # fmt: skip
    (joined,) = cut.paths(land)
    inside = np.linspace(0.1, 2.0 * pi - 0.1, 61)
    np.testing.assert_allclose(joined.geometry(inside), np.tile(constant[0], (61, 1)), rtol=1e-12)
    assert joined.drag_speed is not None
    expected = 0.3 + 0.1 * np.sin(inside + pi)
    np.testing.assert_allclose(joined.drag_speed(inside)[:, 0], expected, atol=1e-4)
    assert np.all(joined.nodes_b == 2 * cut.count + 2)
