"""Did a number change? Stored summary numbers of the shipped cases."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.regression.values import (
    RELATIVE,
    REPEATED,
    RUNS,
    SMALL,
    STORED,
    computer,
    numbers_of,
)


@pytest.fixture(scope="module")
def stored() -> dict[str, Any]:
    return json.loads(STORED.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", RUNS)
def test_numbers_are_those_stored(name: str, stored: dict[str, Any]) -> None:
    """To nine digits on a computer like that of the stored numbers, elsewhere as far as they hold.

    After an intended change: ``python -m tests.regression.values``.
    """
    found = numbers_of(name)
    relative, small = (REPEATED, 0.0) if stored["computer"] == computer() else (RELATIVE, SMALL)
    assert found.keys() == stored[name].keys()
    for key, value in stored[name].items():
        if isinstance(value, str):
            assert found[key] == value, key
        else:
            assert found[key] == pytest.approx(value, rel=relative, abs=small + 1e-12), key
