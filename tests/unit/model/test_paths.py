"""Flow paths as compiled code reads them, and orifices outside the machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.model.description import FlowPath
from toothspace.model.lateral_table import no_lookup
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import PathCategory
from toothspace.model.paths import load_orifice, path_tables
from toothspace.numerics.periodic_table import smooth_table

TURN = 2.0 * np.pi


def test_an_orifice_is_round() -> None:
    area = 3e-6
    path = load_orifice(4, 7, area)
    opened, diameter = path.geometry(np.array([0.0, 2.0])).T
    assert opened == pytest.approx(area)
    assert 0.25 * np.pi * diameter**2 == pytest.approx(area)
    assert path.geometry.period == pytest.approx(TURN)
    assert (path.nodes_a.tolist(), path.nodes_b.tolist(), path.angle_ratio) == ([4], [7], 1.0)


def test_columns_of_a_gap_are_geometry_speeds_and_motions() -> None:
    """Three of the geometry, drag, shear, then what each motion of the solver opens."""
    wave = 1.0 + 0.5 * np.sin(TURN * np.arange(24) / 24)
    geometry, drag, shear = (
        smooth_table(TURN, np.outer(wave, scale)) for scale in ((1.0, 2.0, 3.0), (4.0,), (5.0,))
    )
    opens = smooth_table(TURN, np.outer(wave, (6.0, 7.0)))
    mixed = np.array([[1.0, 0.0, 10.0], [0.0, -1.0, 1.0]])
    category = PathCategory("tip", "tips", "#000000", "gap")
    path = FlowPath(
        "tip", category, "parallel_gap", np.zeros(1, int), np.ones(1, int), 1.0, np.zeros(1),
        geometry, height_by_motion=opens, drag_speed=drag, shear_speed=shear,
    )  # fmt: skip
    (table,) = path_tables(path, mixed)
    scale = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -7.0, 67.0]
    assert table.values == pytest.approx(np.outer(geometry.values[:, 0], scale))
    assert table.slopes == pytest.approx(np.outer(geometry.slopes[:, 0], scale))


def test_without_a_table_lateral_films_are_their_closed_forms() -> None:
    now = no_lookup().now
    assert now[:2].tolist() == [1.0, 1.0]  # gaps and shear over those
    assert not now[2:].any()


def test_conditions_change_over_time_with_a_schedule_alone() -> None:
    given = OperatingCondition(shaft_speed=100.0, inlet_pressure=1e5, outlet_pressure=2e5)
    assert not given.over_time
    assert replace(given, speed_schedule=np.array([[0.0, 100.0], [1.0, 50.0]])).over_time
