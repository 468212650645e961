"""Every Python example of the page on Python runs; the simulation is replaced by a stand-in."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import toothspace as ts
from tests.fake_solution import fake_solution
from toothspace.case import Case
from toothspace.run import ideal
from toothspace.run import run as lumped
from toothspace.run.run import Run

REPOSITORY = Path(__file__).resolve().parents[3]
PAGE = REPOSITORY / "docs" / "how_to" / "use_python.md"
CASES = REPOSITORY / "cases"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.usefixtures("few_figures")
def test_examples_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    seen: list[Case] = []

    def simulate(run: Run, progress: object = None) -> object:
        case = run.case
        seen.append(case)
        solution = fake_solution()
        keys = {"case_toml": case.to_toml(), "case_file": str(case.source or "")}
        return type(solution)(
            solution.status, solution.data, solution.ledger, provenance=keys
        )  # fmt: skip

    for preset in (ideal, lumped):
        monkeypatch.setattr(preset, "simulate", simulate)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks("python"):
        exec(compile(block, str(PAGE), "exec"), names)
    assert len(seen) == 5
    assert (tmp_path / "pressures.png").is_file()
    assert (tmp_path / "samples.csv").is_file()
    assert (tmp_path / "pump.html").is_file()


def test_example_of_a_base_is_a_case(tmp_path: Path) -> None:
    (text,) = blocks("toml")
    (tmp_path / "egm12_motor.toml").write_bytes((CASES / "egm12_motor.toml").read_bytes())
    file = tmp_path / "derived.toml"
    file.write_text(text, encoding="utf-8")
    assert ts.load_case(file).title == "EGM-12 motor at 2000 rpm"
