"""Loaded teeth of a gerotor in a result."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import toothspace as ts
from toothspace.core.errors import ToothspaceError
from toothspace.core.types import Array, ComplexArray
from toothspace.results.tooth_contacts import (
    ToothContacts,
    contact_azimuth,
    contact_numbers,
    tooth_contacts,
    tooth_forces,
)
from toothspace.results.variables import dataset_from

FORCES = np.array([[60.0, 40.0, 0.0], [0.0, 99.5, 0.5], [30.0, 40.0, 30.0], [0.0, 0.0, 100.0]])
"""Four samples of three teeth; half a newton is below 1 % of the mean total of 100 N."""


def data():
    values = {
        "shaft_angle": np.arange(4.0),
        "time": np.arange(4.0),
        "tooth_force": FORCES,
        "tooth_place": np.zeros_like(FORCES),
    }
    return dataset_from(values, {"tooth": ["tooth_0", "tooth_1", "tooth_2"]})


def test_teeth_above_one_percent_of_the_mean_total_are_loaded() -> None:
    found = tooth_contacts(data())
    assert found.mean_total == pytest.approx(100.0)
    assert found.loaded.tolist() == [2, 1, 3, 1]
    assert found.span == pytest.approx(7 / 4)
    assert found.span_above(0.001) == pytest.approx(8 / 4)


def test_numbers_are_parts_of_the_turn() -> None:
    numbers = contact_numbers(data())
    assert numbers == {
        "loaded_contacts_two_or_more": pytest.approx(0.5),
        "loaded_contacts_three_or_more": pytest.approx(0.25),
        "contact_span": pytest.approx(7 / 4),
    }


def test_gears_have_none() -> None:
    gears = data().drop_vars("tooth_force")
    gears.attrs["machine"] = "external_gear"
    assert contact_numbers(gears) == {}
    with pytest.raises(ToothspaceError, match="external_gear"):
        tooth_contacts(gears)


def test_a_run_of_a_gerotor_prints_what_its_solution_tells() -> None:
    """Forces of the teeth are those of the contacts that touch, closer than 0.85 um."""
    rough = ("run.samples_per_revolution=120", "operating_point.outlet_load=fixed_pressure")
    solution = ts.simulate(ts.load_case("cases/gerotor_cycloidal.toml", rough))
    found, numbers = solution.tooth_contacts(), solution.summary()
    assert isinstance(found, ToothContacts)
    touching = np.asarray(solution.data["contact_gap"]) < np.sqrt(2.0) * 0.6e-6
    total = np.where(touching, np.asarray(solution.data["contact_force"]), 0.0).sum(axis=1)
    assert found.force.sum(axis=1) == pytest.approx(total)
    assert found.loaded.size == solution.data.sizes["shaft_angle"]
    assert numbers["contact_span"] == pytest.approx(found.span)
    assert numbers["loaded_contacts_two_or_more"] == pytest.approx(np.mean(found.loaded >= 2))


def test_a_contact_loads_the_tooth_that_stands_there() -> None:
    """One contact after the other: the loaded tooth is the nearest to it, within half a pitch."""
    machine = ts.describe(ts.load_case("cases/gerotor_cycloidal.toml"))
    angle = np.linspace(0.1, 7.0, 41)
    teeth, body = machine.families[0].count, machine.contacts[0].body_b
    ratio = machine.bodies[machine.body_index(body)].speed_ratio
    column, count = 0, sum(pair.count for pair in machine.contacts)
    for pair in machine.contacts:
        for phase in pair.phases:
            force, gap = np.zeros((angle.size, count)), np.full((angle.size, count), 1e-3)
            force[:, column], gap[:, column] = 7.0, 0.0
            found, place = tooth_forces(angle, force, gap, machine)
            np.testing.assert_array_equal(found.sum(axis=1), 7.0)
            there = contact_azimuth(machine, pair, angle, float(phase))
            loaded = place[np.arange(angle.size), np.argmax(found, axis=1)]
            away = np.angle(np.exp(1j * (there - loaded)))
            assert np.abs(away).max() <= np.pi / teeth * (1.0 + 1e-9)
            assert not tooth_forces(angle, force, gap + 1e-3, machine)[0].any()
            column += 1
    assert np.allclose(np.diff(np.sort(place, axis=1), axis=1), 2.0 * np.pi / teeth)
    assert place[0, 0] == pytest.approx(np.mod(ratio * angle[0], 2.0 * np.pi))


def test_a_contact_is_where_its_lever_and_its_normal_say() -> None:
    """r = a n - l t with a = r n and l = (r x n)_z: a point and a normal that go round by hand."""
    angle = np.linspace(0.0, 6.0, 25)
    ratio, phase = -0.75, 0.4

    def place(own: Array) -> ComplexArray:
        return 20e-3 * np.exp(1j * (0.7 + own))

    def normal(own: Array) -> ComplexArray:
        return np.exp(1j * (1.9 + 0.6 * own))

    def gap(own: Array) -> Array:
        n, r = normal(own), place(own)
        return np.stack([n.real, n.imag, (r.conj() * n).imag], axis=-1)

    def slip(own: Array) -> Array:
        along = (place(own).conj() * normal(own)).real
        return np.stack([0.0 * along, 0.0 * along, along], axis=-1)

    pair = SimpleNamespace(body_b="ring", angle_ratio=ratio, gap_by_motion=gap, slip_by_motion=slip)
    axes = ["x", "y", "rotation"]
    machine = SimpleNamespace(motion_index=lambda _, axis: axes.index(axis))
    found = contact_azimuth(cast(Any, machine), cast(Any, pair), angle, phase)
    # from the y axis
    expected = 0.7 + phase + ratio * angle - 0.5 * np.pi
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * expected), rtol=1e-9)
