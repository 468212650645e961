"""Wheel and source archive in an environment that holds nothing else."""

from __future__ import annotations

import json
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from benchmarks.first_contact import Environment, build

pytestmark = [pytest.mark.slow, pytest.mark.verification]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("wheel", tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def fresh(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Environment:
    environment = Environment(tmp_path_factory.mktemp("fresh"))
    asked = environment.run("python", "-m", "pip", "download", "--no-deps", "-d", ".", "typer")
    if asked.returncode:
        pytest.skip("pip reaches no package index")
    done = environment.install(wheel)
    assert done.returncode == 0, done.stderr
    return environment


def test_wheel_holds_cases_fluids_and_published_numbers(wheel: Path, repository: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    cases = {path.relative_to(repository) for path in (repository / "cases").rglob("*.toml")}
    assert {f"toothspace/shipped/{path.as_posix()}" for path in cases} <= names
    data = repository / "src" / "toothspace"
    assert "toothspace/native/toothspace.h" in names
    for folder in ("library", "validation", "report/templates", "fmi"):
        expected = {
            path.relative_to(data.parent).as_posix()
            for path in (data / folder).rglob("*")
            if path.is_file() and "__pycache__" not in path.parts
        }
        assert expected <= names


def test_source_archive_builds_the_same_wheel_without_git(wheel: Path, tmp_path: Path) -> None:
    archive = build("sdist", tmp_path)
    with tarfile.open(archive) as packed:
        packed.extractall(tmp_path, filter="data")
    (unpacked,) = (path for path in tmp_path.iterdir() if path.is_dir())
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=unpacked, check=True, capture_output=True)
    (again,) = tmp_path.glob("*.whl")
    assert again.name == wheel.name
    assert sorted(zipfile.ZipFile(again).namelist()) == sorted(zipfile.ZipFile(wheel).namelist())


def test_first_result_from_another_folder(fresh: Environment) -> None:
    for command in (
        "cases",
        "fluids",
        "init egm12_pump",
        "run egm12_pump.toml",
        "report egm12_pump.nc",
        "compare egm12_pump.nc egm12_pump.nc",
        "validate --short --only raimondi -o book.html",
    ):
        done = fresh.run("toothspace", *command.split())
        assert done.returncode == 0, f"{command}: {done.stderr}"
    assert (fresh.work / "egm12_pump.html").stat().st_size > 100_000
    done = fresh.run("toothspace", "run", "egm12_motor", "--json")
    numbers = json.loads(done.stdout)
    assert numbers["displacement_cm3_per_rev"] == pytest.approx(4.95, abs=0.01)


def test_the_wheel_runs_without_a_compiler_and_stays_small(fresh: Environment) -> None:
    assert "compiled code: library" in fresh.run("toothspace", "--version", "-v").stdout
    assert fresh.run("python", "-c", "import numba").returncode != 0
    assert fresh.size() < 480 * 2**20


def test_what_the_lean_installation_lacks_is_named(fresh: Environment) -> None:
    (fresh.work / "gear.dxf").write_text("0\nEOF\n", encoding="utf-8")
    done = fresh.run("toothspace", "gear", "gear.dxf")
    assert done.returncode == 2
    assert 'pip install "toothspace[cad]"' in done.stderr
