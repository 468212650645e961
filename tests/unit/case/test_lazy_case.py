"""A case computes nothing until somebody asks, and refuses an impossible machine before any run."""

from __future__ import annotations

import cProfile
import pstats
import shutil
from pathlib import Path

import pytest

import toothspace as ts
from toothspace import api
from toothspace.case import Case
from toothspace.case import case as module
from toothspace.cli import main

CASES = Path(__file__).resolve().parents[3] / "cases"
PROFILE = CASES / "egm12_motor_profile.toml"
ASKED = {"assemble", "spec_from", "_hashed", "fingerprint", "detected_gear", "involute_gear"}


def passed(profile: cProfile.Profile) -> set[str]:
    found = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    return {name for file, _, name in found if "/toothspace/" in file}


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """A case with a file of its profile, which may be changed."""
    shutil.copytree(CASES / "profiles", tmp_path / "profiles")
    text = ts.load_case(PROFILE).to_toml(CASES)
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    return tmp_path / "case.toml"


@pytest.mark.parametrize("name", ["egm12_pump", "egm12_motor_profile", "gerotor_trochoidal"])
def test_neither_reading_nor_replacing_builds_geometry_or_reads_files(name: str) -> None:
    ts.load_case(name).check()
    module._machines.clear()
    profile = cProfile.Profile()
    case = profile.runcall(ts.load_case, name)
    profile.runcall(case.replace, {"machine.inlet.volume": "51 cm^3", "run.revolutions": 3})
    assert passed(profile) & ASKED == set()
    profile.runcall(case.check)
    assert {"assemble", "fingerprint"} <= passed(profile)
    assert ("_hashed" in passed(profile)) == ("profile" in name)


def test_an_impossible_machine_is_refused_with_its_line_when_it_is_asked_for(copied: Path) -> None:
    text = copied.read_text(encoding="utf-8").replace('diameter = "18 mm"', 'diameter = "30 mm"')
    copied.write_text(text, encoding="utf-8")
    line = text.splitlines().index('diameter = "30 mm"') + 1
    case = ts.load_case(copied)
    told = rf"case.toml: machine.journal_bearings.diameter: found 30 mm, .*\(line {line}\)$"
    for ask in (case.check, lambda: api.describe(case), lambda: ts.simulate(case)):
        with pytest.raises(ts.CaseError, match=told):
            ask()


@pytest.mark.parametrize("command", ["run", "geometry", "study", "reduce"])
def test_commands_refuse_an_impossible_machine_before_they_begin(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    case = "sweep_clearance" if command == "study" else "egm12_pump"
    options = ["-o", "out.nc"] if command == "reduce" else []
    wrong = "machine.journal_bearings.diameter=30 mm"
    assert main([command, case, *options, "--set", wrong]) == 2
    streams = capsys.readouterr()
    assert streams.out == ""
    assert streams.err.count("\n") == 1
    assert f"{case}: machine.journal_bearings.diameter: found 30 mm, allowed below" in streams.err
    assert list(tmp_path.iterdir()) == []


def test_files_that_change_after_they_were_read_change_nothing(copied: Path) -> None:
    case = ts.load_case(copied).check()
    tooth, known = case.machine_spec.drive.tooth, case.hash
    for file in (copied.parent / "profiles").iterdir():
        file.write_text("changed", encoding="utf-8")
    assert case.machine_spec.drive.tooth is tooth
    assert case.hash == known


def test_files_that_change_between_hash_and_machine_are_refused(copied: Path) -> None:
    case = ts.load_case(copied)
    _ = case.hash
    profile = case.machine.gears.profile
    lines = profile.read_text(encoding="utf-8").splitlines(keepends=True)
    profile.write_text("".join([*lines, "\n# another comment\n"]), encoding="utf-8")
    with pytest.raises(ts.CaseError, match="found files that have changed since the case was hash"):
        case.check()


@pytest.mark.parametrize("ask", [lambda case: case.hash, Case.check])
def test_a_file_that_is_gone_is_told_in_one_sentence(ask: object, copied: Path) -> None:
    case = ts.load_case(copied)
    case.machine.gears.profile.unlink()
    with pytest.raises(ts.CaseError, match=r"found .*, allowed .*") as caught:
        ask(case)  # type: ignore[operator]
    assert "\n" not in str(caught.value)
