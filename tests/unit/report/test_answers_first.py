"""Reports begin with the machine and the answer; what is met folds away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import fake_description, fake_solution
from toothspace.advice.findings import change_first
from toothspace.case import load_case
from toothspace.core.finding import Finding
from toothspace.core.status import Status
from toothspace.report import report_html
from toothspace.report.card import machine_head
from toothspace.report.study import best_points, study_answer
from toothspace.studies.study import StudyResult, StudyTable


@pytest.mark.usefixtures("few_figures")
def test_what_is_met_folds_away() -> None:
    page = report_html(fake_solution(), fake_description())
    assert page.index('class="verdict"') < page.index("What to change first") < page.index("<table")
    if "design rules are met" in page:
        head = page[: page.index("design rules are met")]
        assert head.rindex("<details>") > head.rindex("</section>")


def test_the_first_change_is_the_worst_finding() -> None:
    findings = [
        Finding("limit", "A note.", severity="note"),
        Finding("limit", "Hot.", severity="caution", advice="Cool it."),
        Finding("warning", "Wrong.", severity="serious", advice="Mend it."),
    ]
    assert change_first(fake_solution(), findings) == "Wrong. Mend it."
    assert change_first(fake_solution(), findings[:2]) == "Hot. Cool it."
    told = change_first(fake_solution(), findings[:1])
    assert told.startswith("Nothing has to be changed")
    assert "W" in told
    without = replace(fake_solution().ledger, energy={})
    assert "Nothing" in change_first(replace(fake_solution(), ledger=without), ())


def test_what_is_slight_is_told_but_not_what_to_change_first() -> None:
    slight = Finding(
        "limit", "Vapour.", quantity="Power of vapour", found="0.03 W", weight=5e-5, advice="Fill."
    )
    told = change_first(fake_solution(), [slight])
    assert told.startswith("Nothing has to be changed first")
    assert "Power of vapour, 0.03 W" in told
    assert "largest loss" in told
    rule = Finding("rule", "Thin.", advice="Thicken it.")
    assert change_first(fake_solution(), [slight, rule]) == "Thin. Thicken it."


def test_a_study_names_its_best_points() -> None:
    head = ("machine.casing.radial_clearance (um)", "overall_efficiency", "pressure_ripple_bar")
    rows = (("10 um", 0.90, 5.0), ("20 um", 0.92, 5.0), ("30 um", 0.91, float("nan")))
    table = StudyTable("points", head, rows)
    assert best_points(table) == [
        "Most efficient: overall efficiency 92 % at Casing, radial clearance (µm) 20 um."
    ]


def test_a_map_names_its_best_point_beside_the_machine() -> None:
    speed, pressure = np.array([1000.0, 2000.0]) * np.pi / 30.0, np.array([50e5, 150e5])
    map_ = xr.Dataset(
        {"overall_efficiency": (("shaft_speed", "pressure_difference"), [[0.8, 0.9], [0.7, 0.85]])},
        {"shaft_speed": speed, "pressure_difference": pressure},
    )
    case = load_case("egm12_pump")
    result = StudyResult(Status.DONE, map_, {}, kind="efficiency_map", title=case.title)
    assert study_answer(result) == [
        "Most efficient: overall 90 % at 1000 rpm and 150 bar pressure difference; least 70 %."
    ]
    head = machine_head({"case_toml": case.to_toml()})
    assert head.words == "External gear, pump, 4.95 cm³/rev"
    assert head.section.startswith("<svg")
    assert machine_head({"case_toml": "nonsense"}).section == ""
