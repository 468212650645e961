"""The compiled journal map against the quadrature it stands for."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.closures.bearing_map import JournalMap, build_journal_map, journal_force
from toothspace.films.journal.map import _DIRECTIONS, _GAP_STEPS, _scaled


def force_at(state: np.ndarray, speed: float, journal_map: JournalMap) -> np.ndarray:
    ex, ey, vx, vy = state
    return np.array(journal_force(ex, ey, vx, vy, speed, 1.0, 1.0, journal_map))


@pytest.fixture(scope="module", params=[0.25, 0.5, 1.0])
def journal_map(request: pytest.FixtureRequest) -> JournalMap:
    return build_journal_map(request.param)


def quadrature(ecc: float, direction: float, journal_map: JournalMap) -> np.ndarray:
    """Force along and across the eccentricity at unit speed V of the half-speed frame.

    The pressure of ``build_journal_map`` summed over 3600 angles and 40 axial points.
    """
    angle = (np.arange(3600) + 0.5) * (2.0 * np.pi / 3600)
    axial, weights = np.polynomial.legendre.leggauss(40)
    wedge, squeeze = -2.0 * np.sin(direction), np.cos(direction)
    sin, cos = np.sin(angle), np.cos(angle)
    h = 1.0 + ecc * cos
    short = 0.5 * journal_map.length_over_diameter**2 * (wedge * sin - 2.0 * squeeze * cos) / h**3
    short = np.outer(short, 1.0 - axial**2)
    long = wedge * (2.0 + ecc * cos) * sin / ((2.0 + ecc**2) * h**2)
    long = (long + squeeze / ecc * (1.0 / h**2 - 1.0))[:, None]
    film = (short > 0.0) & (long > 0.0)
    line = np.where(film, short * long / np.where(film, short + long, 1.0), 0.0) @ weights
    return 6.0 * np.pi / angle.size * np.array([line @ cos, line @ sin])


@pytest.mark.parametrize("ecc", [0.05, 0.31, 0.5, 0.77, 0.9])
def test_map_equals_the_quadrature(ecc: float, journal_map: JournalMap) -> None:
    """Within 0.2 % of the force, 0.3 % for the shortest bearing."""
    limit = 3e-3 if journal_map.length_over_diameter < 0.3 else 2e-3
    for direction in np.linspace(0.0, 2.0 * np.pi, 37):
        state = np.array([ecc, 0.0, np.cos(direction), np.sin(direction)])
        ours = force_at(state, 0.0, journal_map)[:2]
        expected = quadrature(ecc, direction, journal_map)
        assert np.hypot(*(ours - expected)) < limit * np.hypot(*expected)


def test_finer_map_is_the_same_to_two_per_mille() -> None:
    """Refinement of grid and quadrature together, up to an eccentricity ratio of 0.98."""
    coarse = build_journal_map(0.5)
    fine = build_journal_map(0.5, rows=127, columns=640, points=400)
    for ecc in (0.2, 0.6, 0.85, 0.95, 0.98):
        for direction in np.linspace(0.03, 2.0 * np.pi, 41):
            state = np.array([ecc, 0.0, np.cos(direction), np.sin(direction)])
            one, other = force_at(state, 0.0, coarse)[:2], force_at(state, 0.0, fine)[:2]
            assert np.hypot(*(one - other)) < 2e-3 * np.hypot(*other)


def test_steady_rotation_is_the_half_speed_frame(journal_map: JournalMap) -> None:
    """A journal at rest that rotates, in any direction of the eccentricity."""
    radial, cross = 0.6 * quadrature(0.6, -0.5 * np.pi, journal_map) * np.array([-1.0, 1.0])
    for angle in (0.0, 1.0, 4.0):
        e = 0.6 * np.array([np.cos(angle), np.sin(angle)])
        along, across = e / 0.6, np.array([-e[1], e[0]]) / 0.6
        ours = force_at(np.array([*e, 0.0, 0.0]), 2.0, journal_map)[:2]
        assert ours == pytest.approx(-radial * along + cross * across, abs=3e-3 * radial)
        # turning with half the speed leaves no wedge
        spin = across * 0.6 * 1.0
        still = force_at(np.array([*e, *spin]), 2.0, journal_map)[:2]
        assert np.hypot(*still) < 1e-9 * radial


def test_derivatives_are_those_of_the_force(journal_map: JournalMap) -> None:
    rng = np.random.default_rng(7)
    for _ in range(60):
        state = np.array([*rng.uniform(-0.65, 0.65, 2), *rng.normal(size=2)])
        speed = 2.0 * rng.normal()
        given = force_at(state, speed, journal_map)[2:].reshape(2, 4)
        numerical = np.empty((2, 4))
        for k in range(4):
            step = np.zeros(4)
            step[k] = 1e-6
            ends = [force_at(state + s * step, speed, journal_map)[:2] for s in (-1.0, 1.0)]
            numerical[:, k] = (ends[1] - ends[0]) / 2e-6
        assert given == pytest.approx(numerical, abs=2e-3 * np.abs(numerical).max())


def test_force_is_continuous_and_bounded_when_centred_or_at_rest(journal_map: JournalMap) -> None:
    centre = force_at(np.array([0.0, 0.0, 0.3, 0.4]), 1.0, journal_map)
    for angle in np.linspace(0.0, 6.0, 7):
        near = np.array([1e-7 * np.cos(angle), 1e-7 * np.sin(angle), 0.3, 0.4])
        force = force_at(near, 1.0, journal_map)
        assert force[:2] == pytest.approx(centre[:2], rel=1e-5)
        assert np.all(np.isfinite(force))
    # squeeze of a centred journal: against the velocity
    assert centre[0] / 0.3 == pytest.approx(centre[1] / 0.4, rel=1e-3)
    assert centre[0] < 0.0
    assert np.all(np.isfinite(force_at(np.zeros(4), 0.0, journal_map)))
    assert np.abs(force_at(np.array([0.5, 0.0, 0.0, 0.0]), 0.0, journal_map)[:2]).max() < 1e-9


def test_force_stays_finite_beyond_the_clearance(journal_map: JournalMap) -> None:
    forces = [
        force_at(np.array([e, 0.0, 1.0, 0.0]), 0.0, journal_map)[0]
        for e in (0.99, 0.9985, 1.0, 2.0)
    ]
    assert np.all(np.diff(forces) <= 0.0)
    assert np.isfinite(forces[-1])
    assert forces[-1] > 2.0 * forces[-2]


def test_film_takes_energy_out_of_any_motion(journal_map: JournalMap) -> None:
    """F . V is never positive in the frame of half the speed."""
    rng = np.random.default_rng(3)
    for _ in range(200):
        angle, size = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.0, 0.98)
        v = rng.normal(size=2)
        state = np.array([size * np.cos(angle), size * np.sin(angle), *v])
        assert force_at(state, 0.0, journal_map)[:2] @ v <= 0.0


def test_a_map_of_solved_films_that_are_the_closed_form_is_its_map(journal_map: JournalMap) -> None:
    """Between its nodes too; half the ratio of solved to closed form is half the force."""
    ratio = np.ones((_GAP_STEPS.size, _DIRECTIONS.size), dtype=complex)
    same = journal_map._replace(nodes=_scaled(journal_map.nodes, journal_map.logarithm_step, ratio))
    half = journal_map._replace(
        nodes=_scaled(journal_map.nodes, journal_map.logarithm_step, 0.5 * ratio)
    )
    for ecc in (0.33, 0.81):
        for direction in np.linspace(0.04, 2.0 * np.pi, 23):
            state = np.array([ecc, 0.0, np.cos(direction), np.sin(direction)])
            expected = force_at(state, 0.0, journal_map)
            size = np.hypot(*expected[:2])
            assert np.hypot(*(force_at(state, 0.0, same) - expected)[:2]) < 2e-3 * size
            assert np.hypot(*(force_at(state, 0.0, half) - 0.5 * expected)[:2]) < 2e-3 * size


def test_a_ratio_of_solved_to_closed_form_is_that_of_its_place(journal_map: JournalMap) -> None:
    """Length and angle that grow with the step of the gap and differ by direction, mirrored."""

    def ratio(step: np.ndarray | float, direction: np.ndarray | float) -> np.ndarray:
        size = (1.0 + 0.1 * np.asarray(step)) * (1.0 + 0.2 * np.cos(direction))
        return np.asarray(size * np.exp(0.2j * np.sin(direction)))

    given = ratio(_GAP_STEPS[:, None], _DIRECTIONS)
    nodes = _scaled(journal_map.nodes, journal_map.logarithm_step, given)
    scaled = journal_map._replace(nodes=nodes)
    for ecc in (0.33, 0.81, 0.98):
        for direction in np.linspace(0.04, 2.0 * np.pi, 23):
            state = np.array([ecc, 0.0, np.cos(direction), np.sin(direction)])
            closed = complex(*force_at(state, 0.0, journal_map)[:2])
            found = complex(*force_at(state, 0.0, scaled)[:2])
            expected = closed * ratio(-np.log(1.0 - ecc), direction)
            assert abs(found - expected) < 3e-3 * abs(expected)
    # beyond the last sample its ratio
    for direction in (0.4, 3.0, 5.0):
        state = np.array([0.996, 0.0, np.cos(direction), np.sin(direction)])
        closed = complex(*force_at(state, 0.0, journal_map)[:2])
        found = complex(*force_at(state, 0.0, scaled)[:2])
        expected = closed * ratio(_GAP_STEPS[-1], direction)
        assert abs(found - expected) < 5e-3 * abs(expected)


def test_the_slope_by_turning_is_rounded_over_a_thousandth_of_the_clearance(
    journal_map: JournalMap,
) -> None:
    """e^2/(e^2 + 1e-6) of it: half at a thousandth, 0.9 at three, whole further out."""
    for ecc, share in ((1e-3, 0.5), (3e-3, 0.9), (0.1, 1.0)):
        state, step = np.array([ecc, 0.0, -0.2, 0.7]), np.array([0.0, 1e-2 * ecc, 0.0, 0.0])
        ends = [force_at(state + sign * step, 0.0, journal_map)[1] for sign in (-1.0, 1.0)]
        slope = force_at(state, 0.0, journal_map)[2:].reshape(2, 4)[1, 1]
        assert slope == pytest.approx(share * (ends[1] - ends[0]) / (2e-2 * ecc), rel=1e-3)
