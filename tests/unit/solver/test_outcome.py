"""What a result holds of the states of a march: energies, flows, places and loads by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tests.toy_machine import (
    AMPLITUDE,
    CONDITION,
    COUNT,
    GAP,
    OIL,
    TURN,
    toy_machine,
    toy_system,
)  # fmt: skip
from toothspace import api
from toothspace.circuit.network import END_A, END_B
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.closures.density import mixture_density
from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble, node_places
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.lateral_table import FORCE_SHARE, HEIGHT_RATIO, LOAD_SCALE, MOMENT_SHARE
from toothspace.model.ledger import LEDGER_NAMES
from toothspace.model.path_category import CIRCUIT_ORIFICE, DRAIN, LATERAL, LOAD_ORIFICE
from toothspace.numerics.periodic_table import table_from_exact_slopes
from toothspace.results.solution import Solution
from toothspace.solver import lost_flow, outcome
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import History, RunPlan, march_revolutions
from toothspace.solver.initial import start_state

COARSE = {"relative_tolerance": 1e-4}
GASSY = fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08))
DRAG = 2e-3
"""Mean speed of the walls of the gaps between cylinders per shaft speed. [m/rad]"""


@pytest.fixture(scope="module")
def turned() -> History:
    """Second revolution of six cylinders, whose walls drag oil and which bleed into a drain."""
    toy, angle = toy_machine(), TURN * np.arange(720) / 720
    *ports, leak = toy.paths
    speed = DRAG * (1.0 + 0.5 * np.cos(angle))
    drag = table_from_exact_slopes(TURN, speed, -0.5 * DRAG * np.sin(angle))
    bleed = replace(leak, name="bleed", category=DRAIN, nodes_b=np.full(COUNT, COUNT + 2))
    paths = (*ports, replace(leak, drag_speed=drag), bleed)
    machine = replace(toy, paths=paths, drain="external")
    system = toy_system(machine, **COARSE)
    return march_revolutions(system, RunPlan(revolutions=2, samples_per_revolution=36))


@pytest.fixture(scope="module")
def solution(turned: History) -> Solution:
    return outcome.solution_from(turned, {}, {"fluid_temperature": 323.15}, "six cylinders")


def test_chambers_stand_at_their_phase_and_the_angle_of_the_shaft(solution: Solution) -> None:
    data = solution.data
    expected = data["shaft_angle"].values[:, None] + TURN * np.arange(COUNT) / COUNT
    found = data["chamber_angle"].values
    assert np.all((found >= 0.0) & (found < TURN))
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * expected), atol=1e-9)
    volume = data["chamber_volume"].values
    assert volume.max() - volume.min() == pytest.approx(2.0 * AMPLITUDE, rel=1e-3)


def test_leakage_of_the_gaps_by_hand(turned: History, solution: Solution) -> None:
    """What it loses in power, at the density of the inlet and over the difference of the ports."""
    seen = observe(turned.system.arrays, turned.states)
    leaks = [k for k, kind in enumerate(turned.system.categories) if kind == LATERAL]
    of_gaps = np.isin(turned.system.arrays.path_index[:, col.CATEGORY], leaks)
    pressure = seen.pressure[:, :COUNT]
    drop = pressure - np.roll(pressure, -1, axis=1)
    power = np.sum(seen.path_flow[:, of_gaps] * drop, axis=1)
    density = float(solution.data["inlet_density"])
    expected = power / density / 49e5
    found = solution.data["equivalent_leakage"].values[:, 0]
    assert found == pytest.approx(expected, rel=1e-3)
    bleeds = [k for k, kind in enumerate(turned.system.categories) if kind == DRAIN]
    bleeding = np.isin(turned.system.arrays.path_index[:, col.CATEGORY], bleeds)
    drained = seen.path_flow[:, bleeding].sum(axis=1) / density
    assert drained.min() > 1e-7
    assert solution.data["drain_flow_rate"].values == pytest.approx(drained)
    share = lost_flow.shares(lost_flow.look_at(turned))[:, :COUNT]
    falling = share - np.roll(share, -1, axis=1)
    leaking = np.sum(seen.path_flow[:, of_gaps] * falling, axis=1)
    found = solution.data["leakage"].values[:, 0]
    assert found == pytest.approx(leaking / density, rel=1e-3)


def test_walls_that_drag_oil_to_higher_pressure_take_torque(
    turned: History, solution: Solution
) -> None:
    """Width times height times speed times rise of pressure, of every gap."""
    pressure = solution.data["chamber_pressure"].values
    rise = np.roll(pressure, -1, axis=1) - pressure
    angle = solution.data["chamber_angle"].values
    speed = DRAG * (1.0 + 0.5 * np.cos(angle))
    expected = np.sum(10e-3 * GAP * speed * rise, axis=1)
    assert np.abs(expected).max() > 1e-4
    found = solution.data["drag_torque"].values[:, 0]
    np.testing.assert_allclose(found, expected, atol=2e-3 * np.abs(expected).max())


def test_a_revolution_keeps_mass_and_energy(turned: History, solution: Solution) -> None:
    """What enters at 1 bar leaves through outlet and drain, in the second turn of the march."""
    ledger = solution.ledger
    assert turned.times[0] == pytest.approx(TURN / 150.0, rel=1e-4)
    assert ledger.duration == pytest.approx(TURN / 150.0, rel=1e-4)
    assert ledger.shaft_angle == pytest.approx(TURN, rel=1e-4)
    assert ledger.mass_balance_error < 1e-6
    assert ledger.energy_balance_error < 1e-3
    assert 0.001 < ledger.mass["drain"] / ledger.mass["inlet"] < 0.2
    low, high = (float(solution.data[f"{port}_density"]) for port in ("inlet", "outlet"))
    ideal = low * turned.system.description.displacement * TURN
    assert 0.9 < ledger.mass["inlet"] / ideal < 1.1
    given = ledger.mass["outlet"] * 49e5 / (0.5 * (low + high))
    assert ledger.port_energy == pytest.approx(given, rel=1e-3)


def test_torque_and_flows_of_the_samples_are_those_of_the_ledger(
    turned: History, solution: Solution
) -> None:
    """What a pump takes a motor would give; flows are masses over the densities of their ports."""
    data, ledger = solution.data, solution.ledger
    torque = data["shaft_torque"].values
    assert torque.mean() == pytest.approx(ledger.shaft_energy / ledger.shaft_angle, rel=0.02)
    for port in ("inlet", "outlet"):
        density = float(data[f"{port}_density"])
        flow = ledger.mass[port] / ledger.duration / density
        assert data[f"{port}_flow_rate"].values.mean() == pytest.approx(flow, rel=0.02)
        assert data[f"dense_{port}_flow_rate"].values.mean() == pytest.approx(flow, rel=0.02)
    system = turned.system
    motor = replace(system, description=replace(system.description, mode="motor"))
    seen = observe(system.arrays, turned.states)
    given = outcome.port_values(replace(turned, system=motor), seen)
    assert given["shaft_torque"] == pytest.approx(-torque)


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_what_a_load_and_lines_dissipate_is_given_to_them_at_a_port(mode: str) -> None:
    """5 J in the load behind the outlet, 3 J in a line at the working port; no oil has moved."""
    machine = replace(toy_machine(), mode=mode, port_volumes=(1e-5, 1e-5))
    system = toy_system(machine, load_area=1e-6, **COARSE)
    first, size = start_state(system), system.arrays.size
    last = first.copy()
    accounts = [*LEDGER_NAMES, *(category.account for category in system.categories)]
    last[size.core + accounts.index("circuit")] += 3.0
    last[size.core + accounts.index(LOAD_ORIFICE.account)] += 5.0
    states, times = np.stack([first, last]), np.array([0.0, 0.1])
    history = History(Status.DONE, system, times, states, (), 1, {})
    energy = outcome.window_ledger(history).energy
    assert energy["load_orifice"] == pytest.approx(8.0)
    assert energy["circuit"] == 0.0
    ports = (0.0, 8.0) if mode == "pump" else (-3.0, 5.0)
    assert (energy["port_inlet"], energy["port_outlet"]) == pytest.approx(ports)


def test_flow_through_a_load_is_that_of_its_orifice() -> None:
    """C A sqrt(2 dp / rho) from 50 to 1 bar, a little less where it is not all turbulent."""
    machine = replace(toy_machine(), port_volumes=(1e-5, 1e-5))
    system = toy_system(machine, load_area=1e-6, **COARSE)
    states = start_state(system)[None]
    history = History(Status.DONE, system, np.zeros(1), states, (), 1, {})
    density = float(mixture_density(50e5, OIL.feed_gas_mass_fraction, OIL))
    expected = DISCHARGE_COEFFICIENT * 1e-6 * np.sqrt(2.0 * 49e5 / density)
    found = outcome._line_flow(history, observe(system.arrays, states))["line_flow_rate"]
    assert 0.9 * expected < float(found[0]) < expected
    # a machine also delivers what its port takes up: 1e-3 kg/s
    node = node_places(machine, system.condition)["outlet"]
    later = states.copy()
    later[0, system.arrays.balance[node, 0]] += 1e-4
    two = replace(history, times=np.array([0.0, 0.1]), states=np.vstack([states, later]))
    seen = observe(system.arrays, two.states)
    delivered = outcome.port_values(two, seen)["outlet_flow_rate"] * seen.density[:, node]
    leaving = outcome._line_flow(two, seen)["line_flow_rate"] * seen.density[:, node]
    assert delivered - leaving == pytest.approx([1e-3, 1e-3])


def test_a_single_state_has_no_flow(turned: History) -> None:
    """A rate of the mass that a port has taken up needs two."""
    single = replace(turned, times=turned.times[:1], states=turned.states[:1])
    seen = observe(turned.system.arrays, single.states)
    assert np.isnan(outcome.port_values(single, seen)["outlet_flow_rate"]).all()


def test_flows_have_their_extremes_among_close_states(solution: Solution) -> None:
    data = solution.data
    for name in ("inlet_flow_rate", "outlet_flow_rate", "shaft_torque", "outlet_pressure"):
        close = data[f"dense_{name}"].values
        spread = max(float(np.ptp(close)), 1e-3 * float(np.abs(close).max()))
        assert float(data[f"{name}_maximum"]) == pytest.approx(close.max(), abs=0.05 * spread)
        assert float(data[f"{name}_minimum"]) == pytest.approx(close.min(), abs=0.05 * spread)
    assert data["outlet_flow_rate"].values.mean() == pytest.approx(
        float(solution.summary()["mean_flow_L_per_min"]) / 6e4, rel=0.02
    )


def test_gaps_of_tips_are_those_whose_throats_move() -> None:
    *ports, leak = toy_machine().paths
    tips = [replace(leak, name=name, throat_speed=0.01) for name in ("first", "second")]
    system = SimpleNamespace(
        description=SimpleNamespace(paths=(*ports, tips[0], replace(leak, name="still"), tips[1]))
    )
    found = outcome._tips(cast(System, system))
    assert found == {"first": slice(0, 6), "second": slice(12, 18)}


@pytest.mark.parametrize("gas", ["none", "equilibrium"])
def test_what_oil_holds_grows_by_the_work_on_it(gas: str) -> None:
    """dE = -p dV where no oil passes; a free shaft of 3.1e-4 kg m2 turns with it."""
    free = replace(CONDITION, **COARSE, free_shaft=FreeShaft(inertia=3e-4))
    law = OIL if gas == "none" else GASSY
    system = assemble(toy_machine(), law, free)
    state, size = start_state(system), system.arrays.size
    room = np.linspace(0.95, 0.9, COUNT) if gas != "none" else np.ones(COUNT)
    state[size.mass : size.gas] *= room
    if gas != "none":
        # air in the room that the oil has left
        state[size.gas : size.position] = 1e-4 * state[size.mass : size.gas]
    state[0], step = 0.3, 1e-4
    held = []
    for turn in (-step, step):
        moved = state.copy()
        moved[0] += turn
        held.append(outcome.held_in(system, moved))
    pressure = observe(system.arrays, state[None]).pressure[0, :COUNT]
    growth = AMPLITUDE * np.sin(0.3 + TURN * np.arange(COUNT) / COUNT)
    work = -float(pressure @ growth)
    assert abs(work) > 0.02
    assert (held[1]["stored"] - held[0]["stored"]) / (2.0 * step) == pytest.approx(work, rel=1e-3)
    assert (
        held[1]["mass"]
        == held[0]["mass"]
        == pytest.approx(850.0 * room.mean() * 6 * 1.2e-6, rel=0.03)
    )
    assert held[0]["kinetic"] == pytest.approx(0.5 * 3.1e-4 * 150.0**2)
    prescribed = toy_system(**COARSE)
    assert outcome.held_in(prescribed, start_state(prescribed))["kinetic"] == 0.0


def test_bodies_that_move_on_their_own_hold_their_kinetic_energy() -> None:
    """The outer rotor of a gerotor turns by itself with its share of the speed, and shifts."""
    run = api.prepare(api.load_case("gerotor_trochoidal"))
    system = assemble(run.machine, run.fluid, run.condition)
    state, size = start_state(system), system.arrays.size
    state[size.velocity : size.column] = 0.0
    (outer,) = (b for b in run.machine.bodies if b.role != "shaft")
    spin = outer.speed_ratio * state[1]
    found = outcome.held_in(system, state)["kinetic"]
    assert found == pytest.approx(0.5 * outer.inertia * spin**2)
    for k, motion in enumerate(system.free_motions):
        moved = state.copy()
        moved[size.velocity + k] = 0.3
        entry = run.machine.motions[motion]
        assert entry.body == outer.name
        if entry.axis == "rotation":
            expected = 0.5 * outer.inertia * (spin + 0.3) ** 2
        else:
            expected = found + 0.5 * outer.mass * 0.3**2
        assert outcome.held_in(system, moved)["kinetic"] == pytest.approx(expected)


def test_vapour_fills_what_oil_does_not(turned: History) -> None:
    """A chamber with nine tenths of the mass at its pressure holds a tenth of vapour."""
    seen = observe(turned.system.arrays, turned.states[:1])
    less = seen.density.copy()
    less[0, 2] *= 0.9
    values = outcome.chamber_values(turned.system, seen._replace(density=less))
    found = values["chamber_vapour_fraction"][0]
    assert found[2] == pytest.approx(0.1, rel=0.02)
    assert np.delete(found, 2) == pytest.approx(np.zeros(5), abs=1e-6)


def test_what_leaves_a_node_goes_into_elements_and_orifices() -> None:
    """Flows count from end a to end b; paths within the machine are none of them."""
    elements = np.zeros((2, 1 + max(END_A, END_B)))
    elements[:, END_A], elements[:, END_B] = [7, 3], [3, 8]
    index = np.zeros((3, 1 + max(col.NODE_A, col.NODE_B, col.CATEGORY)), int)
    index[:, col.NODE_A], index[:, col.NODE_B] = [3, 9, 3], [9, 3, 5]
    index[:, col.CATEGORY] = [1, 1, 0]
    arrays = SimpleNamespace(elements=elements, path_index=index)
    system = SimpleNamespace(arrays=arrays, categories=(LATERAL, CIRCUIT_ORIFICE))
    seen = SimpleNamespace(
        element_flow=np.array([[0.1, 0.25]]), path_flow=np.array([[0.5, 0.02, 9.0]])
    )
    found = outcome._leaving(cast(System, system), cast(Any, seen), 3)
    assert found == pytest.approx([-0.1 + 0.25 + 0.5 - 0.02])


def test_a_wave_of_a_part_is_repeated_with_its_steps() -> None:
    angle = np.array([0.5, 1.0, 1.5, 2.5])
    found = outcome._repeated(angle, 3, 2.0)
    assert found.tolist() == [0.5, 1.0, 1.5, 2.5, 3.0, 3.5, 4.5, 5.0, 5.5, 6.5]
    wave = np.array([3.0, 4.0, 3.0])
    assert outcome._repeated(wave, 2, 0.0).tolist() == [3.0, 4.0, 3.0, 4.0, 3.0]


def test_what_a_machine_that_wanders_leaves_open_is_in_percent(turned: History) -> None:
    wandering = replace(turned, spanned=12, mean_errors=(0.004, 0.03))
    (told,) = outcome._of_several(wandering)
    assert "of 12 revolutions, which leave 0.4 % of the flow" in told.text
    assert "and 3 % of the torque open" in told.text


def test_a_journal_is_where_it_is_from_the_middle_of_its_bearing() -> None:
    """A bearing 1 and 2 um off, a body 4 and 6 um: 5 um apart, half of a clearance of 10 um."""
    journal = np.zeros((1, 1 + max(col.JOURNAL_CLEARANCE, col.BUSH_X, col.BUSH_Y, col.MOTION_X)))
    journal[0, [col.JOURNAL_CLEARANCE, col.BUSH_X, col.BUSH_Y]] = 10e-6, 1e-6, 2e-6
    system = SimpleNamespace(
        arrays=SimpleNamespace(journal=journal),
        free_motions=(0, 1),
        description=SimpleNamespace(motions=[SimpleNamespace(body="gear")] * 2),
    )
    position = np.zeros((1, 2, 3))
    position[0, 1, :2] = 4e-6, 6e-6
    names = ["other", "gear"]
    found = outcome._journal_values(cast(System, system), position, names)
    assert found["journal_eccentricity_ratio"][0] == pytest.approx([0.0, 0.5])
    assert found["journal_film_height"] == pytest.approx(np.array([[5e-6]]))
    assert found["seat_position"][1] == pytest.approx([1e-6, 2e-6, 0.0])
    # of a block that moves, its place counts
    moving = np.array([[4e-6, 3e-6, 0.0]])
    found = outcome._journal_values(cast(System, system), position, names, moving)
    assert found["journal_eccentricity_ratio"][0, 1] == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("force", "moment", "beyond"),
    [
        (0.5, 0.0, 0.0),
        (1.29, 0.0, 0.0),
        (1.31, 0.0, 1.0),
        (0.11, 0.0, 0.0),
        (0.09, 0.0, 1.0),
        (0.5, 9.0, 0.0),
    ],
)
def test_a_load_may_lie_a_tenth_outside_of_its_table(
    force: float, moment: float, beyond: float
) -> None:
    """A table without an axis over the moment holds at any."""
    table = SimpleNamespace(axes=np.array([[0.2, 0.5, 1.2], [0.0, 0.0, 0.0]]), counts=[3, 1])
    seen: Array = np.zeros((1, 1 + max(FORCE_SHARE, MOMENT_SHARE, LOAD_SCALE, HEIGHT_RATIO)))
    seen[0, [FORCE_SHARE, MOMENT_SHARE, LOAD_SCALE, HEIGHT_RATIO]] = force, moment, 200.0, 1.5
    arrays = SimpleNamespace(lateral=table, size=SimpleNamespace(film=2, load=4))
    history = SimpleNamespace(
        system=SimpleNamespace(arrays=arrays), states=np.array([[0.0, 0.0, 0.25, 0.0]])
    )
    found = outcome.lateral_values(cast(History, history), cast(Any, SimpleNamespace(lateral=seen)))
    assert found["lateral_load_beyond"].tolist() == [beyond]
    assert found["axial_load"] == pytest.approx([50.0])
    assert found["lateral_leakage_factor"] == pytest.approx([3.375])


def test_what_leaves_through_an_external_drain_is_its_mean_flow(turned: History) -> None:
    ledger = outcome.window_ledger(turned)
    outside = replace(ledger, duration=0.2, mass={**ledger.mass, "drain": 0.05})
    assert outcome.drain_of(turned, outside) == pytest.approx(0.25)


def test_samples_are_looked_at_among_the_close_states_where_they_are_some(
    turned: History,
) -> None:
    samples, close = lost_flow.looks_at(turned)
    np.testing.assert_array_equal(samples.history.times, turned.times)
    expected = observe(turned.system.arrays, turned.states).pressure
    np.testing.assert_allclose(samples.seen.pressure, expected, rtol=1e-9)
    assert close.copies == 1
    assert len(close.seen.pressure) > 4 * len(expected)
    # a round-off beside them, also beyond the last
    late = replace(turned, times=turned.times * (1.0 + 1e-9))
    samples, close = lost_flow.looks_at(late)
    np.testing.assert_allclose(samples.seen.pressure, expected, rtol=1e-9)
    parts = replace(turned, alike=4)
    assert lost_flow.looks_at(parts)[1].copies == 4


def test_an_opening_at_the_very_edge_of_a_port_is_shut() -> None:
    """Cylinders are open to one port over half a turn, and to none at its ends."""
    toy = toy_machine()
    areas = lost_flow.openings(toy, np.array([0.0, 0.5, 1e-12]))
    inlet, outlet = areas[..., 0], areas[..., 1]
    assert inlet.max() == pytest.approx(4e-5, rel=1e-3)
    own = TURN * np.arange(COUNT) / COUNT
    for row, angle in enumerate((0.0, 0.5)):
        assert np.array_equal(inlet[row] > 0.0, np.sin(own + angle) > 1e-9)
        assert np.array_equal(outlet[row] > 0.0, np.sin(own + angle) < -1e-9)
    assert inlet[1] == pytest.approx(np.maximum(4e-5 * np.sin(own + 0.5), 0.0), rel=1e-3)
    # 4e-17 m2 is nothing beside the largest
    np.testing.assert_array_equal(areas[2] > 0.0, areas[0] > 0.0)
