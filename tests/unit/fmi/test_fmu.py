"""Functional mock-up units: a made-up machine whose closed form the tables must give back."""

from __future__ import annotations

import json
import math
import re
import struct
import subprocess
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr

import toothspace as ts
from tests.fake_solution import fake_solution
from tests.study_cases import REPOSITORY, case_with_study
from toothspace.case import Case, load_case
from toothspace.cli import main
from toothspace.core.types import Array
from toothspace.fmi import archive, export
from toothspace.fmi.operating_tables import PULSATING, ShaftSamples, tables_of
from toothspace.studies.study import Record

PUMP, MOTOR = (REPOSITORY / "cases" / f"egm12_{mode}.toml" for mode in ("pump", "motor"))
DISPLACEMENT = 8e-7
STEPS = 96
RPM = math.pi / 30.0
GRID = {
    "pressure_difference": ["50 bar", "100 bar", "200 bar"],
    "shaft_speed": ["500 rpm", "1000 rpm", "2000 rpm"],
}
COMMAND = [
    *("--pressure", "50 bar", "--pressure", "200 bar"),
    *("--speed", "500 rpm", "--speed", "2000 rpm"),
]
needs_compiler = pytest.mark.skipif(archive.found_compiler() is None, reason="no C compiler")


def machine(speed: float, difference: float, sign: float) -> dict[str, float]:
    """Flows and torques that are linear in speed and pressure; what is lost closes the balance."""
    flow, friction = DISPLACEMENT * speed, 0.3 + 2e-3 * speed + 2e-8 * difference
    torque = DISPLACEMENT * difference + sign * friction
    hydraulic = (flow - sign * 2e-13 * difference) * difference
    return {
        "inlet_flow_rate": flow - sign * 1e-13 * difference,
        "outlet_flow_rate": flow - sign * 1.5e-13 * difference,
        "drain_flow_rate": 3e-14 * difference,
        "leakage": 5e-14 * difference,
        "lost_flow_rate": 1e-13 * difference,
        "shaft_torque": torque,
        "hydraulic_power": hydraulic,
        "power_loss": sign * (torque * speed - hydraulic),
    }


def waves(speed: float, difference: float, angle: Array) -> dict[str, Array]:
    """Ripple of twelve teeth: of flows with the speed, of the torque with the pressure."""
    tooth = np.sin(12.0 * angle)
    return {
        "inlet_flow_rate": 2e-8 * speed * tooth,
        "outlet_flow_rate": 1e-8 * speed * np.cos(12.0 * angle),
        "shaft_torque": 3e-8 * difference * tooth,
    }


class Samples:
    """Stand-in for the runs; counts them, and fails where it is told to."""

    label = "made-up samples"

    def __init__(self) -> None:
        self.count, self.ripple, self.uneven = 0, 1.0, 0.0
        self.fails: Callable[[float], bool] = lambda _: False

    def __call__(self, case: Case) -> Mapping[str, Any]:
        self.count += 1
        at = case.operating_point
        assert at is not None
        assert at.outlet_load == "fixed_pressure"
        sign = -1.0 if case.machine.mode == "motor" else 1.0
        difference = sign * (at.outlet_pressure - at.inlet_pressure)
        if self.fails(difference):
            return {"status": "not_cyclic"}
        angle = np.arange(STEPS) * (2.0 * np.pi / STEPS)
        ripple = waves(at.shaft_speed, difference, angle)
        once = self.uneven * np.sin(angle)
        ripple = {name: one + once * one.max() for name, one in ripple.items()}
        return {
            **machine(at.shaft_speed, difference, sign),
            **{f"{name}_ripple": (self.ripple * one).tolist() for name, one in ripple.items()},
            "displacement": DISPLACEMENT,
            "energy_balance_error": 1e-7,
            "warnings": ["Warned of."],
            "status": "done",
        }


@pytest.fixture
def samples(monkeypatch: pytest.MonkeyPatch) -> Samples:
    found = Samples()
    monkeypatch.setattr(export, "ShaftSamples", lambda: found)
    return found


@pytest.fixture(scope="session")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulator in C."""
    compiler = archive.found_compiler()
    if compiler is None:
        pytest.skip("no C compiler")
    program = tmp_path_factory.mktemp("host") / "fmu_host"
    source = Path(__file__).with_name("data") / "fmu_host.c"
    subprocess.run([compiler, "-O2", "-o", program, source, "-ldl"], check=True)
    return program


class Unit:
    """An unpacked unit in the simulator in C."""

    def __init__(self, path: Path, host: Path) -> None:
        self.folder, self.host = path.with_suffix(""), host
        with zipfile.ZipFile(path) as packed:
            packed.extractall(self.folder)
        self.root = ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        self.references = {
            one.get("name"): one.get("valueReference")
            for one in self.root.iter("ScalarVariable")
            if one.find("Real") is not None
        }
        self.messages = ""

    def run(
        self,
        given: Mapping[str, float],
        wanted: tuple[str, ...],
        *,
        steps: int = 2,
        step: float = 1e-4,
        later: Mapping[str, float] = {},
        token: str | None = None,
        code: int = 0,
    ) -> Array:
        """Values after every step, of shape (steps, wanted)."""
        library = next((self.folder / "binaries").rglob("egm12*"))
        words = [f"{self.references[name]}={value!r}" for name, value in given.items()]
        words += [f"+{self.references[name]}={value!r}" for name, value in later.items()]
        words += [str(self.references[name]) for name in wanted]
        command = [self.host, library, token or self.root.get("guid"), str(steps), repr(step)]
        done = subprocess.run([*command, *words], capture_output=True, text=True, check=False)
        assert done.returncode == code, done.stderr
        self.messages = done.stderr
        return np.array([line.split(",") for line in done.stdout.splitlines()], dtype=float)


def unit(tmp_path: Path, host: Path, case: Path = PUMP, **options: Any) -> Unit:
    path = tmp_path / "unit.fmu"
    result = ts.export_fmu(case, path, **{**GRID, **options})
    assert result.status is ts.Status.DONE
    return Unit(path, host)


def at(speed: float, difference: float, *, motor: bool = False) -> dict[str, float]:
    high, low = "inlet_pressure", "outlet_pressure"
    if not motor:
        high, low = low, high
    return {high: 1e5 + difference, low: 1e5, "shaft_speed": speed}


@pytest.mark.parametrize("case", [PUMP, MOTOR], ids=["pump", "motor"])
@pytest.mark.parametrize(("speed", "bar"), [(500, 50), (2000, 200), (700, 130), (1600, 61)])
def test_the_tables_give_the_machine_back(
    samples: Samples, host: Path, tmp_path: Path, case: Path, speed: float, bar: float
) -> None:
    """Everywhere in the tables, at steps of the angle that are steps of the ripple."""
    motor = case == MOTOR
    names = ("shaft_power", "shaft_angle", *machine(1.0, 1.0, 1.0))
    step = 2.0 * np.pi / STEPS / (speed * RPM)
    found = unit(tmp_path, host, case)
    values = found.run(at(speed * RPM, bar * 1e5, motor=motor), names, steps=STEPS, step=step)
    got = dict(zip(names, values.T, strict=True))
    expected = machine(speed * RPM, bar * 1e5, -1.0 if motor else 1.0)
    ripple = waves(speed * RPM, bar * 1e5, got["shaft_angle"])
    assert np.allclose(got["shaft_angle"], np.arange(1, STEPS + 1) * step * speed * RPM)
    for name, value in expected.items():
        scale = max(abs(value), 1e-3 * DISPLACEMENT * speed * RPM if "rate" in name else 0.0)
        deviation = got[name] - value - ripple.get(name, 0.0)
        assert np.max(np.abs(deviation)) < 1e-6 * scale, name
    lost = got["shaft_power"] - got["hydraulic_power"]
    assert np.allclose((-lost if motor else lost) - got["power_loss"], 0.0, atol=1e-9)
    assert "Beyond" not in found.messages


@pytest.mark.parametrize("case", [PUMP, MOTOR], ids=["pump", "motor"])
def test_efficiencies_are_those_of_the_results(
    samples: Samples, host: Path, tmp_path: Path, case: Path
) -> None:
    names = ("volumetric_efficiency", "hydromechanical_efficiency", "overall_efficiency")
    motor = case == MOTOR
    values = unit(tmp_path, host, case).run(at(100.0, 150e5, motor=motor), names)[-1]
    of = machine(100.0, 150e5, -1.0 if motor else 1.0)
    flow, power, lost = DISPLACEMENT * 100.0, of["shaft_torque"] * 100.0, of["lost_flow_rate"]
    overall = power / of["hydraulic_power"] if motor else of["hydraulic_power"] / power
    volumetric = flow / (flow + lost) if motor else 1.0 - lost / flow
    assert values == pytest.approx([volumetric, overall / volumetric, overall], rel=1e-7)


@pytest.mark.parametrize("case", [PUMP, MOTOR], ids=["pump", "motor"])
def test_no_quadrant_gives_power_away(
    samples: Samples, host: Path, tmp_path: Path, case: Path
) -> None:
    """Beyond the tables losses stay, at rest nothing flows but leakage, and it is said."""
    names = ("power_loss", "outlet_flow_rate", "shaft_torque", "overall_efficiency", "leakage")
    found, motor = unit(tmp_path, host, case), case == MOTOR
    for speed in (-400.0, -20.0, 0.0, 20.0, 400.0):
        for difference in (-300e5, -20e5, 0.0, 20e5, 300e5):
            given = at(speed, difference, motor=motor)
            given = {k: v + 4e7 if "pressure" in k else v for k, v in given.items()}
            loss, flow, torque, _, leakage = found.run(given, names)[-1]
            assert loss > 0.0 if speed or difference else loss == 0.0
            assert "Beyond the tables" in found.messages
            assert found.messages.count("logStatusWarning") == 2
            if speed == 0.0:
                assert abs(flow) == pytest.approx(1.5e-13 * min(abs(difference), 200e5))
                assert abs(torque - DISPLACEMENT * difference) <= 3e-8 * abs(difference)
            assert leakage == pytest.approx(5e-14 * np.clip(difference, -200e5, 200e5))
    high = at(100.0, 100e5, motor=motor) | {"outlet_pressure" if motor else "inlet_pressure": 5e4}
    found.run(high, names)
    assert "Beyond the tables" in found.messages


def test_the_ripple_can_be_left_out_and_the_shaft_turned(
    samples: Samples, host: Path, tmp_path: Path
) -> None:
    found = unit(tmp_path, host)
    given = {**at(100.0, 100e5), "shaft_angle_start": math.pi / 24.0}
    first = found.run(given, ("shaft_torque", "shaft_angle"), steps=1, step=0.0)[0]
    mean = machine(100.0, 100e5, 1.0)["shaft_torque"]
    assert first[0] == pytest.approx(mean + 3e-8 * 100e5, rel=1e-7)
    assert first[1] == pytest.approx(math.pi / 24.0)


def test_a_free_shaft_follows_its_torques(samples: Samples, host: Path, tmp_path: Path) -> None:
    """Motor, load and friction that grows with speed: an exponential towards their balance."""
    samples.ripple = 0.0
    found = unit(tmp_path, host, MOTOR, drive="torque")
    at_start, difference, load, inertia = 60.0, 100e5, 7.15, 2e-4
    given = {
        "inlet_pressure": 1e5 + difference,
        "outlet_pressure": 1e5,
        "load_torque": load,
        "shaft_inertia": inertia,
        "shaft_speed_start": at_start,
    }
    end = (DISPLACEMENT * difference - 0.3 - 2e-8 * difference - load) / 2e-3
    values = found.run(given, ("shaft_speed", "shaft_angle"), steps=200, step=1e-3)
    time, constant = 1e-3 * np.arange(1, 201), inertia / 2e-3
    decay = np.exp(-time / constant)
    assert values[:, 0] == pytest.approx(end + (at_start - end) * decay, rel=1e-6)
    angle = end * time + (at_start - end) * constant * (1.0 - decay)
    assert values[:, 1] == pytest.approx(angle, rel=1e-6)


def test_friction_holds_a_shaft_and_stops_it(samples: Samples, host: Path, tmp_path: Path) -> None:
    found = unit(tmp_path, host, MOTOR, drive="torque")
    given = {
        "inlet_pressure": 101e5,
        "outlet_pressure": 1e5,
        "load_torque": 7.9,
        "shaft_inertia": 1e-3,
    }
    names = ("shaft_speed", "shaft_torque", "shaft_angle")
    # friction of the lowest speed is 0.6 N m, the machine drives with 8 N m
    held = found.run(given, names, steps=100)
    assert np.all(held == [0.0, 7.9, 0.0])
    runs = found.run(given | {"load_torque": 7.0}, names, steps=100)
    assert runs[-1, 0] > 1.0
    assert np.all(found.run(given | {"load_torque": 8.9}, names, steps=100)[-1, 0] < -1.0)
    stops = found.run(
        given | {"shaft_speed_start": 20.0}, names, steps=2000, later={"load_torque": 8.3}
    )
    assert stops[-1, 0] == 0.0
    assert np.all(np.diff(stops[:, 2]) >= 0.0)


@pytest.mark.parametrize(
    ("given", "drive", "message"),
    [
        ({"shaft_speed": math.nan}, "speed", "not a finite number"),
        ({"shaft_inertia": 0.0}, "torque", "shaft_inertia: found zero or less"),
    ],
)
def test_a_unit_refuses_what_is_no_number(
    samples: Samples, host: Path, tmp_path: Path, given: dict[str, float], drive: str, message: str
) -> None:
    found = unit(tmp_path, host, drive=drive)
    found.run(given, ("shaft_torque",), code=4)
    assert message in found.messages


def test_a_binary_knows_its_description(samples: Samples, host: Path, tmp_path: Path) -> None:
    found = unit(tmp_path, host)
    found.run({}, (), token="another", code=3)
    assert "does not belong to modelDescription.xml" in found.messages


@needs_compiler
def test_the_source_is_clean_c(samples: Samples, tmp_path: Path) -> None:
    ts.export_fmu(PUMP, tmp_path / "unit.fmu", **GRID, binary=False)
    with zipfile.ZipFile(tmp_path / "unit.fmu") as packed:
        assert not [name for name in packed.namelist() if name.startswith("binaries")]
        packed.extractall(tmp_path)
    warned = ["-Wall", "-Wextra", "-Wno-unused-parameter", "-pedantic", "-Werror", "-fsyntax-only"]
    command = [archive.found_compiler(), "-std=c99", *warned, tmp_path / "sources" / "machine.c"]
    for options in ([], ["-DFMI2_FUNCTION_PREFIX=pump_"]):
        done = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("drive", export.DRIVES)
def test_references_of_the_description_are_those_of_the_source(
    samples: Samples, tmp_path: Path, drive: str
) -> None:
    path = tmp_path / "unit.fmu"
    ts.export_fmu(MOTOR, path, **GRID, drive=drive, binary=False)
    with zipfile.ZipFile(path) as packed:
        header = packed.read("sources/machine_data.h").decode()
        root = ElementTree.fromstring(packed.read("modelDescription.xml"))
        case = packed.read("resources/case.toml").decode()
    reals, booleans = (group.split(", ") for group in re.findall(r"enum \{ (.*?) \};", header)[:2])
    entries = list(root.iter("ScalarVariable"))
    for entry in entries:
        names = reals if entry.find("Real") is not None else booleans
        assert names[int(entry.get("valueReference", ""))] == entry.get("name", "").upper()
    outputs = [k for k, one in enumerate(entries, 1) if one.get("causality") == "output"]
    for group in ("Outputs", "InitialUnknowns"):
        listed = [int(one.get("index", "")) for one in root.find(f"ModelStructure/{group}") or ()]
        assert listed == outputs
    units = {one.get("name") for one in root.iter("Unit")}
    assert {one.get("unit") for one in root.iter("Real")} <= units
    causality = {one.get("name"): one.get("causality") for one in entries}
    assert causality["shaft_speed"] == ("input" if drive == "speed" else "output")
    assert ("load_torque" in causality) is (drive == "torque")
    assert Case.from_toml(case, MOTOR.parent, "case").machine == load_case(MOTOR).machine


def test_the_same_case_gives_the_same_bytes(samples: Samples, tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("a.fmu", "b.fmu", "c.fmu")]
    for path in paths[:2]:
        ts.export_fmu(PUMP, path, **GRID)
    ts.export_fmu(PUMP, paths[2], **GRID | {"shaft_speed": ["500 rpm", "2000 rpm"]})
    first, second, third = (path.read_bytes() for path in paths)
    assert first == second != third


def test_the_grid_may_be_that_of_an_efficiency_map(samples: Samples, tmp_path: Path) -> None:
    study = (
        'kind = "efficiency_map"\nshaft_speed = ["500 rpm", "900 rpm"]\n'
        'pressure_difference = ["20 bar", "40 bar", "60 bar"]\n'
    )
    result = ts.export_fmu(case_with_study(study), tmp_path / "unit.fmu", binary=False)
    assert result.data["pressure_difference"].values == pytest.approx([20e5, 40e5, 60e5])
    assert result.summary()["points"] == samples.count == 6
    with zipfile.ZipFile(tmp_path / "unit.fmu") as packed:
        root = ElementTree.fromstring(packed.read("modelDescription.xml"))
    # 24 steps in a twelfth of a turn at 900 rpm, one digit of it
    step = float(root.find("DefaultExperiment").get("stepSize"))
    assert step == pytest.approx(1.0 / (15.0 * 12.0 * 24.0), rel=0.25)
    size = (tmp_path / "unit.fmu").stat().st_size
    assert result.summary()["size_kB"] == pytest.approx(1e-3 * size)
    assert 0.0 < result.wall_time < 600.0
    ts.export_fmu(PUMP, tmp_path / "unit.fmu", binary=False)
    assert samples.count == 6 + 20


def test_numbers_of_a_unit_are_those_of_its_tables(samples: Samples, tmp_path: Path) -> None:
    """Teeth that differ by a twentieth of their ripple count as one, which is told."""
    samples.uneven = 0.05
    summary = ts.export_fmu(PUMP, tmp_path / "unit.fmu", **GRID, binary=False).summary()
    assert summary["ripple_left_out_percent"] == pytest.approx(5.0, rel=0.01)
    assert summary["ripple_period_deg"] == pytest.approx(30.0)
    assert summary["ripple_samples"] == STEPS / 12
    volume = 2e6 * math.pi * DISPLACEMENT
    assert summary["displacement_cm3_per_rev"] == pytest.approx(volume)
    assert summary["energy_balance_error"] == 1e-7
    assert summary["binary"] == ""


@pytest.mark.parametrize(
    ("system", "folder"), [("linux", "linux"), ("win32", "win"), ("darwin", "darwin")]
)
def test_binaries_are_in_the_folder_of_their_platform(
    monkeypatch: pytest.MonkeyPatch, system: str, folder: str
) -> None:
    monkeypatch.setattr("sys.platform", system)
    assert archive.platform_folder()[0] == f"{folder}{8 * struct.calcsize('P')}"


def test_failed_points_end_without_a_unit_and_are_made_up_for(
    samples: Samples, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "unit.fmu"
    samples.fails = lambda difference: difference > 150e5
    assert main(["fmu", str(PUMP), "-o", str(path), *COMMAND, "--json"]) == 3
    told = capsys.readouterr()
    assert json.loads(told.out)["points_failed"] == 2
    assert "At 500 rpm and 200 bar: The run reached its last revolution" in told.err
    assert not path.exists()
    samples.fails = lambda _: False
    assert main(["fmu", str(PUMP), "-o", str(path), *COMMAND]) == 0
    assert samples.count == 4 + 2
    assert "At 500 rpm and 50 bar: Warned of." in capsys.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ["unit.fmu"]


def test_without_a_compiler_the_sources_remain(
    samples: Samples,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "unit.fmu"
    monkeypatch.setattr(export, "found_compiler", lambda: None)
    assert main(["fmu", str(PUMP), "-o", str(path), *COMMAND]) == 0
    assert "sources alone: importers compile them" in capsys.readouterr().err
    for broken in ("false", "no_such_compiler"):
        monkeypatch.setattr(export, "found_compiler", lambda broken=broken: broken)
        assert main(["fmu", str(PUMP), "-o", str(path), *COMMAND, "--force"]) == 2
        assert f"compiler: found '{broken}'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--pressure", "50 bar"], "pressure_difference: found 50 bar, allowed at least two"),
        (["--speed", "9 rpm", "--speed", "9 rpm"], "shaft_speed: found 9 rpm, 9 rpm, allowed"),
        (["--pressure", "0 bar"], "--pressure: found '0 bar', allowed above zero"),
        (["--speed", "9 bar"], "--speed: found '9 bar'"),
        (["--drive", "belt"], "drive: found 'belt', allowed 'speed' or 'torque'"),
        (["--set", "run.fidelity=ideal"], "found the fidelity 'ideal', allowed"),
    ],
)
def test_bad_input_is_one_message(
    samples: Samples,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    message: str,
) -> None:
    assert main(["fmu", str(PUMP), "-o", str(tmp_path / "unit.fmu"), *words]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert len(told.splitlines()) == 1
    assert samples.count == 0
    assert not list(tmp_path.iterdir())


def test_a_case_without_an_operating_point_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ts.CaseError, match=r"found no \[operating_point\], allowed"):
        ts.export_fmu("startup_fan_drive", tmp_path / "unit.fmu")


def test_ripple_is_that_of_the_run_at_its_angles(monkeypatch: pytest.MonkeyPatch) -> None:
    """A known wave over a revolution that begins anywhere, at the angles of the shaft from zero."""
    whole = fake_solution(360)
    angle = whole.data["shaft_angle"] + 1.3
    wave = 1e-4 + 3e-6 * np.sin(5.0 * angle + 0.4)
    data = whole.data.assign(outlet_flow_rate=wave).assign_coords(shaft_angle=angle)
    monkeypatch.setattr(ts.api, "simulate", lambda _: replace(whole, data=data))
    found = ShaftSamples()(load_case(PUMP))
    ripple = np.array(found["outlet_flow_rate_ripple"])
    at = np.arange(360) * (2.0 * np.pi / 360)
    np.testing.assert_allclose(ripple, 3e-6 * np.sin(5.0 * at + 0.4), atol=1e-8)
    known = whole.summary()
    assert found["hydraulic_power"] == pytest.approx(known["hydraulic_power_W"])
    assert found["power_loss"] == pytest.approx(known["power_loss_W"])
    assert 6e4 * found["inlet_flow_rate"] == pytest.approx(known["mean_flow_L_per_min"])
    mass = found["inlet_flow_rate"] * 870.0
    assert found["outlet_flow_rate"] * 860.0 == pytest.approx(mass)


@pytest.mark.parametrize(("case", "pitches"), [("egm12_motor", 12), ("gerotor_trochoidal", 6)])
def test_tables_reach_up_to_the_operating_point_over_one_pitch_of_the_shaft(
    case: str,
    pitches: int,
    samples: Samples,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A shaft of six inner lobes meets the same state six times, whatever its pockets."""
    given: list[Any] = []

    def tables(_: Any, pressures: list[float], speeds: list[float], teeth: int) -> None:
        given[:] = [max(pressures), max(speeds), teeth]
        raise InterruptedError

    monkeypatch.setattr(export, "tables_of", tables)
    with pytest.raises(InterruptedError):
        ts.export_fmu(case, tmp_path / "unit.fmu")
    at = load_case(case).operating_point
    assert at is not None
    difference = abs(at.outlet_pressure - at.inlet_pressure)
    assert given == [pytest.approx(difference), pytest.approx(at.shaft_speed), pitches]


def test_teeth_that_differ_are_tabulated_one_by_one() -> None:
    angle = np.arange(STEPS) * (2.0 * np.pi / STEPS)
    even, numbers = np.sin(12.0 * angle), machine(1.0, 1.0, 1.0) | {"displacement": DISPLACEMENT}

    def period(ripple: Array) -> tuple[float, float]:
        found = numbers | {f"{name}_ripple": ripple.tolist() for name in PULSATING}
        tables = tables_of([Record("", "done", found)] * 4, [1.0, 2.0], [1.0, 2.0], 12)
        count = STEPS // (12 if float(tables["period"]) < 1.0 else 1)
        assert tables.sizes["shaft_angle"] == count
        angles = np.arange(count) * float(tables["period"]) / count
        np.testing.assert_allclose(tables["shaft_angle"], angles, atol=1e-12)
        wave = tables[f"{PULSATING[0]}_ripple"].values[0, 0]
        np.testing.assert_allclose(wave, even[:count] if count < STEPS else ripple, atol=1e-12)
        return float(tables["period"]), float(tables["ripple_left_out"])

    assert period(even) == pytest.approx((math.pi / 6.0, 0.0), abs=1e-12)
    uneven = 0.05 * np.sin(angle)
    assert period(even + uneven)[0] == pytest.approx(math.pi / 6.0)
    assert period(even + uneven)[1] == pytest.approx(0.05, rel=1e-2)
    assert period(even + 4.0 * uneven) == pytest.approx((2.0 * math.pi, 0.0))


def test_fmpy_finds_no_fault_and_runs_it(samples: Samples, host: Path, tmp_path: Path) -> None:
    fmpy = pytest.importorskip("fmpy")
    validation = pytest.importorskip("fmpy.validation")
    for drive in export.DRIVES:
        unit(tmp_path, host, MOTOR, drive=drive)
        path = str(tmp_path / "unit.fmu")
        assert validation.validate_fmu(path) == []
        found = fmpy.simulate_fmu(path, stop_time=1e-2, start_values={"ripple": False})
        assert np.all(np.isfinite(found["inlet_flow_rate"]))
        assert np.ptp(found["inlet_flow_rate"]) < 1e-12 or drive == "torque"


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_inputs_start_at_the_highest_pressures_and_speed_of_the_tables(mode: str) -> None:
    """The high pressure stands at the outlet of a pump and at the inlet of a motor."""
    tables = xr.Dataset(
        {"low_pressure": 2e5},
        coords={"pressure_difference": [1e6, 3e7], "shaft_speed": [50.0, 150.0]},
        attrs={"mode": mode, "drain": "external"},
    )
    found = {v.name: v for v in archive.fmu_variables(tables, free_shaft=False)}
    pressures = (2e5, 2e5 + 3e7) if mode == "pump" else (2e5 + 3e7, 2e5)
    starts = tuple(found[f"{port}_pressure"].start for port in ("inlet", "outlet"))
    assert starts == pytest.approx(pressures)
    assert found["shaft_speed"].start == 150.0
    assert found["shaft_speed"].causality == "input"


@pytest.mark.parametrize(
    ("si", "shown", "one"),
    [
        ("Pa", "bar", 1e5),
        ("m3/s", "L/min", 1e-3 / 60.0),
        ("rad/s", "rpm", 2.0 * math.pi / 60.0),
        ("rad", "deg", 2.0 * math.pi / 360.0),
        ("m", "um", 1e-6),
    ],
)
def test_one_of_a_unit_for_display_is_so_many_si_units(si: str, shown: str, one: float) -> None:
    _, factors = archive.UNITS[si]
    assert factors[shown] * one == pytest.approx(1.0)
    assert archive.unit_attributes(si) == {"unit": si, "displayUnit": shown}


def test_a_free_shaft_starts_at_rest_with_an_inertia() -> None:
    """Of a thousandth of a kg m2, as a whole machine has: none would be refused."""
    tables = xr.Dataset(
        {"low_pressure": 2e5},
        coords={"pressure_difference": [1e6, 3e7], "shaft_speed": [50.0, 150.0]},
        attrs={"mode": "motor", "drain": "external"},
    )
    found = {v.name: v for v in archive.fmu_variables(tables, free_shaft=True)}
    starts = {name: found[name].start for name in found if found[name].causality == "parameter"}
    assert starts == {"shaft_angle_start": 0.0, "shaft_inertia": 1e-3, "shaft_speed_start": 0.0}
    assert found["shaft_speed"].causality == "output"
    assert found["load_torque"].causality == "input"
