"""Loaded teeth of a gerotor in a result."""

from __future__ import annotations

import numpy as np
import pytest

import toothspace as ts
from toothspace.core.errors import ToothspaceError
from toothspace.results.tooth_contacts import ToothContacts, contact_numbers, tooth_contacts
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
