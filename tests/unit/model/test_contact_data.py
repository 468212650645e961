"""Contacts as compiled code reads them: laws where surfaces face, gaps of bodies that move."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.contact_cylindrical import pereira_force
from toothspace.model import arrays as col
from toothspace.model.contact_data import compliant_table, displaced_gap, relative_rotation
from toothspace.model.description import MachineDescription


@cache
def machine(name: str) -> MachineDescription:
    return api.describe(api.load_case(name))


def test_contact_is_possible_and_elastic_where_flanks_face_each_other() -> None:
    """Pereira's law of convex flanks as a power law through 1e-3 and 1e-5 of the width."""
    contact = replace(machine("egm12_pump").contacts[0], law="pereira")
    values = compliant_table(contact, np.eye(5)).values
    gap, _, first, second = contact.geometry.values[:, :4].T
    facing = gap < contact.facing_gap
    assert 0.05 < facing.mean() < 0.5
    assert values[:, col.POSSIBLE].tolist() == facing.astype(float).tolist()
    assert values[facing, col.CURVATURE] == pytest.approx((1.0 / first + 1.0 / second)[facing])
    level, power = values[:, [col.LAW_LEVEL, col.LAW_EXPONENT]].T
    assert not level[~facing].any()
    assert np.all(power[~facing] == 1.0)
    for share in (1e-3, 1e-5):
        depth = share * contact.width
        apart = (first + second)[facing]
        wanted = pereira_force(depth, apart, 1.0, 0.5 * contact.effective_modulus, False)
        assert np.exp(level[facing]) * depth ** power[facing] == pytest.approx(wanted, rel=1e-9)


def test_a_linear_contact_has_the_stiffness_of_what_is_behind_it() -> None:
    contact = replace(machine("egm12_pump").contacts[0], law="linear", structure_stiffness=3e8)
    level, power = (
        compliant_table(contact, np.eye(5)).values[:, [col.LAW_LEVEL, col.LAW_EXPONENT]].T
    )
    assert np.exp(level) * contact.width == pytest.approx(3e8)
    assert np.all(power == 1.0)


def test_bodies_turn_relative_to_each_other() -> None:
    pump = machine("egm12_pump")
    contact, motions = pump.contacts[0], pump.motions
    assert motions[4].body == contact.body_b == "driven_gear"
    assert relative_rotation(contact, motions).tolist() == [0.0, 0.0, 0.0, 0.0, 1.0]
    other = replace(contact, body_a=contact.body_b, body_b=contact.body_a)
    assert relative_rotation(other, motions).tolist() == [0.0, 0.0, 0.0, 0.0, -1.0]


def test_a_gap_bends_with_shift_and_turn() -> None:
    """Second derivatives by the motions: A u' u' + B (u' t' + t' u') + C t' t'."""
    gerotor = machine("gerotor_trochoidal")
    contact = gerotor.contacts[0]
    turns = relative_rotation(contact, gerotor.motions)
    angle = contact.phases[None, :] + contact.angle_ratio * 0.3
    shift = contact.slip_by_motion(angle)[0]
    by_shifts, mixed, by_turns = contact.gap_by_shift_and_turn(angle)[0].T

    def gap(*steps: tuple[int, float]) -> np.ndarray:
        motion = np.zeros((1, 3))
        for place, size in steps:
            motion[0, place] += size
        return displaced_gap(contact, angle, turns, motion)[0]

    step = np.array([1e-4, 1e-4, 1e-2])
    rest = gap()
    assert rest == pytest.approx(contact.geometry(angle)[0, :, 0])
    for i in range(3):
        slope = (gap((i, step[i])) - gap((i, -step[i]))) / (2.0 * step[i])
        assert slope == pytest.approx(contact.gap_by_motion(angle)[0, :, i], rel=1e-6, abs=1e-12)
        for j in range(3):
            bend = (
                gap((i, step[i]), (j, step[j])) - gap((i, step[i]), (j, -step[j]))
                - gap((i, -step[i]), (j, step[j])) + gap((i, -step[i]), (j, -step[j]))
            ) / (4.0 * step[i] * step[j])  # fmt: skip
            wanted = by_shifts * shift[:, i] * shift[:, j] + by_turns * turns[i] * turns[j]
            wanted += mixed * (shift[:, i] * turns[j] + turns[i] * shift[:, j])
            assert bend == pytest.approx(wanted, rel=1e-5, abs=1e-6 * np.abs(wanted).max())


def test_flanks_that_match_count_as_a_cylinder_of_a_hundred_widths() -> None:
    contact = machine("egm12_pump").contacts[0]
    values = contact.geometry.values.copy()
    values[:, 3] = -values[:, 2]  # a hollow flank round the other
    matching = replace(contact, geometry=replace(contact.geometry, values=values))
    curvature = compliant_table(matching, np.eye(5)).values[:, col.CURVATURE]
    assert curvature == pytest.approx(1.0 / (100.0 * contact.width), rel=1e-12)
