"""Properties of fluids against tables, published formulas and hand calculation."""

from __future__ import annotations

import numpy as np
import pytest

from tests.reference_formulas.fluids import entrained_gas_bulk_modulus, roelands_viscosity
from toothspace.closures.aeration import (
    equilibrium_gas_fraction,
    gas_exchange_rate,
    gas_volume_fraction,
    vapour_fraction,
)
from toothspace.closures.density import (
    clausius_clapeyron_pressure,
    dowson_higginson_density,
    liquid_bulk_modulus,
    liquid_specific_volume,
    mixture_density,
    mixture_pressure,
    mixture_specific_volume,
    unlimited_pressure,
)
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.viscosity import (
    barus_viscosity,
    dynamic_viscosity,
    exponential_rise,
    throttling_viscosity,
    walther_constants,
    walther_viscosity,
)
from toothspace.model.fluid import GasModel, fluid_law

BAR = 1e5


def law_of(name: str, celsius: float, **options: object) -> FluidLaw:
    return fluid_law(name, celsius + 273.15, GasModel(**options))  # type: ignore[arg-type]


def density_of(pressure: float, law: FluidLaw) -> float:
    return 1.0 / liquid_specific_volume(pressure, law)


@pytest.mark.parametrize(
    ("celsius", "density", "viscosity"),
    [  # of the constants in the library, by hand: kg/m3 and mPa s at 1 bar
        (0, 859.4, 386.7),
        (20, 852.3, 102.7),
        (40, 845.3, 38.5),
        (50, 841.7, 25.95),
        (60, 838.2, 18.4),
        (80, 831.1, 10.4),
        (88, 828.3, 8.60),
        (100, 824.0, 6.67),
    ],
)
def test_vg_46_table(celsius: float, density: float, viscosity: float) -> None:
    law = law_of("iso_vg_46", celsius)
    assert density_of(BAR, law) == pytest.approx(density, abs=0.06)
    assert 1e3 * dynamic_viscosity(BAR, law) == pytest.approx(viscosity, rel=5e-3)


def test_vg_46_under_pressure() -> None:
    """K = 1.667 GPa at 1 bar and 1.766 GPa at 200 bar; viscosity ratio 1.655."""
    law = law_of("iso_vg_46", 50)
    assert liquid_bulk_modulus(BAR, law) == pytest.approx(1.667e9, rel=1e-3)
    assert liquid_bulk_modulus(200 * BAR, law) == pytest.approx(1.766e9, rel=1e-3)
    ratio = dynamic_viscosity(200 * BAR, law) / dynamic_viscosity(BAR, law)
    assert ratio == pytest.approx(1.655, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "celsius", "viscosity"),
    [  # the points that define the grades, ISO 3448 at 40 degC, cSt
        ("iso_vg_32", 40, 32.0),
        ("iso_vg_32", 100, 5.4),
        ("iso_vg_68", 40, 68.0),
        ("iso_vg_68", 100, 8.7),
        # its own Walther constants, by hand
        ("jet_a1", -20, 4.8),
        ("jet_a1", 20, 1.86),
        ("jet_a1", 60, 1.05),
        ("jet_a1", 100, 0.72),
    ],
)
def test_kinematic_viscosity(name: str, celsius: float, viscosity: float) -> None:
    law = law_of(name, celsius)
    kinematic = dynamic_viscosity(101325.0, law) / density_of(101325.0, law)
    assert 1e6 * kinematic == pytest.approx(viscosity, rel=6e-3)


@pytest.mark.parametrize(("name", "density"), [("iso_vg_32", 870.0), ("iso_vg_68", 880.0)])
def test_density_at_15_celsius(name: str, density: float) -> None:
    assert density_of(101325.0, law_of(name, 15)) == pytest.approx(density, abs=0.1)


def test_jet_a1() -> None:
    """By hand: 808 - 0.745 (T - 15), K and vapour pressure at 60 and 100 degC."""
    law = law_of("jet_a1", 60)
    assert density_of(BAR, law) == pytest.approx(808 - 0.745 * 45, rel=2e-4)
    assert liquid_bulk_modulus(0.0, law) == pytest.approx(1.34e9 - 8.2e6 * 40, rel=1e-9)
    slope = (liquid_bulk_modulus(1e5, law) - liquid_bulk_modulus(0.0, law)) / 1e5
    assert slope == pytest.approx(9.5, rel=1e-3)
    assert 1e3 * dynamic_viscosity(BAR, law) == pytest.approx(0.81, abs=0.01)
    assert law_of("jet_a1", 100).vapour_pressure == pytest.approx(14e3, rel=5e-3)
    assert law_of("jet_a1", 20).vapour_pressure == 1000.0  # numerical floor


def test_walther_of_a_typical_vg_46() -> None:
    """ASTM D341 by hand: A = 9.41799, B = 3.68444 and the viscosities that follow."""
    constants = walther_constants((313.15, 373.15), (46e-6, 6.8e-6))
    assert constants == pytest.approx((9.41799, 3.68444), abs=1e-4)
    celsius = np.array([20.0, 50.0, 60.0, 80.0, 88.0])
    expected = [133.8, 30.0, 20.6, 11.1, 9.0]
    assert 1e6 * walther_viscosity(celsius + 273.15, *constants, 0.7) == pytest.approx(
        expected, rel=5e-3
    )


def test_barus_agrees_with_roelands() -> None:
    """Within 1 % at 20 MPa, 6 % at 50 MPa; the film's law stops at its highest ratio."""
    pressure = np.linspace(0, 500e5, 11)
    barus = barus_viscosity(pressure, 0.0385, 2e-8, 20.0)
    roelands = roelands_viscosity(pressure, 0.0385, 2e-8)
    assert barus == pytest.approx(roelands, rel=0.06)
    assert barus[4] == pytest.approx(roelands[4], rel=0.01)
    assert barus_viscosity(1e12, 0.0385, 2e-8, 20.0) == pytest.approx(0.0385 * np.exp(20.0))


def test_both_laws_of_viscosity_are_one_up_to_50_megapascal() -> None:
    law = law_of("iso_vg_46", 50)
    pressure = np.linspace(0.0, 50e6, 11)
    barus = barus_viscosity(pressure, law.dynamic_viscosity, law.pressure_viscosity, 20.0)
    assert dynamic_viscosity(pressure, law) == pytest.approx(barus, rel=1e-3)


def test_rise_of_the_exponential_function() -> None:
    exponent = np.concatenate([-np.logspace(-12, 1, 40), np.logspace(-12, 1, 40)])
    error = np.abs(exponential_rise(exponent) - np.expm1(exponent)) / np.exp(exponent)
    assert error[np.abs(exponent) <= 4.0].max() < 2e-14
    assert error.max() < 3e-10
    assert exponential_rise(0.0) == 0.0


def test_heated_throat_has_the_mean_of_the_reciprocal_viscosity() -> None:
    """Integral of 1/mu over a drop of 200 bar, at which pressure and heat change mu, by sums."""
    law, drop = law_of("iso_vg_46", 50), 2e7
    heating = law.viscosity_temperature / (law.reference_density * law.specific_heat_capacity)
    left = (np.arange(20_000) + 0.5) / 20_000
    mean = np.mean(np.exp((law.pressure_viscosity + heating) * drop * left)) / 0.03
    assert throttling_viscosity(0.03, drop, law) == pytest.approx(1.0 / mean, rel=1e-8)


def test_dowson_higginson_density() -> None:
    """At 0.59 GPa the density is (1 + 1.34)/2 of that at rest, by the formula."""
    assert dowson_higginson_density(0.59e9, 800.0) == pytest.approx(1.17 * 800.0)


def test_mixture_modulus_agrees_with_the_entrained_gas_formula() -> None:
    """Isothermal gas of 0.5 % at 1 atm in a liquid: both laws are the same physics."""
    law = law_of("iso_vg_46", 50, free_air_fraction=0.005)
    pressure = np.array([2e5, 10e5, 100e5])
    volume = mixture_specific_volume(pressure, law.feed_gas_mass_fraction, law)
    mixture = -volume * mixture_pressure(volume, law.feed_gas_mass_fraction, law)[1]
    liquid = liquid_bulk_modulus(pressure, law)
    formula = entrained_gas_bulk_modulus(pressure - 101325.0, liquid, 0.005, 1.0)
    assert mixture == pytest.approx(formula, rel=5e-3)


def test_vapour_pressure_falls_by_the_heat_of_evaporation() -> None:
    """d ln p / d(1/T) is minus the evaporation temperature."""
    one, other = (clausius_clapeyron_pressure(T, 1e4, 350.0, 5000.0) for T in (350.0, 300.0))
    assert one == pytest.approx(1e4)
    assert np.log(one / other) == pytest.approx(5000.0 * (1.0 / 300.0 - 1.0 / 350.0))


def test_free_air_has_its_volume_at_one_atmosphere() -> None:
    law = law_of("iso_vg_46", 50, free_air_fraction=0.01)
    volume = gas_volume_fraction(101325.0, law.feed_gas_mass_fraction, law)
    assert volume == pytest.approx(0.01 / 1.01, rel=1e-3)


def test_stretched_liquid_turns_to_vapour() -> None:
    """Twice the volume without gas: half of it is vapour, at hardly more than p_v."""
    law = law_of("jet_a1", 60)
    volume = 2.0 / law.reference_density
    pressure = mixture_pressure(volume, 0.0, law)[0]
    assert law.vapour_pressure < pressure < 1.06 * law.vapour_pressure
    assert vapour_fraction(volume, pressure, 0.0, law) == pytest.approx(0.5, abs=1e-3)
    assert vapour_fraction(1.0 / mixture_density(10e5, 1e-6, law), 10e5, 1e-6, law) < 1e-6


def test_gas_follows_henry_in_equilibrium() -> None:
    law = law_of("iso_vg_46", 50)
    at_feed, _ = equilibrium_gas_fraction(101325.0, law)
    assert at_feed == pytest.approx(law.feed_gas_mass_fraction, rel=5e-3)
    half, slope = equilibrium_gas_fraction(0.5 * 101325.0, law)
    expected = law.feed_gas_mass_fraction + 0.5 * law.dissolved_mass_fraction
    assert half == pytest.approx(expected, rel=1e-5)
    step = equilibrium_gas_fraction(0.5 * 101325.0 + 1.0, law)[0] - half
    assert step == pytest.approx(slope, rel=1e-4, abs=0.0)
    assert equilibrium_gas_fraction(200e5, law)[0] < 1e-3 * law.total_gas_mass_fraction


def test_release_and_absorption_time() -> None:
    """Defaults of the gas model: 0.02 s and 1 s."""
    law = law_of("iso_vg_46", 50)
    rate = gas_exchange_rate(0.3e5, 0.0, law)[0]
    assert rate == pytest.approx(equilibrium_gas_fraction(0.3e5, law)[0] / 0.02, rel=1e-3)
    fraction = law.total_gas_mass_fraction
    assert gas_exchange_rate(100e5, fraction, law)[0] == pytest.approx(-fraction, rel=1e-2)


@pytest.mark.parametrize(("gas_law", "expected"), [("none", 0.0), ("equilibrium", 1e5)])
def test_limits_of_the_gas_law(gas_law: str, expected: float) -> None:
    law = law_of("iso_vg_46", 50, law=gas_law)
    assert -gas_exchange_rate(0.5e5, 1e-6, law)[2] == pytest.approx(expected)


def test_arrays_and_scalars_agree() -> None:
    law = law_of("iso_vg_68", 30)
    pressure = np.array([2e3, 1e5, 1e7])
    volumes = mixture_specific_volume(pressure, 1e-5, law)
    for k, p in enumerate(pressure):
        assert float(mixture_specific_volume(float(p), 1e-5, law)) == volumes[k]
        assert float(mixture_pressure(float(volumes[k]), 1e-5, law)[0]) == pytest.approx(p)


def test_where_all_gas_just_dissolves_nuclei_and_the_round_corner_remain() -> None:
    law = law_of("iso_vg_46", 50)._replace(nuclei_mass_fraction=3e-7)
    corner = law.total_gas_mass_fraction / law.dissolved_mass_fraction * law.saturation_pressure
    found, slope = equilibrium_gas_fraction(corner, law)
    assert found == pytest.approx(1e-3 * law.total_gas_mass_fraction + 3e-7, rel=1e-9)
    assert slope == pytest.approx(
        -0.5 * law.dissolved_mass_fraction / law.saturation_pressure, rel=1e-6, abs=0.0
    )


@pytest.mark.parametrize(("part", "released"), [(0.25, 0.15625), (0.5, 0.5), (0.75, 0.84375)])
def test_release_sets_in_over_the_round_corner(part: float, released: float) -> None:
    """A thousandth of all gas and the nuclei wide, about equilibrium; the rise is 3 x^2 - 2 x^3."""
    law = law_of("iso_vg_46", 50)._replace(nuclei_mass_fraction=3e-8)
    width = 1e-3 * law.total_gas_mass_fraction + 3e-8
    missing = part * width
    equilibrium, _ = equilibrium_gas_fraction(0.5e5, law)
    rate, _, by_gas = gas_exchange_rate(0.5e5, equilibrium - missing, law)
    blended = released * law.release_rate + (1.0 - released) * law.absorption_rate
    assert rate == pytest.approx(missing * blended, rel=1e-6)
    # d(x^3 (3 - 2 x))/dx = x^2 (9 - 8 x)
    steep = part**2 * (9.0 - 8.0 * part)
    blended = steep * law.release_rate + (1.0 - steep) * law.absorption_rate
    assert by_gas == pytest.approx(-blended, rel=1e-6)


def test_a_mixture_of_free_gas_stretched_to_twice_its_volume_is_half_vapour() -> None:
    """At a pressure that evaporation leaves alone, and with as much gas as liquid by volume."""
    law, pressure = law_of("iso_vg_46", 50), 1e5
    fraction = 1.0 / (1.0 + law.gas_specific_energy / pressure * density_of(pressure, law))
    assert gas_volume_fraction(pressure, fraction, law) == pytest.approx(0.5, rel=1e-3)
    volume = mixture_specific_volume(pressure, fraction, law)
    assert vapour_fraction(2.0 * volume, pressure, fraction, law) == pytest.approx(0.5, rel=1e-3)


def test_viscosity_ends_with_its_data() -> None:
    """It rises up to the end of the data, 100 MPa, and no further; there by 2^(-1/8) of it."""
    law = law_of("iso_vg_46", 50)
    rise = np.log(dynamic_viscosity(np.array([1e8, 1e9, 1e10]), law) / law.dynamic_viscosity)
    expected = law.pressure_viscosity * 1e8 * np.array([0.5**0.125, 1.0, 1.0])
    assert rise == pytest.approx(expected, rel=1e-6)


def test_the_pressure_without_evaporation_stays_positive() -> None:
    """A millionth of the vapour pressure where there is nothing but vapour."""
    law = law_of("jet_a1", 60)
    for part in (0.1, 1.0, 1.0 + 1e-9):
        found = unlimited_pressure(part * law.vapour_pressure, law)
        assert found == pytest.approx(1e-6 * law.vapour_pressure, rel=1e-9)
