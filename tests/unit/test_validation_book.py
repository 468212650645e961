"""The validation book runs cases of its own and tells agreement from deviation."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.report import validation_book
from toothspace.report.validation_book import (
    Check,
    ValidationSource,
    find_validation,
    run_validation,
    write_book,
)

SOURCE = """# Fall of a stone

G. Galilei, Discorsi (1638), third day.

Tolerance: one part in a hundred.
"""
TEST = """
import pytest

@pytest.mark.parametrize("time", [1.0, 2.0])
def test_way(time: float) -> None:
    assert 4.9 * time**2 == pytest.approx({factor} * time**2, rel=0.01)

@pytest.mark.skip(reason="no stone")
def test_splash() -> None: ...
"""


@pytest.fixture
def cases(tmp_path: Path) -> Path:
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\nmarkers = ['slow: x']\n")
    for name, factor in (("galilei_1638", "4.9"), ("wrong_1700", "5.5")):
        folder = tmp_path / "tests" / "validation" / name
        folder.mkdir(parents=True)
        (folder / "SOURCE.md").write_text(SOURCE)
        (folder / f"test_{name}.py").write_text(TEST.format(factor=factor))
    return tmp_path / "tests" / "validation"


def test_verdicts_and_book(cases: Path, tmp_path: Path) -> None:
    good, bad = run_validation(cases)
    assert (good.name, good.title, good.verdict) == ("galilei_1638", "Fall of a stone", "agrees")
    assert (good.count("agrees"), good.count("skipped"), good.count("deviates")) == (2, 1, 0)
    assert good.paragraphs == (
        "G. Galilei, Discorsi (1638), third day.",
        "Tolerance: one part in a hundred.",
    )
    assert bad.verdict == "deviates"
    assert bad.count("deviates") == 2
    assert "5.5" in next(check.reason for check in bad.checks if check.verdict == "deviates")
    page = write_book([good, bad], tmp_path / "book.html").read_text(encoding="utf-8")
    assert page.count("<section") == 3
    assert "2 of 3 agree" in page


def test_command(
    cases: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    given = ["validate", "--cases", str(cases), "-o", str(tmp_path / "book.html"), "--force"]
    assert main([*given, "--only", "newton"]) == 2
    assert "allowed a part of galilei_1638, wrong_1700" in capsys.readouterr().err

    def verdicts(*found: str) -> None:
        sources = [
            ValidationSource(name, "A fall", (), (Check("way", name, "", 0.5),)) for name in found
        ]
        monkeypatch.setattr(validation_book, "run_validation", lambda *_: sources)

    verdicts("agrees")
    assert main([*given, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["status"] == "done"
    assert printed["wall_time_s"] == 0.5
    verdicts("agrees", "deviates")
    assert main(given) == 3
    assert capsys.readouterr().out.split() == ["agrees", "agrees", "deviates", "deviates"]
    assert (tmp_path / "book.html").is_file()


def test_a_place_without_cases_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(CaseError, match="found no validation cases"):
        find_validation(tmp_path)
    assert find_validation().name == "validation"
    monkeypatch.setattr("toothspace.report.validation_book.find_spec", lambda _: None)
    with pytest.raises(CaseError, match="no package 'pytest'"):
        run_validation(tmp_path)
