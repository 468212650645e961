"""Friction and traction against hand calculation and published numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import dblquad

from tests.reference_formulas.rough_contact import pan_hamrock_film
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.friction import (
    next_direction,
    running_share,
    stribeck_friction,
    stribeck_hump,
)
from toothspace.closures.gap_flow import lateral_film_torque
from toothspace.closures.traction import (
    FlankSurface,
    boundary_share,
    film_thickness_dowson_higginson,
    mesh_friction,
    traction_coefficient,
)
from toothspace.core.compiled import njit
from toothspace.model.fluid import fluid_law

OIL = fluid_law("iso_vg_46", 333.15)
STEEL = 2.0 / (2.0 * (1.0 - 0.09) / 206e9)
SURFACE = FlankSurface(STEEL, 0.4e-6, 0.10, 0.05)


def numbers(force: float, slide: float) -> tuple[float, float, float, float]:
    """Arguments of one example: R 4 mm, b 7.5 mm, alpha 2e-8, mu0 0.02."""
    speed_sum = 8.0
    speed = 0.02 * speed_sum / (STEEL * 4e-3)
    return slide, speed, force / (7.5e-3 * STEEL * 4e-3), 2e-8 * STEEL


@pytest.mark.parametrize(("limiting", "expected"), [(0.05, 0.061), (0.08, 0.085)])
def test_traction_of_a_loaded_mesh_is_the_limit(limiting: float, expected: float) -> None:
    """0.8 gamma + 0.021 for every load above 200 N."""
    for force in (200.0, 1000.0):
        traction, *_ = traction_coefficient(*numbers(force, 0.3), limiting)
        assert traction == pytest.approx(expected, abs=5e-4)


def test_traction_of_a_light_load_is_newtonian() -> None:
    """0.0017 to 0.020 at 50 N; the law in its range, by hand."""
    slide, speed, load, material = numbers(50.0, 0.3)
    hand = 0.671e-6 * 0.3**0.81 * speed**0.26 * (load * material**2) ** 3.32
    assert hand < 0.04
    found, *_ = traction_coefficient(slide, speed, load, material, 0.05)
    assert found == pytest.approx(hand, rel=3e-3)


def test_traction_is_continuous_at_the_switch() -> None:
    """The two branches meet where the Newtonian coefficient is 0.8 gamma."""
    slide, speed, _, material = numbers(50.0, 0.3)
    rounded = (slide**2 + 1e-8) ** 0.405 - 1e-4**0.81
    load = (0.04 / (0.671e-6 * rounded * speed**0.26)) ** (1 / 3.32) / material**2
    below, *_ = traction_coefficient(slide, speed, load * (1 - 1e-9), material, 0.05)
    above, *_ = traction_coefficient(slide, speed, load * (1 + 1e-9), material, 0.05)
    assert below == pytest.approx(0.04, rel=1e-6)
    assert above == pytest.approx(0.04, rel=1e-6)


def test_film_thickness_of_gear_flanks() -> None:
    """Two published formulas within 8 %, 0.02 to 0.3 um."""
    _, speed, load, material = numbers(660.0, 0.3)
    one = film_thickness_dowson_higginson(0.5 * speed, material, load)
    minimum, central = pan_hamrock_film(0.5 * speed, material, load)
    assert minimum == pytest.approx(one, rel=0.08)
    assert central > minimum
    assert 0.02e-6 < one * 4e-3 < 0.5e-6


def test_boundary_share() -> None:
    share, exponent = boundary_share(np.array([0.0, 1.0]))
    assert share == pytest.approx([1.0, np.exp(-1.8)])
    assert exponent == pytest.approx([0.0, 1.8])
    assert boundary_share(3.0)[0] < 2e-3


def test_mesh_friction_at_rest_and_in_reverse() -> None:
    """No NaN at rest, boundary friction at creep, odd under reversal."""
    at = (9e4, 2e-3)
    assert mesh_friction(*at, 0.0, 0.0, OIL, SURFACE)[0] == 0.0
    creep, _, _ = mesh_friction(*at, 5e-3, 1e-2, OIL, SURFACE)
    assert creep == pytest.approx(0.10, abs=0.01)
    forward, _, _ = mesh_friction(*at, 1.0, 5.0, OIL, SURFACE)
    assert mesh_friction(*at, -1.0, 5.0, OIL, SURFACE)[0] == -forward
    assert 0.05 < forward < 0.10
    assert np.isfinite(mesh_friction(0.0, 2e-3, 1.0, 5.0, OIL, SURFACE)).all()


def test_hard_flanks_in_thick_oil_creep_before_they_slide() -> None:
    """The power law alone reaches its limit at a slide ratio of 1e-9: a step of the friction."""
    thick, load = OIL._replace(dynamic_viscosity=20.0), 2e8
    radius, rolling = 2e-3, 5.0

    def friction(ratio: float) -> float:
        return mesh_friction(load, radius, ratio * rolling, rolling, thick, SURFACE)[0]

    slid = friction(1e-2)
    assert slid == pytest.approx(0.8 * 0.05 + 0.021, rel=1e-3)
    assert 0.0 < friction(1e-6) < 1e-3 * slid
    assert friction(1e-5) < 0.03 * slid
    assert friction(1e-4) == pytest.approx(0.8 * 0.05, rel=1e-6)


@pytest.mark.parametrize("load", [5e3, 2e4, 3e5, 2e8])
@pytest.mark.parametrize("sliding", [-2.0, 3e-3, 4e-4, 0.4])
def test_mesh_friction_gives_its_derivatives(load: float, sliding: float) -> None:
    def friction(load: float, sliding: float) -> float:
        return mesh_friction(load, 2e-3, sliding, 5.0, OIL, SURFACE)[0]

    up, down = 1.0 + 1e-6, 1.0 - 1e-6
    _, by_load, by_sliding = mesh_friction(load, 2e-3, sliding, 5.0, OIL, SURFACE)
    growth = (friction(load * up, sliding) - friction(load * down, sliding)) / (2e-6 * load)
    assert growth == pytest.approx(by_load, rel=1e-4, abs=1e-12)
    growth = (friction(load, sliding * up) - friction(load, sliding * down)) / (2e-6 * sliding)
    assert growth == pytest.approx(by_sliding, rel=1e-4, abs=1e-9)


def test_stribeck_peak_is_the_breakaway_value() -> None:
    """The Coulomb part is tanh(10) there."""
    assert stribeck_hump(0.006, 0.006)[0] == pytest.approx(1.0)
    assert stribeck_hump(0.006, 0.006)[1] == pytest.approx(0.0, abs=1e-9)
    assert stribeck_friction(0.006, 250.0, 100.0, 0.006)[0] == pytest.approx(250.0, rel=1e-6)
    speed = np.linspace(0.0, 0.1, 2001)
    friction, slope = stribeck_friction(speed, 250.0, 100.0, 0.006)
    assert friction.max() == pytest.approx(250.0, rel=1e-3)
    assert friction[-1] == pytest.approx(100.0)
    assert friction[0] == 0.0
    fine = np.linspace(0.0, 0.03, 30001)
    friction, slope = stribeck_friction(fine, 250.0, 100.0, 0.006)
    assert np.gradient(friction, fine[1])[1:-1] == pytest.approx(slope[1:-1], abs=1e-4 * slope[0])


def test_stribeck_slope_at_rest() -> None:
    """By hand: sqrt(2e) 150 / (sqrt(2) v) + 1000 / v with v = 6.45 mm/s."""
    slope = stribeck_friction(0.0, 250.0, 100.0, 6.45e-3)[1]
    assert slope == pytest.approx((np.sqrt(np.e) * 150.0 + 1000.0) / 6.45e-3)
    assert slope == pytest.approx(1.9e5, rel=0.02)


def test_running_share_is_the_complement_of_the_bell() -> None:
    assert running_share(0.0, 1.0) == 0.0
    assert running_share(np.sqrt(2.0), 1.0) == pytest.approx(1.0 - np.exp(-1.0))


def test_parallel_lateral_film() -> None:
    """pi mu omega (ro^4 - ri^4) / 2h; four faces, three quarters of the ring covered by teeth."""
    torque = lateral_film_torque(0.0184, 157.0, 0.009, 0.0202, 8e-6)
    hand = np.pi * 0.0184 * 157.0 * (0.0202**4 - 0.009**4) / (2 * 8e-6)
    assert torque == pytest.approx(hand)
    assert 4 * 0.75 * torque == pytest.approx(0.27, abs=0.01)


@pytest.mark.parametrize("tilt", [1e-4, 0.3, 0.9])
def test_tilted_lateral_film(tilt: float) -> None:
    """Quadrature of mu omega r^3 / h over the face."""
    inner, outer = 0.009, 0.020

    def shear(angle: float, r: float) -> float:
        return 0.02 * 100.0 * r**3 / (10e-6 * (1 + tilt * r * np.cos(angle) / outer))

    expected = 2 * dblquad(shear, inner, outer, 0.0, np.pi, epsrel=1e-10)[0]
    assert lateral_film_torque(0.02, 100.0, inner, outer, 10e-6, tilt) == pytest.approx(
        expected, rel=1e-8
    )


@njit
def _compiled(speed: float, oil: FluidLaw, surface: FlankSurface) -> tuple[float, float, float]:
    return (
        mesh_friction(9e4, 2e-3, speed, 5.0, oil, surface)[0],
        lateral_film_torque(0.02, speed, 0.01, 0.02, 1e-5, 0.3),
        stribeck_friction(speed, 2.0, 1.0, 0.006)[0],
    )


def test_compiled_friction_equals_python() -> None:
    given = 0.4, OIL, SURFACE
    assert _compiled(*given) == pytest.approx(_compiled.py_func(*given), rel=1e-12)


@pytest.mark.parametrize("roughness", [0.2e-6, 0.4e-6, 0.8e-6])
def test_friction_of_flanks_by_hand(roughness: float) -> None:
    """Film of half the sum of speeds, share exp(-1.8 L^1.2) on asperities, the rest in the oil."""
    load, radius, sliding, rolling, viscosity = 9e4, 2e-3, 1.0, 5.0, OIL.dynamic_viscosity
    speed = viscosity * rolling / (STEEL * radius)
    weight, material = load / (STEEL * radius), OIL.pressure_viscosity * STEEL
    film = 2.65 * (0.5 * speed) ** 0.7 * material**0.54 / weight**0.13 * radius
    share = np.exp(-1.8 * (film / roughness) ** 1.2)
    assert 0.02 < share < 0.98
    newton = 0.671e-6 * (sliding / rolling) ** 0.81 * speed**0.26 * (weight * material**2) ** 3.32
    traction = 0.8 * 0.05 + 0.021 * np.tanh(newton / 0.05 - 0.8)
    surface = SURFACE._replace(roughness=roughness)
    found = mesh_friction(load, radius, sliding, rolling, OIL, surface)[0]
    assert found == pytest.approx((1.0 - share) * traction + share * 0.10, rel=1e-3)


def test_flanks_that_slide_more_than_they_roll_are_at_the_end_of_the_slide_ratio() -> None:
    smooth = SURFACE._replace(roughness=0.1e-6)  # a light load, so that the oil is Newtonian
    at = [mesh_friction(2e3, 2e-3, sliding, 5.0, OIL, smooth) for sliding in (4.9, 5.2, 20.0)]
    assert at[2][0] == pytest.approx(at[1][0], rel=1e-9)
    assert at[0][0] < (1.0 - 1e-3) * at[1][0]
    assert at[0][2] > 0.0
    assert at[1][2] == at[2][2] == 0.0


def test_a_film_grows_with_the_powers_of_its_numbers() -> None:
    """U^0.7, G^0.54 and W^-0.13, and 2.65 in the middle of them."""
    base = film_thickness_dowson_higginson(1e-11, 4000.0, 1e-4)
    assert base == pytest.approx(2.65 * 1e-11**0.7 * 4000.0**0.54 * 1e-4**-0.13)
    for factors, power in (((2, 1, 1), 0.7), ((1, 2, 1), 0.54), ((1, 1, 2), -0.13)):
        numbers = np.array(factors) * (1e-11, 4000.0, 1e-4)
        assert film_thickness_dowson_higginson(*numbers) / base == pytest.approx(2.0**power)


@pytest.mark.parametrize(
    ("speed", "applied", "direction"),
    [
        (0.3, -50.0, 1.0),
        (-0.3, 50.0, -1.0),
        (0.0, 9.0, 0.0),
        (0.0, -9.0, 0.0),
        (0.0, 11.0, 1.0),
        (0.0, -11.0, -1.0),
    ],
)
def test_a_joint_at_rest_holds_up_to_its_static_friction(
    speed: float, applied: float, direction: float
) -> None:
    assert next_direction(speed, applied, 10.0) == direction


def test_a_joint_without_static_friction_never_sticks() -> None:
    assert next_direction(0.0, 0.0, 0.0) == 1.0
