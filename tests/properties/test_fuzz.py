"""A few damaged inputs for every reader; ``python -m tests.fuzz`` draws many."""

from __future__ import annotations

import pytest

from tests.fuzz import READERS, VERDICTS, fuzz

FEW = {"solid": 2, "outline": 30, "result": 8}
"""Inputs of readers that take longer: processes of their own read solids and try results."""


@pytest.mark.parametrize("name", READERS)
def test_every_damaged_input_is_read_or_refused_in_words(name: str) -> None:
    fuzz(name, FEW.get(name, 60))
    assert VERDICTS["refused"] > 0 or name == "store", "a damaged store is nothing, not an error"
