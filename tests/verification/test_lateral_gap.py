"""Floating bearing between two films: rigid limit, exact derivatives, balance and friction."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.lateral_stack import (
    AREA,
    HIGH,
    HIGH_NODE,
    INNER,
    LOW,
    LOW_NODE,
    OUTER,
    VISCOSITY,
    loads,
    pressures,
    ring_stack,
)
from toothspace.core.types import Array
from toothspace.films import FilmFluid, LateralFilm
from toothspace.floating.coupling import hold_down_warning
from toothspace.floating.equilibrium import (
    Equilibrium,
    SearchSettings,
    find_equilibrium,
    march_angles,
)
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.housing_friction import HousingFriction, normal_force
from toothspace.floating.motion import StepSettings, balance_force, state_at
from toothspace.floating.problem import LateralProblem, LateralSettings, numbers_of
from toothspace.floating.stack import (
    BackPressure,
    PreviousStep,
    Stack,
    StackState,
    leaning,
    stop_forces,
)
from toothspace.model.film_faces import FILM, NO_BODY, FaceCells
from toothspace.model.floating_bearing import AxialForce, HousingContact

APPROACH = 3e-13
SHARE = 0.72
"""Balanced part of the back face; a plane ring film carries 0.645 of it. [-]"""


def _solved(
    stack: Stack, q: np.ndarray, high: float = HIGH, v: np.ndarray | None = None
) -> StackState:
    flat = [np.zeros((g.rows, g.lanes)) for g in stack.grids]
    snapshot = stack.snapshot(0.0, pressures(high))
    return stack.solve(snapshot, q, np.zeros(stack.size) if v is None else v, None, flat)


def _settled(
    stack: Stack,
    high: float,
    start: float | np.ndarray,
    coulomb: float = 0.0,
    law: str = "stick",
    stable: bool = True,
) -> Equilibrium:
    snapshots = (stack.snapshot(0.0, pressures(high)),)
    begin = stack.start(start) if isinstance(start, float) else start
    search = SearchSettings(longest_time=1e3 if law == "stick" else 0.01, stable=stable)
    first = state_at(stack, snapshots, begin)
    return find_equilibrium(
        stack, snapshots, loads(high, coulomb, law), first, search, StepSettings()
    )


def _of(stack: Stack, fluid: FilmFluid) -> Stack:
    """Stack with another liquid."""
    return replace(stack, laws=tuple(law._replace(fluid=fluid) for law in stack.laws))


THICKENING = FilmFluid(VISCOSITY, pressure_viscosity=1.7e-7, limit_pressure=0.7 * HIGH)
"""Twice as viscous where the pressure is highest; grows no further there."""


@pytest.mark.parametrize("fluid", [FilmFluid(VISCOSITY), THICKENING])
@pytest.mark.parametrize("tilt", [(0.0, 0.0), (1.2e-4, -0.8e-4)])
def test_rigid_faces_give_the_lateral_film(tilt: tuple[float, float], fluid: FilmFluid) -> None:
    """The same load, moments, shear torque and bore flow as the stand-alone ring."""
    gap, speed = 6e-6, 300.0
    stack = _of(ring_stack(rough=False, motion="full", speed=speed), fluid)
    q = stack.start(gap)
    q[1:3] = tilt
    found = _solved(stack, q).films[0]
    # the bearing turns about x and y, the gear below stays plane
    ring = LateralFilm(
        inner_radius=INNER,
        outer_radius=OUTER,
        side_gap=gap,
        fluid=fluid,
        tilt=tilt,
        grid=(36, 10),
        inner_pressure=LOW,
        outer_pressure=HIGH,
    ).solve(shaft_speed=speed)
    assert found.covered_load == pytest.approx(ring.load, rel=1e-9, abs=1e-9)
    assert found.losses.bore_flow == pytest.approx(ring.inner_flow, rel=1e-9)
    power = ring.friction_torque * speed
    assert abs(found.losses.shear) == pytest.approx(abs(power), rel=2e-4)


@pytest.mark.parametrize("approach", [0.0, APPROACH])
def test_equal_pressure_everywhere_leaves_the_preload(approach: float) -> None:
    stack = ring_stack(approach=approach, preload=250.0)
    state = _solved(stack, stack.start(5e-6), high=LOW)
    net = state.film_force() + state.back_force(BackPressure(LOW, LOW, LOW))
    assert net == pytest.approx(np.array([-250.0, 0, 0, 0, 0, 0]), abs=1e-6)


def test_flow_through_a_ring_follows_the_viscosity_at_the_pressure() -> None:
    r"""Level faces: :math:`Q = \pi h^3 (q_2 - q_1) / (6 \mu_0 \ln(r_2/r_1))` with reduced q."""
    gap, alpha, limit = 6e-6, THICKENING.pressure_viscosity, THICKENING.limit_pressure
    stack = _of(ring_stack(rough=False, speed=0.0), THICKENING)
    flow = _solved(stack, stack.start(gap)).films[0].losses.bore_flow
    below = (np.exp(-alpha * LOW) - np.exp(-alpha * limit)) / alpha
    reduced = below + (HIGH - limit) * np.exp(-alpha * limit)
    exact = np.pi * gap**3 * reduced / (6.0 * VISCOSITY * np.log(OUTER / INNER))
    assert flow == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(
    ("approach", "gap", "fluid"),
    [
        (0.0, 1.2e-6, FilmFluid(VISCOSITY)),
        (0.0, 4e-6, THICKENING),
        (APPROACH, 1.2e-6, THICKENING),
        (APPROACH, 4e-6, FilmFluid(VISCOSITY)),
    ],
)
def test_stiffness_and_damping_are_derivatives(
    approach: float, gap: float, fluid: FilmFluid
) -> None:
    """Central differences of the film force, tilts included, rough walls in contact at 1.2 um."""
    stack = _of(ring_stack(approach=approach, motion="full", limit=0.0), fluid)
    q = stack.start(gap)
    q[1:3] = 1e-5, -0.5e-5
    stiffness, damping = _solved(stack, q).coefficients
    scale = np.array([1.0, 1.0 / OUTER, 1.0 / OUTER] * 2)
    for k in range(stack.size):
        for table, step, rate in ((stiffness, 1e-10, False), (damping, 1e-6, True)):
            change = np.zeros(stack.size)
            change[k] = step * scale[k]
            sides = [
                _solved(stack, q, v=s * change) if rate else _solved(stack, q + s * change)
                for s in (1.0, -1.0)
            ]
            slope = -(sides[0].film_force() - sides[1].film_force()) / (2.0 * change[k])
            size = float(np.abs(table * scale[:, None] * scale[None, :]).max())
            error = np.abs(table[:, k] - slope) * scale * scale[k]
            assert error.max() < 2e-3 * size, (k, rate)


def test_stiffness_within_a_step_is_the_derivative() -> None:
    """Faces that deform and touch while the step goes on: asperities hold off part of the rate."""
    stack = _of(ring_stack(approach=APPROACH, limit=0.0), FilmFluid(VISCOSITY))
    q, v, distant = stack.start(1.2e-6), np.zeros(stack.size), [np.zeros((36, 10))] * 2
    before = _solved(stack, stack.start(1.25e-6))

    def at(place: Array) -> StackState:
        return stack.solve(before.snapshot, place, v, before, distant, PreviousStep(before, 1e-5))

    stiffness, _ = at(q).coefficients
    ahead, behind = (at(q + s * np.eye(stack.size)[0] * 1e-10) for s in (1.0, -1.0))
    slope = (behind.film_force() - ahead.film_force()) / 2e-10
    assert stiffness[0, 0] == pytest.approx(slope[0], rel=2e-3)


def test_equilibrium_is_where_forces_balance() -> None:
    """Residual below 1e-6 of the balance force, told by an independent sum of pressures."""
    stack = ring_stack(approach=APPROACH, high_share=SHARE)
    found = _settled(stack, HIGH, 2e-6)
    assert found.settled
    state = found.balance.states[0]
    film = state.films[0]
    push = float((film.total * film.grid.area).sum())
    area = float(film.grid.area.sum())
    back = SHARE * (HIGH - LOW) * AREA + LOW * area + 100.0
    scale = balance_force(stack, BackPressure(HIGH, LOW, LOW))
    assert found.balance.residual < 1e-6
    assert abs(push - back) < 2e-6 * scale
    gaps = state.mean_gaps()
    assert gaps[0] == pytest.approx(gaps[1], rel=1e-6)


def test_compliant_faces_carry_more_the_closer_they_are() -> None:
    """Pressure widens the gap where it enters, so a thin film carries more than a plane one."""
    loads_over_gap = [
        _solved(s := ring_stack(approach=APPROACH, rough=False), s.start(gap)).film_force()[0]
        for gap in (2e-6, 4e-6, 8e-6)
    ]
    plane = _solved(s := ring_stack(rough=False), s.start(4e-6)).film_force()[0]
    assert loads_over_gap[0] > loads_over_gap[1] > loads_over_gap[2] > plane


def test_two_floating_bearings_move_alike() -> None:
    stack = ring_stack(approach=APPROACH, high_share=SHARE, arrangement="symmetric")
    found = _settled(stack, HIGH, 2e-6)
    assert found.settled
    q = found.balance.position
    gaps = found.balance.states[0].mean_gaps()
    assert gaps[0] == pytest.approx(gaps[1], rel=1e-5)
    assert q[0] - q[3] == pytest.approx(q[3] - q[-3], rel=1e-5)


def test_springs_beside_the_middle_tilt_the_bearing_until_moments_balance() -> None:
    stack = ring_stack(approach=APPROACH, high_share=SHARE, motion="full", preload_x=4e-3)
    found = _settled(stack, HIGH, 3e-6)
    assert found.settled
    assert found.balance.residual < 1e-6
    assert np.abs(found.balance.position[1:3]).max() > 1e-7
    moment = found.balance.states[0].films[0].covered_load[2]
    assert moment == pytest.approx(-100.0 * 4e-3, rel=1e-3)


def test_wall_carries_the_moment_that_the_film_does_not() -> None:
    """Moment of films and back over the tilt is the stiffness given, and tilts less.

    Without the wall the films of this ring circle, with it they tip about the other axis: forces
    that balance are asked for, not rest.
    """
    free = ring_stack(approach=APPROACH, high_share=SHARE, motion="full", preload_x=4e-3)
    leaning = replace(free.balance.floating, wall_stiffness=1e6)
    held = replace(free, balance=replace(free.balance, floating=leaning))
    found, loose = (_settled(s, HIGH, 2e-6, stable=False).balance for s in (held, free))
    state, tilt = found.states[0], found.position[2]
    moment = (state.film_force() + state.back_force(loads(HIGH).back))[2]
    assert moment == pytest.approx(1e6 * tilt, rel=1e-3)
    assert 0.0 < abs(tilt) < 0.5 * abs(loose.position[2])


def test_smooth_friction_peaks_at_the_breakaway_speed() -> None:
    """Eq. 15 of Thiagarajan et al.: odd, F_brk at v_brk, F_c far above."""
    law = HousingFriction(coulomb_force=40.0, breakaway_speed=6.45e-3, law="stribeck")
    speeds = np.linspace(0.1e-3, 30e-3, 3000)
    forces = np.array([law.force(v)[0] for v in speeds])
    assert speeds[np.argmax(forces)] == pytest.approx(6.45e-3, rel=0.02)
    assert forces.max() == pytest.approx(100.0, rel=1e-3)
    assert law.force(0.2)[0] == pytest.approx(40.0, rel=1e-6)
    assert law.force(-4e-3)[0] == -law.force(4e-3)[0]
    for v in (1e-5, 3e-3, 9e-3):
        slope = (law.force(v * (1 + 1e-6))[0] - law.force(v * (1 - 1e-6))[0]) / (2e-6 * v)
        assert law.force(v)[1] == pytest.approx(slope, rel=1e-5)


def test_wall_force_is_the_magnitude_of_the_vector_sum() -> None:
    contact = HousingContact(area=900e-6)
    assert normal_force(contact, 70e5, np.array([-100.0, 0.0])) == pytest.approx(6400.0)
    assert normal_force(contact, 70e5, np.array([6300.0, 500.0])) == pytest.approx(500.0)


def test_stick_holds_below_breakaway_and_slides_down_to_coulomb_force() -> None:
    stack = ring_stack(approach=APPROACH, high_share=SHARE)
    free = _settled(stack, HIGH, 2e-6).balance
    start = free.position * 1.15
    net = _net_force(stack, start, HIGH)
    assert net < 0.0
    held = _settled(stack, HIGH, start, coulomb=abs(net) / 2.0)
    assert held.balance.position[0] == pytest.approx(start[0], abs=1e-12)
    assert held.balance.friction[0] == pytest.approx(-net, rel=1e-3)
    slid = _settled(stack, HIGH, start, coulomb=abs(net) / 4.0)
    assert slid.balance.position[0] < start[0]
    assert slid.balance.friction[0] == pytest.approx(abs(net) / 4.0, rel=1e-2)
    assert slid.balance.position[0] > free.position[0]


def _net_force(stack: Stack, position: np.ndarray, high: float) -> float:
    """Force on the bearing when the gear stands in the middle. [N]."""
    q = position.copy()
    q[3] = 0.5 * q[0]
    state = _solved(stack, q, high)
    return float((state.film_force() + state.back_force(BackPressure(high, LOW, LOW)))[0])


def test_smooth_friction_creeps_where_stick_holds() -> None:
    stack = ring_stack(approach=APPROACH, high_share=SHARE)
    start = _settled(stack, HIGH, 2e-6).balance.position * 1.15
    coulomb = abs(_net_force(stack, start, HIGH)) / 2.0
    creeps = _settled(stack, HIGH, start, coulomb, law="stribeck").balance.position[0]
    assert creeps < start[0] - 1e-9


def _loop(coulomb: float) -> np.ndarray:
    """Positions as the pressure goes up and down."""
    stack = ring_stack(approach=APPROACH, high_share=0.68, preload=400.0, cells=(12, 10))
    now: float | np.ndarray = 0.8e-6
    positions = []
    for high in (20e5, 40e5, 60e5, 40e5, 20e5):
        found = _settled(stack, high, now, coulomb * high / 60e5)
        assert found.settled
        now = found.balance.position
        positions.append(now[0])
    return np.array(positions)


@pytest.mark.slow
def test_loop_of_positions_opens_with_friction_and_closes_without() -> None:
    free, rubbed = _loop(0.0), _loop(60.0)
    assert free[3:] == pytest.approx(free[1::-1], rel=1e-4)
    assert np.all(np.diff(free[:3]) > 0.0)
    assert np.all(np.diff(rubbed[:3]) >= 0.0)
    assert np.all(rubbed[3:] > rubbed[1::-1] + 1e-8)


def test_march_over_the_revolution_keeps_its_equilibrium() -> None:
    """Steady pressures: implicit steps stay where the search came to rest."""
    stack = ring_stack(approach=APPROACH, high_share=SHARE)
    rest = _settled(stack, HIGH, 2e-6).balance
    angles = np.arange(1, 7) * np.pi / 3.0
    settings = StepSettings()
    for balance in march_angles(
        stack, lambda _: pressures(HIGH), loads(HIGH), rest, angles, settings
    ):
        assert balance.converged
        assert balance.position[0] == pytest.approx(rest.position[0], rel=1e-5)


def test_squeeze_slows_the_closing_bearing() -> None:
    """A step of pressure: the gap closes with the time constant of damping over stiffness."""
    stack = ring_stack(approach=APPROACH, high_share=SHARE)
    rest = _settled(stack, HIGH, 2e-6).balance
    angles = np.arange(1, 21) * 0.5
    higher = loads(HIGH)._replace(back=BackPressure(1.05 * HIGH, LOW, LOW))
    march = march_angles(stack, lambda _: pressures(HIGH), higher, rest, angles, StepSettings())
    path = np.array([rest.position[0]] + [b.position[0] for b in march])
    assert np.all(np.diff(path) < 0.0)
    assert abs(path[1] - path[0]) > 2.0 * abs(path[-1] - path[-2])


@pytest.mark.parametrize("fluid", [FilmFluid(VISCOSITY), THICKENING])
def test_powers_of_a_film_balance(fluid: FilmFluid) -> None:
    """Shear and pressure drive what flow dissipates; approaching faces add their work."""
    stack = _of(ring_stack(approach=APPROACH, rough=False, limit=0.0), fluid)
    v = np.zeros(stack.size)
    v[0] = -1e-4
    q = stack.start(4e-6)
    lost = _solved(stack, q, v=v).films[0].losses
    assert lost.dissipation == pytest.approx(lost.shear + lost.pressure - lost.squeeze, rel=1e-9)
    assert lost.squeeze < 0.0


@dataclass(frozen=True)
class _HalfFace:
    """Film on the half with y > 0, from high pressure at angle zero to low pressure."""

    def __call__(self, shaft_angle: float, x: np.ndarray, y: np.ndarray) -> FaceCells:
        inside = np.hypot(x, y) <= OUTER
        film = inside & (y > 0.0)
        open_to = np.where(x > 0.0, HIGH_NODE, LOW_NODE)
        return FaceCells(np.where(film, FILM, open_to), np.where(film, 0, NO_BODY))


def test_flow_that_pressure_drives_pulls_the_face_along_at_any_speed() -> None:
    """Between parallel faces the shear is h/2 dp/ds, so every arc pulls with h/2 r per drop."""
    height, drop = 4e-6, HIGH - LOW
    wanted = -0.5 * height * drop * 0.5 * (OUTER**2 - INNER**2)
    sheared = []
    for speed in (300.0, 600.0):
        stack = ring_stack(rough=False, speed=speed)
        halves = tuple(
            replace(i, face=replace(i.face, face_map=_HalfFace())) for i in stack.balance.interfaces
        )
        grids = tuple(FaceGrid(i, 36, 10) for i in halves)
        stack = replace(stack, balance=replace(stack.balance, interfaces=halves), grids=grids)
        lost = _solved(stack, stack.start(height)).films[0].losses
        assert lost.drag / speed == pytest.approx(wanted, rel=1e-6)
        sheared.append((lost.shear - lost.drag) / speed)
    assert sheared[1] == pytest.approx(2.0 * sheared[0], rel=1e-9)


def test_seat_of_the_solid_bearing_is_where_the_film_presses() -> None:
    """High pressure on the +x side presses beside the middle."""
    stack = ring_stack(limit=0.0, rough=False)
    state = _solved(stack, stack.start(4e-6))
    force, about_x, about_y = state.hold_down(LOW)
    film = state.films[1]
    push = float(((film.pressure - LOW) * film.grid.area).sum())
    place = float(((film.pressure - LOW) * film.grid.area * film.grid.points.x).sum()) / push
    assert force == pytest.approx(push, rel=1e-9)
    assert -about_y / force == pytest.approx(place, rel=1e-9)
    assert state.tipping_margin(LOW) == pytest.approx(OUTER - np.hypot(place, about_x / force))
    assert place > 1e-3


def test_solid_bearing_that_lifts_off_or_tips_is_reported() -> None:
    stack = ring_stack(limit=0.0, rough=False)
    problem = LateralProblem(
        stack,
        (stack.snapshot(0.0, pressures(HIGH)),),
        loads(HIGH),
        lambda _: pressures(HIGH),
        LateralSettings(),
    )
    numbers = numbers_of(problem, problem.started(4e-6))
    assert hold_down_warning(numbers) == ""
    assert "tips on its cover" in hold_down_warning(replace(numbers, tipping_margin=-1e-3))
    assert "lifts off its cover: 12 N" in hold_down_warning(replace(numbers, hold_down_force=-12.0))


def test_axial_force_of_helical_teeth_presses_the_gear_to_the_floating_side() -> None:
    """Positive along z: the floating film carries it, the solid one is relieved of it."""
    push = 200.0
    stack = ring_stack(approach=APPROACH, high_share=SHARE)
    helical = replace(stack, balance=replace(stack.balance, body_forces=(AxialForce(push),)))
    plain, pushed = (_settled(s, HIGH, 2e-6).balance for s in (stack, helical))
    carried = []
    for state in (plain.states[0], pushed.states[0]):
        carried.append([float(((f.total - LOW) * f.grid.area).sum()) for f in state.films])
    assert carried[0][0] == pytest.approx(carried[0][1], rel=1e-5)
    assert carried[1][0] == pytest.approx(carried[0][0], rel=1e-5)
    assert carried[1][0] - carried[1][1] == pytest.approx(push, rel=1e-3)
    near, far = (float(f.gap.mean()) for f in pushed.states[0].films)
    assert near < far
    seats = [float(b.states[0].hold_down(LOW)[0]) for b in (plain, pushed)]
    assert seats[0] - seats[1] == pytest.approx(push, rel=1e-3)


def test_axial_force_of_the_teeth_tilts_the_gear_until_films_take_its_moment() -> None:
    """The floating bearing follows, so that the film on the solid side takes all of it."""
    push, arm = 100.0, 15e-3
    stack = ring_stack(approach=APPROACH, high_share=SHARE, motion="full")
    forces = (AxialForce(push, (0.0, arm)),)
    helical = replace(stack, balance=replace(stack.balance, body_forces=forces))
    state = _settled(helical, HIGH, 2e-6).balance.states[0]
    floating, solid = (film.covered_load for film in state.films)
    assert floating - solid == pytest.approx([push, push * arm, 0.0], rel=1e-3, abs=1e-3)
    assert helical.tilts(state.position)[0] > 1e-5
    bearing, gear = (state.position[k + 1 : k + 3] for k in (0, helical.first_body))
    assert gear == pytest.approx(bearing, rel=1e-3)


@pytest.mark.parametrize("push", [-150.0, 150.0])
def test_thrust_between_two_floating_bearings_holds_one_of_them_on_its_cover(push: float) -> None:
    """That one is then a solid bearing: films are those of one pressed and one solid."""
    both, one = (
        ring_stack(approach=APPROACH, high_share=SHARE, arrangement=arrangement)
        for arrangement in ("symmetric", "asymmetric")
    )
    gaps = []
    for stack, size in ((both, push), (one, -abs(push))):
        balance = replace(stack.balance, body_forces=(AxialForce(size),))
        thrust = replace(stack, balance=balance)
        found = _settled(thrust, HIGH, 2e-6)
        assert found.settled
        assert leaning(thrust, found.balance.position) == []
        gaps.append(found.balance.states[0].mean_gaps())
        if stack is both:
            cover = stop_forces(thrust, found.balance.position)[0]
            assert cover.sum() == pytest.approx(-push, rel=1e-3)
    near_floating = gaps[0] if push < 0.0 else gaps[0][::-1]
    assert near_floating == pytest.approx(gaps[1], rel=1e-4)
    assert gaps[1][1] < 0.95 * gaps[1][0]


def test_films_scale_with_viscosity_and_speed_over_pressure() -> None:
    """Viscosity times speed over pressure is one number: all pressures double with the speed."""
    one = ring_stack(rough=False, limit=0.0, speed=300.0)
    two = ring_stack(rough=False, limit=0.0, speed=600.0)
    place = one.start(4e-6)
    snapshots = [s.snapshot(0.0, k * pressures(HIGH)) for s, k in ((one, 1.0), (two, 2.0))]
    flat = [np.zeros((g.rows, g.lanes)) for g in one.grids]
    still = np.zeros(one.size)
    films = [
        s.solve(snapshot, place, still, None, flat).films[0]
        for s, snapshot in zip((one, two), snapshots, strict=True)
    ]
    np.testing.assert_allclose(films[1].pressure, 2.0 * films[0].pressure, rtol=1e-7)
    lost = [film.losses for film in films]
    assert lost[1].bore_flow == pytest.approx(2.0 * lost[0].bore_flow, rel=1e-7)
    assert lost[1].shear == pytest.approx(4.0 * lost[0].shear, rel=1e-7)
