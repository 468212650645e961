"""A few damaged inputs for every reader; ``python -m tests.fuzz`` draws many."""

from __future__ import annotations

import pytest

from tests.fuzz import READERS, fuzz


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", READERS)
def test_damaged_inputs_are_refused_in_words(name: str) -> None:
    fuzz(name, 60)
