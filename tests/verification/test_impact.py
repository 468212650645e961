"""A block between compliant walls: impacts, static sharing, energy, all against closed forms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.reference_formulas.cylinder_contact import johnson_indentation
from tests.toy_machine import TURN, toy_machine
from toothspace.model.arrays import CONTACT_ENERGY
from toothspace.model.assembly import System, assemble
from toothspace.model.contact_pair import ContactPair
from toothspace.model.description import MachineDescription, Motion
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.periodic_table import PeriodicTable
from toothspace.solver.compiled_model import evaluate_state, observe
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import Piece, start_march

MASS = 0.1  # of the toy's rotor
GAP = 20e-6
STIFFNESS = 1e8
SPEED = 0.1
ONSET = 1e-9
MODULUS = 2.26e11
WIDTH = 10e-3


def walls(**changes: Any) -> tuple[ContactPair, ContactPair]:
    """One wall on each side of the block, at the same distance."""
    return wall("right", -1.0, **changes), wall("left", 1.0, **changes)


def wall(name: str, direction: float, **changes: Any) -> ContactPair:
    settings: dict[str, Any] = {
        "name": name,
        "body_a": "rotor",
        "body_b": "rotor",
        "angle_ratio": 1.0,
        "phases": np.zeros(1),
        "geometry": constant(changes.pop("gap", GAP), 1.0, 8e-3, -12e-3, 0.0, 0.0),
        "gap_by_motion": constant(direction),
        "width": WIDTH,
        "effective_modulus": MODULUS,
        "roughness": 4e-7,
        "law": "linear",
        "structure_stiffness": STIFFNESS,
        "onset": ONSET,
        "restitution": 1.0,
    }
    return ContactPair(**{**settings, **changes})


def constant(*row: float) -> PeriodicTable:
    return PeriodicTable(TURN, np.tile(row, (4, 1)), np.zeros((4, len(row))))


def block(contacts: tuple[ContactPair, ...], force: float = 0.0) -> System:
    """The toy's rotor may slide along x between the contacts, untouched by the fluid."""
    toy = toy_machine(360)
    still = PeriodicTable(TURN, np.zeros((360, 1)), np.zeros((360, 1)))
    machine: MachineDescription = replace(
        toy,
        motions=(Motion("rotor", "x"),),
        families=(replace(toy.families[0], volume_by_motion=still),),
        contacts=contacts,
    )
    condition = OperatingCondition(
        shaft_speed=157.0,
        inlet_pressure=1e5,
        outlet_pressure=1e5,
        radial_load=(force, 0.0),
        relative_tolerance=1e-7,
    )
    return assemble(
        machine,
        fluid_law(
            "iso_vg_46",
            323.15,
            GasModel(law="none", free_air_fraction=0.0, dissolved_air_fraction=0.0),
        ),
        condition,
    )


def bounce(system: System, speed: float, duration: float, samples: int = 2000) -> Piece:
    state = start_state(system)
    state[system.arrays.size.velocity] = speed
    march = start_march(system, state)
    return march.advance(np.linspace(0.0, duration, samples + 1))


def energies(system: System, piece: Piece) -> np.ndarray:
    total = []
    for state in piece.states:
        evaluate_state(system.arrays, state)
        stored = float(np.sum(system.arrays.contact[:, CONTACT_ENERGY]))
        total.append(0.5 * MASS * state[system.arrays.size.velocity] ** 2 + stored)
    return np.array(total)


def period() -> float:
    """There and back at constant speed, and two half sines in the walls."""
    return 4.0 * GAP / SPEED + TURN * np.sqrt(MASS / STIFFNESS)


def test_period_of_a_block_between_springs() -> None:
    system = block(walls())
    piece = bounce(system, SPEED, 10.0 * period())
    made = [event.time for event in piece.events if event.kind == "contact_made"]
    labels = [event.label for event in piece.events if event.kind == "contact_made"]
    assert labels[:4] == ["right_0", "left_0", "right_0", "left_0"]
    assert np.mean(np.diff(made[::2])) == pytest.approx(period(), rel=1e-3)


@pytest.mark.parametrize("law", ["linear", "hertz_line", "johnson", "pereira"])
def test_energy_is_kept_without_damping(law: str) -> None:
    """Over twenty impacts; a law whose force is not the slope of its energy would drift."""
    flexible = STIFFNESS if law == "linear" else np.inf
    system = block(walls(law=law, structure_stiffness=flexible))
    total = energies(system, bounce(system, SPEED, 10.0 * period()))
    assert total == pytest.approx(total[0], rel=2e-3)


@pytest.mark.parametrize("law", ["linear", "hertz_line"])
@pytest.mark.parametrize("speed_ratio", [0.5, 1.0, 2.0])
def test_restitution_of_an_impact(law: str, speed_ratio: float) -> None:
    r"""Whatever the law, with a = 3/4 (1 - c^2)/v0 the rebound e v obeys

    .. math:: v - \ln(1 + a v)/a = -e v - \ln(1 - a e v)/a .
    """
    speed = speed_ratio * SPEED
    loss = 0.75 * (1.0 - 0.8**2) / SPEED
    flexible = STIFFNESS if law == "linear" else np.inf
    pair = walls(law=law, structure_stiffness=flexible, restitution=0.8, approach_speed=SPEED)
    system = block(pair)
    piece = bounce(system, speed, 1.5 * GAP / speed + 3e-4)
    parted = next(event.time for event in piece.events if event.kind == "contact_lost")
    after = piece.states[np.searchsorted(piece.times, parted) + 1]
    rebound = -after[system.arrays.size.velocity] / speed

    def remainder(e: float) -> float:
        given = speed - np.log1p(loss * speed) / loss
        return float(given + e * speed + np.log1p(-loss * e * speed) / loss)

    expected = brentq(remainder, 0.3, 1.0)
    assert rebound == pytest.approx(expected, abs=2e-3)
    if speed_ratio == 1.0:
        assert rebound == pytest.approx(0.8, abs=0.05)


def test_restitution_holds_for_each_impact() -> None:
    """Walls that damp by the speed of each impact give back one share of any speed."""
    pair = walls(restitution=0.8, approach_speed=None)
    shares = []
    for speed in (0.2 * SPEED, SPEED, 5.0 * SPEED):
        system = block(pair)
        piece = bounce(system, speed, 1.5 * GAP / speed + 1e-3)
        parted = next(event.time for event in piece.events if event.kind == "contact_lost")
        after = piece.states[np.searchsorted(piece.times, parted) + 1]
        shares.append(-after[system.arrays.size.velocity] / speed)
    assert shares == pytest.approx([shares[1]] * 3, abs=2e-3)
    assert shares[1] == pytest.approx(0.8, abs=0.05)


def test_two_walls_share_a_load() -> None:
    """Springs of 1 and 3 and a head start of 2 um: forces by hand."""
    load = 500.0
    pair = (
        wall("near", -1.0, gap=10e-6, structure_stiffness=1e8, restitution=0.2),
        wall("far", -1.0, gap=12e-6, structure_stiffness=3e8, restitution=0.2),
    )
    forces = settled(block(pair, load))
    overlap = (load + 3e8 * 2e-6) / 4e8
    assert forces == pytest.approx([1e8 * overlap, 3e8 * (overlap - 2e-6)], rel=1e-4)


def test_two_hertzian_walls_share_a_load() -> None:
    """The same with Johnson's closed form, solved for the common position."""
    load, modulus = 500.0, 0.5 * MODULUS
    pair = tuple(
        wall(name, -1.0, gap=gap, law="johnson", structure_stiffness=np.inf, restitution=0.2)
        for name, gap in (("near", 10e-6), ("far", 11e-6))
    )

    def depth(force: float) -> float:
        return float(johnson_indentation(force / WIDTH, 4e-3, modulus))

    near = brentq(lambda f: depth(f) - depth(load - f) - 1e-6, 0.5 * load, load - 1e-6)
    assert settled(block(pair, load)) == pytest.approx([near, load - near], rel=1e-3)


def settled(system: System) -> np.ndarray:
    piece = bounce(system, 0.0, 0.2, 50)
    return observe(system.arrays, piece.states[-1:]).contact_force[0]
