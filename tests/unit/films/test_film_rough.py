"""Flow factors, contact laws and their use in a film."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from tests.reference_formulas.rough_contact import contact_factor_fit
from toothspace.closures import flow_factors as ff
from toothspace.closures.contact_rough import (
    asperity_force,
    asperity_pressure,
    exceedance_moment,
    greenwood_tripp_pressure,
    kogut_etsion_pressure,
    mean_gap_ratio,
    real_contact_share,
)
from toothspace.core.errors import CaseError
from toothspace.films import JournalBearing, RoughSurfaces
from toothspace.films.journal.geometry import MotionState, SurfaceSpeed
from toothspace.films.journal.solution import solve_motion
from toothspace.films.reynolds.rough_surfaces import (
    SMALLEST_FLOW_GAP,
    SMOOTH,
    carried_law,
    conductance_law,
    contact_pressure,
    contact_table,
    flow_law,
    pressure_stress,
    squeeze_law,
    stress_factors,
    tabulated,
)

ROUGH = RoughSurfaces(
    moving_roughness=0.3e-6, resting_roughness=0.2e-6, moving_pattern=3.0, resting_pattern=1 / 3
)
BEARING = JournalBearing(
    diameter=18e-3,
    length=19e-3,
    radial_clearance=8e-6,
    dynamic_viscosity=0.026,
    grid=(72, 11),
    surfaces=ROUGH,
)


def test_pressure_factor_of_table_patterns() -> None:
    """Patir and Cheng (1978), table 1, isotropic and longitudinal, H = 2 and 3."""
    isotropic = ff.pattern_columns(1.0)
    value, _ = ff.pressure_flow_factor(2.0, isotropic.pressure, isotropic.weight)
    assert value == pytest.approx(1.0 - 0.90 * np.exp(-1.12), rel=1e-12)
    along = ff.pattern_columns(6.0)
    value, _ = ff.pressure_flow_factor(3.0, along.pressure, along.weight)
    assert value == pytest.approx(1.0 + 0.520 * 3.0**-1.5, rel=1e-12)


def test_factors_are_interpolated_between_patterns() -> None:
    middle = ff.pattern_columns(2.0)
    low, high = ff.pattern_columns(1.0), ff.pattern_columns(3.0)
    for factor in (
        lambda c: ff.pressure_flow_factor(2.0, c.pressure, c.weight)[0],
        lambda c: ff.shear_flow_factor(2.0, c.shear, c.weight)[0],
        lambda c: ff.shear_stress_correction(2.0, c.stress_correction, c.weight),
        lambda c: ff.pressure_stress_factor(2.0, c.pressure_stress, c.weight),
    ):
        assert factor(middle) == pytest.approx(0.5 * (factor(low) + factor(high)), rel=1e-12)


@pytest.mark.parametrize("pattern", [1 / 9, 0.2, 1.0, 2.0, 9.0])
def test_thick_films_are_smooth(pattern: float) -> None:
    columns = ff.pattern_columns(pattern)
    assert ff.pressure_flow_factor(60.0, columns.pressure, columns.weight)[0] == pytest.approx(
        1.0, abs=2.1e-3
    )
    assert ff.shear_flow_factor(60.0, columns.shear, columns.weight)[0] < 1e-5
    assert ff.shear_stress_correction(7.0, columns.stress_correction, columns.weight) == 0.0
    assert 60.0 * ff.shear_stress_factor(60.0) == pytest.approx(1.0, abs=5e-4)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0, 2.9, 3.1, 8.0, 17.9, 18.1, 40.0])
def test_shear_stress_factor_is_the_mean_inverse_gap(ratio: float) -> None:
    """Direct quadrature of the polynomial density, gaps below 0.01 excluded."""

    def density(height: float) -> float:
        return 35.0 / 96.0 * (1.0 - (height / 3.0) ** 2) ** 3 / (ratio + height)

    lowest = max(-3.0, 0.01 - ratio)
    turn = min(lowest + 0.05, 2.9)
    mean = quad(density, lowest, turn)[0] + quad(density, turn, 3.0)[0]
    assert ff.shear_stress_factor(ratio) == pytest.approx(mean, rel=2e-3)


def test_contact_factor_and_its_published_fit() -> None:
    for ratio in np.linspace(0.0, 3.0, 13):
        fit = contact_factor_fit(float(ratio))
        assert fit == pytest.approx(ff.contact_factor(float(ratio)), rel=4e-3)
        step = ff.contact_factor(ratio + 1e-6) - ff.contact_factor(ratio - 1e-6)
        assert ff.contact_factor_slope(float(ratio)) == pytest.approx(step / 2e-6, rel=1e-6)


@pytest.mark.parametrize("pattern", [0.05, 12.0])
def test_patterns_outside_the_tables_are_refused(pattern: float) -> None:
    with pytest.raises(CaseError, match=r"roughness\.pattern"):
        ff.pattern_columns(pattern)


@pytest.mark.parametrize("ratio", [0.3, 0.9, 2.2, 4.5, 6.0])
def test_laws_have_exact_derivatives(ratio: float) -> None:
    law = flow_law(ROUGH, 1.0)
    gap, step = ratio * law.roughness, 1e-5 * law.roughness
    for function in (
        lambda h: conductance_law(h, law, law.along),
        lambda h: conductance_law(h, law, law.across),
        lambda h: carried_law(h, law),
        lambda h: squeeze_law(h, law),
        lambda h: contact_pressure(h, law.roughness, contact_table(ROUGH)),
    ):
        slope = (function(gap + step)[0] - function(gap - step)[0]) / (2.0 * step)
        assert function(gap)[1] == pytest.approx(slope, rel=1e-5, abs=1e-4)


def test_exceedance_moments() -> None:
    """Closed form of order 2 and direct quadrature of order 5/2."""
    for x in (0.0, 1.0, 2.5):
        density = np.exp(-0.5 * x * x) / np.sqrt(2.0 * np.pi)
        above = quad(lambda s: np.exp(-0.5 * s * s) / np.sqrt(2.0 * np.pi), x, 12.0)[0]
        assert exceedance_moment(2.0, x) == pytest.approx(
            (1 + x * x) * above - x * density, rel=1e-6
        )
        direct = quad(lambda s, x=x: (s - x) ** 2.5 * np.exp(-0.5 * s * s), x, 12.0)[0]
        assert exceedance_moment(2.5, x) == pytest.approx(direct / np.sqrt(2 * np.pi), rel=1e-7)


def test_single_asperity_joins_its_regimes() -> None:
    """Published constants are continuous within 4 percent at 1, 6 and 110 critical depths."""
    radius, modulus, hardness = 50e-6, 2e11, 2e9
    critical = (np.pi * (0.454 + 0.41 * 0.3) * hardness / modulus) ** 2 * radius
    for multiple in (1.0, 6.0):
        below, above = asperity_force(
            critical * multiple * np.array([1 - 1e-9, 1 + 1e-9]), radius, modulus, hardness, 0.3
        )
        assert above == pytest.approx(below, rel=0.04)


def test_contact_laws_agree_where_asperities_are_separate() -> None:
    """A sum over elastic summits lies within 15 percent of the boundary element law."""
    for ratio in (1.8, 2.0, 2.2):
        sum_over_summits = kogut_etsion_pressure(ratio, 0.4e-6, 15e-6, 1.55e11, 5e10)
        fitted = asperity_pressure(ratio * 0.4e-6, 0.4e-6, 15e-6, 1.55e11, 5e10)
        assert sum_over_summits == pytest.approx(fitted, rel=0.15)


def test_greenwood_tripp_example() -> None:
    """Hand calculation: 16 sqrt2 pi / 15 * 0.05^2 * 1e11 * sqrt(1e-2) * 0.08056."""
    expected = 16 * np.sqrt(2) * np.pi / 15 * 0.0025 * 1e11 * 0.1 * 0.08056
    assert greenwood_tripp_pressure(1.0, 0.05, 1e-2, 2e11) == pytest.approx(expected, rel=1e-4)


def test_user_table_is_followed() -> None:
    points = ((0.0, 1e8), (1.0, 1e7), (3.0, 1e5))
    surfaces = replace(ROUGH, contact_law="table", contact_points=points)
    table = contact_table(surfaces)
    pressure, _ = contact_pressure(2.0 * surfaces.roughness, surfaces.roughness, table)
    assert pressure == pytest.approx(1e6, rel=1e-3)


def test_stiffness_of_a_mixed_film_is_its_derivative() -> None:
    place = np.array([7.2e-6, 2e-6, 0.0, 0.0])
    speed = SurfaceSpeed(5.0)
    film = solve_motion(BEARING, MotionState(place, np.zeros(4)), speed)
    assert np.hypot(*film.contact_force) > 0.1 * film.load
    fixed = replace(BEARING, supply="none", end_pressure=2e5)
    film = solve_motion(fixed, MotionState(place, np.zeros(4)), speed)
    numeric = np.zeros((2, 2))
    for k in range(2):
        forces = []
        for sign in (1.0, -1.0):
            moved = place.copy()
            moved[k] += sign * 1e-13
            forces.append(solve_motion(fixed, MotionState(moved, np.zeros(4)), speed).force)
        numeric[:, k] = -(forces[0] - forces[1]) / 2e-13
    assert film.stiffness == pytest.approx(numeric, rel=1e-4, abs=1e-5 * np.abs(numeric).max())


def test_slow_shaft_rests_on_its_asperities() -> None:
    """Friction tends to the boundary coefficient when the film carries nothing."""
    film = BEARING.equilibrium(load=(0.0, -2000.0), shaft_speed=1e-4)
    assert film.status.succeeded
    friction = -film.friction_torque / (0.5 * BEARING.diameter * 2000.0)
    assert np.hypot(*film.contact_force) == pytest.approx(2000.0, rel=0.01)
    # pressure normal to the wall sums to more than the load
    assert ROUGH.boundary_friction < friction < 1.2 * ROUGH.boundary_friction


def test_thick_film_does_not_feel_roughness() -> None:
    smooth = replace(BEARING, surfaces=None, radial_clearance=60e-6)
    rough = replace(BEARING, radial_clearance=60e-6)
    a = smooth.solve(eccentricity=(0.3, 0.0), shaft_speed=100.0)
    b = rough.solve(eccentricity=(0.3, 0.0), shaft_speed=100.0)
    assert b.force == pytest.approx(a.force, rel=0.01)
    assert b.friction_torque == pytest.approx(a.friction_torque, rel=1e-3)
    assert b.mass_balance_error < 1e-10


def test_two_smooth_walls_are_refused() -> None:
    with pytest.raises(CaseError, match="two smooth walls"):
        RoughSurfaces(moving_roughness=0.0, resting_roughness=0.0)
    with pytest.raises(CaseError, match="contact_law"):
        replace(ROUGH, contact_law="hertz")


def test_tables_of_thin_films_are_their_laws_from_the_smallest_gap_on() -> None:
    """Values and slopes between the nodes, right above the gap from which on the laws hold."""
    law = flow_law(ROUGH, 0.4)
    size, table = law.roughness, law.table
    for ratio in (*(table.first * np.array([1.001, 1.03, 1.09])), 1.217, 2.011):
        gap = ratio * size
        expected = {
            "along": conductance_law(gap, law, law.along),
            "across": conductance_law(gap, law, law.across),
            "carried": carried_law(gap, law),
            "squeeze": squeeze_law(gap, law),
        }
        units = {"along": (3, 2), "across": (3, 2), "carried": (1, 0), "squeeze": (0, -1)}
        for name, (value, slope) in expected.items():
            found, steep = tabulated(table, getattr(table, name), float(ratio))
            powers = units[name]
            assert found * size ** powers[0] == pytest.approx(value, rel=1e-5, abs=0.0), name
            assert steep * size ** powers[1] == pytest.approx(slope, rel=1e-3, abs=0.0), name


def test_shear_and_stress_factors_of_the_isotropic_pattern_by_hand() -> None:
    """Patir and Cheng (1979), tables 1, 3 and 4; the far branch of the shear factor from H = 5."""
    columns = ff.pattern_columns(1.0)
    near, slope = ff.shear_flow_factor(2.0, columns.shear, columns.weight)
    assert near == pytest.approx(1.899 * 2.0**0.98 * np.exp(-0.92 * 2.0 + 0.05 * 4.0), rel=1e-12)
    assert slope == pytest.approx(near * (0.49 - 0.92 + 0.2), rel=1e-12)
    far, slope = ff.shear_flow_factor(6.0, columns.shear, columns.weight)
    assert far == pytest.approx(1.126 * np.exp(-1.5), rel=1e-12)
    assert slope == pytest.approx(-0.25 * far, rel=1e-12)
    sides = [ff.shear_flow_factor(h, columns.shear, columns.weight)[0] for h in (4.8, 5.2)]
    assert sides[0] == pytest.approx(1.899 * 4.8**0.98 * np.exp(-0.92 * 4.8 + 0.05 * 4.8**2))
    assert sides[1] == pytest.approx(1.126 * np.exp(-1.3))
    correction = ff.shear_stress_correction(2.0, columns.stress_correction, columns.weight)
    assert correction == pytest.approx(11.1 * 2.0**2.31 * np.exp(-2.38 * 2.0 + 0.11 * 4.0))
    assert ff.shear_stress_correction(6.9, columns.stress_correction, columns.weight) > 0.0
    pressed = ff.pressure_stress_factor(2.0, columns.pressure_stress, columns.weight)
    assert pressed == pytest.approx(1.0 - 1.40 * np.exp(-1.32), rel=1e-12)


def test_factors_keep_their_value_below_the_range_of_their_fits() -> None:
    columns = ff.pattern_columns(1.0)
    for factor in (
        lambda h: ff.pressure_flow_factor(h, columns.pressure, columns.weight),
        lambda h: ff.shear_flow_factor(h, columns.shear, columns.weight),
    ):
        assert factor(-0.2) == factor(0.0009)
        assert factor(-0.2)[1] == 0.0
    lowest = 1.0 - 0.90 * np.exp(-0.56 * 0.5)
    assert ff.pressure_flow_factor(0.3, columns.pressure, columns.weight)[0] == pytest.approx(
        lowest
    )
    value = ff.shear_flow_factor(0.0, columns.shear, columns.weight)[0]
    assert value == pytest.approx(1.899 * 1e-3**0.98, rel=1e-3)
    assert ff.shear_stress_correction(-1.0, columns.stress_correction, columns.weight) == 0.0
    assert ff.shear_stress_factor(-1.0) == ff.shear_stress_factor(0.0)


@pytest.mark.parametrize("ratio", [3.2, 5.0, 12.0, 17.9])
def test_without_touching_the_mean_inverse_gap_is_exact(ratio: float) -> None:
    mean = quad(lambda s: 35.0 / 96.0 * (1.0 - s * s / 9.0) ** 3 / (ratio + s), -3.0, 3.0)[0]
    assert ff.shear_stress_factor(ratio) == pytest.approx(mean, rel=1e-9)


@pytest.mark.parametrize("ratio", [18.1, 40.0])
def test_far_walls_have_the_series_of_the_mean_inverse_gap(ratio: float) -> None:
    mean = quad(lambda s: 35.0 / 96.0 * (1.0 - s * s / 9.0) ** 3 / (ratio + s), -3.0, 3.0)[0]
    assert ff.shear_stress_factor(ratio) == pytest.approx(mean, rel=1e-6)


@pytest.mark.parametrize("ratio", [-1.0, 0.0, 0.7, 2.0, 4.0])
def test_mean_gap_is_that_of_gaussian_heights(ratio: float) -> None:
    def gap(s: float) -> float:
        return (ratio + s) * np.exp(-0.5 * s * s) / np.sqrt(2.0 * np.pi)

    assert mean_gap_ratio(ratio) == pytest.approx(quad(gap, -ratio, 12.0)[0], rel=1e-9)


def _at_mean_gap(mean: float, hardness: float) -> float:
    """Pressure of asperities over that of the roughness flattened whole."""
    nominal = brentq(lambda ratio: mean_gap_ratio(ratio) - mean, -5.0, 5.0, xtol=1e-14)
    pressure = asperity_pressure(nominal * 0.4e-6, 0.4e-6, 15e-6, 2e11, hardness)
    return pressure / (np.pi * 2e11 * 0.4e-6 / (2.0 * 15e-6))


def test_asperities_carry_the_published_fits() -> None:
    """Lee and Ren (1996): exponents at mean gaps of one and two roughnesses, summed by hand."""
    unit = np.pi * 2e11 * 0.4e-6 / (2.0 * 15e-6)
    for mean, elastic, plastic in ((1.0, -3.7269779, -2.1007898), (2.0, -5.9926152, -4.2478794)):
        hard, soft = _at_mean_gap(mean, 1e6 * unit), _at_mean_gap(mean, 1e-5 * unit)
        assert hard == pytest.approx(np.exp(elastic), rel=1e-6)
        assert soft == pytest.approx(1e-5 * np.exp(plastic), rel=1e-6)
        equal = np.exp(elastic - plastic) * unit
        assert _at_mean_gap(mean, equal) == pytest.approx(
            np.exp(elastic) / 2.0 ** (1 / 3), rel=1e-6
        )


def test_asperities_let_go_between_three_and_four_roughnesses() -> None:
    """The fit holds up to 3, half of it at 3.5, 5/32 at 3.75, none at 4."""
    for mean, exponent, share in (
        (2.99, -8.320312, 1.0),
        (3.25, -8.963262, 27.0 / 32.0),
        (3.5, -9.598513, 0.5),
        (3.75, -10.252754, 5.0 / 32.0),
    ):
        assert _at_mean_gap(mean, 1e18) == pytest.approx(share * np.exp(exponent), rel=2e-5)
    assert asperity_pressure(4.0 * 0.4e-6, 0.4e-6, 15e-6, 2e11, 1e18) == 0.0
    assert asperity_pressure(9.0 * 0.4e-6, 0.4e-6, 15e-6, 2e11, 1e18) == 0.0


def test_single_asperity_by_hand() -> None:
    """Kogut and Etsion (2002) over the critical load, and the whole area at the hardness."""
    radius, modulus, hardness = 50e-6, 2e11, 2e9
    critical = (np.pi * (0.454 + 0.41 * 0.3) * hardness / modulus) ** 2 * radius
    first = 4.0 / 3.0 * 0.5 * modulus * np.sqrt(radius) * critical**1.5
    depths = critical * np.array([-1.0, 0.5, 0.97, 3.0, 50.0, 105.0, 200.0])
    force = asperity_force(depths, radius, modulus, hardness, 0.3)
    elastic_plastic = [1.03 * 3.0**1.425, 1.40 * 50.0**1.263, 1.40 * 105.0**1.263]
    assert force[:-1] / first == pytest.approx([0.0, 0.5**1.5, 0.97**1.5, *elastic_plastic])
    assert force[-1] == pytest.approx(2.0 * np.pi * radius * 200.0 * critical * hardness)


@pytest.mark.parametrize("ratio", [0.5, 2.0, 3.5])
def test_sum_over_elastic_summits_is_its_integral(ratio: float) -> None:
    """Hertz on summits of 0.1274 per square of the length, with their mean height and spread."""
    size, length, modulus = 0.4e-6, 15e-6, 1.55e11
    density, radius = 0.1274 / length**2, 0.2768 * length**2 / size

    def carried(height: float) -> float:
        share = np.exp(-0.5 * ((height - 1.303) / 0.8373) ** 2) / (0.8373 * np.sqrt(2.0 * np.pi))
        depth = size * (height - ratio)
        return float(share * 4.0 / 3.0 * 0.5 * modulus * np.sqrt(radius) * depth**1.5)

    expected = density * quad(carried, ratio, 1.303 + 8.0 * 0.8373)[0]
    found = kogut_etsion_pressure(ratio, size, length, modulus, 1e15)
    assert found == pytest.approx(expected, rel=1e-5)


def test_real_contact_of_elastic_surfaces_by_hand() -> None:
    """Load over share of area: 0.2346 at once, 0.2346 - 0.0985 + 0.22375 at a quarter."""
    unit = np.pi * 2e11 * 0.4e-6 / (2.0 * 15e-6)
    found = real_contact_share(unit * np.array([1e-12, 0.25]), 0.4e-6, 15e-6, 2e11, 1e15)
    assert found == pytest.approx([1e-12 / 0.2346, 0.25 / 0.35985], rel=1e-5, abs=0.0)


def test_rough_walls_carry_their_mean_gap_and_the_difference_of_their_patterns() -> None:
    """Variances 9 and 4 of 13; what conducts is the pattern of the weighted logarithms."""
    law, gap = flow_law(ROUGH, 0.6), 2.0 * ROUGH.roughness
    moving, resting = ff.pattern_columns(3.0), ff.pattern_columns(1 / 3)
    shear = 9.0 / 13.0 * ff.shear_flow_factor(2.0, moving.shear, moving.weight)[0]
    shear -= 4.0 / 13.0 * ff.shear_flow_factor(2.0, resting.shear, resting.weight)[0]
    expected = ROUGH.roughness * (mean_gap_ratio(2.0) + 0.6 * shear)
    assert carried_law(gap, law)[0] == pytest.approx(expected, rel=1e-12, abs=0.0)
    for columns, sign in ((law.along, 1.0), (law.across, -1.0)):
        own = ff.pattern_columns(3.0 ** (sign * 5.0 / 13.0))
        factor = ff.pressure_flow_factor(2.0, own.pressure, own.weight)[0]
        found = conductance_law(gap, law, columns)[0]
        assert found == pytest.approx(factor * gap**3, rel=1e-12, abs=0.0)
    held = conductance_law(0.3 * SMALLEST_FLOW_GAP * ROUGH.roughness, law, law.along)
    lowest = ff.pressure_flow_factor(0.0, law.along.pressure, law.along.weight)[0]
    assert held == (
        pytest.approx(lowest * (SMALLEST_FLOW_GAP * ROUGH.roughness) ** 3, rel=1e-6, abs=0.0),
        0,
    )
    assert squeeze_law(gap, law)[0] == pytest.approx(ff.contact_factor(2.0), rel=1e-12)


def test_walls_shear_by_their_share_of_the_variance() -> None:
    law, gap = flow_law(ROUGH, 1.0), 2.0 * ROUGH.roughness
    moving, resting = ff.pattern_columns(3.0), ff.pattern_columns(1 / 3)
    of_moving = ff.shear_stress_correction(2.0, moving.stress_correction, moving.weight)
    of_resting = ff.shear_stress_correction(2.0, resting.stress_correction, resting.weight)
    mean, pattern = stress_factors(gap, law)
    assert mean * ROUGH.roughness == pytest.approx(ff.shear_stress_factor(2.0), rel=1e-12)
    assert pattern * gap == pytest.approx((9.0 * of_moving - 4.0 * of_resting) / 13.0, rel=1e-12)
    columns = law.along
    factor = ff.pressure_stress_factor(2.0, columns.pressure_stress, columns.weight)
    assert pressure_stress(gap, law) == pytest.approx(0.5 * gap * factor, rel=1e-12, abs=0.0)
    assert pressure_stress(-gap, law) == 0.0
    # where walls overlap, the pattern counts from a thousandth of the roughness on
    assert stress_factors(-gap, law)[1] == 0.0


def test_smooth_walls_by_hand() -> None:
    assert conductance_law(2e-6, SMOOTH, SMOOTH.along) == pytest.approx(
        (8e-18, 12e-12), abs=0.0, rel=1e-12
    )
    assert carried_law(2e-6, SMOOTH) == (2e-6, 1.0)
    assert squeeze_law(2e-6, SMOOTH) == (1.0, 0.0)
    assert stress_factors(2e-6, SMOOTH) == (pytest.approx(5e5), 0.0)
    assert pressure_stress(2e-6, SMOOTH) == 1e-6


def test_contact_is_tabulated_from_one_roughness_of_overlap_to_five_of_gap() -> None:
    """Between the nodes the law, along its logarithm below them, nothing above."""
    points = ((-4.0, 1e9), (4.0, 1e7), (20.0, 1e6))
    surfaces = replace(ROUGH, contact_law="table", contact_points=points)
    size, table = surfaces.roughness, contact_table(surfaces)
    assert table.first == -1.0
    assert table.first + table.step * (table.value.size - 1) == pytest.approx(5.0, rel=1e-12)
    slope = np.log(1e-2) / 8.0
    for ratio in (-2.5, -1.0, -0.31, 0.0, 1.013, 3.9):
        pressure, rise = contact_pressure(ratio * size, size, table)
        assert pressure == pytest.approx(1e9 * np.exp(slope * (ratio + 4.0)), rel=1e-9)
        assert rise * size == pytest.approx(slope * pressure, rel=1e-9)
    assert contact_pressure(4.99 * size, size, table)[0] > 8e6
    assert contact_pressure(5.001 * size, size, table) == (0.0, 0.0)
    assert contact_pressure(5.05 * size, size, table) == (0.0, 0.0)
