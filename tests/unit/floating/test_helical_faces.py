"""Faces beside helical gears: ends that lead and lag, and the axial force that presses them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import toothspace as ts
from tests.lateral_stack import HIGH, loads, pressures, ring_stack
from toothspace import api
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.floating.elastic_faces import flank_forces, loaded_bodies, node_pressures
from toothspace.floating.equilibrium import SearchSettings, find_equilibrium
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.motion import Balance, StepSettings, state_at
from toothspace.floating.problem import LateralSettings, lateral_problem, numbers_of
from toothspace.floating.stack import BackPressure, Stack
from toothspace.model.lateral_load import chamber_pressures
from toothspace.run.run import Run

HELICAL = Path(__file__).resolve().parents[3] / "cases" / "helical_pump.toml"
ANGLE = "machine.gears.helix_angle"
FIXED = 'machine.lateral.arrangement="fixed"'


def fixed_case(**changes: object) -> ts.Case:
    """The helical pump between bushings that rest."""
    gone = {f"machine.floating_bearing.{k}": None for k in ("high_pressure_area", "seal_preload")}
    keys = {"machine.lateral.arrangement": "fixed", "machine.floating_bearing.motion": "axial"}
    return ts.load_case(HELICAL).replace({**gone, **keys, **changes})


@cache
def prepared(hand: str = "right") -> Run:
    return api.prepare(ts.load_case(HELICAL, (f"machine.gears.helix_hand={hand}",)))


def between_walls(thrust: float | None) -> tuple[Stack, Balance]:
    """One ring between walls that rest, pushed along its axis."""
    stack = ring_stack(approach=3e-13, arrangement="fixed")
    if thrust is not None:
        stack = replace(stack, thrust=lambda angle: np.array([thrust]))
    snapshots = (stack.snapshot(0.0, pressures(HIGH)),)
    begun = state_at(stack, snapshots, stack.start(5e-6))
    found = find_equilibrium(stack, snapshots, loads(HIGH), begun, SearchSettings(), StepSettings())
    assert found.settled
    return stack, found.balance


def film_forces(balance: Balance) -> Array:
    return np.array([film.covered_load[0] for film in balance.states[0].films])


def test_the_gap_that_is_pressed_is_the_smaller_one_and_holds_the_force() -> None:
    _, balance = between_walls(300.0)
    floating, solid = balance.states[0].mean_gaps()
    assert floating < 0.95 * solid
    pressed, other = film_forces(balance)
    assert pressed - other == pytest.approx(300.0, abs=0.1)


def test_the_opposite_force_swaps_the_faces() -> None:
    gaps = [between_walls(push)[1].states[0].mean_gaps() for push in (300.0, -300.0)]
    np.testing.assert_allclose(gaps[0], gaps[1][::-1], rtol=2e-5)


def test_no_force_is_no_helix() -> None:
    (_, still), (_, straight) = between_walls(0.0), between_walls(None)
    np.testing.assert_allclose(still.position, straight.position, rtol=1e-9, atol=1e-18)


def test_both_ends_lead_and_lag_by_half_the_twist() -> None:
    for hand, sense in (("right", 1.0), ("left", -1.0)):
        found = prepared(hand).machine
        winding, balance = found.winding, found.lateral_balance
        assert winding is not None
        assert balance is not None
        for interface in balance.interfaces:
            side = 1.0 if interface.side == "floating" else -1.0
            assert interface.lead == pytest.approx(0.5 * sense * side * winding.twist, rel=1e-12)
    spur = api.prepare(
        ts.load_case(HELICAL).replace({ANGLE: "0 deg", "machine.gears.helix_hand": None})
    ).machine.lateral_balance
    assert spur is not None
    assert {interface.lead for interface in spur.interfaces} == {0.0}


@pytest.mark.parametrize("hand", ["right", "left"])
def test_spaces_push_the_bearings_as_they_push_the_teeth(hand: str) -> None:
    r"""The wider end of a space: :math:`A^+ - A^- = \kappa\,dV/d\varphi`, of all spaces together.

    Oil in a space is at rest along the axis, so that nothing is left between the covers.
    """
    run, found = prepared(hand), prepared(hand).machine
    assert found.lateral_balance is not None
    assert found.winding is not None
    at, pitch = chamber_pressures(found, run.condition), 2.0 * np.pi / 12
    bearings, teeth = 0.0, 0.0
    for angle in (np.arange(6) + 0.5) * pitch / 6:
        pressure = at(float(angle))
        for interface in found.lateral_balance.interfaces:
            grid = FaceGrid(interface, 504, 48)
            mask = grid.mask(float(angle))
            push = np.where(mask.open_face, pressure[mask.node] * grid.area, 0.0).sum()
            bearings += push if interface.side == "floating" else -push
        rates = [
            family.angle_ratio
            * family.volume.derivative(family.phases + family.angle_ratio * angle)[..., 0]
            for family in found.families
        ]
        work = pressure[: found.chamber_count] @ np.hstack(rates)
        teeth -= found.winding.turn_per_length * work
    assert abs(teeth) > 500.0
    # where a groove is open to a space the bearing has the pressure of its port
    assert bearings == pytest.approx(-teeth, rel=0.06)


@pytest.mark.parametrize(
    ("name", "slices"),
    [pytest.param("continuous_pump", None, marks=pytest.mark.slow), ("helical_pump", 3)],
)
def test_ends_have_the_pressures_of_the_chambers_that_pass_there(
    name: str, slices: int | None
) -> None:
    r"""Spaces that are parted push the bearings as those of one chamber do: :math:`\mp F`."""
    gone = {f"machine.floating_bearing.{k}": None for k in ("high_pressure_area", "seal_preload")}
    keys = {
        **gone,
        "machine.gears.axial_slices": slices,
        "machine.lateral.arrangement": "fixed",
        "machine.floating_bearing.length": "19 mm",
        "machine.floating_bearing.motion": "axial",
    }
    run = api.prepare(ts.load_case(HELICAL.with_name(f"{name}.toml")).replace(keys))
    found, at = run.machine, chamber_pressures(run.machine, run.condition)
    balance, samples = found.lateral_balance, np.array([0.0, 0.1, 0.9, 2.0 * np.pi])
    assert balance is not None
    assert found.parts_spaces
    chambers = np.array([at(float(angle))[: found.chamber_count] for angle in samples])
    ports = {
        f"{port}_pressure": ("shaft_angle", np.full(4, getattr(run.condition, f"{port}_pressure")))
        for port in ("inlet", "outlet")
    }
    data = xr.Dataset(
        {"chamber_pressure": (("shaft_angle", "chamber"), chambers), **ports},
        coords={"shaft_angle": samples},
    )
    pressures_at, bearings, teeth = node_pressures(found, balance, data), 0.0, 0.0
    for k in (1, 2):
        angle, pressure = float(samples[k]), pressures_at(float(samples[k]))
        for interface in balance.interfaces:
            grid = FaceGrid(interface, 360, 36)
            mask = grid.mask(angle)
            push = np.where(mask.open_face, pressure[mask.node] * grid.area, 0.0).sum()
            bearings += push if interface.side == "floating" else -push
        rates = [
            own.angle_ratio * own.volume.derivative(own.phases + own.angle_ratio * angle)[..., 0]
            for own in found.families
        ]
        teeth -= found.winding.turn_per_length * (chambers[k] @ np.hstack(rates))
    assert bearings == pytest.approx(-teeth, rel=0.04)


def test_slices_of_a_contact_line_push_their_flank_together() -> None:
    found = prepared().machine
    pair, teeth = found.contacts[0], 12
    slices = pair.count // teeth
    assert slices > 1
    # all slices of flank k carry k; the other flanks of both gears do not count
    row = np.concatenate([np.tile(np.arange(teeth), slices), np.full(pair.count, 99.0)])
    forces = flank_forces(found, xr.Dataset({"contact_force": (("angle", "contact"), row[None])}))
    np.testing.assert_array_equal(forces, [slices * np.arange(teeth)])


@pytest.mark.slow
def test_films_of_continuous_contact_hold_its_axial_force() -> None:
    """Between bushings that rest both gears settle, pressed by what the run says."""
    keys = {
        "machine.lateral.arrangement": "fixed",
        "machine.floating_bearing.length": "19 mm",
        "machine.floating_bearing.motion": "axial",
        "machine.floating_bearing.gear_axial_force": ["-1500 N", "-550 N"],
        "run.samples_per_revolution": 360,
        "run.relative_tolerance": 1e-5,
    }
    case = ts.load_case(HELICAL.with_name("continuous_pump.toml")).replace(keys)
    prepared, solution = api.prepare(case), ts.simulate(case)
    settings = LateralSettings(grid=(126, 18), angles=4)
    problem = lateral_problem(prepared.machine, prepared.fluid, solution.data, settings)
    found = problem.settle(problem.started(8e-6))
    assert found.settled
    states = found.balance.states
    thrust = np.mean([state.snapshot.thrust for state in states], axis=0)
    film = np.mean([[f.covered_load[0] for f in s.films] for s in states], axis=0)
    np.testing.assert_allclose(film[:2] - film[2:], thrust - [1500.0, 550.0], atol=1.0)


@pytest.mark.slow
def test_floating_bushings_of_continuous_contact_find_their_balance() -> None:
    """Films carry both bushings where the area closes with a tenth more than the gears open."""
    found = ts.simulate(HELICAL.with_name("continuous_floating.toml")).summary()
    assert found["status"] == "done"
    assert found["torque_loss_lateral_asperity_N_m"] == 0.0
    assert found["smallest_film_um"] > 5.0
    assert abs(found["force_balance_error"]) < 1e-5
    assert found["mass_balance_error"] < 1e-7


def test_bushings_that_rest_are_not_pressed() -> None:
    with pytest.raises(CaseError, match=r"floating_bearing\.high_pressure_area"):
        ts.load_case(HELICAL, (FIXED,)).machine_spec  # noqa: B018
    machine = api.prepare(fixed_case()).machine
    balance = machine.lateral_balance
    assert balance is not None
    assert balance.arrangement == "fixed"
    assert balance.floating.high_pressure.area == 0.0
    back = BackPressure(HIGH, HIGH, HIGH)
    with pytest.raises(CaseError, match="deformation"):
        loaded_bodies(machine, balance, (), back, xr.Dataset())


@pytest.mark.slow
def test_hands_of_a_machine_swap_its_faces_and_the_forces_close() -> None:
    gaps, pressed = [], []
    for hand in ("right", "left"):
        case = fixed_case(**{"machine.gears.helix_hand": hand})
        prepared, solution = (
            api.prepare(case),
            ts.simulate(case.replace({"run.fidelity": "lumped"})),
        )
        problem = lateral_problem(
            prepared.machine,
            prepared.fluid,
            solution.data,
            LateralSettings(grid=(126, 18), angles=4),
        )
        found = problem.settle(problem.started(5e-6))
        assert found.settled
        gaps.append(numbers_of(problem, found.balance).gaps)
        states = found.balance.states
        thrust = np.mean([state.snapshot.thrust for state in states], axis=0)
        film = np.mean([[f.covered_load[0] for f in s.films] for s in states], axis=0)
        np.testing.assert_allclose(film[:2] - film[2:], thrust, atol=0.2)
        pressed.append(thrust[0])
    np.testing.assert_allclose(gaps[0], gaps[1][[2, 3, 0, 1]], rtol=1e-3)
    assert pressed[0] == pytest.approx(-pressed[1], rel=1e-6)
    assert gaps[0][0] < 0.9 * gaps[0][2]
