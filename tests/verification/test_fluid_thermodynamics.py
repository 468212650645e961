"""The equation of state and its energies, against numerical integration and differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from toothspace.closures.aeration import gas_exchange_rate
from toothspace.closures.density import (
    free_gas_fraction,
    mixture_density,
    mixture_pressure,
    mixture_specific_volume,
    unlimited_pressure,
)
from toothspace.closures.enthalpy import gas_enthalpy, liquid_enthalpy, partial_enthalpies
from toothspace.closures.fluid_law import FluidLaw
from toothspace.model.fluid import GasModel, fluid_law

LAWS = [fluid_law("iso_vg_46", 323.15), fluid_law("jet_a1", 373.15)]


def liquid_volume(pressure: float, law: FluidLaw) -> float:
    p0 = float(unlimited_pressure(pressure, law))
    stiff = 1.0 + (law.compliance + law.stiffening) * p0
    return (1.0 + law.stiffening * p0) / stiff / law.reference_density


@pytest.mark.parametrize("law", LAWS, ids=["oil", "fuel"])
@pytest.mark.parametrize("factor", [1.07, 1.5, 5.0, 50.0, 3e3])
def test_enthalpies_are_the_integral_of_the_volume(law: FluidLaw, factor: float) -> None:
    """Quadrature through the transition to the vapour pressure, to 1e-10."""
    pressure = factor * law.vapour_pressure
    tolerance = {"epsabs": 0.0, "epsrel": 1e-12, "limit": 500}
    start = law.saturation_pressure
    liquid = quad(lambda p: liquid_volume(p, law), start, pressure, **tolerance)[0]
    gas = quad(
        lambda p: law.gas_specific_energy / unlimited_pressure(p, law), start, pressure, **tolerance
    )[0]
    assert liquid_enthalpy(pressure, law) == pytest.approx(liquid, rel=1e-10)
    assert gas_enthalpy(pressure, law) == pytest.approx(gas, rel=1e-10)


@pytest.mark.parametrize("law", LAWS, ids=["oil", "fuel"])
@pytest.mark.parametrize("fraction", [0.0, 1e-9, 2e-5])
def test_enthalpy_of_the_mixture_grows_with_its_volume(law: FluidLaw, fraction: float) -> None:
    """dh/dp = v at frozen composition, nuclei included: what closes the energy ledger."""
    for pressure in law.vapour_pressure * np.array([1.08, 1.3, 2.0, 20.0, 2e3]):
        step = 1e-5 * pressure
        liquid, gas = partial_enthalpies(pressure + step * np.array([-1.0, 1.0]), fraction, law)
        h = (1.0 - fraction) * liquid + fraction * gas
        volume = mixture_specific_volume(pressure, fraction, law)
        assert (h[1] - h[0]) / (2.0 * step) == pytest.approx(float(volume), rel=1e-7)


@pytest.mark.parametrize("law", LAWS, ids=["oil", "fuel"])
@pytest.mark.parametrize("fraction", [0.0, 1e-9, 2e-5])
def test_partial_enthalpies_are_derivatives_by_mass(law: FluidLaw, fraction: float) -> None:
    """Gas that joins a mixture adds the partial enthalpy of the gas; so does liquid."""
    pressure = 40.0 * law.vapour_pressure

    def enthalpy(liquid_mass: float, gas_mass: float) -> float:
        whole = liquid_mass + gas_mass
        f = free_gas_fraction(gas_mass / whole, law)
        of_liquid, of_gas = liquid_enthalpy(pressure, law), gas_enthalpy(pressure, law)
        return float(whole * ((1.0 - f) * of_liquid + f * of_gas))

    first, second = partial_enthalpies(pressure, fraction, law)
    step = 1e-3 * law.nuclei_mass_fraction
    for change, expected in (((1e-4, 0.0), first), ((0.0, step), second)):
        ends = [
            enthalpy(1.0 - fraction + sign * change[0], fraction + sign * change[1])
            for sign in (-1.0, 1.0)
        ]
        assert (ends[1] - ends[0]) / (2.0 * sum(change)) == pytest.approx(float(expected), rel=1e-3)


@pytest.mark.parametrize("fraction", [0.0, 0.05, 0.4])
def test_partial_enthalpies_add_up_to_that_of_liquid_and_free_gas(fraction: float) -> None:
    """With nuclei that count; at half the feed's pressure gas and liquid have given off heat."""
    law = LAWS[0]._replace(nuclei_mass_fraction=0.1)
    pressure = 0.5 * law.saturation_pressure
    free = float(free_gas_fraction(fraction, law))
    of_liquid, of_gas = liquid_enthalpy(pressure, law), gas_enthalpy(pressure, law)
    first, second = partial_enthalpies(pressure, fraction, law)
    whole = (1.0 - free) * of_liquid + free * of_gas
    assert (1.0 - fraction) * first + fraction * second == pytest.approx(whole, rel=1e-9)
    step = 1e-6
    slope = free_gas_fraction(fraction + step, law) - free_gas_fraction(fraction - step, law)
    slope *= (of_gas - of_liquid) / (2.0 * step)
    assert second - first == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("law", LAWS, ids=["oil", "fuel"])
@pytest.mark.parametrize("fraction", [0.0, 1e-8, 2e-6, 1e-4, 1e-2])
def test_derivatives_of_the_pressure(law: FluidLaw, fraction: float) -> None:
    """Against central differences on both sides of the vapour pressure."""
    for pressure in law.vapour_pressure * np.array([1.062, 1.2, 3.0, 100.0, 2e4]):
        volume = float(mixture_specific_volume(pressure, fraction, law))
        _, by_volume, by_gas = mixture_pressure(volume, fraction, law)
        # Steps that change the pressure by a millionth.
        dv, df = 1e-6 * pressure / by_volume, 1e-6 * pressure / by_gas
        rise = mixture_pressure(volume + dv, fraction, law)[0]
        fall = mixture_pressure(volume - dv, fraction, law)[0]
        assert (rise - fall) / (2.0 * dv) == pytest.approx(by_volume, rel=1e-4)
        df = np.clip(df, -1e-3 * (fraction + 1e-9), 1e-3 * (fraction + 1e-9))
        rise = mixture_pressure(volume, fraction + df, law)[0]
        fall = mixture_pressure(volume, fraction - df, law)[0]
        tolerance = 1e-3 * abs(by_gas) + 1e-9 * pressure / abs(df)
        assert (rise - fall) / (2.0 * df) == pytest.approx(by_gas, abs=tolerance)


@pytest.mark.parametrize("law", LAWS, ids=["oil", "fuel"])
def test_bulk_modulus_is_the_exact_derivative_of_the_density(law: FluidLaw) -> None:
    for pressure in (0.3e5, 1e5, 20e5, 200e5):
        ends = pressure * (1.0 + np.array([-1e-4, 1e-4]))
        density = np.log(mixture_density(ends, 2e-6, law))
        numerical = (ends[1] - ends[0]) / (density[1] - density[0])
        volume = mixture_specific_volume(pressure, 2e-6, law)
        modulus = -volume * mixture_pressure(volume, 2e-6, law)[1]
        assert modulus == pytest.approx(numerical, rel=1e-5)


@pytest.mark.parametrize("gas_law", ["dynamic", "equilibrium", "none"])
def test_derivatives_of_the_gas_exchange(gas_law: str) -> None:
    law = fluid_law("iso_vg_46", 323.15, GasModel(law=gas_law))
    total = law.total_gas_mass_fraction
    for pressure in (2e3, 0.9e5, 1.03e5, 5e5):
        for fraction in (0.0, 0.02 * total, 0.5 * total, total):
            _, by_pressure, by_gas = gas_exchange_rate(pressure, fraction, law)
            dp, df = 1.0, 1e-7 * total
            p = (
                gas_exchange_rate(pressure + dp, fraction, law)[0]
                - gas_exchange_rate(pressure - dp, fraction, law)[0]
            ) / (2.0 * dp)
            f = (
                gas_exchange_rate(pressure, fraction + df, law)[0]
                - gas_exchange_rate(pressure, fraction - df, law)[0]
            ) / (2.0 * df)
            scale = law.release_rate * total / 1e5
            assert by_pressure == pytest.approx(p, rel=1e-3, abs=1e-4 * scale)
            assert by_gas == pytest.approx(f, rel=1e-4, abs=1e-6)
