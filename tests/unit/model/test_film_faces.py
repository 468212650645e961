"""Geometry of film faces: sectors of chambers and of the rim, places, whose the open wall is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.types import Array
from toothspace.model.film_faces import NO_BODY, ChamberRing, FaceBody, FaceCells, FilmFace

TURN = 2.0 * np.pi


def nothing(_angle: float, x: Array, _y: Array) -> FaceCells:
    none = np.full(np.shape(x), NO_BODY)
    return FaceCells(none, none)


FACE = FilmFace(
    bodies=(FaceBody("large", (1.0, 2.0), 2.0), FaceBody("small", (1.0, 6.0), 1.0)),
    center=(1.0, 2.0),
    inner_radius=0.5,
    outer_radius=2.0,
    gap=1e-5,
    face_map=nothing,
    chambers=ChamberRing(np.arange(5) + 10, 0.3 + TURN * np.arange(5) / 5, angle_ratio=0.4),
    recesses=np.zeros(0, dtype=np.int64),
    inner_node=0,
    sectors=4,
)
"""Five chambers that turn by two fifths of the shaft's angle."""


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("shaft_angle", [0.0, 0.9])
def test_a_place_belongs_to_the_chamber_in_the_middle_of_whose_sector_it_lies(
    direction: float, shaft_angle: float
) -> None:
    """A chamber is where its table angle is that of the place; also 0.45 of a pitch beside."""
    ring = ChamberRing(
        np.arange(5), np.array([4.0, 2.0, 0.0, 3.0, 1.0]) * TURN / 5 + 0.2, 0.4, 0.7, direction,
        (3.0, -1.0),
    )  # fmt: skip
    for beside in (-0.45, 0.0, 0.45):
        table = ring.phases + beside * ring.pitch + ring.angle_ratio * shaft_angle
        polar = ring.zero_angle + direction * table
        x, y = 3.0 + 2.0 * np.cos(polar), -1.0 + 2.0 * np.sin(polar)
        assert ring.nearest(shaft_angle, x, y).tolist() == [0, 1, 2, 3, 4]


def test_a_face_looks_the_same_when_the_next_chamber_stands_where_one_stood() -> None:
    assert FACE.period == pytest.approx(TURN / 5 / 0.4)


@pytest.mark.parametrize("sectors", [1, 3, 4])
def test_sectors_of_the_rim_part_the_pitch_of_each_chamber_evenly(sectors: int) -> None:
    phases = replace(FACE, sectors=sectors).sector_phases.reshape(5, sectors)
    assert phases.mean(axis=1) == pytest.approx(FACE.chambers.phases)
    assert np.diff(phases.ravel()) == pytest.approx(TURN / (5 * sectors))


def test_points_lie_about_the_axis_of_the_face() -> None:
    x, y = FACE.places(np.array([0.0, 0.5 * np.pi, np.pi]), np.array([1.0, 3.0]))
    np.testing.assert_allclose(x, [[2.0, 4.0], [1.0, 1.0], [0.0, -2.0]], atol=1e-15)
    np.testing.assert_allclose(y, [[2.0, 2.0], [3.0, 5.0], [2.0, 2.0]], atol=1e-15)


def test_open_wall_is_parted_where_tangents_to_both_circles_are_alike() -> None:
    """Circles of 2 and 1, four apart: the radical axis is (16 + 4 - 1) / 8 from the larger one."""
    cells = nothing(0.0, np.zeros(3), np.zeros(3))
    border, beside = 2.0 + 19.0 / 8.0, np.array([-8.0, 1.0, 9.0])
    for off, owner in ((-1e-9, 0), (1e-9, 1)):
        y = np.full(3, border + off)
        for body in (0, 1):
            assert FACE.open_wall(body, cells, beside, y).tolist() == [body == owner] * 3
    covered = FaceCells(cells.node, np.array([0, NO_BODY, 1]))
    assert FACE.open_wall(0, covered, beside, np.zeros(3)).tolist() == [False, True, False]
