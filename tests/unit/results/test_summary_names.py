"""Names that a study may ask for are those that runs give."""

from __future__ import annotations

import json

import pytest

from tests.conftest import TESTS
from toothspace.core.errors import CaseError
from toothspace.results.variables import BY_LABEL, OVER_TIME, STEADY, require_known


def test_all_numbers_of_the_stored_runs_are_known() -> None:
    stored = json.loads((TESTS / "regression" / "values.json").read_text())
    found = {run: set(numbers) for run, numbers in stored.items() if isinstance(numbers, dict)}
    assert len(found) > 4
    for run, numbers in found.items():
        known = OVER_TIME if "duration_s" in numbers else STEADY
        unknown = {name for name in numbers if not name.startswith(BY_LABEL)} - {*known, "status"}
        assert not unknown, run


def test_a_name_of_another_kind_of_run_is_refused() -> None:
    require_known({"study.objective": "leakage_drain_L_per_min"}, "case", over_time=False)
    require_known({"study.objective": "breakaway_time_s"}, "case", over_time=True)
    with pytest.raises(CaseError, match=r"case: study\.objective: found 'breakaway_time_s'"):
        require_known({"study.objective": "breakaway_time_s"}, "case", over_time=False)
