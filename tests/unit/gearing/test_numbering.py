"""Numbers of chambers: places of spaces and teeth, and which spaces meet."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.gearing.numbering import number
from toothspace.model.description import FlowPath
from toothspace.model.path_category import PathCategory
from toothspace.numerics.periodic_table import smooth_table

TURN = 2.0 * np.pi
PAIRS = [(11, 13), (13, 11), (12, 12), (7, 21)]


def apart(found: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    return np.abs(np.mod(found - wanted + np.pi, TURN) - np.pi)


@pytest.mark.parametrize("counts", PAIRS)
def test_spaces_and_teeth_stand_where_the_page_says(counts: tuple[int, int]) -> None:
    """Drive space 0 and driven tooth 0 in the mesh; numbers grow against the rotation."""
    found = number(counts)
    drive, driven = (TURN * np.arange(count) / count for count in counts)
    halves = [np.pi / count for count in counts]
    spaces, teeth = found.space_phases, found.tooth_phases
    assert np.all(apart(spaces[0], np.pi - drive) < 1e-12)
    assert np.all(apart(spaces[1], np.pi - driven - halves[1]) < 1e-12)
    # a tooth stands half a pitch behind its space
    for gear in (0, 1):
        assert np.all(apart(teeth[gear], spaces[gear] - halves[gear]) < 1e-12)
    first, second = counts
    assert [*found.nodes[0], *found.nodes[1]] == [*range(first + second)]
    ports = found.inlet, found.outlet, found.drain
    assert ports == (first + second, first + second + 1, first + second + 2)


@pytest.mark.parametrize("counts", [(k, k + more) for k in range(5, 25) for more in (0, 1, 3)])
def test_places_are_those_of_one_turn_with_zero_and_without_its_end(
    counts: tuple[int, int],
) -> None:
    found = number(counts)
    for phases in (*found.space_phases, *found.tooth_phases):
        assert np.all((phases >= 0.0) & (phases < TURN - 1e-6))


@pytest.mark.parametrize("counts", PAIRS)
def test_spaces_meet_in_turn(counts: tuple[int, int]) -> None:
    """Whenever a space of the drive gear comes to the mesh, it is the turn of the next mate."""
    found, (first, second) = number(counts), counts
    path = FlowPath(
        "mesh", PathCategory("mesh", "mesh", "#000000", "gap"), "orifice", found.nodes[0],
        first + found.met_spaces, found.ratios[0], found.space_phases[0],
        smooth_table(TURN, np.ones((12, 2))), partner_shift=found.partner_shift,
    )  # fmt: skip
    steps = np.arange(3 * first)
    partners = path.partners(TURN * steps / first + 1e-9)
    met = partners[steps, steps % first]
    assert met.tolist() == [first + k % second for k in steps]
    # the mate is half a pitch before the mesh then
    place = found.space_phases[1][met - first] + found.ratios[1] * TURN * steps / first
    assert np.all(apart(place, np.full(place.shape, np.pi * (1.0 - 1.0 / second))) < 1e-9)
