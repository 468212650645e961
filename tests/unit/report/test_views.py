"""Views of a result: page, report and notebook draw the same ones."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import fake_description, fake_solution
from toothspace.core.status import Status
from toothspace.report.view_page import ViewPage
from toothspace.report.views import study_views, views_html, views_of
from toothspace.results.ledger import loss_causes
from toothspace.results.solution import Solution
from toothspace.studies.study import StudyResult


@pytest.fixture
def solution(monkeypatch: pytest.MonkeyPatch) -> Solution:
    machine = fake_description()
    monkeypatch.setattr(Solution, "description", property(lambda _: machine))
    return fake_solution()


def test_views_hold_what_the_result_holds(solution: Solution) -> None:
    views = {view["name"]: view for view in views_of(solution)}
    flow = views["outlet_flow_rate"]
    shown = np.asarray(flow["lines"][0]["values"])
    assert shown.max() == pytest.approx(
        6e4 * float(solution.data["outlet_flow_rate"].max()), rel=1e-2
    )
    assert len(flow["x"]) == len(shown)
    # amplitudes of twelve teeth stand at multiples of twelve
    spectrum = views["spectra"]["lines"][0]
    assert spectrum["x"][int(np.argmax(spectrum["values"]))] % 12.0 == pytest.approx(0.0, abs=1e-9)
    tree = views["loss_tree"]["tree"]
    lost = sum(one.power for one in loss_causes(solution.ledger) if one.power > 0.0)
    assert tree["value"] == pytest.approx(lost)
    for cause in tree["children"]:
        assert cause["value"] == pytest.approx(sum(c["value"] for c in cause["children"]))


def test_views_are_json_and_end_no_script(solution: Solution) -> None:
    views = views_of(solution)
    json.dumps(views, allow_nan=False)
    hostile = [{**views[0], "title": "</script><b>"}]
    assert "</script><b>" not in views_html(hostile)
    assert views_html([]) == ""


def test_a_notebook_shows_a_page_without_server(solution: Solution, tmp_path: Path) -> None:
    page = solution.bench()
    assert isinstance(page, ViewPage)
    assert page._repr_html_().startswith("<iframe sandbox=")
    written = page.save(tmp_path / "views.html").read_text(encoding="utf-8")
    assert "toothspaceViews(" in written
    assert "http://" not in written.replace("http://www.w3.org", "")
    assert "https://" not in written


def test_films_have_holes_where_no_film_is() -> None:
    height = np.full((1, 6, 4), 3e-6)
    height[0, 0, 0] = np.nan
    sizes = ("film", "film_row", "film_column")
    data = xr.Dataset(
        {
            "film_height": (sizes, height),
            "film_pressure": (sizes, np.full((1, 6, 4), 5e5)),
            "film_contact_pressure": (sizes, np.zeros((1, 6, 4))),
            "film_angle": ("film_row", np.arange(6.0)),
            "film_radius": (("film", "film_column"), 1e-2 * np.arange(1.0, 5.0)[None]),
            "film_center_x": ("film", [0.0]),
            "film_center_y": ("film", [0.0]),
        },
        {"film": ["floating_drive_gear"], "shaft_angle": [0.0, 0.1, 0.2]},
    )
    whole = fake_solution()
    views = views_of(Solution(Status.DONE, data, whole.ledger))
    (films,) = (view for view in views if view["kind"] == "films")
    assert [field["label"] for field in films["fields"]] == ["Film height", "Pressure"]
    heights, pressures = films["pieces"][0]["values"]
    assert heights[0] is None
    assert pressures[0] is None
    assert heights[1:] == [3.0] * 23
    assert pressures[1] == pytest.approx(5.0)


def test_a_map_opens_its_points() -> None:
    data = xr.Dataset(
        {
            "overall_efficiency": (
                ("shaft_speed", "pressure_difference"),
                [[0.8, 0.9], [0.7, np.nan]],
            )
        },
        {"shaft_speed": [50.0 * np.pi, 100.0 * np.pi], "pressure_difference": [50e5, 100e5]},
    )
    result = StudyResult(Status.DONE, data, {})
    operating = SimpleNamespace(inlet_pressure=1e5, outlet_pressure=2e7)
    case = SimpleNamespace(operating_point=operating, machine=SimpleNamespace(mode="pump"))
    (view,) = study_views(result, case)
    assert view["fields"][0]["values"] == [80.0, 90.0, 70.0, None]
    assert view["points"][1] == {
        "operating_point.shaft_speed": "1500 rpm",
        "operating_point.outlet_pressure": "101 bar",
    }


def test_loops_go_up_and_down() -> None:
    data = xr.Dataset(
        {
            "outlet_pressure_bar": ("point", [10.0, 20.0, 10.0]),
            "film_height_um": ("point", [3.0, 2.0, 2.5]),
        }
    )
    (view,) = study_views(StudyResult(Status.DONE, data, {}))
    assert view["x"]["values"] == [10.0, 20.0, 10.0]
    assert view["y"] == {"label": "Mean film", "unit": "µm", "values": [3.0, 2.0, 2.5]}
