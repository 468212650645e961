"""The validation book shows published numbers beside ours with a verdict for each."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace.case.shipped import shipped_case
from toothspace.cli import main
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.report.validation_book import summary_of, write_book
from toothspace.validation import book
from toothspace.validation.claim import (
    Claim,
    ComparedCurve,
    ComparedValue,
    Effort,
    Evidence,
    ValidationSource,
    close,
    columns,
    holds,
)

SOURCE = ValidationSource(
    "galilei_1638", "Fall of a stone", "G. Galilei, Discorsi (1638), third day."
)
TIME = np.array([1.0, 2.0, 3.0])


def _fall(gravity: float, margin: float):
    def measure(effort: Effort) -> Evidence:
        ours, published = 0.5 * gravity * TIME**2, 4.9 * TIME**2
        return Evidence(
            (close("way after 1 s", float(ours[0]), 4.9, "m", rel=0.01),),
            (ComparedCurve("Way", "time (s)", "way (m)", TIME, ours, published, tolerance=margin),),
        )

    return measure


def _break(effort: Effort) -> Evidence:
    raise ToothspaceError("no stone")


CLAIMS = (
    Claim("stone", SOURCE, "A stone falls.", "One in a hundred.", _fall(9.81, 0.1)),
    Claim(
        "feather",
        SOURCE,
        "So does a feather.",
        "One in a hundred.",
        _fall(9.0, 0.1),
        reason="Air is left out.",
    ),
    Claim("splash", SOURCE, "It splashes.", "The height is not published.", None),
    Claim("lost", SOURCE, "It is lost.", "None.", _break),
)


@pytest.fixture
def examined():
    return [book.examine(claim) for claim in CLAIMS]


def test_verdicts(examined) -> None:
    assert [one.verdict for one in examined] == ["pass", "fail", "cannot be had", "fail"]
    assert examined[3].trouble == "no stone"
    bad = examined[1].finding
    assert bad.values[0].deviation == pytest.approx(4.5 / 4.9 - 1.0)
    assert bad.curves[0].error == pytest.approx(0.4 * 9.0)


def test_bounds_words_and_curves_for_the_eye() -> None:
    assert ComparedValue("largest", 2.0, "m", high=1.0).verdict == "fail"
    assert ComparedValue("largest", 1.0, "m", low=1.0).verdict == "pass"
    assert math.isnan(ComparedValue("largest", 1.0, "m").deviation)
    assert ComparedValue("no number", math.nan, "m", 0.0, 1.0).verdict == "fail"
    assert holds("it moves", False, "words").verdict == "fail"
    assert holds("it moves", True, "words").verdict == "pass"
    free = ComparedCurve("ours alone", "x", "y", TIME, TIME)
    assert free.verdict == "not judged"
    assert ComparedValue("for comparison", 1.0, "m").verdict == "not judged"
    assert ComparedValue("lost", math.nan, "m").verdict == "fail"
    assert math.isnan(free.error)


def test_book_shows_both_numbers_the_curve_and_why_not(examined, tmp_path: Path) -> None:
    page = write_book(examined, tmp_path / "book.html").read_text(encoding="utf-8")
    assert "1 pass" in page
    assert "2 fail" in page
    assert "4.905" in page
    assert "+0.10 %" in page
    assert "-8.16 %" in page
    assert "The height is not published." in page
    assert "no stone" in page
    assert page.count("<svg") == 2


def test_films_of_a_study_are_drawn(tmp_path: Path) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    height = np.full((2, 2, 24, 5), 3e-6)
    films = xr.Dataset(
        {
            "film_height": (("point", "film", "film_angle", "row"), height),
            "point_label": ("point", ["1: 20 bar", "2: 40 bar"]),
            "film_radius": (("film", "row"), np.tile(np.linspace(9e-3, 20e-3, 5), (2, 1))),
            "film_center_x": ("film", [0.0, 0.0]),
            "film_center_y": ("film", [0.0, 34e-3]),
        },
        coords={"film": ["floating_drive", "solid_drive"], "film_angle": angle},
    )
    claim = Claim("ring", SOURCE, "Oil.", "None.", lambda effort: Evidence((), (), films))
    page = write_book([book.examine(claim)], tmp_path / "book.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 1
    assert "Film height" in page


def test_summary_names_what_fails(examined) -> None:
    found = summary_of(examined)
    assert found["failing"] == ["feather", "lost"]
    assert found["counts"] == {"pass": 1, "fail": 2, "cannot be had": 1}
    assert found["status"] == "failed"
    assert found["unexpected"] == ["lost"]
    assert summary_of(examined[:3])["status"] == "done"


def test_a_verdict_other_than_announced_fails() -> None:
    late = replace(CLAIMS[1], reason="")
    assert summary_of([book.examine(late)])["unexpected"] == ["feather"]
    mended = replace(CLAIMS[0], reason="Stones float.")
    found = summary_of([book.examine(mended)])
    assert found["unexpected"] == ["stone"]
    assert found["failing"] == []
    assert found["status"] == "failed"


def test_processes_find_what_one_does(monkeypatch) -> None:
    chosen = [claim for claim in book.CLAIMS if claim.key.startswith("bertocchi")]
    alone, shared = (book.examine_all(chosen, "short", workers=n) for n in (1, 2))
    for one, other in zip(alone, shared, strict=True):
        assert one.claim is other.claim
        assert [v.ours for v in one.finding.values] == [v.ours for v in other.finding.values]
        assert one.verdict == other.verdict == "pass"


def test_one_process_examines_the_claims_of_one_computation(monkeypatch) -> None:
    tasks = []

    class Here:
        """Calls the function in this process and keeps what it was given."""

        def __init__(self, count: int) -> None:
            self.count = count

        def __enter__(self) -> Here:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def each(self, function, given):
            tasks.extend(given)
            yield from enumerate(function(one) for one in given)

    monkeypatch.setattr(book, "Workers", Here)
    keys = {claim.key for claim in book.CLAIMS}
    shared = {c.key: c.computed_with for c in book.CLAIMS if c.computed_with}
    assert shared
    assert set(shared.values()) <= keys - shared.keys()
    light = replace(book.CLAIMS[0], minutes=1.0)
    beside = replace(light, key="beside", computed_with=light.key)
    monkeypatch.setattr(book, "CLAIMS", (light, *book.CLAIMS[1:3], beside))
    found = book.examine_all(book.CLAIMS, "short", workers=2)
    assert [one.claim.key for one in found] == [claim.key for claim in book.CLAIMS]
    assert tasks[0] == [light.key, "beside"]
    assert len(tasks) == 3


def test_command(tmp_path: Path, monkeypatch, capsys) -> None:
    given = ["validate", "-o", str(tmp_path / "book.html"), "--force"]
    assert main([*given, "--only", "newton"]) == 2
    assert "allowed a part of raimondi_boyd_load" in capsys.readouterr().err
    monkeypatch.setattr(book, "CLAIMS", CLAIMS)
    assert main([*given, "--only", "stone", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["failing"] == []
    assert main([*given, "--only", "feather", "--short"]) == 0
    assert main([*given, "--only", "lost"]) == 3
    assert (tmp_path / "book.html").is_file()


def test_claims_have_names_of_their_own_and_a_reason() -> None:
    keys = [claim.key for claim in book.CLAIMS]
    assert len(set(keys)) == len(keys)
    assert all(len(c.tolerance) > 10 and c.statement for c in book.CLAIMS)


def test_data_and_cases_are_found() -> None:
    assert columns("bertocchi_2013")["x"].size > 10
    assert shipped_case("hysteresis_055").is_file()
    with pytest.raises(CaseError, match="case: found 'newton'"):
        shipped_case("newton")
