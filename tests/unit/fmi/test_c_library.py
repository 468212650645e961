"""The whole machine as a C library: numbers of the march in Python, copies, states, refusals."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.core.compilation.library import FOLDER, LIBRARY, Way, chosen
from toothspace.core.errors import CaseError
from toothspace.fmi.machine_file import machine_file
from toothspace.model import arrays as col
from toothspace.model.assembly import assemble, node_places
from toothspace.run.run import warmed_through
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

REPOSITORY = Path(__file__).resolve().parents[3]
CASE = REPOSITORY / "cases" / "gerotor_trochoidal.toml"
PUMP = REPOSITORY / "cases" / "egm12_pump.toml"
STEP = 1e-4

pytestmark = pytest.mark.skipif(chosen()[0] != Way.LIBRARY, reason=chosen()[1])


class Machine:
    """A machine of the C library; ``library`` is a ctypes library."""

    def __init__(self, library: ctypes.CDLL, handle: int) -> None:
        self.library, self.handle = library, ctypes.c_void_p(handle)

    def number(self, name: str) -> int:
        return int(self.library.toothspace_find(self.handle, name.encode()))

    def get(self, name: str) -> float:
        return float(self.library.toothspace_get(self.handle, self.number(name)))

    def set(self, name: str, value: float) -> int:
        given = ctypes.c_double(value)
        return int(self.library.toothspace_set(self.handle, self.number(name), given))

    def step(self, end: float) -> int:
        return int(self.library.toothspace_step(self.handle, ctypes.c_double(end)))

    def names(self) -> list[str]:
        count = self.library.toothspace_variables(self.handle)
        return [self.library.toothspace_name(self.handle, k).decode() for k in range(count)]


@pytest.fixture(scope="module")
def library() -> ctypes.CDLL:
    found = ctypes.CDLL(str(FOLDER / LIBRARY))
    found.toothspace_create.restype = ctypes.c_void_p
    found.toothspace_copy.restype = ctypes.c_void_p
    found.toothspace_get.restype = ctypes.c_double
    found.toothspace_time.restype = ctypes.c_double
    found.toothspace_name.restype = ctypes.c_char_p
    found.toothspace_state_size.restype = ctypes.c_size_t
    return found


def created(library: ctypes.CDLL, path: Path) -> Machine:
    message = ctypes.create_string_buffer(300)
    handle = library.toothspace_create(str(path).encode(), message, ctypes.c_size_t(300))
    assert handle, message.value
    return Machine(library, handle)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("machine") / "gerotor.machine"
    path.write_bytes(machine_file(api.load_case(CASE)).content)
    return path


@pytest.fixture
def machine(library: ctypes.CDLL, file: Path) -> Iterator[Machine]:
    found = created(library, file)
    yield found
    library.toothspace_destroy(found.handle)


def test_pressures_are_those_of_the_march_in_python(machine: Machine) -> None:
    run = warmed_through(api.prepare(api.load_case(CASE)).worn().with_films())
    condition = replace(run.condition, load_area=0.0, circuit=None)
    system = assemble(run.machine, run.fluid, condition)
    times = STEP * np.arange(1, 41)
    march = start_march(system, start_state(system))
    states = np.vstack([march.advance(times[k : k + 1]).states for k in range(times.size)])
    scale = max(condition.inlet_pressure, condition.outlet_pressure)
    from toothspace.solver.compiled_model import observe

    expected = observe(system.arrays, states)
    labels = run.machine.chamber_labels
    for k, time in enumerate(times):
        assert machine.step(time) == 0
        found = [machine.get(f"chamber_pressure[{label}]") for label in labels]
        np.testing.assert_allclose(found, expected.pressure[k, : len(labels)], atol=1e-6 * scale)
        assert machine.get("shaft_angle") == pytest.approx(states[k, 0], rel=1e-9)
    torque = expected.torque[-1, -1] * (-1.0 if run.machine.mode == "motor" else 1.0)
    assert machine.get("shaft_torque") == pytest.approx(torque, rel=1e-6)
    node = node_places(run.machine, condition)["outlet"]
    mass = np.diff(states[:, system.arrays.balance[node, 0]])[-1]
    density = system.arrays.node[node, col.DENSITY]
    assert machine.get("outlet_flow_rate") == pytest.approx(mass / STEP / density, rel=1e-5)


def test_a_higher_outlet_pressure_needs_more_torque(machine: Machine) -> None:
    assert machine.step(4e-3) == 0
    before = machine.get("shaft_torque")
    pressure = machine.get("outlet_pressure")
    assert machine.set("outlet_pressure", 1.5 * pressure) == 0
    assert machine.step(8e-3) == 0
    assert machine.get("outlet_pressure") == 1.5 * pressure
    assert machine.get("shaft_torque") > 1.2 * before


def test_the_shaft_follows_its_speed(machine: Machine) -> None:
    speed = machine.get("shaft_speed")
    assert machine.set("shaft_speed", 0.8 * speed) == 0
    assert machine.step(1e-3) == 0
    assert machine.step(2e-3) == 0
    # from the speed at the start to the new one over the first step, then at that
    assert machine.get("shaft_angle") == pytest.approx((0.9 + 0.8) * speed * 1e-3, rel=1e-3)


def test_a_copy_and_a_saved_state_go_on_alike(library: ctypes.CDLL, machine: Machine) -> None:
    assert machine.step(1e-3) == 0
    copy = Machine(library, library.toothspace_copy(machine.handle))
    kept = ctypes.create_string_buffer(library.toothspace_state_size(machine.handle))
    library.toothspace_save(machine.handle, kept)
    ends = []
    for one in (machine, copy):
        assert one.step(2e-3) == 0
        ends.append([one.get(name) for name in one.names()])
    library.toothspace_restore(machine.handle, kept)
    assert library.toothspace_time(machine.handle) == 1e-3
    assert machine.step(2e-3) == 0
    assert ends[0] == ends[1] == [machine.get(name) for name in machine.names()]
    library.toothspace_destroy(copy.handle)


@pytest.mark.slow
def test_a_motor_starts_from_rest_when_its_load_lets_it(
    library: ctypes.CDLL, tmp_path: Path
) -> None:
    path = tmp_path / "motor.machine"
    case = api.load_case(REPOSITORY / "cases" / "egm12_motor.toml")
    path.write_bytes(machine_file(case, drive="torque").content)
    motor = created(library, path)
    assert motor.get("shaft_speed") == 0.0
    motor.set("load_torque", 40.0)
    assert motor.step(5e-3) == 0
    held = motor.get("shaft_speed")
    motor.set("load_torque", 5.0)
    assert motor.step(1e-2) == 0
    assert motor.get("shaft_speed") > held + 1.0
    library.toothspace_destroy(motor.handle)


def test_what_cannot_be_is_refused(library: ctypes.CDLL, machine: Machine, tmp_path: Path) -> None:
    assert machine.set("shaft_torque", 1.0) == -1
    assert machine.set("outlet_pressure", np.nan) == -1
    assert machine.number("nothing") == -1
    assert machine.step(0.0) == 5
    message = ctypes.create_string_buffer(300)
    for content, why in ((b"", "no file that can be read"), (b"x" * 500, "no file of a machine")):
        path = tmp_path / "wrong"
        path.write_bytes(content)
        size = ctypes.c_size_t(300)
        assert not library.toothspace_create(str(path).encode(), message, size)
        assert why in message.value.decode()
    with pytest.raises(CaseError, match="--drive: found 'wind', allowed 'speed' or 'torque'"):
        machine_file(api.load_case(CASE), drive="wind")


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_example_compiles_and_runs(file: Path, tmp_path: Path) -> None:
    source = REPOSITORY / "native" / "c" / "example.c"
    program = tmp_path / "example"
    flags = [f"-I{FOLDER}", f"-L{FOLDER}", f"-Wl,-rpath,{FOLDER}", "-ltoothspace"]
    subprocess.run(["cc", "-Wall", "-Werror", str(source), *flags, "-o", str(program)], check=True)
    done = subprocess.run([program, file], capture_output=True, text=True, check=True)
    assert len(done.stdout.splitlines()) == 40
    refused = subprocess.run([program, "nowhere"], capture_output=True, text=True, check=False)
    assert refused.returncode == 2
    assert "nowhere: found no file that can be read" in refused.stderr
