"""The library of compiled code: which way is taken, what it takes and gives, same bits as Numba."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from native.compile import target
from native.record import widened
from native.signatures import ArrayType, Scalar, TupleType, parsed, read_entries, text_of
from toothspace.cli.output import load
from toothspace.core.compilation import library
from toothspace.core.compilation.entry import Entry
from toothspace.core.compilation.library import Way, chosen
from toothspace.model.chambers import wall_volume
from toothspace.numerics.structured_grid import CellBalance
from toothspace.numerics.vectors import norm

REPOSITORY = Path(__file__).resolve().parents[3]
CASES = REPOSITORY / "cases"

needs_library = pytest.mark.skipif(chosen()[0] != Way.LIBRARY, reason=chosen()[1])

MACHINES = {
    "egm12_motor": (),
    "egm12_pump": (),
    "fuel14_pump": (),
    "gerotor_trochoidal": (),
    "gerotor_cycloidal": (),
    "crescent_pump": (),
    "startup_fan_drive": ('circuit.duration="0.4 s"', "run.time_samples=100"),
}
"""Cases whose numbers are compared, with overrides."""

RUN = """
import hashlib, json, sys
if sys.argv[1] == "library":
    sys.modules["numba"] = sys.modules["llvmlite"] = None
    from toothspace.core.compilation.entry import Entry
    def missed(self):
        raise AssertionError(f"{self.py_func.__qualname__} is not in the library")
    Entry._otherwise = property(missed)
from toothspace import api
from toothspace.core.compilation.library import way
found = {"way": way()}
for path, overrides in json.loads(sys.argv[2]):
    case = api.load_case(path, overrides)
    if path.endswith("journal_bearing.toml"):
        found[path] = {k: v for k, v in api.solve_bearing(case).items()
                       if k != "wall_time_s"}
    elif path.endswith("film.toml"):
        found[path] = {k: v for k, v in api.solve_film(case).items()
                       if k != "wall_time_s"}
    else:
        data = api.simulate(case).data
        found[path] = {n: hashlib.sha256(v.values.tobytes()).hexdigest()
                       for n, v in sorted(data.variables.items()) if v.dtype.kind == "f"}
print(json.dumps(found))
"""
"""Prints digests of all numbers of some cases, computed one way."""


def numbers(way: str, cases: list[tuple[str, tuple[str, ...]]]) -> dict[str, dict[str, str]]:
    own = {
        "TOOTHSPACE_COMPILATION": way,
        "NUMBA_CPU_NAME": target(),
        "NUMBA_CPU_FEATURES": "",
        "PYTHONPATH": str(REPOSITORY / "src"),
    }
    done = subprocess.run(
        [sys.executable, "-c", RUN, way, json.dumps(cases)],
        env={**os.environ, **own},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, dict[str, str]] = json.loads(done.stdout)
    assert found.pop("way") == way  # type: ignore[comparison-overlap]
    return found


@needs_library
@pytest.mark.slow
def test_machines_are_the_same_numbers_from_the_library_and_from_numba() -> None:
    cases = [(str(CASES / f"{name}.toml"), own) for name, own in MACHINES.items()]
    warmup = REPOSITORY / "src" / "toothspace" / "library" / "warmup" / "machine.toml"
    films = [str(CASES / name) for name in ("journal_bearing.toml", "egm12_lateral_film.toml")]
    cases += [(str(warmup), ("run.fidelity=films",)), *((film, ()) for film in films)]
    native, just_in_time = numbers("library", cases), numbers("jit", cases)
    for name, values in native.items():
        differing = [key for key in values if values[key] != just_in_time[name][key]]
        assert not differing, f"{name}: {differing}"


@needs_library
def test_arrays_that_do_not_fit_are_not_handed_to_the_library(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert isinstance(norm, Entry)
    monkeypatch.setattr(norm, "_otherwise", lambda *given: "elsewhere")
    assert norm(np.array([3.0, 4.0])) == 5.0
    assert norm(np.arange(6.0)[::2]) == "elsewhere"  # type: ignore[comparison-overlap]
    assert norm(np.array([3, 4])) == "elsewhere"  # type: ignore[comparison-overlap]
    assert norm(np.ones((2, 2))) == "elsewhere"  # type: ignore[comparison-overlap]
    assert norm([3.0, 4.0]) == "elsewhere"  # type: ignore[arg-type, comparison-overlap]
    assert norm(np.ones(2), 1) == "elsewhere"  # type: ignore[call-arg]


@needs_library
def test_an_entry_for_any_layout_takes_a_column() -> None:
    rows = np.zeros((40, 2))
    rows[:, 1] = np.linspace(1.0, 2.0, 40)
    plain = wall_volume.py_func(rows[:, 1], 1e5)  # type: ignore[attr-defined]
    assert wall_volume(rows[:, 1], 1e5) == pytest.approx(plain, rel=1e-14)


def test_types_are_read_as_they_are_written() -> None:
    for types in read_entries().values():
        assert written(parsed(types)) == types


def written(kind: Scalar | ArrayType | TupleType) -> str:
    if isinstance(kind, Scalar):
        return kind.dtype
    if isinstance(kind, ArrayType):
        end = "r" if kind.readonly else ""
        return f"{kind.dtype}[{kind.dimensions}{kind.layout}]{end}"
    return f"{kind.class_name}({','.join(map(written, kind.members))})"


def test_types_of_values() -> None:
    columns = np.zeros((2, 3), order="F", dtype=np.float32)
    columns.flags.writeable = False
    given = (1, 2.0, True, columns, (np.zeros(3)[::2],))
    assert text_of(given) == "(i8,f8,b1,f4[2F]r,(f8[1A]))"


def test_fields_of_recorded_tuples_are_those_of_their_classes() -> None:
    for types in read_entries().values():
        check(parsed(types))
    assert "numerics.structured_grid.CellBalance" in "".join(read_entries().values())
    assert CellBalance._fields


def test_every_entry_is_a_compiled_function() -> None:
    for name in read_entries():
        module, function = name.rsplit(".", 1)
        found = getattr(import_module(f"toothspace.{module}"), function, None)
        assert hasattr(found, "py_func"), f"native/entries.txt: found {name}, which is no function"


def check(kind: Scalar | ArrayType | TupleType) -> None:
    if isinstance(kind, TupleType):
        if kind.class_name:
            assert len(kind.load()._fields) == len(kind.members), kind.class_name
        for member in kind.members:
            check(member)


def test_other_sources_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    if chosen()[0] != Way.LIBRARY:
        pytest.skip(chosen()[1])
    monkeypatch.setattr(library, "digest_of_modules", lambda names: "other")
    found = library._opened()
    assert isinstance(found, str)
    assert found.endswith("was built from other sources")


def test_a_checkout_whose_library_is_older_says_that_it_compiles_first(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    case = Path(__file__).parents[3] / "cases" / "gerotor_cycloidal.toml"
    older = Way.JUST_IN_TIME, "the library was built from other sources", None
    monkeypatch.setattr(library, "chosen", lambda: older)
    monkeypatch.delenv("TOOTHSPACE_COMPILATION", raising=False)
    monkeypatch.setattr(library, "FOLDER", Path(__file__).parent)
    monkeypatch.setattr(library, "LIBRARY", Path(__file__).name)
    load(case, None)
    said = capsys.readouterr().err
    assert "built from other sources; what is used is compiled first. make kernels" in said
    monkeypatch.setenv("TOOTHSPACE_COMPILATION", "jit")
    load(case, None)
    assert capsys.readouterr().err == ""


def test_without_library_and_compiler_a_run_says_what_to_install(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; sys.modules['numba'] = None\n"
        "import toothspace.core.compilation.library as library\n"
        "library.FOLDER = Path('nowhere')\n"
        "from toothspace.cli import main; main()"
    )
    command = [sys.executable, "-c", code, "run", str(CASES / "egm12_motor.toml"), "-o", "m.nc"]
    environment = {**os.environ, "TOOTHSPACE_COMPILATION": ""}
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    said = 'compiled code is missing, allowed after pip install "toothspace[jit]"'
    assert said in done.stderr
    assert not (tmp_path / "m.nc").exists()


def test_an_unknown_way_is_refused() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import toothspace.numerics.vectors"],
        env={**os.environ, "TOOTHSPACE_COMPILATION": "fast"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "TOOTHSPACE_COMPILATION: found fast, allowed library, jit or plain" in done.stderr


def test_types_that_differ_in_layout_take_any() -> None:
    assert widened("(f8[2F],i8,f8[1C])", "(f8[2C],i8,f8[1C])") == "(f8[2A],i8,f8[1C])"
    assert widened("(f8[2A])", "(f8[2C])") == "(f8[2A])"
    assert widened("(f8[2C],i8)", "(f8[2C])") == "(f8[2C])"
