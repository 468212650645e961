"""Claims of the validation book: their short version always, the full one with ``slow``."""

from __future__ import annotations

import pytest

from toothspace.validation.book import CLAIMS, examine

LONG = 0.1
"""Claims that take longer are examined with the slow tests only. [min]"""


def _marked(claim):
    marks = [pytest.mark.slow] if claim.minutes > LONG else []
    if claim.reason:
        marks.append(pytest.mark.xfail(reason=claim.reason, strict=True))
    return pytest.param(claim, id=claim.key, marks=marks)


HAD = [_marked(claim) for claim in CLAIMS if claim.measure is not None]


@pytest.mark.slow
@pytest.mark.parametrize("claim", HAD)
def test_short(claim) -> None:
    found = examine(claim, "short")
    assert found.verdict == "pass", [v for v in found.finding.values if v.verdict != "pass"]


@pytest.mark.slow
@pytest.mark.parametrize("claim", HAD)
def test_full(claim) -> None:
    found = examine(claim, "full")
    assert found.verdict == "pass", [v for v in found.finding.values if v.verdict != "pass"]
