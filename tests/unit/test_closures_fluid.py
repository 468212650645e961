"""Properties of fluids against the tables of PHYSICS 8 and published formulas."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.closures.aeration import (
    equilibrium_gas_fraction,
    gas_exchange_rate,
    gas_volume_fraction,
    undissolved_share,
    vapour_fraction,
)
from toothspace.closures.bulk_modulus import (
    effective_bulk_modulus,
    entrained_gas_bulk_modulus,
    liquid_bulk_modulus,
)
from toothspace.closures.density import (
    dowson_higginson_density,
    hlp_32_density,
    liquid_density,
    mixture_density,
    mixture_pressure,
    mixture_specific_volume,
)
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.viscosity import (
    dynamic_viscosity,
    hlp_32_viscosity,
    roelands_exponent,
    roelands_viscosity,
    walther_constants,
    walther_viscosity,
)
from toothspace.model.fluid import fluid_law

BAR = 1e5


def law_of(name: str, celsius: float, **options: object) -> FluidLaw:
    return fluid_law(name, celsius + 273.15, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("celsius", "density", "viscosity"),
    [  # PHYSICS 8.1, table of the VG 46 model: kg/m3 and mPa s at 1 bar
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
    assert liquid_density(BAR, law) == pytest.approx(density, abs=0.06)
    assert 1e3 * dynamic_viscosity(BAR, law) == pytest.approx(viscosity, rel=5e-3)


def test_vg_46_under_pressure() -> None:
    """K = 1.667 GPa at 1 bar and 1.766 GPa at 200 bar; viscosity ratio 1.655 (PHYSICS 8.1)."""
    law = law_of("iso_vg_46", 50)
    assert liquid_bulk_modulus(BAR, law) == pytest.approx(1.667e9, rel=1e-3)
    assert liquid_bulk_modulus(200 * BAR, law) == pytest.approx(1.766e9, rel=1e-3)
    ratio = dynamic_viscosity(200 * BAR, law) / dynamic_viscosity(BAR, law)
    assert ratio == pytest.approx(1.655, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "celsius", "viscosity"),
    [  # the points that define the grades (PHYSICS 0.15), cSt
        ("iso_vg_32", 40, 32.0),
        ("iso_vg_32", 100, 5.4),
        ("iso_vg_68", 40, 68.0),
        ("iso_vg_68", 100, 8.7),
        # PHYSICS 8.2
        ("jet_a1", -20, 4.8),
        ("jet_a1", 20, 1.86),
        ("jet_a1", 60, 1.05),
        ("jet_a1", 100, 0.72),
    ],
)
def test_kinematic_viscosity(name: str, celsius: float, viscosity: float) -> None:
    law = law_of(name, celsius)
    kinematic = dynamic_viscosity(101325.0, law) / liquid_density(101325.0, law)
    assert 1e6 * kinematic == pytest.approx(viscosity, rel=6e-3)


@pytest.mark.parametrize(("name", "density"), [("iso_vg_32", 870.0), ("iso_vg_68", 880.0)])
def test_density_at_15_celsius(name: str, density: float) -> None:
    assert liquid_density(101325.0, law_of(name, 15)) == pytest.approx(density, abs=0.1)


def test_jet_a1() -> None:
    """PHYSICS 8.2: 808 - 0.745 (T - 15), K and vapour pressure at 60 and 100 degC."""
    law = law_of("jet_a1", 60)
    assert liquid_density(BAR, law) == pytest.approx(808 - 0.745 * 45, rel=2e-4)
    assert liquid_bulk_modulus(0.0, law) == pytest.approx(1.34e9 - 8.2e6 * 40, rel=1e-9)
    slope = (liquid_bulk_modulus(1e5, law) - liquid_bulk_modulus(0.0, law)) / 1e5
    assert slope == pytest.approx(9.5, rel=1e-3)
    assert 1e3 * dynamic_viscosity(BAR, law) == pytest.approx(0.81, abs=0.01)
    assert law_of("jet_a1", 100).vapour_pressure == pytest.approx(14e3, rel=5e-3)
    assert law_of("jet_a1", 20).vapour_pressure == 1000.0  # numerical floor


def test_walther_of_a_typical_vg_46() -> None:
    """PHYSICS 8.1: A = 9.41799, B = 3.68444 and the viscosities that follow."""
    constants = walther_constants((313.15, 373.15), (46e-6, 6.8e-6))
    assert constants == pytest.approx((9.41799, 3.68444), abs=1e-4)
    celsius = np.array([20.0, 50.0, 60.0, 80.0, 88.0])
    expected = [133.8, 30.0, 20.6, 11.1, 9.0]
    assert 1e6 * walther_viscosity(celsius + 273.15, *constants, 0.7) == pytest.approx(
        expected, rel=5e-3
    )


def test_roelands() -> None:
    """PHYSICS 8.1: Z = 0.61 at 40 degC; agrees with Barus within 1 % up to 500 bar."""
    exponent = roelands_exponent(0.0385, 2e-8)
    assert exponent == pytest.approx(0.61, abs=0.006)
    pressure = np.linspace(0, 500e5, 11)
    barus = 0.0385 * np.exp(2e-8 * pressure)
    assert roelands_viscosity(pressure, 0.0385, exponent) == pytest.approx(barus, rel=0.06)
    assert roelands_viscosity(200e5, 0.0385, exponent) == pytest.approx(barus[4], rel=0.01)


def test_measured_hlp_32() -> None:
    """Viscosity 17.02 mPa s at 50 degC and zero pressure by its formula (PHYSICS 8.1)."""
    assert hlp_32_viscosity(323.15, 0.0) == pytest.approx(1.702e-2)
    assert hlp_32_density(313.15, 0.0) == pytest.approx(1047.03 * (1 - 5.761668e-4 * 313.15))
    modulus = 1e7 / np.log(hlp_32_density(313.15, 1.05e7) / hlp_32_density(313.15, 5e5))
    assert 1.4e9 < modulus < 1.9e9  # rule in PHYSICS 8.1


def test_dowson_higginson_density() -> None:
    """At 0.59 GPa the density is (1 + 1.34)/2 of that at rest, by the formula."""
    assert dowson_higginson_density(0.59e9, 800.0) == pytest.approx(1.17 * 800.0)


def test_entrained_gas_modulus() -> None:
    """Example of PHYSICS 8.4."""
    gauge = np.array([0.0, 10e5, 100e5])
    modulus = entrained_gas_bulk_modulus(gauge, 1.7e9, 0.005, 1.4, 101325.0)
    assert modulus == pytest.approx([2.80e7, 0.85e9, 1.66e9], rel=6e-3)


def test_mixture_modulus_agrees_with_the_entrained_gas_formula() -> None:
    """Isothermal gas of 0.5 % at 1 atm in a liquid: both laws are the same physics."""
    law = law_of("iso_vg_46", 50, free_air_fraction=0.005)
    pressure = np.array([2e5, 10e5, 100e5])
    mixture = effective_bulk_modulus(pressure, law.feed_gas_mass_fraction, law)
    liquid = liquid_bulk_modulus(pressure, law)
    formula = entrained_gas_bulk_modulus(pressure - 101325.0, liquid, 0.005, 1.0, 101325.0)
    assert mixture == pytest.approx(formula, rel=5e-3)


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
    at_feed = equilibrium_gas_fraction(101325.0, law)
    assert at_feed == pytest.approx(law.feed_gas_mass_fraction, rel=5e-3)
    half = equilibrium_gas_fraction(0.5 * 101325.0, law)
    expected = law.feed_gas_mass_fraction + 0.5 * law.dissolved_mass_fraction
    assert half == pytest.approx(expected, rel=1e-5)
    assert equilibrium_gas_fraction(200e5, law) < 1e-3 * law.total_gas_mass_fraction


def test_release_and_absorption_time() -> None:
    """PHYSICS 0.15: 0.02 s and 1 s."""
    law = law_of("iso_vg_46", 50)
    rate = gas_exchange_rate(0.3e5, 0.0, law)[0]
    assert rate == pytest.approx(equilibrium_gas_fraction(0.3e5, law) / 0.02, rel=1e-3)
    fraction = law.total_gas_mass_fraction
    assert gas_exchange_rate(100e5, fraction, law)[0] == pytest.approx(-fraction, rel=1e-2)


@pytest.mark.parametrize(("gas_law", "expected"), [("none", 0.0), ("equilibrium", 1e5)])
def test_limits_of_the_gas_law(gas_law: str, expected: float) -> None:
    law = law_of("iso_vg_46", 50, gas_law=gas_law)
    assert -gas_exchange_rate(0.5e5, 1e-6, law)[2] == pytest.approx(expected)


def test_smooth_henry_law() -> None:
    """All free at the lower, all dissolved at the upper pressure (PHYSICS 8.3)."""
    share = undissolved_share(np.array([0.1e5, 0.3e5, 1e5, 2e5]), 0.3e5, 1e5)
    assert share == pytest.approx([1.0, 1.0, 0.0, 0.0])
    # sum of the series at the middle: 2^-5 (1 + 5/2 + 15/4 + 35/8 + 70/16)
    middle = undissolved_share(0.65e5, 0.3e5, 1e5)
    assert middle == pytest.approx((1 + 2.5 + 3.75 + 4.375 + 4.375) / 32)


def test_arrays_and_scalars_agree() -> None:
    law = law_of("iso_vg_68", 30)
    pressure = np.array([2e3, 1e5, 1e7])
    volumes = mixture_specific_volume(pressure, 1e-5, law)
    for k, p in enumerate(pressure):
        assert float(mixture_specific_volume(float(p), 1e-5, law)) == volumes[k]
        assert float(mixture_pressure(float(volumes[k]), 1e-5, law)[0]) == pytest.approx(p)
