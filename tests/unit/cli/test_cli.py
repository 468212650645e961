"""Commands, exit codes and streams; the simulation itself is replaced by a stand-in."""

from __future__ import annotations

import errno
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toothspace
from tests.conftest import posix
from toothspace.cli import machines, main, output
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.finding import Finding
from toothspace.core.status import Status

REPOSITORY = Path(__file__).resolve().parents[3]
MOTOR = REPOSITORY / "cases" / "egm12_motor.toml"
GEROTOR = REPOSITORY / "cases" / "gerotor_cycloidal.toml"
GEROTOR = REPOSITORY / "cases" / "gerotor_trochoidal.toml"


@dataclass
class FakeSolution:
    status: Status = Status.DONE
    findings: tuple[Finding, ...] = ()

    def summary(self) -> dict[str, Any]:
        return {"mean_flow_L_per_min": np.float64(7.5), "flow_ripple_percent": math.nan}

    def save(self, path: Path) -> Path:
        path.write_bytes(b"result")
        return path


@dataclass
class FakeCheck:
    name: str = "tip_land"
    value: float = 0.5
    unit: str = "mm"
    allowed: str = "at least 0.55 mm"
    passed: bool = False
    reason: str = "A thin land breaks and leaks."


@dataclass
class FakeDescription:
    lateral_balance = None
    geometry_summary: Mapping[str, Any] = field(
        default_factory=lambda: {"displacement_cm3_per_rev": 4.949}
    )
    checks: tuple[FakeCheck, ...] = (FakeCheck(), FakeCheck(name="contact_ratio", passed=True))


Simulate = Callable[..., Any]


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[Simulate], None]:
    """Replace the simulation, and work in an empty folder."""
    from toothspace import api

    monkeypatch.chdir(tmp_path)

    def replace(simulate: Simulate) -> None:
        monkeypatch.setattr(api, "simulate", simulate)

    return replace


@pytest.fixture
def described(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Replace the machine description, and work in an empty folder."""
    from toothspace import api

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(api, "describe", lambda case: FakeDescription())


@pytest.mark.parametrize(
    ("status", "code"),
    [
        (Status.DONE, 0),
        (Status.NOT_CYCLIC, 3),
        (Status.NOT_REPEATING, 3),
        (Status.STEP_TOO_SMALL, 3),
        (Status.NOT_CONVERGED, 3),
        (Status.INTERRUPTED, 130),
    ],
)
def test_run_keeps_the_result_and_tells_its_status(
    status: Status,
    code: int,
    simulated: Callable[[Simulate], None],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    simulated(lambda case, progress: FakeSolution(status))
    assert main(["run", str(MOTOR), "--json"]) == code
    streams = capsys.readouterr()
    assert json.loads(streams.out) == {
        "mean_flow_L_per_min": 7.5,
        "flow_ripple_percent": None,
        "findings": [],
    }
    assert (tmp_path / "egm12_motor.nc").read_bytes() == b"result"
    assert (status.value in streams.err) == (status is not Status.DONE)


def test_run_passes_overrides_and_fidelity(
    simulated: Callable[[Simulate], None], tmp_path: Path
) -> None:
    seen = []

    def simulate(case: Any, progress: Any) -> FakeSolution:
        seen.append(case)
        return FakeSolution()

    simulated(simulate)
    options = ["--fidelity", "ideal", "--set", "operating_point.shaft_speed=2000 rpm"]
    assert main(["run", str(MOTOR), "-o", str(tmp_path / "r.nc"), *options]) == 0
    assert seen[0].run.fidelity == "ideal"
    assert seen[0].overrides == ("operating_point.shaft_speed=2000 rpm", "run.fidelity=ideal")


def test_tables_that_are_not_used_are_reported(
    simulated: Callable[[Simulate], None], capsys: pytest.CaptureFixture[str]
) -> None:
    simulated(lambda case, progress: FakeSolution())
    main(["run", str(MOTOR), "--json"])
    assert "Note: [machine.startup] is not used by a run with 'lumped'" in capsys.readouterr().err
    main(["run", str(MOTOR), "--json", "--force", "--fidelity", "ideal"])
    assert "[machine.casing.wear_in] is not used" in capsys.readouterr().err


def test_free_rotors_are_reported_where_their_films_are_not_solved(
    simulated: Callable[[Simulate], None], capsys: pytest.CaptureFixture[str]
) -> None:
    simulated(lambda case, progress: FakeSolution())
    told = "Note: machine.lateral.position is not used "
    free = ["run", str(GEROTOR), "--json", "--force", "--set", "machine.lateral.position=free"]
    main([*free, "--fidelity", "ideal"])
    assert told + "by a run with 'ideal'" in capsys.readouterr().err
    main([*free, "--fidelity", "lumped"])
    assert told + "without run.interfaces.lateral = 'reynolds'" in capsys.readouterr().err
    main([*free, "--fidelity", "films", "--set", "run.interfaces.lateral=closed_form"])
    assert told in capsys.readouterr().err
    main([*free, "--fidelity", "lumped", "--set", "run.interfaces.lateral=reynolds"])
    main([*free, "--fidelity", "films"])
    main(["run", str(GEROTOR), "--json", "--force", "--fidelity", "lumped"])
    assert told not in capsys.readouterr().err


def test_files_of_bodies_that_do_not_deform_are_reported(
    simulated: Callable[[Simulate], None], capsys: pytest.CaptureFixture[str]
) -> None:
    simulated(lambda case, progress: FakeSolution())
    edge = ["--force", "--set", "machine.elastic_bodies.edge_length=3 mm"]
    main(["run", str(MOTOR), "--json", *edge])
    assert "[machine.elastic_bodies] is not used by a run" in capsys.readouterr().err
    main(["run", str(MOTOR), "--json", "--fidelity", "elastic", *edge])
    told = "[machine.elastic_bodies] is not used with run.deformation = 'winkler'"
    assert told in capsys.readouterr().err
    bodies = ["--set", "run.deformation=bodies"]
    main(["run", str(MOTOR), "--json", "--fidelity", "elastic", *edge, *bodies])
    assert "elastic_bodies" not in capsys.readouterr().err


def test_text_summary_is_aligned(
    simulated: Callable[[Simulate], None], capsys: pytest.CaptureFixture[str]
) -> None:
    simulated(lambda case, progress: FakeSolution())
    main(["run", str(MOTOR)])
    assert capsys.readouterr().out == "mean_flow_L_per_min  7.5\nflow_ripple_percent  -\n"


@pytest.mark.parametrize("error", [CaseError, GeometryError])
def test_later_errors_name_the_file(
    error: type[Exception],
    simulated: Callable[[Simulate], None],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def simulate(case: Any, progress: Any) -> None:
        raise error("machine.gears.module: found 1, allowed 2")

    simulated(simulate)
    assert main(["run", str(MOTOR)]) == 2
    streams = capsys.readouterr()
    assert streams.err == f"{MOTOR}: machine.gears.module: found 1, allowed 2\n"
    assert list(tmp_path.iterdir()) == []


def test_unexpected_error_is_one_line(
    simulated: Callable[[Simulate], None],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def simulate(case: Any, progress: Any) -> None:
        raise ZeroDivisionError("division by zero")

    simulated(simulate)
    assert main(["run", str(MOTOR)]) == 70
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert "ZeroDivisionError: division by zero" in line
    assert "TOOTHSPACE_DEBUG=1" in line
    monkeypatch.setenv("TOOTHSPACE_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        main(["run", str(MOTOR)])


def test_interrupt_before_the_first_step(
    simulated: Callable[[Simulate], None], capsys: pytest.CaptureFixture[str]
) -> None:
    def simulate(case: Any, progress: Any) -> None:
        raise KeyboardInterrupt

    simulated(simulate)
    assert main(["run", str(MOTOR)]) == 130
    assert capsys.readouterr().err == f"{MOTOR}: interrupted before there was a result\n"


@pytest.mark.parametrize("target", ["folder", "absent/out.nc"])
def test_place_of_the_result_is_checked_before_the_run(
    target: str,
    simulated: Callable[[Simulate], None],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "folder").mkdir()
    simulated(lambda case, progress: pytest.fail("was run"))
    assert main(["run", str(MOTOR), "-o", str(tmp_path / target)]) == 2
    assert "-o: found" in capsys.readouterr().err


def test_results_are_replaced_only_by_force(
    simulated: Callable[[Simulate], None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    simulated(lambda case, progress: FakeSolution())
    target = tmp_path / "egm12_motor.nc"
    target.write_bytes(b"kept")
    assert main(["run", str(MOTOR)]) == 2
    assert "found a file that exists, allowed a new one, or --force" in capsys.readouterr().err
    assert target.read_bytes() == b"kept"
    assert main(["run", str(MOTOR), "--force"]) == 0
    assert target.read_bytes() == b"result"


@pytest.mark.parametrize(
    "arguments",
    [
        ["report", "result.nc", "-o", "there"],
        ["compare", "result.nc", "result.nc", "-o", "there"],
        ["gear", "gear.dxf", "--plot", "there"],
        ["geometry", str(MOTOR), "-o", "there"],
        ["geometry", str(MOTOR), "--plot", "there"],
        ["bearing", str(MOTOR.with_name("journal_bearing.toml")), "-o", "there"],
        ["film", str(MOTOR.with_name("slider_pad.toml")), "-o", "there"],
        ["reduce", str(MOTOR), "-o", "there"],
        ["validate", "-o", "there"],
        ["study", str(MOTOR.with_name("sweep_clearance.toml")), "-o", "."],
    ],
)
def test_no_command_replaces_a_file_unasked(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("there", "points.jsonl"):
        (tmp_path / name).write_bytes(b"kept")
    assert main(arguments) == 2
    assert "--force" in capsys.readouterr().err
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"kept", b"kept"]


def test_a_result_that_its_place_refuses_is_kept_elsewhere(
    simulated: Callable[[Simulate], None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    refused: list[Path] = []

    class Homeless(FakeSolution):
        def save(self, path: Path) -> Path:
            if path.parent.name != "spare":
                refused.append(path)
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
            return super().save(path)

    simulated(lambda case, progress: Homeless())
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "spare"))
    (tmp_path / "spare").mkdir()
    assert main(["run", str(MOTOR), "--json"]) == 2
    streams = capsys.readouterr()
    assert json.loads(streams.out)["mean_flow_L_per_min"] == 7.5
    (kept,) = (tmp_path / "spare").iterdir()
    assert f"egm12_motor.nc: found {os.strerror(errno.ENOSPC)} on writing" in streams.err
    assert f"Result: {kept}" in streams.err
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert main(["run", str(MOTOR), "--json"]) == 2
    assert "Result: the numbers above only" in capsys.readouterr().err


def test_an_interrupt_while_the_result_is_written_waits(
    simulated: Callable[[Simulate], None], tmp_path: Path
) -> None:
    class Late(FakeSolution):
        def save(self, path: Path) -> Path:
            signal.raise_signal(signal.SIGTERM)
            return super().save(path)

    simulated(lambda case, progress: Late())
    assert main(["run", str(MOTOR), "--json"]) == 130
    assert (tmp_path / "egm12_motor.nc").read_bytes() == b"result"


@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_the_end_of_a_batch_job_is_an_interrupt(
    name: str, simulated: Callable[[Simulate], None], capsys: pytest.CaptureFixture[str]
) -> None:
    sent = getattr(signal, name)
    simulated(lambda case, progress: signal.raise_signal(sent))
    # tests that run without a terminal may inherit that its end is ignored
    inherited = signal.signal(sent, signal.SIG_DFL)
    try:
        assert main(["run", str(MOTOR)]) == 130
    finally:
        signal.signal(sent, inherited)
    assert "interrupted before there was a result" in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
def test_numbers_that_cannot_be_printed_are_an_error(tmp_path: Path) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        command = [sys.executable, "-m", "toothspace", "schema"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == f"found {os.strerror(errno.ENOSPC)}\n"


@pytest.mark.parametrize("content", [b"\xff\xfe\x00binary", b"a" * 200_000, b""])
def test_measured_data_that_are_none(
    content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    measured = tmp_path / "measured.csv"
    measured.write_bytes(content)
    assert main(["report", str(tmp_path / "a.nc"), "--measured", str(measured)]) == 2
    streams = capsys.readouterr()
    assert f"{measured}: " in streams.err
    assert streams.err.count("\n") == 1


@pytest.mark.usefixtures("described")
def test_geometry_prints_numbers_and_checks(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["geometry", str(MOTOR), "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert numbers == {"displacement_cm3_per_rev": 4.949, "warnings": ["tip_land"]}
    assert main(["geometry", str(MOTOR)]) == 0
    text = capsys.readouterr().out
    assert "LOOK  tip_land: 0.5 mm (allowed at least 0.55 mm)" in text
    assert "A thin land breaks and leaks." in text


@pytest.mark.usefixtures("described")
@pytest.mark.parametrize("suffix", ["txt", "dxf"])
def test_geometry_exports_profiles_that_can_be_read(
    suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["geometry", str(MOTOR), "--json", "--export", suffix]) == 0
    file = tmp_path / f"egm12_motor_drive.{suffix}"
    assert capsys.readouterr().err == f"Profile: {file.name}\n"
    case = toothspace.load_case(MOTOR, [f"machine.gears.profile={file}"])
    assert case.machine_spec.drive.tooth.tooth_count == 12


@pytest.mark.usefixtures("described")
def test_geometry_replaces_no_file_unasked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(FakeDescription, "angle_tables", lambda _: (), raising=False)
    monkeypatch.setattr(FakeDescription, "outlines", {"gear": np.eye(2)}, raising=False)
    given = {"--export": "txt", "--txt": "tables", "--plot": "plot.png"}
    words = ["geometry", str(MOTOR), "--export", "txt", "--txt", "tables"]
    assert main(words) == 0
    Path("plot_openings.png").touch()
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.*")}
    for option, value in given.items():
        assert main(["geometry", str(MOTOR), option, value]) == 2
        assert f"{option}: found" in capsys.readouterr().err
    assert before == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.*")}
    assert main([*words, "--force"]) == 0


@pytest.mark.usefixtures("described")
def test_export_of_an_unknown_format_or_machine(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["geometry", str(MOTOR), "--export", "iges"]) == 2
    assert "--export: found 'iges', allowed dxf, stl, step, txt" in capsys.readouterr().err
    monkeypatch.setattr(machines, "optional_function", lambda *_: None)
    assert main(["geometry", str(GEROTOR), "--export", "dxf"]) == 2
    assert "--export: found machine type 'gerotor', allowed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("table", "name"), [("bearing", "journal_bearing"), ("film", "slider_pad")]
)
def test_stand_alone_film(
    table: str, name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from toothspace import api

    for status, code in (("done", 0), ("not_converged", 3)):
        summary = {"load_N": 1.0, "status": status}
        monkeypatch.setattr(api, f"solve_{table}", lambda case, _fields, summary=summary: summary)
        assert main([table, str(MOTOR.with_name(f"{name}.toml")), "--json"]) == code
        assert json.loads(capsys.readouterr().out) == summary


def test_stand_alone_film_has_its_own_command(capsys: pytest.CaptureFixture[str]) -> None:
    pad = MOTOR.with_name("slider_pad.toml")
    assert main(["run", str(pad)]) == 2
    assert capsys.readouterr().err == (
        f"{pad}: film: found a stand-alone film, allowed with 'toothspace film' only\n"
    )
    assert main(["bearing", str(pad)]) == 2
    assert "bearing: found nothing, allowed a table [bearing]" in capsys.readouterr().err


def test_report_of_a_missing_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(tmp_path / "absent.nc")]) == 2
    streams = capsys.readouterr()
    assert streams.err.count("\n") == 1
    assert "absent.nc" in streams.err


def test_schema_is_one_json_object(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert schema["$schema"].endswith("2020-12/schema")
    assert schema["additionalProperties"] is False


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["runn"], "No such command 'runn'"),
        (["run"], "Missing argument 'CASE.toml'"),
        (["run", "case.toml", "--sett", "a=1"], "No such option"),
        (["run", "case.toml", "more.toml"], "more.toml"),
    ],
)
def test_wrong_use_is_one_line(
    arguments: list[str], part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    streams = capsys.readouterr()
    assert part in streams.err
    assert streams.err.count("\n") == 1
    assert streams.out == ""


@pytest.mark.parametrize("arguments", [[], ["--help"], ["run", "-h"], ["--version"]])
def test_help_and_version(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 0
    streams = capsys.readouterr()
    assert "toothspace" in streams.out
    assert streams.err == ""


def test_values_of_numpy_become_json() -> None:
    value = {"a": np.arange(2), "b": (np.int64(1), math.inf), "c": None, "d": Path("x")}
    assert output.plain(value) == {"a": [0, 1], "b": [1, None], "c": None, "d": "x"}


def test_lumped_runs_load_no_scipy() -> None:
    used = "api", "machines.external_gear.describe", "run.run", "results.file_layout"
    heavy = {"scipy.linalg", "scipy.sparse", "scipy.spatial", "scipy.special", "matplotlib"}
    program = (
        f"import sys, {', '.join(f'toothspace.{name}' for name in used)}\n"
        f"assert not {heavy!r} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_help_answers_without_what_is_heavy() -> None:
    heavy = {"numpy", "numba", "scipy", "xarray", "pint", "matplotlib", "shapely"}
    program = (
        "import sys\nfrom toothspace.cli import main\n"
        f"assert main(['--help']) == 0\nassert not {heavy!r} & set(sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "geometry" in done.stdout


def test_long_lists_are_shown_by_their_range(capsys: pytest.CaptureFixture[str]) -> None:
    output.write({"short": [1.0, 2.0], "long": [float(k) for k in range(50)]}, as_json=False)
    assert capsys.readouterr().out.split("\n")[:2] == ["short  1, 2", "long   50 values, 0 to 49"]
    output.write({"long": list(range(50))}, as_json=True)
    assert json.loads(capsys.readouterr().out)["long"] == list(range(50))


PROFILE = Path(__file__).parents[3] / "cases" / "profiles" / "egm12_drive.txt"


def test_gear_prints_what_a_drawing_and_a_tester_say(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "deviation.png"
    options = ["--json", "--center-distance", "34.465 mm", "--plot", str(picture)]
    assert main(["gear", str(PROFILE), *options]) == 0
    found = json.loads(capsys.readouterr().out)
    (gear,) = found["gears"]
    assert gear["tooth_count"] == 12
    assert gear["module_mm"] == pytest.approx(2.75, abs=1e-4)
    assert gear["profile_shift"] == pytest.approx(0.3, abs=1e-4)
    assert gear["tip_rounding_mm"] == pytest.approx(0.1, abs=0.02)
    assert gear["left_total_profile_deviation_um"] < 0.5
    assert found["pairs"][0]["normal_backlash_mm"] == pytest.approx(0.0203, abs=2e-4)
    assert picture.stat().st_size > 10_000


def test_gear_in_a_wrong_unit_asks_back(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gear", str(PROFILE), "--unit", "in"]) == 0
    assert "with --unit mm the gear has a standard module" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options", [["--unit", "furlong"], ["--axis", "w"], ["--plane", "3"], ["--plot", "a.txt"]]
)
def test_gear_refuses_wrong_options(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gear", str(PROFILE), *options]) == 2
    assert "allowed" in capsys.readouterr().err


def test_a_run_without_memory_ends_with_a_line_and_the_code_of_a_failure(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def greedy(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr("toothspace.api.simulate", greedy)
    assert main(["run", str(MOTOR)]) == 3
    assert capsys.readouterr().err.splitlines()[-1].startswith("memory: found no more")


def test_what_a_library_says_without_memory_is_put_as_lack_of_memory(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What fails is anything: SystemError, ImportError, an error of LLVM."""

    def fails(*_: object, **__: object) -> None:
        raise SystemError("returned NULL without setting an exception")

    monkeypatch.setattr("toothspace.api.simulate", fails)
    assert main(["run", str(MOTOR)]) == 70
    monkeypatch.setattr("toothspace.cli.is_short", lambda: True)
    assert main(["run", str(MOTOR)]) == 3
    assert capsys.readouterr().err.splitlines()[-1].startswith("memory: found no more")


@posix
@pytest.mark.parametrize("mebibytes", [60, 150])
def test_libraries_that_end_or_hang_without_memory_are_not_loaded(mebibytes: int) -> None:
    """OpenBLAS at 60 MiB: exit code 1 of its own; at 150 to 200 MiB it asks for ever."""
    program = (
        "import resource, sys\n"
        f"resource.setrlimit(resource.RLIMIT_DATA, ({mebibytes << 20},) * 2)\n"
        "from toothspace.cli import main; sys.exit(main(['fluids', '--list']))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False
    )
    assert run.returncode == 3, run.stderr
    assert run.stderr.startswith("memory: found no more")
