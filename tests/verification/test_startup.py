"""Start-up of a motor in its circuit: breakaway, rest, ledgers, circuit elements."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.conftest import REPOSITORY
from toothspace import api
from toothspace.case import Case
from toothspace.circuit.circuit import build_circuit
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.model.assembly import System, assemble
from toothspace.model.description import MachineDescription
from toothspace.results.solution import Solution
from toothspace.results.variables import CHANNELS
from toothspace.run.condition import condition_of
from toothspace.solver.transient import TimePlan, TransientMarch, transient_solution

CASE = REPOSITORY / "cases" / "startup_fan_drive.toml"
BAR = 1e5
BREAKAWAY_TORQUE = 1.0


def startup_case(*overrides: str) -> Case:
    return api.load_case(CASE, overrides)


@cache
def machine() -> MachineDescription:
    """The motor without its running-in, which only costs time here."""
    return api.describe(startup_case())


def system_of(case: Case) -> System:
    fluid = api.fluid_of(case)
    return assemble(machine(), fluid, condition_of(case, machine(), fluid))


def solve(case: Case, duration: float, cells: int = 100) -> Solution:
    march = TransientMarch(system_of(case), TimePlan(duration, cells))
    return transient_solution(march, {}, {}, "start")


def slow_supply(speed: str, *more: str) -> Case:
    """Supply of one speed without slip, which would keep a slow one from any pressure."""
    leakless = "circuit.supply.rated_point.volumetric_efficiency=1"
    return startup_case(f'circuit.supply.speed=[["0 s", "{speed}"]]', leakless, *more)


def test_a_rubber_wall_keeps_its_compliance_and_gives_a_part_of_it_late() -> None:
    """Standard linear solid: C/s at once, the rest in the relaxation time R C (1 - 1/s)."""

    def parts(*overrides: str) -> tuple[float, float, float]:
        case = startup_case(*overrides)
        circuit = build_circuit(case.circuit, machine().port_volumes, api.fluid_of(case))
        own = {node.name: node.wall_compliance for node in circuit.nodes}
        late = [e.law.linear for e in circuit.elements if e.node_b == "line:wall"]
        return own["inlet"], own.get("line:wall", 0.0), late[0] if late else 0.0

    rest, none, _ = parts()
    given = ("circuit.line.wall_stiffening=1.5", 'circuit.line.wall_relaxation_time="0.2 s"')
    quick, late, resistance = parts(*given)
    assert none == 0.0
    assert quick == pytest.approx(rest / 1.5, rel=1e-6, abs=0.0)
    assert quick + late == pytest.approx(rest, rel=1e-6, abs=0.0)
    assert resistance * late == pytest.approx(0.2)
    with pytest.raises(CaseError, match=r"wall_stiffening: found 1.5, allowed 1 with waves"):
        startup_case(given[0], "circuit.line.model=transmission_line")


def test_a_run_that_fails_within_its_first_row_keeps_the_start() -> None:
    limits = ("run.max_steps=100", "run.time_samples=10", 'circuit.duration="50 s"')
    solution = api.simulate(startup_case(*limits))
    assert solution.status is Status.MAX_STEPS
    assert solution.data["time"].values == pytest.approx([0.0], abs=1e-9)
    assert solution.data["chamber_pressure"].values == pytest.approx(1e5, rel=1e-3)
    assert solution.summary()["status"] == "max_steps"


def wide_values(*overrides: str) -> set[str]:
    data = api.simulate(startup_case('circuit.duration="0.05 s"', *overrides)).data
    assert {"pressure_difference_highest", "load_torque", "inlet_flow_rate"} <= set(data.data_vars)
    sampled = [name for name in data.data_vars if "time" in data[name].dims[:1]]
    return {str(name) for name in sampled if data[name].ndim > 1}


@pytest.mark.slow
def test_a_run_keeps_the_chosen_channels_only() -> None:
    """Values with one number in each row always stay; of the others only the chosen."""
    ends = ("_lowest", "_highest")
    assert {name for name in wide_values() if not name.endswith(ends)} == set(CHANNELS)
    found = wide_values('run.channels=["contact_force"]')
    assert found == {"contact_force", *(f"contact_force{end}" for end in ends)}
    assert not wide_values("run.channels=[]")


@pytest.mark.parametrize(
    "angle",
    [
        0.0,
        pytest.param(7.5, marks=pytest.mark.slow),
        15.0,
        pytest.param(22.5, marks=pytest.mark.slow),
    ],
)
def test_breakaway_pressure_is_torque_over_displacement(angle: float) -> None:
    """2 pi M/V_d = 12.7 bar in the mean, 12.06 to 14.18 bar over the start angle."""
    case = slow_supply("12 rpm", f'circuit.initial_shaft_angle="{angle} deg"')
    solution = solve(case, 2.0, 400)
    released = next(e.time for e in solution.events if e.kind == "shaft_released")
    time = solution.data["time"].values
    pressure = np.interp(released, time, solution.data["pressure_difference"].values)
    assert 12.0 * BAR < pressure < 14.3 * BAR
    before = time < released - 0.01
    assert np.all(solution.data["shaft_angle"].values[before] == np.radians(angle))


def test_shaft_below_breakaway_does_not_move_at_all() -> None:
    """1000 s against a relief valve at 10 bar, below the 12 bar that start the shaft."""
    case = slow_supply("50 rpm", 'circuit.relief.opening_pressure="10 bar"')
    solution = solve(case, 1000.0, 200)
    assert solution.status.succeeded
    assert solution.data["pressure_difference"].values[-1] > 9.0 * BAR
    assert np.all(solution.data["shaft_angle"].values == 0.0)
    assert np.all(solution.data["shaft_speed"].values == 0.0)
    assert np.isnan(solution.summary()["startup_pressure_bar"])


def short_cycle(tolerance: str) -> Solution:
    """Start, run and stop within 3 s."""
    speeds = '[["0 s", "0 rpm"], ["0.5 s", "200 rpm"], ["1 s", "200 rpm"], ["1.5 s", "0 rpm"]]'
    case = startup_case(f"circuit.supply.speed={speeds}", f"run.relative_tolerance={tolerance}")
    return solve(case, 3.0, 600)


@pytest.fixture(scope="module")
def cycle() -> Solution:
    """The short cycle at a fine tolerance."""
    return short_cycle("1e-7")


@pytest.mark.slow
def test_coarse_and_fine_tolerances_agree(cycle: Solution) -> None:
    """Ten times the tolerance changes no number by 0.1 %."""
    coarse, fine = short_cycle("1e-6").summary(), cycle.summary()
    for name in (
        "startup_pressure_bar",
        "breakaway_pressure_bar",
        "breakaway_time_s",
        "max_shaft_speed_rpm",
        "revolutions",
        "supply_energy_J",
        "shaft_energy_J",
        "loss_energy_J",
    ):
        assert coarse[name] == pytest.approx(fine[name], rel=1e-3), name


def test_ledgers_close_over_a_whole_cycle(cycle: Solution) -> None:
    assert cycle.ledger.mass_balance_error < 1e-7
    assert cycle.ledger.energy_balance_error < 1e-5


def test_shaft_starts_runs_and_rests(cycle: Solution) -> None:
    kinds = [e.kind for e in cycle.events if e.kind.startswith("shaft")]
    assert kinds[0] == "shaft_released"
    assert kinds[-1] == "shaft_stopped"
    assert cycle.data["shaft_speed"].values.max() > 15.0
    assert cycle.data["shaft_speed"].values[-1] == 0.0
    numbers = cycle.summary()
    assert 12.0 < numbers["startup_pressure_bar"] < 25.0
    assert 0.0 < numbers["breakaway_time_s"] < 0.5


def test_shaft_work_is_load_work(cycle: Solution) -> None:
    """From rest to rest the shaft does what the fan takes: linear and cubic part."""
    data = cycle.data
    power = data["load_torque"] * data["shaft_speed"]
    work = float(np.trapezoid(power.values, data["time"].values))
    assert -cycle.ledger.shaft_energy == pytest.approx(work, rel=5e-3)


def test_flow_of_the_motor_is_that_of_the_outlet(cycle: Solution) -> None:
    """Masses into inlet and out of outlet agree but for what the chambers keep."""
    data = cycle.data
    step = np.gradient(data["time"].values)
    volumes = [float(np.sum(data[f"{p}_flow_rate"].values * step)) for p in ("inlet", "outlet")]
    assert volumes[0] == pytest.approx(volumes[1], rel=0.01)


TWO_TANKS = """
[circuit]
duration = "0.05 s"
connections = {connections}
{elements}
[circuit.high]
kind = "tank"
pressure = "21 bar"
[circuit.low]
kind = "tank"
pressure = "1 bar"
[circuit.middle]
kind = "volume"
volume = "20 cm^3"
[circuit.spin]
kind = "speed_source"
speed = [["0 s", "600 rpm"]]
"""
PORTS = '["machine.inlet", "high"], ["machine.outlet", "low"]'


def between_tanks(elements: str, joints: str) -> Case:
    """The motor between two tanks at constant speed, with further elements beside it."""
    text = CASE.read_text(encoding="utf-8")
    head, tail = text[: text.index("[circuit]")], text[text.index("[run]") :]
    circuit = TWO_TANKS.format(connections=f"[{PORTS}, {joints}]", elements=elements)
    return Case.from_toml(head + circuit + tail)


IN_SERIES = '["high", "{a}"], ["{a}", "middle"], ["middle", "{b}"], ["{b}", "low"]'
ORIFICE = '[circuit.{name}]\nkind = "orifice"\narea = "{area} mm^2"\n'


def middle_pressure(solution: Solution) -> float:
    nodes = [str(n) for n in solution.data["node"].values]
    return float(solution.data["node_pressure"].values[-1, nodes.index("middle")])


def test_two_equal_orifices_halve_the_pressure() -> None:
    elements = ORIFICE.format(name="a", area=1) + ORIFICE.format(name="b", area=1)
    case = between_tanks(elements, IN_SERIES.format(a="a", b="b"))
    assert middle_pressure(solve(case, 0.05, 20)) == pytest.approx(11.0 * BAR, rel=5e-3)


def test_half_open_valve_passes_what_half_its_area_passes() -> None:
    valve = '[circuit.{}]\nkind = "proportional_valve"\narea = "{} mm^2"\n{}\n'
    half = valve.format("a", 2, 'opening = [["0 s", 0.5]]')
    full = valve.format("b", 1, 'opening = [["0 s", 1.0]]')
    case = between_tanks(half + full, IN_SERIES.format(a="a", b="b"))
    assert middle_pressure(solve(case, 0.05, 20)) == pytest.approx(11.0 * BAR, rel=5e-3)


def test_check_valve_lets_pass_in_one_direction() -> None:
    valve = '[circuit.a]\nkind = "check_valve"\ngradient = "0.1 bar s/L"\n'
    orifice = ORIFICE.format(name="b", area=1)
    forward = between_tanks(valve + orifice, IN_SERIES.format(a="a", b="b"))
    assert middle_pressure(solve(forward, 0.05, 20)) == pytest.approx(21.0 * BAR, rel=1e-2)
    backward = IN_SERIES.format(a="b", b="a").replace('["middle", "a"], ["a", "low"]', "{}")
    against = between_tanks(valve + orifice, backward.format('["low", "a"], ["a", "middle"]'))
    assert middle_pressure(solve(against, 0.05, 20)) == pytest.approx(21.0 * BAR, rel=1e-2)


def test_cooler_drops_its_rated_pressure() -> None:
    """Two coolers of one rating in series share the drop; each obeys its own law."""
    cooler = '[circuit.{}]\nkind = "cooler"\npressure_drop = "10 bar"\nflow_rate = "20 L/min"\n'
    elements = cooler.format("a") + cooler.format("b")
    solution = solve(between_tanks(elements, IN_SERIES.format(a="a", b="b")), 0.05, 20)
    assert middle_pressure(solution) == pytest.approx(11.0 * BAR, rel=5e-3)


def test_accumulator_keeps_gas_by_its_polytropic_law() -> None:
    """Charged through an orifice to 21 bar, it holds V (1 - (p0/p)^(1/n)) more fluid."""
    store = (
        '[circuit.store]\nkind = "accumulator"\ngas_volume = "10 cm^3"\n'
        'precharge = "5 bar"\ngas_exponent = 1.3\n'
    )
    joints = '["high", "a"], ["a", "middle"], ["middle", "store"]'
    case = between_tanks(ORIFICE.format(name="a", area=5) + store, joints)
    fluid = api.fluid_of(case)
    circuit = build_circuit(case.circuit, machine().port_volumes, fluid)
    solution = solve(case, 0.05, 50)
    assert solution.ledger.mass_balance_error < 1e-9
    assert middle_pressure(solution) == pytest.approx(21.0 * BAR, rel=1e-2)
    node = next(n for n in circuit.nodes if n.gas_volume > 0.0)
    assert node.volume == pytest.approx(30e-6)
    system = system_of(case)
    place = [n.name for n in circuit.nodes].index("middle")
    march = TransientMarch(system, TimePlan(0.05, 50))
    for _ in march.chunks():
        pass
    filled = np.isclose(system.arrays.node[:, 18], 10e-6)
    volume = system.arrays.node[filled, 0][0]
    pressure = system.arrays.node[filled, 2][0]
    assert place >= 0
    expected = 30e-6 + 10e-6 * (1.0 - (5e5 / pressure) ** (1.0 / 1.3))
    assert volume == pytest.approx(expected, rel=1e-9)


def test_prescribed_speed_follows_its_ramp() -> None:
    case = between_tanks("", '["middle", "low"]')
    element = replace(case.circuit.elements["spin"], speed=((0.0, 0.0), (0.02, 60.0), (0.05, 60.0)))
    ramp = replace(
        case, circuit=replace(case.circuit, elements=case.circuit.elements | {"spin": element})
    )
    data = solve(ramp, 0.05, 50).data
    expected = np.interp(data["time"].values, [0.0, 0.02, 0.05], [0.0, 60.0, 60.0])
    assert np.abs(data["shaft_speed"].values - expected).max() < 1.0
    assert data["shaft_speed"].values[-1] == pytest.approx(60.0, rel=1e-9)


SPARE = '[circuit.spare]\nkind = "tank"\npressure = "2 bar"\n'


@pytest.mark.parametrize(
    ("joints", "elements", "message"),
    [
        ('["middle", "high"], ["middle", "spare"]', SPARE, "two tanks joined"),
        ('["high", "a"]', ORIFICE.format(name="a", area=1), "one connection of 'a'"),
        ('["high", "a"], ["a", "b"], ["b", "low"]', "AB", "nothing that holds fluid"),
    ],
)
def test_impossible_circuits_are_refused(joints: str, elements: str, message: str) -> None:
    if elements == "AB":
        elements = "".join(ORIFICE.format(name=name, area=1) for name in "ab")
    joints = f'{joints}, ["middle", "low"]' if "middle" not in joints else joints
    case = between_tanks(elements, joints)
    with pytest.raises(CaseError, match=message):
        build_circuit(case.circuit, machine().port_volumes, api.fluid_of(case))


def test_example_states_its_supply() -> None:
    supply = tomllib.loads(CASE.read_text(encoding="utf-8"))["circuit"]["supply"]
    assert supply["speed"][3] == ["14 s", "300 rpm"]
