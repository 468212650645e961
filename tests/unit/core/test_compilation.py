"""Compiled code: records by address, parts, entries kept on disk, what is shown meanwhile."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from toothspace import api
from toothspace.core.compilation import jit, notice
from toothspace.core.compilation.library import Way
from toothspace.core.compilation.notice import Notice, reachable
from toothspace.core.compilation.records import RecordAddress
from toothspace.core.compilation.sources import with_imports
from toothspace.core.compiled import inlined, kernel, njit, passed_by_address
from toothspace.core.types import Array, IntArray
from toothspace.solver import compiled_model

REPOSITORY = Path(__file__).resolve().parents[3]
SOURCES = REPOSITORY / "src"
MOTOR = REPOSITORY / "cases" / "egm12_motor.toml"

USE = (
    "import numpy as np; from toothspace.numerics.vectors import dot; "
    "print(dot(np.arange(3.0), np.arange(3.0)), sum(dot.stats.cache_hits.values()))"
)
"""Prints 5.0 and whether the compiled code was found on disk."""


@passed_by_address
class Inner(NamedTuple):
    factor: float
    count: int


@passed_by_address
class Outer(NamedTuple):
    inner: Inner
    row: Array
    columns: Array
    places: IntArray


def just_in_time(function: Any) -> Any:
    """Function as Numba compiles it, library or not."""
    return getattr(function, "just_in_time", function)


def outer() -> Outer:
    columns = np.asfortranarray(np.arange(12.0).reshape(3, 4))
    return Outer(Inner(2.5, 3), np.arange(5.0), columns, np.array([2, 0, 1]))


@inlined
def square(value: float) -> float:
    return value * value


@kernel
def entry_of(record: Outer, i: int) -> float:
    return square(record.columns[record.places[i], 1]) * record.inner.factor


@njit
def total(record: Outer) -> float:
    result = 0.0
    for i in range(record.inner.count):
        result += entry_of(record, i)
        record.row[i] = result
    return result + record.columns.shape[1] + record.row.strides[0]


def compiling(cache: Path) -> dict[str, str]:
    """Environment of a process that compiles by itself, library or not."""
    own = {"PYTHONPATH": str(SOURCES), "TOOTHSPACE_CACHE": str(cache)}
    return {**os.environ, **own, "TOOTHSPACE_COMPILATION": "jit"}


def run_python(code: str, cache: Path, sources: Path = SOURCES, **extra: str) -> str:
    environment = compiling(cache) | {"PYTHONPATH": str(sources)}
    environment.pop("NUMBA_CACHE_DIR", None)
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=environment | extra,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def kept(cache: Path) -> list[Path]:
    return sorted((cache / "toothspace" / "compiled").iterdir())


def test_compiled_code_reads_and_writes_a_record_as_python_does() -> None:
    compiled, plain = outer(), outer()
    expected = 0.0
    for i in range(3):
        expected += plain.columns[plain.places[i], 1] ** 2 * 2.5
        plain.row[i] = expected
    assert total(compiled) == expected + 4 + 8
    np.testing.assert_array_equal(compiled.row, plain.row)


def test_an_array_of_other_layout_makes_another_type() -> None:
    one, other = numba.typeof(outer()), numba.typeof(outer()._replace(columns=np.zeros((3, 4))))
    assert isinstance(one, RecordAddress)
    assert one == numba.typeof(outer())
    assert one != other
    assert len(str(one)) < 30


def test_what_no_block_can_hold_is_refused_by_name() -> None:
    with pytest.raises(TypeError, match=r"Inner\.factor: found unicode_type, allowed an array"):
        numba.typeof(Inner("2.5", 3))  # type: ignore[arg-type]


@pytest.mark.skipif(not jit.PARTS, reason="Numba not tested with parts")
def test_what_an_entry_calls_has_no_machine_code_of_its_own() -> None:
    total(outer())
    assert len(just_in_time(total).overloads) == 1
    assert not just_in_time(entry_of).overloads


@pytest.mark.slow
def test_results_do_not_depend_on_the_way_of_compiling(tmp_path: Path) -> None:
    code = (
        "from toothspace.core.compilation import jit; "
        "from tests.unit.core.test_compilation import outer, total; "
        "print(jit.PARTS, total(outer()).hex())"
    )
    path = f"{SOURCES}{os.pathsep}{REPOSITORY}"
    parts = run_python(code, tmp_path, PYTHONPATH=path)
    plain = run_python(code, tmp_path, PYTHONPATH=path, TOOTHSPACE_COMPILATION="plain")
    assert plain == f"False {total(outer()).hex()}"
    assert parts.split()[1] == plain.split()[1]


def test_an_untested_numba_compiles_every_function_on_its_own(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(jit, "way", lambda: Way.JUST_IN_TIME)
    monkeypatch.setattr(jit, "parent_process", lambda: None)  # not one of several workers
    monkeypatch.setattr(numba, "__version__", "9.9.0")
    assert not jit._parts_wanted()
    assert "Numba 9.9.0 (tested with 0.68): the first use" in capsys.readouterr().err
    monkeypatch.setattr(numba, "__version__", f"{jit.TESTED[0]}.0")
    assert jit._parts_wanted()
    assert not capsys.readouterr().err


@pytest.mark.slow
def test_the_cache_follows_content_not_place_or_time(tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(SOURCES / "toothspace", elsewhere / "toothspace")
    cache = tmp_path / "cache"
    assert run_python(USE, cache) == "5.0 0"
    assert run_python(USE, cache, elsewhere) == "5.0 1"
    assert len(kept(cache)) == 1
    changed = elsewhere / "toothspace" / "numerics" / "vectors.py"
    changed.write_text(changed.read_text() + "\nMORE = 1\n")
    assert run_python(USE, cache, elsewhere) == "5.0 0"


def test_an_entry_depends_on_modules_that_are_imported_as_such() -> None:
    """The columns of the arrays, which kernels read as ``col.PRESSURE``, are constants in it."""
    assert "model.arrays" in with_imports({"model.chambers"})


@pytest.mark.slow
def test_a_damaged_entry_is_compiled_again(tmp_path: Path) -> None:
    run_python(USE, tmp_path)
    (path,) = kept(tmp_path)
    sound = path.read_bytes()
    path.write_bytes(sound[: len(sound) // 2])
    assert run_python(USE, tmp_path) == "5.0 0"
    assert run_python(USE, tmp_path) == "5.0 1"


@pytest.mark.slow
def test_two_processes_share_one_cache(tmp_path: Path) -> None:
    environment = compiling(tmp_path)
    both = [
        subprocess.Popen([sys.executable, "-c", USE], env=environment, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    for process in both:
        written, _ = process.communicate(timeout=300)
        assert written.split()[0] == b"5.0"
    assert len(kept(tmp_path)) == 1
    assert run_python(USE, tmp_path) == "5.0 1"


def test_a_folder_that_cannot_be_written_is_said_and_the_result_is_right(tmp_path: Path) -> None:
    (tmp_path / "toothspace").write_text("a file where a folder should be")
    assert run_python(USE, tmp_path) == "5.0 0"


def test_the_counter_shows_how_far_compilation_is(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = iter(range(1000))
    monkeypatch.setattr(notice.time, "perf_counter", lambda: float(next(clock)))
    shown = Notice()
    with shown.making_ready(total.py_func):
        for _ in range(12):
            shown.step()
    first, second = capsys.readouterr().err.splitlines()[:2]
    assert first.startswith("Compiling 1/")
    assert first.endswith(f", once, kept in {notice.compiled_folder()}")
    assert second.startswith("Compiling 6/")
    assert shown.seconds > 12.0


def test_the_functions_ahead_are_counted_through_their_callers() -> None:
    names = {function.__name__ for function in reachable(compiled_model._run.py_func)}
    assert {"update_network", "journal_force", "factorise", "advance"} <= names


def test_wall_time_leaves_compilation_out(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = iter([3.0, 1003.0])
    monkeypatch.setattr(api, "compile_seconds", lambda: next(seconds))
    case = api.load_case(MOTOR, ["run.fidelity=ideal"])
    solution = api.simulate(case)
    assert solution.statistics["compile_time"] == 1000.0
    assert -1000.0 < solution.statistics["wall_time"] < 0.0


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to another process")
def test_ctrl_c_while_compiling_ends_with_the_code_of_an_interrupt(tmp_path: Path) -> None:
    environment = compiling(tmp_path)
    process = subprocess.Popen(
        [sys.executable, "-m", "toothspace", "run", str(MOTOR), "-o", str(tmp_path / "x.nc")],
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        # a job in the background of a script ignores Ctrl-C, and would hand that on
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert process.stderr is not None
    read = ""
    while "Compiling" not in read:
        line = process.stderr.readline()
        assert line, read
        read += line
    process.send_signal(signal.SIGINT)
    read += process.communicate(timeout=120)[1]
    assert process.returncode == 130, read
    assert "Unexpected" not in read
    assert not (tmp_path / "x.nc").exists()
