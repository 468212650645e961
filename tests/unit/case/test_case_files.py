"""Case files on a base, and those that come with the package."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

import toothspace as ts
from toothspace.cli import main

REPOSITORY = Path(__file__).resolve().parents[3]
CASES = REPOSITORY / "cases"
MOTOR = CASES / "egm12_motor.toml"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "base.toml").write_bytes(MOTOR.read_bytes())
    return tmp_path


def loaded(folder: Path, text: str) -> ts.Case:
    file = folder / "derived.toml"
    file.write_text(text, encoding="utf-8")
    return ts.load_case(file)


def test_keys_are_laid_over_those_of_the_base(folder: Path) -> None:
    text = """
        base = "base.toml"
        title = "faster"
        [operating_point]
        shaft_speed = "2000 rpm"
        [run]
        revolutions = 3
    """
    case = loaded(folder, text)
    values = {
        "title": "faster",
        "operating_point.shaft_speed": "2000 rpm",
        "run.revolutions": 3,
    }
    assert case == ts.load_case(MOTOR).replace(values)
    assert (case.run.revolutions, case.run.until) == (3, None)
    assert "base" not in case.to_toml()


def test_what_the_base_has_can_be_left_out(folder: Path) -> None:
    left_out = ["machine.startup", "machine.casing.wear_in"]
    text = f'base = {{file = "base.toml", without = {json.dumps(left_out)}}}\n'
    case = loaded(folder, text)
    assert case.machine.startup is None
    assert case.machine.casing.wear_in is None


def test_a_circuit_takes_the_place_of_the_operating_point(folder: Path) -> None:
    fan = (CASES / "startup_fan_drive.toml").read_text(encoding="utf-8")
    circuit = fan[fan.index("[circuit]") : fan.index("[run]")]
    case = loaded(folder, f'base = "base.toml"\n{circuit}')
    assert case.operating_point is None
    assert case.circuit is not None


def test_a_table_of_another_kind_replaces_that_of_the_base(folder: Path) -> None:
    sweep = '[study]\nkind = "sweep"\n[study.vary]\n"machine.gears.face_width" = ["7 mm", "8 mm"]\n'
    (folder / "base.toml").write_text(f"{MOTOR.read_text(encoding='utf-8')}\n{sweep}")
    case = loaded(folder, 'base = "base.toml"\n[study]\nkind = "contact_span"\n')
    assert type(case.study).__name__ == "ContactSpanStudy"


def test_files_of_a_base_lie_beside_it(tmp_path: Path) -> None:
    base = CASES / "egm12_motor_profile.toml"
    case = loaded(tmp_path, f'base = "{base.as_posix()}"\ntitle = "elsewhere"\n')
    assert case.machine.gears.profile == ts.load_case(base).machine.gears.profile
    assert ts.Case.from_toml(case.to_toml()) == case


def test_messages_name_the_file_that_holds_the_key(folder: Path) -> None:
    file = folder / "base.toml"
    text = file.read_text(encoding="utf-8").replace('"lumped"', '"lumpy"')
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ts.CaseError) as caught:
        loaded(folder, 'base = "base.toml"\n[operating_point]\nshaft_speed = "fast"\n')
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{folder / 'derived.toml'}: operating_point.shaft_speed: found")
    assert first.endswith("(line 3)")
    assert second.startswith(f"{file}: run.fidelity: found 'lumpy'")
    number = text.splitlines().index('fidelity = "lumpy"') + 1
    assert second.endswith(f"(line {number})")


@pytest.mark.parametrize(
    ("base", "found"),
    [
        ('"absent.toml"', "'absent.toml', which is no file"),
        ('"."', "'.', which is no file"),
        ("3", "3"),
        ('{name = "base.toml"}', "{'name'"),
        ('"derived.toml"', "10 bases on each other"),
        ('{file = "base.toml", without = "study"}', "{'file'"),
    ],
)
def test_bad_base_is_refused(base: str, found: str, folder: Path) -> None:
    with pytest.raises(ts.CaseError) as caught:
        loaded(folder, f"base = {base}\n")
    assert f"derived.toml: base: found {found}" in str(caught.value)
    assert "allowed" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_shipped_cases_are_known_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    assert ts.load_case("egm12_pump") == ts.load_case(CASES / "egm12_pump.toml")
    with pytest.raises(ts.CaseError, match=r"found 'egm12_pumps', allowed egm12_pump \(did you"):
        ts.load_case("egm12_pumps")


def test_shipped_cases_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cases", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert set(found) == {path.stem for path in CASES.glob("*.toml")}
    assert all(found.values())


def test_fluids_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fluids"]) == 0
    assert "iso_vg_46" in capsys.readouterr().out


@pytest.mark.parametrize("name", sorted(path.stem for path in CASES.glob("*.toml")))
def test_a_copied_case_is_whole(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "new"
    assert main(["init", name, str(folder)]) == 0
    assert ts.load_case(folder / f"{name}.toml").hash == ts.load_case(CASES / f"{name}.toml").hash
    assert main(["init", name, str(folder)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["init", name, str(folder), "--force"]) == 0


def test_wheel_holds_the_cases() -> None:
    text = (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
    wheel = tomllib.loads(text)["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["force-include"]["cases"] == "toothspace/shipped/cases"
