"""Did a number change? Stored summary numbers of the shipped cases."""

from __future__ import annotations

import json

import pytest

from tests.regression.values import RUNS, STORED, numbers_of

RELATIVE = 5e-3
ROUNDING = 1e-6


@pytest.fixture(scope="module")
def stored() -> dict[str, dict[str, float | str]]:
    return json.loads(STORED.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", RUNS)
def test_numbers_are_those_stored(name: str, stored: dict[str, dict[str, float | str]]) -> None:
    found = numbers_of(name)
    assert found.keys() == stored[name].keys()
    for key, value in stored[name].items():
        if isinstance(value, str):
            assert found[key] == value, key
        else:
            assert found[key] == pytest.approx(value, rel=RELATIVE, abs=ROUNDING), key
