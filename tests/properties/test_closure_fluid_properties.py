"""What must hold of the equation of state for any fluid, pressure and gas content."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from toothspace.closures.aeration import gas_exchange_rate, gas_volume_fraction, vapour_fraction
from toothspace.closures.density import mixture_density, mixture_pressure, mixture_specific_volume
from toothspace.model.fluid import fluid_law

LAWS = [
    fluid_law(name, celsius + 273.15)
    for name in ("iso_vg_32", "iso_vg_46", "iso_vg_68", "jet_a1")
    for celsius in (-30.0, 50.0, 110.0)
]
laws = st.sampled_from(LAWS)
pressures = st.floats(-3.0, 5.0).map(lambda x: 30e3 * 10.0**x)
fractions = st.one_of(st.just(0.0), st.floats(-9.0, -2.0).map(lambda x: 10.0**x))
stretches = st.floats(0.97, 50.0)


@given(laws, st.floats(-1.0, 4.0), fractions)
def test_volume_and_pressure_are_inverse(law, decades: float, fraction: float) -> None:
    pressure = law.vapour_pressure * (1.06 + 10.0**decades)
    volume = mixture_specific_volume(pressure, fraction, law)
    assert np.isclose(mixture_pressure(volume, fraction, law)[0], pressure, rtol=1e-9)


@given(laws, stretches, fractions)
def test_pressure_stays_above_the_vapour_pressure(law, stretch: float, fraction: float) -> None:
    pressure, by_volume, by_gas = mixture_pressure(stretch / law.reference_density, fraction, law)
    assert pressure > law.vapour_pressure
    assert by_volume < 0.0
    assert by_gas >= 0.0 or stretch < 1.0


@given(laws, stretches, stretches, fractions)
def test_pressure_grows_with_density(law, one: float, other: float, fraction: float) -> None:
    low, high = sorted((one, other))
    dense = mixture_pressure(low / law.reference_density, fraction, law)[0]
    thin = mixture_pressure(high / law.reference_density, fraction, law)[0]
    assert dense >= thin


def bulk_modulus(pressure: float, fraction: float, law) -> float:
    """Exact stiffness of the mixture at frozen composition, -v dp/dv. [Pa]."""
    volume = mixture_specific_volume(pressure, fraction, law)
    return -volume * mixture_pressure(volume, fraction, law)[1]


@given(laws, st.floats(1.07, 1e4), fractions)
def test_bulk_modulus_is_positive(law, factor: float, fraction: float) -> None:
    pressure = factor * law.vapour_pressure
    modulus = bulk_modulus(pressure, fraction, law)
    assert modulus > 0.0
    liquid = bulk_modulus(pressure, 0.0, law)
    assert modulus <= liquid * (1.0 + 1e-9)


@given(laws, st.floats(1.07, 1e4), fractions)
def test_volume_fractions_lie_between_zero_and_one(law, factor: float, fraction: float) -> None:
    pressure = factor * law.vapour_pressure
    volume = 1.0 / mixture_density(pressure, fraction, law)
    gas = gas_volume_fraction(pressure, fraction, law)
    vapour = vapour_fraction(volume, pressure, fraction, law)
    assert gas >= 0.0
    assert vapour >= 0.0
    assert gas + vapour <= 1.0 + 1e-12


@given(laws, st.floats(1.07, 1e4), st.floats(0.0, 1.0))
def test_gas_content_stays_between_none_and_all(law, factor: float, share: float) -> None:
    """Nothing is released beyond all gas, nothing absorbed below none."""
    pressure = factor * law.vapour_pressure
    assert gas_exchange_rate(pressure, 0.0, law)[0] >= 0.0
    total = law.total_gas_mass_fraction * (1.0 + 2e-3)
    assert gas_exchange_rate(pressure, total, law)[0] <= 1e-3 * total
    assert gas_exchange_rate(pressure, share * total, law)[2] <= 0.0
