"""Gerotor machines: closed-form limits of the tables and balances of short runs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
from benchmarks.random_machines import case_text
from tests.gerotor_designs import CYCLOIDAL, TROCHOIDAL, machine
from toothspace.core.registry import machine_type, machine_type_names
from toothspace.core.status import Status
from toothspace.machines.gerotor.describe import describe
from toothspace.machines.shared_tables import ShaftBearingParameters
from toothspace.model.description import MachineDescription
from toothspace.results.solution import Solution
from toothspace.solver.cyclic import successors

CASES = Path(__file__).resolve().parents[2] / "cases"
NAMES = ["gerotor_trochoidal", "gerotor_cycloidal"]
SHORT = ("run.max_revolutions=2", 'operating_point.outlet_load="fixed_pressure"')


@cache
def _solved(name: str, *overrides: str) -> Solution:
    return ts.simulate(ts.load_case(CASES / f"{name}.toml", overrides))


@cache
def _described(kind: str) -> MachineDescription:
    return describe(machine(TROCHOIDAL if kind == "trochoidal" else CYCLOIDAL), 350)


def test_gerotor_is_a_machine_type():
    """Found by its name, without an installed entry point."""
    assert "gerotor" in machine_type_names()
    assert machine_type("gerotor").name == "gerotor"


@pytest.mark.parametrize(
    ("name", "displacement", "ripple"),
    [("gerotor_trochoidal", 6.160, 5.46), ("gerotor_cycloidal", 5.557, None)],
)
def test_rigid_fluid_without_leakage_gives_the_kinematic_flow(name, displacement, ripple):
    """Kinematic flow, and a torque of pressure times dV/dphi at every angle."""
    ideal = _solved(name, 'run.fidelity="ideal"')
    summary = ideal.summary()
    assert summary["displacement_cm3_per_rev"] == pytest.approx(displacement, rel=1e-3)
    assert summary["volumetric_efficiency"] == pytest.approx(1.0, abs=2e-5)
    if ripple:
        assert summary["flow_ripple_percent"] == pytest.approx(ripple, abs=0.01)
    span = ideal.data["outlet_pressure"] - ideal.data["inlet_pressure"]
    power = ideal.data["shaft_torque"] * ideal.data["shaft_speed"]
    assert np.allclose(power, span * ideal.data["outlet_flow_rate"], rtol=1e-9)


def test_ideal_flow_pulses_twelve_times_a_revolution():
    """Seven lobes pass the line of centres twice each while six teeth turn once."""
    flow = _solved("gerotor_trochoidal", 'run.fidelity="ideal"').data["outlet_flow_rate"].values
    flow = flow[:-1]
    peaks = (flow > np.roll(flow, 1)) & (flow >= np.roll(flow, -1))
    assert np.count_nonzero(peaks) == 12


@pytest.mark.parametrize("kind", ["trochoidal", "cycloidal"])
def test_volumes_of_all_pockets_sum_to_a_constant(kind):
    """Interpolated between the nodes as well."""
    description = _described(kind)
    family = description.families[0]
    angles = np.linspace(0.0, 2.0 * np.pi, 97)[:, None]
    places = family.phases + family.angle_ratio * angles
    total = family.volume(places).sum(axis=(1, 2))
    assert np.ptp(total) < 1e-9 * total.mean()
    assert family.volume.values.min() > 0.0


@pytest.mark.parametrize("kind", ["trochoidal", "cycloidal"])
def test_equal_pressures_give_no_net_force(kind):
    """On the outer rotor, in x, y and rotation, relative to one chamber alone."""
    family = _described(kind).families[0]
    angles = np.linspace(0.0, 2.0 * np.pi, 50)[:, None]
    force = family.volume_by_motion(family.phases + family.angle_ratio * angles)
    assert np.abs(force.sum(axis=1)).max() < 1e-6 * np.abs(force).max()


def test_pressure_on_the_growing_side_turns_the_outer_rotor_forwards():
    """Virtual work: a higher pressure in the pockets at positive x drives the rotation."""
    description = _described("trochoidal")
    family = description.families[0]
    columns = family.volume_by_motion(family.phases)
    growing = family.volume.derivative(family.phases)[:, 0] > 1e-12
    x, _, rotation = columns[growing].sum(axis=0)
    assert x > 0.0
    assert rotation > 0.0


def test_ports_lie_where_the_pockets_grow_and_shrink():
    """Inlet at positive x, outlet at negative x for the counter-clockwise shaft."""
    outlines = _described("trochoidal").outlines
    assert outlines["port_inlet"][:, 0].min() > 0.0
    assert outlines["port_outlet"][:, 0].max() < 0.0


def test_pockets_exchange_places_after_a_revolution():
    """Six sevenths of a turn: every pocket stands where its follower stood."""
    found = successors(_described("trochoidal"))
    assert list(found[:7]) == [6, 0, 1, 2, 3, 4, 5]
    assert found[7] == 7


def test_a_floating_inner_rotor_gets_bearings_and_motions():
    """Bearings under the key journal_bearings free x and y of the inner rotor."""
    shaft = ShaftBearingParameters(diameter=12e-3, length=12e-3, radial_clearance=15e-6)
    description = describe(machine(TROCHOIDAL, journal_bearings=shaft), 140)
    assert [f"{m.body}.{m.axis}" for m in description.motions[:2]] == [
        "inner_rotor.x",
        "inner_rotor.y",
    ]
    assert {j.body for j in description.journals} == {"inner_rotor", "outer_rotor"}
    columns = description.shared_faces.families[0].volume_by_motion.values
    # action and reaction along x and y
    assert np.allclose(columns[:, :2], -columns[:, 2:4])


def test_pockets_press_on_the_outer_rotor_through_its_film():
    """Ring of 2800 sectors, each with its share of two faces and of the film to its neighbours.

    Side gap 20 um and film 50 um, rim 26 mm, cavity floor 21.7 mm, width 12 mm.
    """
    spec, count, sectors = machine(TROCHOIDAL), 7, 2800
    description = describe(spec, 140)
    pressure = np.array([1.0, 3.0, 40.0, 41.0, 38.0, 20.0, 2.0]) * 1e5
    step = 2.0 * np.pi / sectors
    place = step * np.arange(sectors)
    beside = np.rint(place / (2.0 * np.pi / count)).astype(int) % count
    faces = 2.0 * (20e-6) ** 3 * step / np.log(26.0 / 21.7)
    along = (50e-6) ** 3 * 12e-3 / (26e-3 * step)
    matrix = np.diag(np.full(sectors, faces + 2.0 * along))
    matrix -= along * (np.roll(np.eye(sectors), 1, axis=1) + np.roll(np.eye(sectors), -1, axis=1))
    film = np.linalg.solve(matrix, faces * pressure[beside])
    wanted = -26e-3 * 12e-3 * step * np.array([film @ np.sin(place), -film @ np.cos(place)])
    family = description.families[0]
    both = family.volume_by_motion(family.phases)
    without = description.shared_faces.families[0].volume_by_motion(family.phases)
    found = pressure @ (both - without)
    assert found == pytest.approx([*wanted, 0.0], rel=0.01, abs=1e-6)


def test_open_film_ends_leak_to_the_drain():
    """Condition at the axial ends of the film round the outer rotor."""
    closed = machine(TROCHOIDAL)
    housing = replace(closed.housing, end_condition="pressure")
    opened = describe(replace(closed, housing=housing), 140)
    (ends,) = (p for p in opened.paths if p.name == "film_end")
    film = closed.rotors.inner_tooth_count + 1  # behind as many pockets
    assert (ends.nodes_a.tolist(), ends.nodes_b.tolist()) == ([film], [opened.drain_node])
    # 50 um round 52 mm, from the mean of the film out: a quarter of 12 mm
    assert ends.geometry.values[0] == pytest.approx([50e-6, 52e-3 * np.pi, 3e-3])
    assert opened.journals[0].end_condition == "pressure"


@pytest.mark.slow
def test_walls_part_the_film_from_the_pockets():
    """Nothing passes the ends of the film, and no pocket pushes the rotor through it."""
    spec = machine(TROCHOIDAL)
    closed = describe(replace(spec, housing=replace(spec.housing, end_condition="wall")), 140)
    film = spec.rotors.inner_tooth_count + 1
    assert not any(film in (*path.nodes_a, *path.nodes_b) for path in closed.paths)
    assert closed.journals[0].end_condition == "no_flow"
    fed, alone = describe(spec, 140).families[0], closed.families[0]
    without = describe(spec, 140).shared_faces.families[0].volume_by_motion.values
    assert np.array_equal(alone.volume_by_motion.values, without)
    assert not np.array_equal(fed.volume_by_motion.values, without)


@pytest.mark.parametrize("name", NAMES)
def test_balances_close(name):
    """Mass and energy ledgers of two revolutions of the shipped cases."""
    solution = _solved(name, *SHORT)
    assert solution.status in (ts.Status.DONE, ts.Status.NOT_CYCLIC)
    assert solution.ledger.mass_balance_error < 1e-7
    assert solution.ledger.energy_balance_error < 2e-5


def test_a_run_that_fails_before_its_second_sample_keeps_the_first():
    """A hundred steps do not last for a thirty-sixth of a revolution."""
    limits = ("run.max_steps=100", "run.samples_per_revolution=36")
    solution = _solved("gerotor_cycloidal", *limits)
    assert solution.status is Status.MAX_STEPS
    assert solution.data.sizes["shaft_angle"] == 1
    assert np.isnan(solution.data["outlet_flow_rate"]).all()
    assert solution.summary()["status"] == "max_steps"


@pytest.mark.parametrize("seed", [254, pytest.param(529, marks=pytest.mark.slow)])
def test_rotors_that_knock_are_told_by_several_revolutions(seed):
    """Lightly loaded lobes with play: one revolution tells another torque than the next."""
    solution = ts.simulate(ts.Case.from_toml(case_text(seed)))
    assert solution.status is Status.DONE
    assert any("repeats itself" in str(warning) for warning in solution.warnings)
    turned = solution.ledger.shaft_angle / (2.0 * np.pi)
    assert turned == pytest.approx(round(turned), rel=1e-9)
    assert turned > 1.5
    angle = solution.data["shaft_angle"]
    assert float(angle[-1] - angle[0]) == pytest.approx(solution.ledger.shaft_angle)
    assert solution.ledger.mass_balance_error < 1e-7
    assert solution.ledger.energy_balance_error < 1e-5


@pytest.mark.slow
def test_a_rotor_that_whirls_is_followed_to_where_it_repeats():
    """Left to itself it comes closer by 1.5 % in a revolution."""
    case = ts.load_case(CASES / "gerotor_cycloidal.toml").replace(
        {
            "machine.rotors.inner_tooth_count": 5,
            "machine.rotors.eccentricity": "2.4554 mm",
            "machine.rotors.tip_clearance": "5.16 um",
            "machine.rotors.face_width": "11.7 mm",
            "machine.housing.outer_rotor_diameter": "49.1 mm",
            "machine.housing.radial_clearance": "22.4 um",
            "machine.lateral.side_gap": "29.7 um",
            "machine.ports.inner_radius": "12.1 mm",
            "machine.ports.outer_radius": "19.5 mm",
            "fluid.name": "iso_vg_32",
            "fluid.temperature": "18.4 degC",
            "fluid.free_air_fraction": 0.0171,
            "operating_point": {
                "shaft_speed": "4433 rpm",
                "inlet_pressure": "3.33 bar",
                "outlet_pressure": "25.33 bar",
            },
        }
    )
    solution = ts.simulate(case)
    assert solution.status is Status.DONE
    assert solution.statistics["revolutions"] <= 30
    assert solution.summary()["energy_balance_error"] < 1e-5


@pytest.mark.slow
def test_a_rotor_whirling_at_half_speed_in_thick_oil_costs_few_steps():
    """Its film force is proportional to a velocity near zero whose direction decides the slope."""
    case = ts.load_case(CASES / "gerotor_trochoidal.toml").replace(
        {
            "machine.rotors.eccentricity": "2.4333 mm",
            "machine.rotors.generating_radius": "24.5257 mm",
            "machine.rotors.lobe_radius": "8.3537 mm",
            "machine.rotors.face_width": "11.3335 mm",
            "machine.rotors.tip_clearance": "45.1 um",
            "machine.housing.outer_rotor_diameter": "49.2466 mm",
            "machine.housing.radial_clearance": "24.7 um",
            "machine.ports.inner_radius": "13.3797 mm",
            "machine.ports.outer_radius": "20.5442 mm",
            "machine.lateral.side_gap": "24.6 um",
            "fluid.name": "iso_vg_46",
            "fluid.temperature": "-15.8 degC",
            "fluid.free_air_fraction": 0.0025,
            "operating_point": {
                "shaft_speed": "7511 rpm",
                "inlet_pressure": "4.99 bar",
                "outlet_pressure": "91.48 bar",
            },
            "run.revolutions": 3,
            "run.max_steps": 100_000,
        }
    )
    solution = ts.simulate(case)
    assert solution.status is Status.DONE
    assert solution.statistics["steps"] < 3_000 * solution.statistics["revolutions"]


@pytest.mark.parametrize("name", NAMES)
def test_bodies_are_as_fast_as_their_places_change(name):
    """Velocities of the result belong to the bodies whose places stand beside them."""
    data = _solved(name, *SHORT).data
    speed, time = np.asarray(data["body_velocity"]), np.asarray(data["time"])
    change = np.gradient(np.asarray(data["body_position"]), time, axis=0)
    size = np.sqrt(np.mean(speed**2, axis=0))
    apart = np.sqrt(np.mean((change - speed)[2:-2] ** 2, axis=0))
    assert np.any(size > 0.0)
    assert np.all(apart <= 0.15 * size)
