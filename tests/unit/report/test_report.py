from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.fake_solution import fake_description, fake_solution
from toothspace.advice.findings import findings_of, limits_of, verdict
from toothspace.api import describe, load_case, machine_of, simulate
from toothspace.core.finding import Finding
from toothspace.core.status import Status
from toothspace.plotting.catalogue import FIGURES
from toothspace.report import html, report_html, write_report
from toothspace.report.html import document_lines, report_contents, turning_section
from toothspace.report.page import format_value, quantity
from toothspace.results.credibility import with_warnings
from toothspace.results.ledger import Ledger, loss_causes, power_ledger
from toothspace.results.solution import load_solution


class Resources(HTMLParser):
    """Collects what a browser would load, and the text outside of scripts and styles."""

    def __init__(self) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.text: list[str] = []
        self.ids: set[str] = set()
        self.links: list[str] = []
        self._inside = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag
        for key, value in attrs:
            if key == "id":
                self.ids.add(str(value))
            elif tag == "a" and key == "href":
                self.links.append(str(value))
            elif key in {"src", "href", "xlink:href", "data", "srcset"}:
                self.loaded.append(str(value))

    def handle_data(self, data: str) -> None:
        if self._inside not in {"script", "style"}:
            self.text.append(data)


@pytest.fixture(scope="module")
def page() -> str:
    return report_html(fake_solution(), fake_description())


@pytest.fixture(scope="module")
def parsed(page: str) -> Resources:
    parser = Resources()
    parser.feed(page)
    return parser


def test_nothing_is_loaded_from_elsewhere(page: str, parsed: Resources) -> None:
    assert [target for target in parsed.loaded if not target.startswith(("#", "data:"))] == []
    outside = re.sub(r"<script>.*?</script>", "", page, flags=re.DOTALL)
    assert "@import" not in outside
    assert re.findall(r"url\(\s*['\"]?(?!#)", outside) == []
    assert "<script src" not in page


def test_links_stay_in_the_page(parsed: Resources) -> None:
    assert parsed.links
    assert {link.removeprefix("#") for link in parsed.links} <= parsed.ids


def test_size_stays_below_three_megabytes(page: str) -> None:
    assert len(page.encode()) < 3e6


@pytest.mark.usefixtures("few_figures")
def test_document_has_the_numbers_of_the_page(tmp_path: Path) -> None:
    path = write_report(fake_solution(), tmp_path / "report.pdf", fake_description())
    content = path.read_bytes()
    assert content.startswith(b"%PDF-")
    pages = content.count(b"/Type /Page ") + content.count(b"/Type /Page\n")
    shown = html.available_figures(fake_solution(), fake_description())
    assert pages > len(shown) + 2 > 3
    contents = report_contents(fake_solution(), fake_description())
    text = " ".join(cell for line in document_lines(contents) for _, cell in line.cells)
    assert contents["verdict"][:60] in text
    assert "Losses by cause" in text
    assert all(row.value in text for row in contents["key_numbers"])


def test_losses_by_cause_are_all_losses() -> None:
    ledger = fake_solution().ledger
    assert sum(c.power for c in loss_causes(ledger)) == pytest.approx(
        ledger.loss_energy / ledger.duration
    )


def test_exceeded_limits_are_findings() -> None:
    solution = fake_solution()
    peak = solution.data["chamber_pressure"] * 0.0 + 900e5
    contents = report_contents(
        replace(solution, data=solution.data.assign(chamber_pressure=peak)), None
    )
    assert any("Highest chamber pressure is 900 bar" in x.text for x in contents["findings"])


def test_cavitation_index_is_one_number_in_limits_and_summary() -> None:
    data = fake_solution().data
    angle = data["shaft_angle"]
    fraction = data["chamber_pressure"] * 0.0 + 0.1 * (1.0 + np.cos(3.0 * angle))
    solution = replace(fake_solution(), data=data.assign(chamber_vapour_fraction=fraction))
    (limit,) = (x for x in limits_of(solution, None) if x.label.startswith("Cavitation"))
    index = float(solution.summary()["cavitation_index_W"])
    assert index > 0.0
    assert limit.value.startswith(f"{index:.4g} W")


def test_report_shows_every_figure_and_chapter(page: str, parsed: Resources) -> None:
    steady = [e for e in FIGURES if e.sampled not in ("transient", "start") and not e.rotors]
    lacking = {"film_radius", "journal_film_height"}
    shown = [e for e in steady if lacking.isdisjoint(e.needs)]
    assert {f"figure_{e.name}" for e in shown} <= parsed.ids
    for part in ("key", "machine", "ledger", "numbers", "events", "provenance"):
        assert part in parsed.ids
    text = " ".join(parsed.text)
    assert "Teeth must overlap." in text
    assert "cavitation onset" in text
    assert "0123abcd" in text


def test_text_of_the_case_is_escaped(page: str) -> None:
    assert "Fake &lt;motor&gt;" in page
    assert "Fake <motor>" not in page


@pytest.mark.usefixtures("few_figures")
@pytest.mark.parametrize(("severity", "badge"), [("serious", "badge "), ("note", "badge good")])
def test_badge_is_green_only_where_nothing_is_serious(severity: Any, badge: str) -> None:
    found = Finding("warning", "Pressures reach 2027 bar.", severity=severity)
    bare = replace(fake_solution(), status=Status.DONE, warnings=())
    page = report_html(bare.with_note(found), None)
    assert re.search(rf'<span class="{badge}">done, \d+ finding', page)


def test_machine_turns_over_one_pitch(page: str) -> None:
    angles = json.loads(re.findall(r"angles = (\[.*?\])", page)[0])
    assert page.count('<g class="frame"') == len(angles) == 16
    assert float(angles[-1]) == pytest.approx(30.0 * 15 / 16, abs=1.0)


@pytest.mark.usefixtures("few_figures")
@pytest.mark.parametrize("name", ["continuous_pump", "helical_slices"])
def test_teeth_that_wind_in_parts_turn_in_their_middle(repository: Path, name: str) -> None:
    """Every space of the section has the pressure of the chamber that stands there."""
    ideal = {"run.fidelity": "ideal", "run.samples_per_revolution": 36, "heat": None}
    solution = simulate(load_case(repository / "cases" / f"{name}.toml").replace(ideal))
    description = solution.description
    assert description is not None
    assert description.winding is not None
    page = turning_section(solution, description)
    spaces = description.winding.section.chamber_count
    assert page.count(" bar</title>") == page.count("inlet: ") * (spaces + 2) > 0


def test_report_without_machine_and_after_reading_back(tmp_path: Path) -> None:
    solution = load_solution(fake_solution().save(tmp_path / "result.nc"))
    path = write_report(solution, tmp_path / "out" / "report.html")
    text = path.read_text(encoding="utf-8")
    assert 'id="figure_ripple"' in text
    assert 'id="machine"' not in text
    assert "The machine could not be rebuilt" in text


def test_machine_is_rebuilt_from_the_case_in_the_result(repository: Path) -> None:
    case = load_case(repository / "cases" / "egm12_motor.toml")
    provenance = {"case_toml": case.to_toml(), "case_hash": case.hash, "case_file": "elsewhere"}
    solution = replace(fake_solution(), provenance=provenance)
    description, reason = machine_of(solution)
    assert reason == ""
    assert description is not None
    assert description.displacement == describe(case).displacement


def test_machine_is_not_rebuilt_from_changed_files(repository: Path) -> None:
    case = load_case(repository / "cases" / "egm12_motor.toml")
    provenance = {"case_toml": case.to_toml(), "case_hash": "other"}
    description, reason = machine_of(replace(fake_solution(), provenance=provenance))
    assert description is None
    assert "have changed since the run" in reason


def test_verdict_names_work_efficiency_and_largest_loss() -> None:
    text = verdict(fake_solution())
    assert text.startswith("At 1500 rpm, from 200 to 1 bar, the motor turns 7.73 L/min into")
    assert "volumetric 96.0 %" in text
    assert "the largest loss is friction, journal bearings, with 55 W" in text


def test_pump_of_the_circuit_is_what_a_run_over_time_is_supplied_with() -> None:
    energy = {"supply": 10.0, "shaft": -6.0, "shaft_seal": 3.0, "drain": 1.0}
    ledger = Ledger(2.0, 1.0, {}, energy, {"drain": "leakage, drain"})
    supplied = power_ledger(ledger)[0]
    assert (supplied.label, supplied.power) == ("fluid", 5.0)
    assert [cause.share for cause in loss_causes(ledger)] == [0.1, 0.3]
    assert ledger.energy_remainder == 0.0


def test_findings_name_balances_and_failed_rules() -> None:
    solution = fake_solution()
    energy = {**solution.ledger.energy, "shaft": 0.9 * solution.ledger.energy["shaft"]}
    broken = replace(
        solution, status=Status.NOT_CYCLIC, ledger=replace(solution.ledger, energy=energy)
    )
    broken = with_warnings(broken, math.inf)
    found = " ".join(map(str, findings_of(broken, fake_description())))
    assert "Energy balance error" in found
    assert "Tip land is 0.9 mm, allowed >= 1.0 mm" in found
    assert "Contact ratio is" not in found


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("mean_flow_L_per_min", 7.7321, ("Mean flow", "7.732", "L/min")),
        ("overall_efficiency", 0.912345, ("Overall efficiency", "91.23", "%")),
        ("trapped_volume_mm3", 12.0, ("Trapped volume", "12", "mm³")),
        ("undercut", False, ("Undercut", "no", "")),
        ("energy_balance_error", 2.5e-7, ("Energy balance error", "2.50e-07", "")),
        ("operating_pressure_angle_deg", 25.25, ("Operating pressure angle", "25.25", "°")),
    ],
)
def test_names_become_labels_and_units(name: str, value: object, expected: object) -> None:
    assert quantity(name, value) == expected


def test_missing_number_is_a_dash() -> None:
    assert format_value(float("nan")) == "–"
