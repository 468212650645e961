"""The whole machine as a C library: numbers of the march in Python, copies, states, refusals."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.density import mixture_density
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compilation.library import FOLDER, LIBRARY, Way, chosen
from toothspace.core.errors import CaseError
from toothspace.fmi.machine_file import MachineVariable, machine_file
from toothspace.model import arrays as col
from toothspace.model.assembly import assemble, node_places
from toothspace.run.run import warmed_through
from toothspace.solver.compiled_model import observe
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

REPOSITORY = Path(__file__).resolve().parents[3]
CASE = REPOSITORY / "cases" / "gerotor_trochoidal.toml"
PUMP = REPOSITORY / "cases" / "egm12_pump.toml"
STEP = 1e-4
DRAINED = ("machine.drain=external", 'machine.drain_pressure="1.5 bar"')
MOTOR = (
    "machine.mode=motor",
    'operating_point.inlet_pressure="21 bar"',
    'operating_point.outlet_pressure="1 bar"',
    "operating_point.outlet_load=fixed_pressure",
)

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


def made_of(
    library: ctypes.CDLL, folder: Path, *overrides: str, **options: Any
) -> tuple[Machine, dict[str, MachineVariable]]:
    """A machine of the library, and the variables of its file by their names."""
    path = folder / "made.machine"
    found = machine_file(api.load_case(CASE, overrides), **options)
    path.write_bytes(found.content)
    return created(library, path), {one.name: one for one in found.variables}


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


@pytest.mark.parametrize("overrides", [(), MOTOR], ids=["pump", "motor"])
def test_pressures_are_those_of_the_march_in_python(
    library: ctypes.CDLL, tmp_path: Path, overrides: tuple[str, ...]
) -> None:
    machine, _ = made_of(library, tmp_path, *overrides)
    run = warmed_through(api.prepare(api.load_case(CASE, overrides)).worn().with_films())
    condition = replace(run.condition, load_area=0.0, circuit=None)
    system = assemble(run.machine, run.fluid, condition)
    times = STEP * np.arange(1, 41)
    march = start_march(system, start_state(system))
    states = np.vstack([march.advance(times[k : k + 1]).states for k in range(times.size)])
    scale = max(condition.inlet_pressure, condition.outlet_pressure)
    expected = observe(system.arrays, states)
    labels = run.machine.chamber_labels
    for k, time in enumerate(times):
        assert machine.step(time) == 0
        found = [machine.get(f"chamber_pressure[{label}]") for label in labels]
        np.testing.assert_allclose(found, expected.pressure[k, : len(labels)], atol=1e-6 * scale)
        assert machine.get("shaft_angle") == pytest.approx(states[k, 0], rel=1e-9)
    torque = expected.torque[-1, -1] * (-1.0 if run.machine.mode == "motor" else 1.0)
    assert machine.get("shaft_torque") == pytest.approx(torque, rel=1e-6)
    assert torque > 0.0
    node = node_places(run.machine, condition)["outlet"]
    mass = np.diff(states[:, system.arrays.balance[node, 0]])[-1]
    density = system.arrays.node[node, col.DENSITY]
    assert machine.get("outlet_flow_rate") == pytest.approx(mass / STEP / density, rel=1e-5)
    places = states[-1, system.arrays.size.position :]
    for k, motion in enumerate(system.free_motions):
        moved = run.machine.motions[motion]
        place = machine.get(f"position[{moved.body} {moved.axis}]")
        assert place == pytest.approx(places[k], rel=1e-6, abs=1e-12)
    library.toothspace_destroy(machine.handle)


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


@pytest.mark.parametrize("drive", ["speed", "torque"])
def test_variables_stand_where_the_library_finds_their_start(
    library: ctypes.CDLL, tmp_path: Path, drive: str
) -> None:
    """Inputs first; pressures, speeds and inertia as given, angle and flows from zero."""
    machine, known = made_of(library, tmp_path, *DRAINED, drive=drive)
    at = api.load_case(CASE).operating_point
    assert at is not None
    expected = {
        "inlet_pressure": at.inlet_pressure,
        "outlet_pressure": at.outlet_pressure,
        "drain_pressure": 1.5e5,
        "shaft_speed": at.shaft_speed if drive == "speed" else 0.0,
        "shaft_angle": 0.0,
        "inlet_flow_rate": 0.0,
        "outlet_flow_rate": 0.0,
        "drain_flow_rate": 0.0,
    }
    if drive == "torque":
        expected |= {"load_torque": 0.0, "shaft_inertia": 1e-3}
    for name, value in expected.items():
        assert known[name].start == pytest.approx(value, rel=1e-9), name
        assert machine.get(name) == pytest.approx(value, rel=1e-9), name
    inputs = [one.is_input for one in known.values()]
    assert inputs == sorted(inputs, reverse=True)
    assert machine.library.toothspace_inputs(machine.handle) == sum(inputs)
    assert machine.names() == list(known)
    pressures = [machine.get(name) for name in known if name.startswith("chamber_pressure")]
    assert min(pressures) > 0.5 * at.inlet_pressure
    assert max(pressures) < 1.5 * at.outlet_pressure
    library.toothspace_destroy(machine.handle)


def density_at(machine: Machine, port: str, fluid: FluidLaw) -> float:
    pressure = machine.get(f"{port}_pressure")
    return float(mixture_density(pressure, fluid.feed_gas_mass_fraction, fluid))


def mass_flow(machine: Machine, port: str, fluid: FluidLaw) -> float:
    """Mean mass flow through a port over the last step, at its pressure. [kg/s]."""
    return machine.get(f"{port}_flow_rate") * density_at(machine, port, fluid)


def test_flows_of_all_ports_are_those_of_the_mass(library: ctypes.CDLL, tmp_path: Path) -> None:
    """What enters in a turn leaves through outlet and drain: nothing gathers in a machine."""
    overrides = (*DRAINED, 'machine.lateral.side_gap="80 um"')
    machine, _ = made_of(library, tmp_path, *overrides)
    turn = 2.0 * np.pi / machine.get("shaft_speed")
    assert machine.step(turn) == machine.step(2.0 * turn) == 0
    fluid = api.prepare(api.load_case(CASE, overrides)).fluid
    inlet, outlet, drain = (
        mass_flow(machine, port, fluid) for port in ("inlet", "outlet", "drain")
    )
    assert min(outlet, drain) > 0.0
    assert inlet - outlet == pytest.approx(drain, rel=0.02)
    library.toothspace_destroy(machine.handle)


def test_the_inertia_of_a_shaft_is_without_that_of_the_bodies(
    library: ctypes.CDLL, tmp_path: Path
) -> None:
    """The rotor round the other turns freely in its play, so that it is none of the shaft's."""
    machine, known = made_of(library, tmp_path, drive="torque")
    inner, _ = api.describe(api.load_case(CASE)).bodies
    assert inner.speed_ratio == 1.0
    assert known["shaft_inertia"].factor == pytest.approx(inner.inertia, rel=1e-9)
    library.toothspace_destroy(machine.handle)


@pytest.mark.parametrize(("port", "sign"), [("inlet", 1.0), ("outlet", -1.0)])
def test_a_flow_that_is_given_is_what_passes_its_port(
    library: ctypes.CDLL, tmp_path: Path, port: str, sign: float
) -> None:
    """What the other port passes beside it in a turn gathers in the volume of the port."""
    machine, known = made_of(library, tmp_path, flows=(port,))
    run = api.prepare(api.load_case(CASE))
    displaced = run.machine.displacement * machine.get("shaft_speed")
    assert known[f"{port}_flow_rate"].start == pytest.approx(displaced, rel=1e-9)
    turn, masses = 2.0 * np.pi / machine.get("shaft_speed"), []
    volume = run.machine.port_volumes[0 if port == "inlet" else 1]
    for end in (turn, 2.0 * turn):
        assert machine.set(f"{port}_flow_rate", 0.95 * displaced) == 0
        assert machine.step(end) == 0
        density = density_at(machine, port, run.fluid)
        masses.append(volume * density)
    other = mass_flow(machine, "inlet" if port == "outlet" else "outlet", run.fluid)
    given = 0.95 * displaced * density
    assert given - sign * (masses[1] - masses[0]) / turn == pytest.approx(other, rel=0.01)
    library.toothspace_destroy(machine.handle)


def test_a_step_ends_when_the_shaft_stops(library: ctypes.CDLL, tmp_path: Path) -> None:
    """A load that grows stops a motor which runs, within the step; the library says when."""
    motor, _ = made_of(library, tmp_path, *MOTOR, drive="torque")
    assert motor.step(5e-3) == 0
    assert motor.get("shaft_speed") > 1.0
    motor.set("load_torque", 30.0)
    motor.set("inlet_pressure", 1.2e5)
    begun = library.toothspace_time(motor.handle)
    assert library.toothspace_step_to_event(motor.handle, ctypes.c_double(0.1)) == 1
    assert motor.get("shaft_speed") == 0.0
    assert begun < library.toothspace_time(motor.handle) < begun + 5e-3
    library.toothspace_destroy(motor.handle)
