"""Names that a study may ask for are those that runs give."""

from __future__ import annotations

import json

import pytest

from tests.conftest import REPOSITORY, TESTS
from toothspace.core.errors import CaseError
from toothspace.results.variables import (
    BY_LABEL,
    OVER_TIME,
    STEADY,
    WORDS,
    label_of,
    require_known,
    stem_and_unit,
    words_of,
)


def test_all_numbers_of_the_stored_runs_are_known() -> None:
    stored = json.loads((TESTS / "regression" / "stored" / "runs.json").read_text())
    found = {run: {name for name in numbers if "." not in name} for run, numbers in stored.items()}
    assert len(found) > 4
    for run, numbers in found.items():
        known = OVER_TIME if "duration_s" in numbers else STEADY
        unknown = {name for name in numbers if not name.startswith(tuple(BY_LABEL))} - {
            *known,
            "status",
        }
        assert not unknown, run


def test_a_name_of_another_kind_of_run_is_refused() -> None:
    require_known({"study.objective": "leakage_drain_L_per_min"}, "case", over_time=False)
    require_known({"study.objective": "breakaway_time_s"}, "case", over_time=True)
    with pytest.raises(CaseError, match=r"case: study\.objective: found 'breakaway_time_s'"):
        require_known({"study.objective": "breakaway_time_s"}, "case", over_time=False)


def test_words_are_of_names_that_there_are() -> None:
    """Of summaries, or of the geometry of a machine type."""
    known = {stem_and_unit(name)[0] for name in (*STEADY, *OVER_TIME)}
    machines = REPOSITORY / "src" / "toothspace"
    sources = "".join(path.read_text() for path in machines.glob("*/**/summary.py"))
    sources += (machines / "gearing" / "helix.py").read_text()
    strange = [stem for stem in WORDS if stem not in known and f'"{stem}' not in sources]
    assert strange == []
    assert len(set(WORDS.values())) == len(WORDS)


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("mean_flow_L_per_min", "mean flow (L/min)"),
        ("cavitation_index_W", "power of collapsing vapour (W)"),
        ("drag_leakage_tooth_tip_L_per_min", "leakage by drag, tooth tip (L/min)"),
        ("power_loss_W", "lost power (W)"),
        ("power_loss_friction_W", "power lost, friction (W)"),
        ("overall_efficiency", "overall efficiency"),
    ],
)
def test_labels_are_words_of_a_designer(name: str, label: str) -> None:
    assert label_of(name) == label
    assert label.startswith(words_of(name))
