"""Fixtures that several unit tests share."""

from __future__ import annotations

import pytest

from tests.study_cases import Answer, answer
from toothspace import api
from toothspace.case import Case


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Replace the simulation; the cases that it was asked for."""
    seen: list[Case] = []

    def simulate(case: Case) -> Answer:
        seen.append(case)
        return Answer(answer(case))

    monkeypatch.setattr(api, "simulate", simulate)
    return seen
