"""A pump from the STEP file that this program exports, without grooves, to 2000 bar: one list."""

from __future__ import annotations

import json
from html import unescape
from pathlib import Path

import pytest

import toothspace as ts
from toothspace.app.answers import shown as shown_in_page
from toothspace.cli import main
from toothspace.report.html import report_html

CASES = Path(__file__).resolve().parents[3] / "cases"


@pytest.fixture
def pump(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Case file of a pair cut from a STEP file, whose spaces are shut between the teeth."""
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    sealed = ts.load_case(CASES / "egm12_pump.toml").replace(
        {
            "machine.relief_grooves": None,
            "machine.casing.wear_in": None,
            "machine.casing.radial_clearance": "60 um",
            "machine.gears.normal_backlash": "0.005 mm",
            "heat.model": "network",
            "run.samples_per_revolution": 180,
            "operating_point.outlet_load": "fixed_pressure",
        }
    )
    Path("drawn.toml").write_text(sealed.to_toml(Path()), encoding="utf-8")
    assert main(["geometry", "drawn.toml", "--export", "step", "--json"]) == 0
    tables = sealed.to_dict()
    gears = tables["machine"]["gears"]
    kept = {key: gears[key] for key in ("face_width", "normal_backlash")}
    tables["machine"]["gears"] = {"profile": "drawn_drive.step", **kept}
    case = ts.Case.from_dict(tables, tmp_path)
    path = tmp_path / "pump.toml"
    path.write_text(case.to_toml(tmp_path), encoding="utf-8")
    return path


@pytest.mark.slow
def test_a_drawn_pump_tells_its_pressures_once_in_every_channel(
    pump: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert main(["run", str(pump)]) == 0
    text = capsys.readouterr().err
    solution = ts.load_solution(pump.with_suffix(".nc"))
    assert main(["run", str(pump), "--json", "--force"]) == 0
    streams = capsys.readouterr()
    beyond = next(x for x in solution.findings if x.quantity.startswith("Highest pressure"))
    assert float(beyond.found.split()[0]) > 2000.0
    assert "relief_grooves" in beyond.advice
    assert json.loads(streams.out)["findings"] == [x.to_dict() for x in solution.findings]
    assert {"warning", "limit", "rule"} <= {finding.kind for finding in solution.findings}
    rules = {finding.quantity for finding in solution.findings if finding.kind == "rule"}
    assert {"Normal backlash", "Relief grooves"} <= rules
    channels = {
        "command line": text,
        "command line beside JSON": streams.err,
        "notebook": solution._repr_html_(),
        "page": " ".join(
            f"{entry['text']} {entry['advice']}" for entry in shown_in_page(solution)["findings"]
        ),
        "report": report_html(solution, solution.description),
    }
    for name, shown in channels.items():
        words = " ".join(unescape(shown).split())
        for finding in solution.findings:
            assert words.count(finding.sentence) == 1, (name, finding.sentence)
