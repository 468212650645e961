"""Fixtures that several unit tests share."""

from __future__ import annotations

from typing import Any

import pytest

from tests.study_cases import Answer, answer
from toothspace import api
from toothspace.case import Case
from toothspace.plotting.catalogue import FigureEntry, available_figures
from toothspace.report import html


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Replace the simulation; the cases that it was asked for."""
    seen: list[Case] = []

    def simulate(case: Case) -> Answer:
        seen.append(case)
        return Answer(answer(case))

    monkeypatch.setattr(api, "simulate", simulate)
    return seen


@pytest.fixture
def few_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reports show the figures of one chapter only: to draw all takes seconds."""

    def some(*given: Any) -> list[FigureEntry]:
        return [entry for entry in available_figures(*given) if entry.chapter == "ripple"]

    monkeypatch.setattr(html, "available_figures", some)
