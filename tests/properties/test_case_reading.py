"""Whatever stands in a case file, reading it ends in a case or in a clear line for every key."""

from __future__ import annotations

import copy
import math
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from toothspace.case import Case
from toothspace.case.document import document_text, parse_document
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.units import format_si, parse_quantity

REPOSITORY = Path(__file__).resolve().parents[2]
CASES = [
    tomllib.loads((REPOSITORY / "cases" / f"{name}.toml").read_text(encoding="utf-8"))
    for name in ("egm12_motor", "fuel14_pump", "gerotor_trochoidal")
]
UNITS = ["mm", "um", "bar", "GPa", "rpm", "rad/s", "deg", "cm^3", "kg m^2", "N m/rpm", "Pa s"]

TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
QUANTITY_TEXT = st.builds(
    lambda number, unit: f"{number!r} {unit}", st.floats(width=32), st.sampled_from(UNITS)
)
SCALARS = st.one_of(st.integers(-(2**40), 2**40), st.floats(), st.booleans(), TEXT, QUANTITY_TEXT)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3),
    max_leaves=6,
)


def paths(table: dict[str, Any], prefix: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Paths of all keys, tables included."""
    found = []
    for name, value in table.items():
        found.append((*prefix, name))
        if isinstance(value, dict):
            found += paths(value, (*prefix, name))
    return found


def canonical(value: Any) -> str:
    """Text of a value that neither order of keys nor NaN can change."""
    if isinstance(value, dict):
        return str(sorted((name, canonical(item)) for name, item in value.items()))
    return str([canonical(item) for item in value]) if isinstance(value, list) else repr(value)


def check(tables: dict[str, Any]) -> None:
    """Read tables; an error must be one line that says what was found and is allowed."""
    try:
        case = Case.from_toml(document_text(tables), label="case").check()
        assert Case.from_dict(case.to_dict()) == case
    except ToothspaceError as error:
        for line in str(error).split("\n"):
            assert line.startswith("case: ")
            assert ": found " in line
            assert "allowed " in line


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_any_value_at_any_key(data: st.DataObject) -> None:
    tables = copy.deepcopy(data.draw(st.sampled_from(CASES)))
    *folders, name = data.draw(st.sampled_from(paths(tables)))
    table = tables
    for folder in folders:
        table = table[folder]
    table[name] = data.draw(VALUES)
    check(tables)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_key_missing_or_added(data: st.DataObject) -> None:
    tables = copy.deepcopy(data.draw(st.sampled_from(CASES)))
    *folders, name = data.draw(st.sampled_from(paths(tables)))
    table = tables
    for folder in folders:
        table = table[folder]
    value = table.pop(name)
    if data.draw(st.booleans()):
        table[data.draw(TEXT)] = value
    check(tables)


@settings(max_examples=200, deadline=None)
@given(st.dictionaries(TEXT, VALUES, max_size=5))
def test_normalised_text_keeps_every_value(tables: dict[str, Any]) -> None:
    text = document_text(tables)
    assume("\\u0000" not in text)
    again = parse_document(text, "text").tables
    assert canonical(again) == canonical(tables)
    assert document_text(again) == text


@given(st.floats(-1e12, 1e12), st.sampled_from(UNITS))
def test_quantity_survives_its_text(value: float, unit: str) -> None:
    text = f"{value!r} {unit}"
    again = parse_quantity(format_si(parse_quantity(text, unit), unit), unit)
    # messages show ten digits
    assert again == pytest.approx(parse_quantity(text, unit), rel=1e-9, abs=1e-300)


@given(TEXT, st.sampled_from(UNITS))
def test_any_text_is_a_finite_quantity_or_refused(text: str, unit: str) -> None:
    assume("\0" not in text)
    try:
        value = parse_quantity(text, unit)
    except CaseError:
        return
    assert math.isfinite(value)
