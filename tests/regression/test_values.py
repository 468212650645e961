"""Did a number change? Stored numbers of shipped cases: of runs, machines, films."""

from __future__ import annotations

import json

import pytest

from tests.regression.values import KINDS, Kind

CASES = [
    pytest.param(kind, name, id=f"{kind.numbers.__name__}-{name}")
    for kind in KINDS
    for name in kind.names
]


@pytest.mark.parametrize(("kind", "name"), CASES)
def test_numbers_are_those_stored(kind: Kind, name: str) -> None:
    """As far as they hold on any processor.

    After an intended change: ``python -m tests.regression.values``.
    """
    found = kind.numbers(name)
    expected = json.loads(kind.file.read_text(encoding="utf-8"))[name]
    assert found.keys() == expected.keys()
    for key, value in expected.items():
        if isinstance(value, str):
            assert found[key] == value, key
        else:
            moved = kind.rounding(key, expected) + 1e-12
            assert found[key] == pytest.approx(value, rel=0.0, abs=moved), key
