"""A case that is begun from nothing is told all that it must hold; a long one is read in time."""

from __future__ import annotations

import time

import pytest

from toothspace.case.case import Case
from toothspace.case.document import parse_document
from toothspace.core.errors import CaseError

COMPULSORY = {
    "operating_point",
    "fluid",
    "machine.gears.tooth_count",
    "machine.gears.module",
    "machine.gears.pressure_angle",
    "machine.gears.tip_diameter",
    "machine.casing.radial_clearance",
    "machine.journal_bearings.diameter",
    "machine.journal_bearings.length",
    "machine.journal_bearings.radial_clearance",
}


def test_all_that_is_compulsory_is_named_at_once_with_examples() -> None:
    begun = {"schema": 1, "title": "begun", "machine": {"type": "external_gear", "mode": "pump"}}
    with pytest.raises(CaseError) as refused:
        Case.from_dict(begun)
    told = {problem.key: problem.allowed for problem in refused.value.problems}
    assert set(told) >= COMPULSORY
    assert "such as '1 mm'" in told["machine.gears.module"]
    assert 'name = "iso_vg_46"' in told["fluid"]


def test_an_empty_case_is_told_its_tables_at_once() -> None:
    with pytest.raises(CaseError) as refused:
        Case.from_dict({"schema": 1, "title": "empty"})
    assert {problem.key for problem in refused.value.problems} == {
        "operating_point",
        "machine",
        "fluid",
    }


def test_pressures_below_nothing_are_told_to_be_absolute() -> None:
    point = {"shaft_speed": "1500 rpm", "inlet_pressure": "-0.1 bar", "outlet_pressure": "9 bar"}
    with pytest.raises(CaseError, match=r"inlet_pressure: found '-0.1 bar', allowed an absolute"):
        Case.from_dict({"schema": 1, "title": "vacuum", "operating_point": point})


@pytest.mark.parametrize("line", ["k{} = 1", "[t{}]\na = 1", "[[t]]\na{} = 1"])
def test_lines_of_many_keys_are_found_in_linear_time(line: str) -> None:
    text = "\n".join(line.format(k) for k in range(20_000))
    started = time.perf_counter()
    found = parse_document(text, "many.toml")
    assert time.perf_counter() - started < 5.0
    assert len(found.places) >= 20_000


def test_a_name_with_dots_and_brackets_has_its_line() -> None:
    found = parse_document('[a]\n"b.c" = 1\nd.e = 2\n"f[0]" = 3\n[[g]]\nh = 4\n', "names.toml")
    assert {key: line for key, (_, line) in found.places.items()} == {
        "a": 1,
        "a.b.c": 2,
        "a.d.e": 3,
        "a.f[0]": 4,
        "g[0]": 5,
        "g[0].h": 6,
    }


def test_unknown_keys_beyond_twenty_are_counted() -> None:
    with pytest.raises(CaseError) as refused:
        Case.from_dict({"schema": 1, "title": "many", **{f"k{k}": 1 for k in range(1000)}})
    unknown = [one for one in refused.value.problems if "unknown" in one.found]
    assert len(unknown) == 21
    assert unknown[-1].found == "980 more unknown keys"
