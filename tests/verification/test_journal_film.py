"""Journal film against closed forms, symmetries and its own central differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.films import Groove, JournalBearing, RoughSurfaces
from toothspace.films.journal.geometry import MotionState, SurfaceSpeed
from toothspace.films.journal.solution import solve_motion

SPEED = 300.0
GROOVED = JournalBearing(
    diameter=0.06,
    length=0.04,
    radial_clearance=60e-6,
    dynamic_viscosity=0.02,
    grid=(72, 19),
    grooves=(Groove(np.radians(100.0), np.radians(25.0), 0.028, 2.5e5),),
    end_pressure=1.2e5,
    cavitation_pressure=0.9e5,
)

PLAIN = replace(GROOVED, grooves=(), grid=(48, 9), supply="none")


def _half_sommerfeld(bearing: JournalBearing, ratio: float) -> tuple[float, float]:
    """Force against and across the eccentricity of an endless bearing, negative pressures cut.

    Sommerfeld (1904) integrals over the half with positive pressure.
    """
    radius = 0.5 * bearing.diameter
    unit = bearing.dynamic_viscosity * SPEED * radius * bearing.length
    unit *= (radius / bearing.radial_clearance) ** 2
    common = 2.0 + ratio**2
    against = 12.0 * unit * ratio**2 / (common * (1.0 - ratio**2))
    across = 6.0 * np.pi * unit * ratio / (common * np.sqrt(1.0 - ratio**2))
    return against, across


def _endless(rows: int) -> JournalBearing:
    return JournalBearing(
        diameter=0.06,
        length=0.04,
        radial_clearance=60e-6,
        dynamic_viscosity=0.02,
        grid=(rows, 4),
        cavitation="guembel",
        end_condition="no_flow",
    )


def test_endless_bearing_converges_with_second_order() -> None:
    """Measured order of the force on three grids."""
    exact = np.array(_half_sommerfeld(_endless(40), 0.6))
    errors = []
    for rows in (40, 80, 160):
        film = _endless(rows).solve(eccentricity=(0.6, 0.0), shaft_speed=SPEED)
        errors.append(np.abs(np.array([-film.force[0], film.force[1]]) / exact - 1.0))
    order = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert errors[-1].max() < 2e-3
    assert order == pytest.approx(2.0, abs=0.15)


def test_short_bearing() -> None:
    """Ocvirk's short bearing; its error is of the order of (L/D)^2."""
    bearing = replace(
        GROOVED, length=0.003, grooves=(), cavitation="guembel", grid=(360, 31), end_pressure=0.9e5
    )
    ratio = 0.5
    film = bearing.solve(eccentricity=(ratio, 0.0), shaft_speed=SPEED)
    radius = 0.5 * bearing.diameter
    unit = bearing.dynamic_viscosity * SPEED * radius * bearing.length
    unit *= (radius / bearing.radial_clearance) ** 2 * (bearing.length / bearing.diameter) ** 2
    expected = np.array(
        [
            -4.0 * ratio**2 / (1.0 - ratio**2) ** 2,
            np.pi * ratio / (1.0 - ratio**2) ** 1.5,
        ]
    )
    assert film.force / unit == pytest.approx(expected, rel=0.01)


def test_concentric_shaft_has_petroff_friction() -> None:
    bearing = replace(GROOVED, grooves=())
    film = bearing.solve(shaft_speed=SPEED)
    radius = 0.5 * bearing.diameter
    petroff = bearing.dynamic_viscosity * SPEED * radius**3 * 2.0 * np.pi * bearing.length
    assert film.friction_torque == pytest.approx(-petroff / bearing.radial_clearance, rel=1e-9)
    assert film.load < 1e-9 * petroff / bearing.radial_clearance / radius


@pytest.mark.parametrize("cavitation", ["jfo", "reynolds", "guembel"])
def test_coefficients_are_the_derivative_of_the_discrete_film(cavitation: str) -> None:
    """Position 1e-11 m and rotation 1e-9 rad keep the cavity boundary in its cells."""
    bearing = replace(GROOVED, cavitation=cavitation)
    speed = SurfaceSpeed(SPEED)
    place = np.array([0.33, -0.21, 0.0, 0.0]) * bearing.radial_clearance
    place[2:] = 3e-4, -2e-4
    film = solve_motion(bearing, MotionState(place, np.zeros(4)), speed)
    exact = np.hstack(film.coefficients())
    numeric = np.zeros((4, 8))
    for k, step in enumerate((1e-11, 1e-11, 1e-9, 1e-9, 1e-8, 1e-8, 1e-7, 1e-7)):
        loads = []
        for sign in (1.0, -1.0):
            state = np.concatenate([place, np.zeros(4)])
            state[k] += sign * step
            varied = solve_motion(bearing, MotionState(state[:4], state[4:]), speed)
            loads.append(np.concatenate([varied.force, varied.moment]))
        numeric[:, k] = -(loads[0] - loads[1]) / (2.0 * step)
    error = np.abs(exact - numeric).max(axis=0) / np.abs(numeric).max(axis=0)
    assert error.max() < 1e-6


def test_half_film_equals_whole_film() -> None:
    for lanes in (18, 19):
        bearing = replace(GROOVED, grid=(72, lanes))
        motion = MotionState(np.array([20e-6, 10e-6, 0.0, 0.0]), np.zeros(4))
        half = solve_motion(bearing, motion, SurfaceSpeed(SPEED), half=True)
        whole = solve_motion(bearing, motion, SurfaceSpeed(SPEED), half=False)
        assert half.force == pytest.approx(whole.force, rel=1e-10)
        assert half.pressure == pytest.approx(whole.pressure, rel=1e-9)
        assert half.side_flow == pytest.approx(whole.side_flow, rel=1e-9)
        assert half.stiffness == pytest.approx(whole.stiffness, rel=1e-8)


def test_turning_the_frame_turns_the_forces() -> None:
    """A quarter turn of everything is a shift of the cells."""
    groove = GROOVED.grooves[0]
    turned = replace(GROOVED, grooves=(replace(groove, angle=groove.angle + np.pi / 2),))
    film = GROOVED.solve(eccentricity=(0.5, 0.2), shaft_speed=SPEED)
    other = turned.solve(eccentricity=(-0.2, 0.5), shaft_speed=SPEED)
    assert other.force == pytest.approx([-film.force[1], film.force[0]], rel=1e-9)
    assert other.attitude_angle == pytest.approx(film.attitude_angle, rel=1e-9)


def test_mirrored_rotation_mirrors_the_forces() -> None:
    groove = GROOVED.grooves[0]
    mirrored = replace(GROOVED, grooves=(replace(groove, angle=-groove.angle),))
    film = GROOVED.solve(eccentricity=(0.5, 0.2), shaft_speed=SPEED)
    other = mirrored.solve(eccentricity=(0.5, -0.2), shaft_speed=-SPEED)
    assert other.force == pytest.approx([film.force[0], -film.force[1]], rel=1e-9)
    assert other.friction_torque == pytest.approx(-film.friction_torque, rel=1e-9)


@pytest.mark.parametrize(
    ("eccentricity", "tilt"),
    [((0.1, 0.0), (0.0, 0.0)), ((0.6, -0.5), (0.0, 0.0)), ((-0.2, 0.4), (8e-4, -6e-4))],
)
def test_mass_is_conserved(eccentricity: tuple[float, float], tilt: tuple[float, float]) -> None:
    film = GROOVED.solve(eccentricity=eccentricity, tilt=tilt, shaft_speed=SPEED)
    assert film.status.succeeded
    assert film.mass_balance_error < 1e-10
    assert film.supply_flow == pytest.approx(film.side_flow, rel=1e-9)


def test_complementarity_of_pressure_and_film_fraction() -> None:
    film = GROOVED.solve(eccentricity=(0.7, 0.0), shaft_speed=SPEED)
    excess = film.pressure - GROOVED.cavitation_pressure
    empty = 1.0 - film.film_fraction
    assert excess.min() >= 0.0
    assert empty.min() >= 0.0
    assert float((excess * empty).max()) == 0.0
    assert 0.05 < film.cavitated_fraction < 0.6


def test_equilibrium_carries_the_load() -> None:
    for load in ((30.0, -20.0), (4e3, 1e3), (2e5, 0.0)):
        film = GROOVED.equilibrium(load=load, shaft_speed=SPEED)
        assert film.status.succeeded
        assert film.force == pytest.approx(
            [-load[0], -load[1]], rel=1e-6, abs=1e-6 * np.hypot(*load)
        )


def test_squeeze_of_an_endless_bearing_opposes_the_motion() -> None:
    """Damping is positive definite and the film pushes against the velocity."""
    film = GROOVED.solve(eccentricity=(0.5, 0.0), shaft_speed=0.0, velocity=(0.01, 0.0))
    assert film.force[0] < 0.0
    damping = GROOVED.solve(eccentricity=(0.5, 0.0), shaft_speed=SPEED).damping
    assert np.linalg.eigvalsh(damping + damping.T).min() > 0.0


def test_contact_is_refused_with_one_line() -> None:
    with pytest.raises(CaseError, match=r"eccentricity ratio of 1\.02"):
        GROOVED.solve(eccentricity=(1.02, 0.0), shaft_speed=SPEED)
    with pytest.raises(CaseError, match=r"bearing\.cavitation: found 'elrod'"):
        replace(GROOVED, cavitation="elrod")


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_light_load_against_the_pressure_of_grooves_finds_its_equilibrium(turn: float) -> None:
    """Two grooves push forty times harder than the load: Newton's method alone jumps about."""
    bearing = JournalBearing(
        diameter=0.02,
        length=0.02,
        radial_clearance=18e-6,
        dynamic_viscosity=0.02,
        grid=(134, 13),
        cavitation="reynolds",
        grooves=(Groove(5.98, 0.361, 0.0169, 4.8e5), Groove(4.19, 0.455, 0.0132, 2.87e5)),
        cavitation_pressure=0.0,
    )
    load = np.array([-27.85, -12.04])
    film = bearing.equilibrium(load=(load[0], load[1]), shaft_speed=0.597 * turn)
    assert film.status.succeeded
    np.testing.assert_allclose(film.force, -load, atol=1e-6)


def test_groove_below_the_pressure_of_the_cavity_holds_a_cavity() -> None:
    """1 bar in a groove under an atmospheric cavity: as at cavity pressure, and mass is kept."""
    films = []
    for pressure in (1.0e5, 101325.0):
        bearing = JournalBearing(
            diameter=0.02,
            length=0.02,
            radial_clearance=1e-5,
            dynamic_viscosity=0.02,
            grid=(64, 10),
            grooves=(Groove(1.0, 0.4, 0.01, pressure),),
        )
        films.append(bearing.solve(eccentricity=(0.6, 0.0), shaft_speed=100.0))
    assert films[0].mass_balance_error < 1e-10
    np.testing.assert_allclose(films[0].force, films[1].force, rtol=1e-9)


@pytest.mark.parametrize("moment", [(0.0, 0.0), (0.8, -1.5)])
def test_shaft_free_to_tilt_carries_a_moment(moment: tuple[float, float]) -> None:
    """Force and moment balance; without a moment the tilted search ends where the parallel does."""
    bearing = JournalBearing(
        diameter=0.02,
        length=0.02,
        radial_clearance=1.5e-5,
        dynamic_viscosity=0.02,
        grid=(64, 12),
        cavitation="reynolds",
    )
    film = bearing.equilibrium(load=(400.0, 0.0), shaft_speed=150.0, moment=moment)
    assert film.status.succeeded
    np.testing.assert_allclose(film.force, (-400.0, 0.0), atol=1e-5)
    np.testing.assert_allclose(film.moment, (-moment[0], -moment[1]), atol=1e-7)
    if moment == (0.0, 0.0):
        parallel = bearing.equilibrium(load=(400.0, 0.0), shaft_speed=150.0)
        np.testing.assert_allclose(film.eccentricity, parallel.eccentricity, atol=1e-6)
    else:
        assert np.hypot(*film.motion.place[2:]) > 1e-5


@pytest.mark.parametrize(
    ("length", "grid", "grooves", "end_pressure", "eccentricity", "velocity"),
    [
        (0.04, (45, 13), (), 0.0, (-0.066, -0.518), (9.76e-4, 3.02e-4)),
        (
            0.01,
            (49, 14),
            (Groove(2.795, 0.0785, 0.004, 1e5),),
            8e5,
            (0.06, -0.733),
            (-1.367e-3, 1.105e-3),
        ),
    ],
)
def test_film_squeezed_faster_than_it_flows_settles(
    length: float,
    grid: tuple[int, int],
    grooves: tuple[Groove, ...],
    end_pressure: float,
    eccentricity: tuple[float, float],
    velocity: tuple[float, float],
) -> None:
    """Two of twenty thousand random films on which the active set alone goes in circles."""
    film = JournalBearing(
        diameter=0.05,
        length=length,
        radial_clearance=40e-6,
        dynamic_viscosity=0.02,
        grid=grid,
        grooves=grooves,
        end_pressure=end_pressure,
        cavitation_pressure=0.0,
        end_condition="no_flow",
    ).solve(eccentricity=eccentricity, shaft_speed=30.0, velocity=velocity)
    fields = film.solved.fields
    assert film.status is Status.DONE
    assert film.mass_balance_error < 1e-12
    assert fields.saturation.max() <= 1.0 + 1e-9
    assert fields.saturation.min() >= 0.0
    assert np.all((fields.potential == 0.0) | (fields.saturation == 1.0))


def test_a_bush_that_turns_is_the_film_of_its_own_walls() -> None:
    """Rough walls change places: with the bush in place of the shaft the film is the same."""
    rough = {"moving_roughness": 6e-6, "resting_roughness": 2e-6}
    swapped = {"moving_roughness": 2e-6, "resting_roughness": 6e-6}
    one, other = (
        replace(PLAIN, surfaces=RoughSurfaces(**walls, contact_law="none"))
        for walls in (rough, swapped)
    )
    shaft = one.solve(eccentricity=(0.5, 0.1), shaft_speed=100.0)
    bush = other.solve(eccentricity=(0.5, 0.1), shaft_speed=0.0, bush_speed=100.0)
    assert bush.force == pytest.approx(shaft.force, rel=1e-9)
    wrong = one.solve(eccentricity=(0.5, 0.1), shaft_speed=0.0, bush_speed=100.0)
    assert wrong.force != pytest.approx(shaft.force, rel=1e-3)


def test_numbers_of_a_journal_by_hand() -> None:
    """Both walls turn: S = (eta N/P)(R/c)^2 of the sum of their speeds; lanes about the middle."""
    film = PLAIN.solve(eccentricity=(0.5, 0.0), shaft_speed=90.0, bush_speed=30.0)
    pressure = film.load / (PLAIN.diameter * PLAIN.length)
    turns = 120.0 / (2.0 * np.pi)
    ratio = 0.5 * PLAIN.diameter / PLAIN.radial_clearance
    number = PLAIN.dynamic_viscosity * turns / pressure * ratio**2
    assert film.sommerfeld_number == pytest.approx(number, rel=1e-9)
    lanes = PLAIN.grid[1]
    edges = np.linspace(-0.5 * PLAIN.length, 0.5 * PLAIN.length, lanes + 1)
    assert film.axial_position == pytest.approx(0.5 * (edges[1:] + edges[:-1]), abs=1e-15)


def test_a_shaft_that_approaches_heats_its_film_by_its_work() -> None:
    """It does not turn, and the oil leaves at no pressure: F v and M times the rate of tilt."""
    open_ends = replace(PLAIN, end_pressure=0.0, cavitation_pressure=0.0)
    film = open_ends.solve(shaft_speed=0.0, velocity=(2e-3, -1e-3), tilt_rate=(0.3, 0.2))
    work = -film.force @ [2e-3, -1e-3] - film.moment @ [0.3, 0.2]
    assert film.moment @ [0.3, 0.2] < -0.01 * work
    assert film.dissipated_power == pytest.approx(work, rel=1e-6)
