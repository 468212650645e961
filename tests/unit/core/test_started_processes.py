"""Processes that the package starts run no Python file of the current folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import h5netcdf  # noqa: F401  this process looks for it here, too
import numpy as np
import pytest
import xarray as xr

import toothspace
from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset
from toothspace.core.processes import outcomes, program_named, run_python
from toothspace.geometry.limited_reading import read_in_process
from toothspace.studies.workers import Workers

NAMES = ("json", "h5py", "numpy", "xarray", "socket", "pickle", "queue", "toothspace", "OCP")
"""Modules that processes of the package import, or could."""
SHAPE = "0 0\n10 0\n10 10\n0 10\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, in which modules lie that leave a mark when they are run."""
    for name in NAMES:
        text = f"open({str(tmp_path / 'executed')!r}, 'a').write({name!r})\nraise SystemExit(9)\n"
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(params=["", "folder"])
def in_the_way(
    folder: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """The same, where this process looks into it first."""
    monkeypatch.setattr(sys, "path", [str(folder) if request.param else "", *sys.path])
    return folder


def executed(folder: Path) -> str:
    mark = folder / "executed"
    return mark.read_text() if mark.exists() else ""


def test_drawings_are_data(in_the_way: Path) -> None:
    (in_the_way / "shape.txt").write_text(SHAPE)
    found = read_in_process(Path("shape.txt"), {"unit": 1e-3, "layer": None})
    np.testing.assert_allclose(found["curve_0"].max(axis=0), [0.01, 0.01])
    assert executed(in_the_way) == ""


def test_results_are_data(in_the_way: Path) -> None:
    # without a checksum, so that a process tries to read it first
    xr.Dataset({"speed": ("time", [1.0, 2.0])}).to_netcdf("foreign.nc", engine="h5netcdf")
    assert read_dataset("foreign.nc")["speed"].values.tolist() == [1.0, 2.0]
    Path("broken.nc").write_bytes(Path("foreign.nc").read_bytes()[:3000])
    with pytest.raises(CaseError, match="cannot be read"):
        read_dataset("broken.nc")
    assert executed(in_the_way) == ""


def test_workers_look_here_last(in_the_way: Path) -> None:
    (in_the_way / "own_functions.py").write_text("def twice(x):\n    return 2 * x\n")
    from own_functions import twice  # type: ignore[import-not-found]

    before = list(sys.path), dict(os.environ)
    try:
        with Workers(2) as workers:
            assert dict(workers.each(twice, [1, 2])) == {0: 2, 1: 4}
        assert outcomes(twice, [1, 2], workers=2) == [2, 4]
    finally:
        del sys.modules["own_functions"]
    assert (list(sys.path), dict(os.environ)) == before
    assert executed(in_the_way) == ""


def started(folder: Path, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    variables = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | environment
    return subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )


_ELSEWHERE = """
import sys
import toothspace
from toothspace.core.processes import run_python
done = run_python("import toothspace, os; print(toothspace.__file__, os.listdir())")
print(toothspace.__file__, [])
print(done.stdout + done.stderr, end="")
"""


@pytest.mark.parametrize("way", ["PYTHONPATH", "current folder", "archive"])
def test_a_process_finds_the_package_of_its_parent(tmp_path: Path, way: str) -> None:
    """Not the installed one, where another was found first."""
    package = tmp_path / "place" / "toothspace"
    shutil.copytree(
        Path(toothspace.__file__).parent / "core",
        package / "core",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    (package / "__init__.py").write_text("")
    for name in ("json", "h5py"):
        (tmp_path / "place" / f"{name}.py").write_text("raise SystemExit(9)")
    place, inside = package.parent, {}
    if way == "archive":
        place = Path(shutil.make_archive(str(tmp_path / "package"), "zip", place, "toothspace"))
    if way == "current folder":
        done = started(place, "-c", _ELSEWHERE)
    else:
        inside["PYTHONPATH"] = str(place)
        done = started(tmp_path, "-c", _ELSEWHERE, **inside)
    first, second = done.stdout.splitlines()
    assert first == second, done.stderr
    assert str(place) in first


def test_a_process_ends_with_its_program() -> None:
    done = run_python(
        "import sys; print(sys.argv[1:], input()); sys.exit(4)", ["a", "--", "b"], "ä\n"
    )
    assert (done.returncode, done.stdout) == (4, "['a', '--', 'b'] ä\n")
    with pytest.raises(subprocess.TimeoutExpired):
        run_python("import time; time.sleep(60)", longest=0.2)


def test_by_its_name_the_program_passes_by_the_current_folder(folder: Path) -> None:
    (folder / "toothspace.py").unlink()  # Python itself would run this one
    for name in ("pickle", "socket", "queue"):
        (folder / f"{name}.py").unlink(missing_ok=True)
    done = started(folder, "-m", "toothspace", "cases")
    assert done.returncode == 0, done.stderr
    assert executed(folder) == ""


def test_a_program_of_the_current_folder_is_not_taken(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "gmsh").write_text("#!/bin/sh\n")
    (folder / "gmsh").chmod(0o755)
    monkeypatch.setenv("PATH", f".{os.pathsep}")
    assert program_named("gmsh") is None
    monkeypatch.setenv("PATH", str(folder))
    assert program_named("absent", "gmsh") == str(folder / "gmsh")
