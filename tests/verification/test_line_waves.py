"""Lines with waves against the exact impedance of a compliant lossy line; elastic coupling."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt
import pytest
from scipy.special import jv

from tests.conftest import REPOSITORY
from tests.iteration_matrices import jacobian_of
from toothspace import api
from toothspace.case import Case
from toothspace.circuit.circuit import build_circuit
from toothspace.closures.density import liquid_bulk_modulus
from toothspace.closures.line_friction import memory_branches, memory_transform, turbulent_growth
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.errors import CaseError
from toothspace.model.arrays import DENSITY, PRESSURE_BY_MASS
from toothspace.model.assembly import System, assemble, node_places
from toothspace.results.solution import Solution
from toothspace.run.condition import condition_of
from toothspace.solver.initial import start_state
from toothspace.solver.transient import TimePlan, TransientMarch, transient_solution

MOTOR = (REPOSITORY / "cases" / "startup_fan_drive.toml").read_text(encoding="utf-8")
LENGTH, BORE, MODULUS, PRESSURE = 2.5, 0.008, 0.6e9, 20e5
ComplexArray = npt.NDArray[np.complex128]

LINE = """
[circuit]
duration = "{duration} s"
initial_pressure = "20 bar"
connections = [["machine.inlet", "near"], ["near", "line"], ["line", "far"],
    ["machine.outlet", "low"]]
[circuit.near]
kind = "volume"
volume = "100 cm^3"
[circuit.far]
kind = "volume"
volume = "100 cm^3"
[circuit.low]
kind = "tank"
pressure = "20 bar"
[circuit.line]
kind = "hose"
model = "transmission_line"
length = "2.5 m"
bore = "8 mm"
effective_bulk_modulus = "0.6 GPa"
cells = {cells}
[circuit.spin]
kind = "speed_source"
speed = [["0 s", "60 rpm"]]
"""


def line_system(cells: int) -> System:
    text = MOTOR.split("[circuit]")[0] + LINE.format(duration=0.01, cells=cells)
    case = Case.from_toml(text)
    description, fluid = api.describe(case), api.fluid_of(case)
    return assemble(description, fluid, condition_of(case, description, fluid))


def solved_admittance(system: System, cells: int, frequencies: npt.ArrayLike) -> ComplexArray:
    """Flows into the line per pressure at its near end, the far one held, from the Jacobian."""
    arrays, size = system.arrays, system.arrays.size
    state = start_state(system)
    matrix = jacobian_of(system, state)
    places = node_places(system.description, system.condition)
    dynamic = {name: int(arrays.dynamic_index[k]) for name, k in places.items()}
    inner = [dynamic[f"line:{k}"] for k in range(1, cells)]
    rows = [*(size.mass + d for d in inner), *range(size.column, size.load)]
    near, far = places["inlet"], places["far"]
    end = size.mass + dynamic["inlet"]
    drive = matrix[rows, end] / arrays.node[near, PRESSURE_BY_MASS]
    block = matrix[np.ix_(rows, rows)]
    flow = [rows.index(size.column), rows.index(size.load - branches(system) - 1)]
    assert far != near
    found = []
    for w in np.atleast_1d(frequencies):
        x = np.linalg.solve(1j * w * np.eye(len(rows)) - block, drive)
        found.append(x[flow])
    return np.array(found)


def branches(system: System) -> int:
    circuit = system.condition.circuit
    assert circuit is not None
    return len(circuit.elements[-1].table)


def exact_admittance(system: System, cells: int, frequencies: npt.ArrayLike) -> ComplexArray:
    """Flows of the exact line, less what the half cell at the near end stores."""
    fluid = system.arrays.fluid
    density = float(system.arrays.node[system.description.inlet_node, DENSITY])
    kinematic = float(dynamic_viscosity(PRESSURE, fluid)) / density
    area, s = 0.25 * np.pi * BORE**2, 1j * np.atleast_1d(frequencies)
    capacity = area / modulus(system)
    root = 0.5j * BORE * np.sqrt(s / kinematic)
    series = density / area * s / (1.0 - 2.0 * jv(1, root) / (root * jv(0, root)))
    wave, impedance = np.sqrt(series * capacity * s) * LENGTH, np.sqrt(series / (capacity * s))
    half = 0.5 * capacity * LENGTH / cells * s
    near = 1.0 / (impedance * np.tanh(wave)) - half
    return np.column_stack([near, 1.0 / (impedance * np.sinh(wave))])


def modulus(system: System) -> float:
    """Effective modulus at the pressure of the run, where that of the liquid differs a little."""
    fluid = system.arrays.fluid
    liquid = [float(liquid_bulk_modulus(p, fluid)) for p in (20e5, PRESSURE)]
    return 1.0 / (1.0 / MODULUS - 1.0 / liquid[0] + 1.0 / liquid[1])


def test_admittance_is_that_of_the_exact_line() -> None:
    """Up to the second resonance, 168 and 336 Hz; second order in the cells."""
    frequencies = 2.0 * np.pi * np.array([3.0, 30.0, 90.0, 140.0, 200.0, 260.0])
    errors = []
    for cells in (16, 32):
        system = line_system(cells)
        found = solved_admittance(system, cells, frequencies)
        exact = exact_admittance(system, cells, frequencies)
        errors.append(np.linalg.norm(found - exact, axis=1) / np.linalg.norm(exact, axis=1))
    assert errors[1].max() < 0.02
    assert errors[0][2:].max() / errors[1][2:].max() > 3.0


@pytest.mark.parametrize("highest", [50.0, 1e3, 1e5])
def test_branches_give_the_exact_series_impedance(highest: float) -> None:
    """Low frequency: 4/3 of the inertance; all frequencies: the Bessel functions of Zielke."""
    rates, weights = memory_branches(highest).T
    assert np.all(weights > 0.0)
    s = 1j * np.geomspace(1e-2, highest, 300)
    root = 1j * np.sqrt(s)
    exact = s / (1.0 - 2.0 * jv(1, root) / (root * jv(0, root)))
    np.testing.assert_allclose(s + 8.0 + 4.0 * s * memory_transform(s), exact, rtol=1e-6)
    fitted = s + 8.0 + 4.0 * s * np.sum(weights / (s[:, None] + rates), axis=1)
    assert np.abs(fitted / exact - 1.0).max() < 0.006
    assert 1.0 + 4.0 * np.sum(weights / rates) == pytest.approx(4.0 / 3.0, abs=0.01)


def test_turbulent_friction_is_smooth_and_follows_blasius() -> None:
    assert turbulent_growth(0.5) == (1.0, 0.0)
    reynolds = 1e4
    found, _ = turbulent_growth(reynolds / 2300.0)
    assert found == pytest.approx(0.3164 * reynolds**-0.25 / (64.0 / reynolds), rel=1e-12)
    for ratio in (0.869, 0.9, 1.3, 1.73, 1.75, 3.0):
        slope = (turbulent_growth(ratio + 1e-6)[0] - turbulent_growth(ratio - 1e-6)[0]) / 2e-6
        assert turbulent_growth(ratio)[1] == pytest.approx(slope, abs=2e-5)


@pytest.mark.parametrize("reynolds", [2000.0, 4000.0])
def test_friction_of_both_regimes_meets_that_of_the_transition(reynolds: float) -> None:
    below, above = (turbulent_growth(reynolds * f / 2300.0) for f in (1.0 - 1e-9, 1.0 + 1e-9))
    assert above == pytest.approx(below, rel=1e-6, abs=1e-6)


def test_friction_of_the_transition_by_hand() -> None:
    """At Re 2500 laminar and three quarters of the way to go: 1 + 5/32 (Blasius - 1)."""
    blasius = 0.3164 * 2500.0**-0.25 / (64.0 / 2500.0)
    growth, _ = turbulent_growth(2500.0 / 2300.0)
    assert growth == pytest.approx(1.0 + 5.0 / 32.0 * (blasius - 1.0), rel=1e-12)


@pytest.mark.parametrize("highest", [1e3, 1e5])
def test_weights_of_the_branches_fit_the_impedance_best(highest: float) -> None:
    """No weight may change: the squares of the relative error over all frequencies are least."""
    rates, weights = memory_branches(highest).T
    s = 1j * np.geomspace(0.1, highest, 200)
    exact = s + 8.0 + 4.0 * s * memory_transform(s)
    fitted = s + 8.0 + 4.0 * s * np.sum(weights / (s[:, None] + rates), axis=1)
    by_weight = 4.0 * (s / exact)[:, None] * weights / (s[:, None] + rates)
    slope = np.sum(by_weight.conj() * (fitted / exact - 1.0)[:, None], axis=0).real
    assert np.abs(slope / np.sum(np.abs(by_weight) ** 2, axis=0)).max() < 1e-6
    assert rates == pytest.approx(26.374616427163392 * 6.0 ** np.arange(rates.size), rel=1e-12)
    assert highest < rates[-1] < 36.0 * highest


def test_branches_reach_four_times_the_first_rate_at_least() -> None:
    least = memory_branches(4.0 * 26.374616427163392)
    np.testing.assert_array_equal(memory_branches(1.0), least)
    assert np.abs(memory_branches(4.05 * 26.374616427163392)[:, 1] / least[:, 1] - 1.0).max() > 1e-6


def run(text: str, *overrides: str) -> Solution:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "circuit.toml"
        path.write_text(text, encoding="utf-8")
        case = api.load_case(path, overrides)
    description, fluid = api.describe(case), api.fluid_of(case)
    system = assemble(description, fluid, condition_of(case, description, fluid))
    assert case.circuit is not None
    march = TransientMarch(system, TimePlan(case.circuit.duration, 1000))
    return transient_solution(march, {}, {}, "circuit")


QUICK = (
    'circuit.duration="1.2 s"',
    'circuit.supply.speed=[["0 s", "0 rpm"], ["0.5 s", "300 rpm"]]',
    "run.relative_tolerance=1e-7",
)


@pytest.mark.slow
def test_line_with_waves_starts_the_motor_as_a_lumped_one_does() -> None:
    """Breakaway is slow against the waves, so both lines give its pressure; ledgers close."""
    runs = [
        run(MOTOR, *QUICK, f'circuit.line.model="{m}"') for m in ("lumped", "transmission_line")
    ]
    found = [solution.summary() for solution in runs]
    for key in ("breakaway_pressure_bar", "breakaway_time_s"):
        assert found[1][key] == pytest.approx(found[0][key], rel=3e-3)
    assert runs[1].ledger.mass_balance_error < 1e-7
    assert runs[1].ledger.energy_balance_error < 1e-4


COUPLING = """
[circuit.coupling]
kind = "coupling"
stiffness = "{stiffness} N m/rad"
damping = "{damping} N m s/rad"
"""
PUSHED = (
    MOTOR.replace('linear = "0.0002 N m/rpm"\ncubic = "4e-7 N m s^3/rad^3"\n', "")
    + '\n[circuit.push]\nkind = "torque_source"\ntorque = [["0 s", "0.2 N m"]]\n'
)
"""A motor that 0.2 N m hold from beyond a fan without resistance."""


@pytest.mark.slow
def test_stiff_coupling_is_a_rigid_shaft() -> None:
    """Stiff and damped: friction that falls with speed would else make the light motor jerk."""
    rigid = run(MOTOR, *QUICK).summary()
    solution = run(MOTOR + COUPLING.format(stiffness=1e4, damping=2), *QUICK)
    stiff = solution.summary()
    for key in ("breakaway_pressure_bar", "startup_pressure_bar", "breakaway_time_s"):
        assert stiff[key] == pytest.approx(rigid[key], rel=5e-3)
    assert solution.ledger.energy_balance_error < 1e-4
    assert solution.ledger.energy["coupling"] > 0.0


def test_soft_coupling_lets_the_load_swing_at_its_own_frequency() -> None:
    """While the motor is held the fan swings against the coupling: w = sqrt(k/J)."""
    soft = COUPLING.format(stiffness=2, damping=0)
    data = run(PUSHED + soft, 'circuit.duration="0.6 s"', "run.relative_tolerance=1e-7").data
    assert np.all(data["shaft_angle"].values == 0.0)
    swing = np.sqrt(2.0 / 0.0035)
    expected = -0.2 / 0.0035 / swing * np.sin(swing * data["time"].values)
    np.testing.assert_allclose(data["load_speed"].values, expected, atol=0.02 * 2.4)


def test_a_coupling_turns_its_load() -> None:
    """J dw/dt = coupling torque - load torque, with the damping of the coupling in the first."""
    damped = COUPLING.format(stiffness=2, damping=0.02)
    short = 'circuit.duration="0.15 s"', "run.time_samples=200"
    data = run(PUSHED + damped, *short).data
    time, speed = data["time"].values, data["load_speed"].values
    turning = (data["coupling_torque"] - data["load_torque"]).values
    gained = 0.0035 * np.gradient(speed, time)
    np.testing.assert_allclose(gained[1:-1], turning[1:-1], atol=4e-3)
    assert np.abs(speed).max() == pytest.approx(0.2 / np.sqrt(2.0 * 0.0035), rel=0.2)


SOFT = COUPLING.format(stiffness=5, damping=0)
SPIN = '[circuit.spin]\nkind = "speed_source"\nspeed = [["0 s", "60 rpm"]]\n'


@pytest.mark.parametrize(
    ("more", "message"),
    [(SOFT + SOFT.replace("circuit.", "circuit.second_"), "two couplings"), (SPIN, "speed source")],
)
def test_impossible_couplings_are_refused(more: str, message: str) -> None:
    text = MOTOR + (more if "second" in more else SOFT + more)
    with pytest.raises(CaseError, match=message):
        solve_shaft(Case.from_toml(text))


def solve_shaft(case: Case) -> None:
    description, fluid = api.describe(case), api.fluid_of(case)
    assert case.circuit is not None
    build_circuit(case.circuit, description.port_volumes, fluid)
    condition_of(case, description, fluid)


@pytest.mark.slow
def test_quadratic_fan_is_the_other_reading_of_the_paper() -> None:
    """4e-7 N m/rpm^2 takes 0.4 N m at 1000 rpm."""
    text = MOTOR.replace('cubic = "4e-7 N m s^3/rad^3"', 'quadratic = "4e-7 N m/rpm^2"')
    case = Case.from_toml(text)
    fan = case.circuit.elements["load"]
    speed = 1000.0 * np.pi / 30.0
    assert fan.quadratic * speed**2 == pytest.approx(0.4, rel=1e-12)
    solution = run(text, *QUICK)
    data = solution.data
    at = int(np.argmax(data["shaft_speed"].values))
    speed = data["shaft_speed"].values[at]
    expected = fan.linear * speed + fan.quadratic * speed**2
    assert data["load_torque"].values[at] == pytest.approx(expected, rel=0.02)


SHARED_NAMES = """
[circuit]
duration = "1 s"
connections = [["suction", "machine.inlet"], ["machine.outlet", "line"], ["line", "first"],
    ["first", "drain"], ["drain", "second"], ["second", "suction"]]
[circuit.line]
kind = "hose"
model = "transmission_line"
length = "1 m"
bore = "8 mm"
effective_bulk_modulus = "0.6 GPa"
cells = 4
[circuit.first]
kind = "orifice"
area = "1 mm^2"
[circuit.drain]
kind = "volume"
volume = "20 cm^3"
[circuit.second]
kind = "orifice"
area = "1 mm^2"
[circuit.suction]
kind = "tank"
pressure = "1 bar"
[circuit.spin]
kind = "speed_source"
speed = [["0 s", "60 rpm"]]
"""


def test_every_node_has_a_name_of_its_own() -> None:
    """The far end of a line is none of its cells, a part called drain not the machine's drain."""
    case = Case.from_toml(MOTOR.split("[circuit]")[0] + SHARED_NAMES)
    assert case.circuit is not None
    description, fluid = api.describe(case), api.fluid_of(case)
    names = [
        node.name for node in build_circuit(case.circuit, description.port_volumes, fluid).nodes
    ]
    assert len(set(names)) == len(names)
    assert "drain" not in names
    system = assemble(description, fluid, condition_of(case, description, fluid))
    dynamic = system.arrays.dynamic_index
    assert sorted(dynamic[dynamic >= 0]) == list(range(system.arrays.size.dynamic))
