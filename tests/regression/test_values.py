"""Did a number change? Stored summary numbers of the shipped cases."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.regression.values import RUNS, STORED, numbers_of, rounding


@pytest.fixture(scope="module")
def stored() -> dict[str, Any]:
    return json.loads(STORED.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", RUNS)
def test_numbers_are_those_stored(name: str, stored: dict[str, Any]) -> None:
    """As far as they hold on any processor.

    After an intended change: ``python -m tests.regression.values``.
    """
    found = numbers_of(name)
    expected = stored[name]
    assert found.keys() == expected.keys()
    for key, value in expected.items():
        if isinstance(value, str):
            assert found[key] == value, key
        else:
            moved = rounding(key, expected) + 1e-12
            assert found[key] == pytest.approx(value, rel=0.0, abs=moved), key
