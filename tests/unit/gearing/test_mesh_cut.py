"""Spaces that the mesh cuts in two: what opens them to the inlet between two fillings."""

from __future__ import annotations

from dataclasses import make_dataclass
from math import pi

import numpy as np
import pytest

from toothspace.gearing.mesh_cut import _BREATHER, CutSpaces
from toothspace.numerics.periodic_table import monotone_table

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
