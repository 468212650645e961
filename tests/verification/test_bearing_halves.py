"""A floating bearing that is split: its halves move as bearings of their own."""

from __future__ import annotations

import numpy as np
import pytest

from tests.external_gear_designs import floating_block, fuel14
from tests.lateral_stack import HIGH, LOW, loads, pressures, ring_stack, split_stack
from toothspace.core.errors import GeometryError
from toothspace.floating.equilibrium import Equilibrium, SearchSettings, find_equilibrium
from toothspace.floating.housing_friction import HousingFriction
from toothspace.floating.motion import Loads, StepSettings, state_at
from toothspace.floating.stack import Stack
from toothspace.gearing.materials import Material
from toothspace.machines.external_gear.describe import describe
from toothspace.machines.external_gear.floating.floating_parameters import (
    FloatingBearingParameters,
    NoseParameters,
    PressureAreaParameters,
    SpringParameters,
)
from toothspace.machines.external_gear.spec import FloatingBlock
from toothspace.model.floating_bearing import HousingContact

APPROACH = 3e-13


def _pair(shares: tuple[float, float], **changes: object) -> Stack:
    return split_stack(shares, approach=APPROACH, **changes)


def _settled(stack: Stack, acting: Loads) -> Equilibrium:
    snapshots = (stack.snapshot(0.0, pressures(HIGH)),)
    start = state_at(stack, snapshots, stack.start(2e-6))
    step = StepSettings(force_tolerance=1e-9)
    return find_equilibrium(stack, snapshots, acting, start, SearchSettings(), step)


@pytest.mark.parametrize("motion", ["axial", "full"])
def test_halves_settle_where_two_bearings_would(motion: str) -> None:
    """Every half against the same half computed alone."""
    shares = (0.70, 0.74)
    both = _settled(_pair(shares, motion=motion, preload_x=1e-3), loads(HIGH))
    assert both.settled
    found = both.balance.states[0].stack.positions(both.balance.position)
    for k, share in enumerate(shares):
        alone = ring_stack(approach=APPROACH, high_share=share, motion=motion, preload_x=1e-3)
        single = _settled(alone, loads(HIGH))
        assert single.settled
        assert found[k] == pytest.approx(alone.gauge(single.balance.position), rel=1e-4)
    assert found[0] > found[1] * 1.01


def test_friction_holds_one_half_and_lets_the_other_slide() -> None:
    free = HousingFriction(coulomb_force=1.0, breakaway_speed=6e-3, law="stick")
    stuck = HousingFriction(coulomb_force=1e4, breakaway_speed=6e-3, law="stick")
    acting = loads(HIGH)._replace(friction=stuck, parts=(free, stuck))
    stack = _pair((0.70, 0.70))
    found = _settled(stack, acting)
    start, end = stack.positions(stack.start(2e-6)), stack.positions(found.balance.position)
    assert end[1] == pytest.approx(start[1], abs=1e-12)
    assert abs(end[0] - start[0]) > 1e-8
    assert abs(found.balance.friction[0]) <= free.breakaway_force
    assert found.balance.friction.shape == (2,)


def test_gears_stay_between_two_split_bearings() -> None:
    stack = _pair((0.70, 0.74), arrangement="symmetric")
    assert stack.size == 18
    assert list(stack.free) == [0, 3, 12, 15]
    found = _settled(stack, loads(HIGH))
    assert found.settled
    q = found.balance.position
    assert q[0] - q[6] == pytest.approx(q[6] - q[12], rel=1e-4)


def _machine(**changes: object) -> FloatingBlock:
    metal = Material(elastic_modulus=1e11, poisson_ratio=0.3, hardness=1e9, density=8800.0)
    springs = tuple(
        SpringParameters(force=70.0, x=x, y=y) for x in (-12e-3, 9e-3) for y in (0.0, 31.53e-3)
    )
    keys = FloatingBearingParameters(
        high_pressure_area=PressureAreaParameters(seal_line_x=8e-3),
        nose=NoseParameters(area=400e-6, center=(-20e-3, 28e-3)),
        springs=springs,
        seal_preload=35.0,
        housing_contact=HousingContact(area=900e-6),
        split=True,
    )
    return floating_block(FloatingBlock(keys=keys, material=metal, length=38e-3), **changes)


def test_halves_of_a_machine_add_up_to_the_whole() -> None:
    balance = describe(fuel14(floating_block=_machine())).lateral_balance
    assert balance is not None
    whole, halves = balance.floating, balance.halves
    assert [half.gauge_point[1] for half in halves] == pytest.approx(
        [-36.06e-3, 99.12e-3], abs=2e-5
    )
    for name in ("face", "high_pressure", "nose"):
        parts = np.sum([getattr(half, name).moments for half in halves], axis=0)
        assert parts == pytest.approx(getattr(whole, name).moments, rel=1e-9, abs=1e-15)
    springs = np.sum([h.preload.moments for h in halves], axis=0)
    assert springs == pytest.approx(whole.preload.moments, rel=1e-9)
    assert sum(half.mass for half in halves) == pytest.approx(whole.mass)
    assert sum(half.housing.area for half in halves) == pytest.approx(whole.housing.area)
    # equal gears: the cut is half way, and the nose is below it but for its upper edge
    assert halves[0].face.area == pytest.approx(halves[1].face.area, rel=1e-9)
    assert halves[0].nose.area == pytest.approx(20e-3 * (31.53e-3 - 18e-3), rel=1e-9)


def test_split_needs_an_outline_of_the_balanced_area() -> None:
    bearing = _machine(
        high_pressure_area=PressureAreaParameters(area=2000e-6, center=(0.0, 31.53e-3))
    )
    described = describe(fuel14(floating_block=bearing))
    with pytest.raises(GeometryError, match=r"floating_bearing\.split: found"):
        described.lateral_balance  # noqa: B018 - made when it is asked for


def test_low_pressure_everywhere_leaves_the_springs() -> None:
    stack = _pair((0.5, 0.6))
    low = pressures(LOW)
    state = stack.solve(
        stack.snapshot(0.0, low),
        stack.start(4e-6),
        np.zeros(stack.size),
        None,
        [np.zeros_like(grid.area) for grid in stack.grids],
    )
    force = state.film_force() + state.back_force(loads(LOW).back)
    assert force[[0, 3]] == pytest.approx([-100.0, -100.0], rel=1e-6)
