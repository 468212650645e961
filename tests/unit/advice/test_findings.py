"""One list of findings, the same in every place that shows a result."""

from __future__ import annotations

import json
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest

import toothspace as ts
from tests.fake_solution import fake_description, fake_solution
from toothspace import api
from toothspace.advice.findings import CAVITATION, findings_of
from toothspace.app.answers import shown as shown_in_page
from toothspace.case import Case, load_case
from toothspace.cli import main
from toothspace.core.finding import Finding, status_line
from toothspace.core.status import Event, Status
from toothspace.report.comparison import Comparison
from toothspace.report.html import document_lines, report_contents, report_html
from toothspace.results.credibility import with_warnings
from toothspace.results.ledger import loss_causes
from toothspace.results.solution import Solution

MOTOR = Path(__file__).resolve().parents[3] / "cases" / "egm12_motor.toml"


def told_solution(case: Case) -> Solution:
    """A result with a warning, a limit that is exceeded, and a machine that breaks a rule."""
    made = fake_solution()
    peak = made.data["chamber_pressure"] * 0.0 + 2027e5
    texts = {"case_toml": case.to_toml(), "case_file": str(case.source), "case_hash": case.hash}
    solution = replace(
        made,
        data=made.data.assign(chamber_pressure=peak),
        provenance={**made.provenance, **texts},
    )
    return with_warnings(solution, 1000e5)


@pytest.fixture
def solution(monkeypatch: pytest.MonkeyPatch) -> ts.Solution:
    """The result as a notebook has it; the machine of its case is a made-up one."""
    case = load_case(MOTOR)
    monkeypatch.setattr(api, "describe", lambda _: fake_description())
    monkeypatch.setattr(api, "simulate", lambda case, progress=None: told_solution(case))
    return api.simulate(case)


def test_the_list_holds_warnings_limits_and_rules_serious_ones_first(
    solution: ts.Solution,
) -> None:
    kinds = [finding.kind for finding in solution.findings]
    assert kinds[0] == "warning"
    assert solution.findings[0].severity == "serious"
    assert solution.findings[0].found == "2027 bar"
    assert solution.findings[0].allowed == "up to 1000 bar"
    assert {"warning", "limit", "rule"} == set(kinds)
    rule = next(finding for finding in solution.findings if finding.kind == "rule")
    assert rule.text == "Tip land is 0.9 mm, allowed >= 1.0 mm."
    assert rule.advice == "A thin land leaks & chips."
    assert all(finding.text and finding.advice for finding in solution.findings[:2])


@pytest.mark.slow
def test_every_channel_tells_every_finding_once(
    solution: ts.Solution,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", str(MOTOR)]) == 0
    text = capsys.readouterr().err
    assert main(["run", str(MOTOR), "--json", "--force"]) == 0
    streams = capsys.readouterr()
    entries = json.loads(streams.out)["findings"]
    assert entries == [finding.to_dict() for finding in solution.findings]
    page = " ".join(
        f"{entry['text']} {entry['advice']}" for entry in shown_in_page(solution)["findings"]
    )
    contents = report_contents(solution, solution.description)
    lines = [cell for line in document_lines(contents) for _, cell in line.cells]
    again = ts.load_solution(tmp_path / "egm12_motor.nc")
    compared = Comparison(solution, again)
    channels = {
        "command line": text,
        "command line beside JSON": streams.err,
        "notebook": solution._repr_html_(),
        "page": page,
        "report": report_html(solution, solution.description),
        "document": " ".join(lines),
        "file": again._repr_html_(),
        "comparison": "\n".join(compared.finding_lines()),
        "comparison in a notebook": compared._repr_html_(),
        "comparison as page": compared.write(tmp_path / "c.html").read_text(encoding="utf-8"),
    }
    for name, shown in channels.items():
        words = " ".join(unescape(shown).split())
        for finding in solution.findings:
            assert words.count(finding.sentence) == 1, (name, finding.sentence)
    line = f"done, {len(solution.findings)} findings"
    assert line in text
    assert line in solution._repr_html_()
    assert line in repr(solution)
    assert line in channels["report"]
    assert compared.findings()["both"] == list(solution.findings)


def test_comparison_tells_which_run_a_finding_belongs_to(solution: ts.Solution) -> None:
    calm = ts.Solution(Status.DONE, fake_solution().data, solution.ledger, {}, solution.provenance)
    found = Comparison(calm, solution).findings()
    assert "2027 bar" in found["second"][0].text
    assert found["first"] == []
    assert [finding.kind for finding in found["both"]].count("rule") == 1
    told = Comparison(calm, solution).to_dict()["findings"]
    assert told["second"][0]["found"] == "2027 bar"


@pytest.mark.parametrize(
    ("status", "count", "line"),
    [
        (Status.DONE, 0, "done, no findings"),
        (Status.DONE, 1, "done, 1 finding"),
        (Status.NOT_CYCLIC, 2, f"not_cyclic, 2 findings: {Status.NOT_CYCLIC.value}"),
    ],
)
def test_line_of_the_status(status: Status, count: int, line: str) -> None:
    assert status_line(status, [Finding("warning", "Seen.")] * count) == line


def test_the_same_sentence_stands_once(tmp_path: Path) -> None:
    solution = fake_solution().with_note("Seen.", "").with_note("Seen.").with_note("Other.")
    assert [warning.text for warning in solution.warnings] == ["Seen.", "Other."]
    kept = ts.load_solution(solution.save(tmp_path / "told.nc"))
    assert kept.provenance["warnings"] == "Seen.\nOther."


def test_cavitation_is_told_by_its_power_or_else_by_its_events() -> None:
    solution = replace(fake_solution(), events=(Event(1.0, 0.1, "cavitation_onset", "space_3"),))

    def told(solution: Solution) -> list[str]:
        return [x.text for x in findings_of(solution, None) if x.quantity.startswith("Cavitation")]

    (seen,) = told(solution)
    assert seen.startswith("Cavitation begins once")
    vapour = solution.data["chamber_pressure"] * 0.0 + 0.1
    vapour = vapour * (solution.data["shaft_angle"] > solution.data["shaft_angle"].mean())
    data = solution.data.assign(chamber_vapour_fraction=vapour)
    (seen,) = told(replace(solution, data=data))
    assert "no vapour" in seen


def test_limits_stand_by_how_far_they_are_missed_and_slight_vapour_last() -> None:
    """Power of collapsing vapour counts with its share of all losses."""
    made = fake_solution()
    peak = made.data["chamber_pressure"] * 0.0 + 900e5
    collapse = made.data["outlet_pressure"].mean() * 0.0

    def order(power: float) -> list[tuple[str, float]]:
        data = made.data.assign(chamber_pressure=peak, vapour_collapse_power=collapse + power)
        found = findings_of(replace(made, data=data), fake_description())
        return [(x.quantity, x.weight) for x in found if x.severity == "caution"]

    losses = sum(loss.power for loss in loss_causes(made.ledger))
    much, little = order(0.2 * losses), order(1e-4 * losses)
    weights = dict(much)
    assert weights[CAVITATION] == pytest.approx(0.2)
    highest = max(float(made.data[f"{port}_pressure"].mean()) for port in ("inlet", "outlet"))
    assert weights["Highest chamber pressure"] == pytest.approx(900e5 / (1.5 * highest) - 1.0)
    names = [name for name, _ in much]
    assert names.index("Highest chamber pressure") < names.index(CAVITATION)
    assert names.index(CAVITATION) < names.index("Tip land")  # a rule
    assert little[-1] == (CAVITATION, pytest.approx(1e-4))
    assert len(little) == len(much)


def test_without_a_machine_the_list_says_why(solution: ts.Solution) -> None:
    gone = replace(solution, provenance={**solution.provenance, "case_hash": "other"})
    (note,) = (finding for finding in gone.findings if finding.severity == "note")
    assert "files that the case names have changed since the run" in note.text
    assert "rule" not in {finding.kind for finding in gone.findings}


def test_results_of_older_versions_keep_their_warnings(tmp_path: Path) -> None:
    from toothspace.core.netcdf import read_dataset, write_dataset

    path = fake_solution().with_note("Seen.").save(tmp_path / "old.nc")
    dataset = read_dataset(path, "a result").load()
    del dataset.attrs["findings"]
    write_dataset(dataset, path)
    assert ts.load_solution(path).warnings == (Finding("warning", "Seen."),)
