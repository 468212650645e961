"""A march that goes astray ends after minutes, not hours."""

from __future__ import annotations

from pathlib import Path

from toothspace import api

CASES = Path(__file__).resolve().parents[3] / "cases"


def test_a_march_has_a_limit_of_its_kind() -> None:
    run = api.load_case(CASES / "egm12_pump.toml").run
    assert run.step_limit(over_time=False) == 4_000_000
    assert run.step_limit(over_time=True) == 20_000_000


def test_the_limit_of_the_case_stands() -> None:
    case = api.load_case(CASES / "egm12_pump.toml").replace({"run.max_steps": 5000})
    assert case.run.step_limit(over_time=False) == case.run.step_limit(over_time=True) == 5000
