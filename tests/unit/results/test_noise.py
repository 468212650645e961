"""Forces on the casing and the sound that they make: conservation, limits, scaling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from toothspace.closures.sound import (
    AIR_DENSITY,
    SOUND_SPEED,
    plate_critical_frequency,
    plate_near_field_power,
    plate_point_mobility,
    plate_radiation_efficiency,
    plate_transfer_ratio,
    sphere_radiation_efficiency,
)
from toothspace.model.description import Body
from toothspace.results.noise import (
    NET_MOMENT,
    NET_X,
    NET_Y,
    Casing,
    CasingForces,
    Plate,
    blocked_foot_forces,
    casing_forces,
    orders_up_to,
    sound_powers,
)

SPEED = 150.0
CASING = Casing(mass=4.0, surface=0.05, stiffness=2e9)
PLATE = Plate(length=0.8, width=0.6, thickness=0.01, foot_distance=0.12, shaft_height=0.06)
BODY = Body("rotor", (0.0, 0.0), 1.0, 0.3, 1e-4, "shaft")
WIDTH = 0.02


def run_of_a_rotor() -> xr.Dataset:
    """One rotor on a journal: what pressure and journal do not balance accelerates it."""
    angle = np.linspace(0.0, 2.0 * np.pi, 721)
    k = 12.0
    velocity = np.stack([1e-4 * np.sin(k * angle), 3e-5 * np.cos(2 * k * angle)], axis=-1)
    rate = np.stack([1e-4 * k * np.cos(k * angle), -6e-5 * k * np.sin(2 * k * angle)], axis=-1) * (
        BODY.mass * SPEED
    )
    force = np.stack([900.0 + 80.0 * np.cos(k * angle + 0.4), 30.0 * np.sin(3 * k * angle)], -1)
    pressure = 50e5 + np.stack([1e5 * np.cos(k * angle), 2e4 * np.sin(2 * k * angle)], -1)

    def of_body(values: np.ndarray) -> tuple[tuple[str, ...], np.ndarray]:
        return ("shaft_angle", "body", "axis"), values[:, None]

    return xr.Dataset(
        {
            "shaft_speed": ("shaft_angle", np.full(angle.size, SPEED)),
            "body_force": of_body(force),
            "journal_force": of_body(rate - force),
            "body_velocity": of_body(velocity),
            "chamber_pressure": (("shaft_angle", "chamber"), pressure),
            "chamber_volume": (("shaft_angle", "chamber"), np.full(pressure.shape, 2e-7)),
            "inlet_pressure": ("shaft_angle", np.full(angle.size, 1e5)),
            "outlet_pressure": ("shaft_angle", 1e7 + 2e5 * np.cos(k * angle)),
            "shaft_torque": ("shaft_angle", 9.0 + 0.7 * np.cos(k * angle)),
        },
        coords={"shaft_angle": angle, "body": ["rotor"], "axis": ["x", "y"]},
        attrs={"mode": "pump"},
    )


def only(order: float, **net: complex) -> CasingForces:
    """Net forces of one order alone."""
    zero = {name: np.zeros(1, dtype=complex) for name in (NET_X, NET_Y, NET_MOMENT)}
    given = {name: np.array([complex(value)]) for name, value in net.items()}
    return CasingForces(np.array([order]), SPEED, {"pair": np.zeros(1, complex)}, {}, zero | given)


def test_pressures_and_journals_on_a_closed_casing_sum_to_the_inertia_of_the_gears() -> None:
    forces = casing_forces(run_of_a_rotor(), [BODY], WIDTH)
    for axis in "xy":
        both = forces.pressure[f"pressure_rotor_{axis}"] + forces.inside[f"journal_rotor_{axis}"]
        assert np.abs(both).max() > 0.03
        assert forces.net[f"net_{axis}"] == pytest.approx(both, abs=1e-9)


def test_spectra_hold_the_power_of_their_signals() -> None:
    """Parseval: half the sum of the squares of amplitudes is the variance."""
    data = run_of_a_rotor()
    forces = casing_forces(data, [BODY], WIDTH)
    signal = data["journal_force"].sel(axis="x").values[:-1]
    amplitude = forces.inside["journal_rotor_x"]
    assert 0.5 * np.sum(np.abs(amplitude) ** 2) == pytest.approx(signal.var(), rel=1e-9)
    place = int(np.argmin(np.abs(forces.order - 12.0)))
    assert forces.net[NET_MOMENT][place] == pytest.approx(0.7)
    # both chambers have the same volume: their pressures act on faces of V/b
    assert abs(forces.inside["cover_z"][place]) == pytest.approx(1e5 * 2e-7 / WIDTH)


def test_a_hose_leaves_the_force_of_its_port() -> None:
    """What leaves through the outlet pushes against x, what enters along it."""
    data = run_of_a_rotor()
    data["inlet_pressure"] = 1e5 + 5e4 * np.cos(12.0 * data["shaft_angle"])
    pipes, hoses = (casing_forces(data, [BODY], WIDTH, d) for d in (0.0, 0.02))
    place = int(np.argmin(np.abs(pipes.order - 12.0)))
    extra = hoses.net[NET_X] - pipes.net[NET_X]
    assert extra[place] == pytest.approx(-(2e5 - 5e4) * np.pi * 0.01**2)
    assert hoses.net[NET_Y] == pytest.approx(pipes.net[NET_Y], rel=1e-6, abs=0.0)


def test_orders_end_where_samples_or_bands_do() -> None:
    data = run_of_a_rotor()
    assert casing_forces(data, [BODY], WIDTH).order[-1] == 359
    few = casing_forces(data.isel(shaft_angle=slice(None, None, 40)), [BODY], WIDTH)
    assert few.order[-1] == 8
    assert orders_up_to(1000.0, SPEED)[-1] == 41


def test_a_free_casing_moves_as_an_oscillating_sphere() -> None:
    """W = rho c 4 pi a^2/3 sigma_1 v^2/2 with v = F/(omega m)."""
    found = sound_powers(only(40.0, **{NET_X: 5.0}), CASING, None)
    velocity = 5.0 / (40.0 * SPEED * CASING.mass)
    sigma = sphere_radiation_efficiency(1, 40.0 * SPEED / SOUND_SPEED, CASING.radius)
    expected = AIR_DENSITY * SOUND_SPEED * CASING.surface / 3.0 * sigma * velocity**2 / 2.0
    assert found["motion"][0] == pytest.approx(expected)
    assert "plate" not in found


def test_a_soft_pair_follows_its_spring_and_is_loudest_at_resonance() -> None:
    order = np.array([1.0, 2.0, CASING.resonance / SPEED])
    pair = {"pair": np.full(3, 10.0 + 0.0j)}
    net = {name: np.zeros(3, complex) for name in (NET_X, NET_Y, NET_MOMENT)}
    power = sound_powers(CasingForces(order, SPEED, pair, {}, net), CASING, None)["deformation"]
    # a monopole of constant displacement: velocity squared and efficiency grow by 2^2 each
    assert power[1] / power[0] == pytest.approx(16.0, rel=0.02)
    stiff = replace(CASING, loss_factor=2.0 * CASING.loss_factor)
    calmer = sound_powers(CasingForces(order, SPEED, pair, {}, net), stiff, None)["deformation"]
    assert power[2] / calmer[2] == pytest.approx(4.0)


def test_a_casing_pressed_along_a_line_narrows_across_it() -> None:
    """Radial motion m + q P2: one along the line, minus Poisson's ratio 0.3 across it."""
    m, q = np.linalg.solve([[1.0, 1.0], [1.0, -0.5]], [1.0, -0.3])
    order, force = 60.0, 80.0
    pair = {"pair": np.array([complex(force)])}
    net = {name: np.zeros(1, dtype=complex) for name in (NET_X, NET_Y, NET_MOMENT)}
    omega = order * SPEED
    number = omega / SOUND_SPEED
    sigma = {n: float(sphere_radiation_efficiency(n, number, CASING.radius)) for n in (0, 2)}
    shape = m**2 * sigma[0] + q**2 / 5.0 * sigma[2]
    soft = abs(1.0 - (omega / CASING.resonance) ** 2 + 1j * CASING.loss_factor)
    velocity = 0.5 * omega * force / (CASING.stiffness * soft)
    expected = AIR_DENSITY * SOUND_SPEED * CASING.surface * shape * 0.5 * velocity**2
    forces = CasingForces(np.array([order]), SPEED, pair, {}, net)
    found = sound_powers(forces, CASING, None)["deformation"]
    assert float(found[0]) == pytest.approx(expected, rel=1e-9)


def test_feet_on_a_stiff_plate_feel_the_blocked_forces() -> None:
    forces = only(30.0, **{NET_X: 4.0, NET_Y: 6.0, NET_MOMENT: 1.5})
    lift, tilt = blocked_foot_forces(forces, PLATE)
    assert lift[0] == 3.0
    assert tilt[0] == pytest.approx((1.5 - 0.06 * 4.0) / 0.12)


def test_an_undamped_plate_radiates_all_that_a_light_machine_brings_into_it() -> None:
    found = sound_powers(
        only(30.0, **{NET_Y: 6.0}), replace(CASING, mass=1e-9), replace(PLATE, loss_factor=1e-12)
    )
    bending, mass = PLATE.bending_stiffness, PLATE.mass_per_area
    wave_number = np.array([np.sqrt(30.0 * SPEED) * (mass / bending) ** 0.25])
    ratio = plate_transfer_ratio(wave_number, PLATE.foot_distance).real
    brought = 3.0**2 * plate_point_mobility(bending, mass) * (1.0 + ratio)
    near = plate_near_field_power(3.0**2, mass)
    assert found["plate"] == pytest.approx(brought + near, rel=1e-6)


def test_a_plate_radiates_no_more_than_it_gets_and_mounts_keep_it_quiet() -> None:
    forces = only(30.0, **{NET_Y: 6.0, NET_MOMENT: 1.0})
    loud = sound_powers(forces, CASING, replace(PLATE, loss_factor=1e-9))["plate"][0]
    damped = sound_powers(forces, CASING, PLATE)["plate"][0]
    quiet = sound_powers(forces, CASING, replace(PLATE, mount_stiffness=1e5))["plate"][0]
    assert quiet < 0.01 * damped < 0.01 * loud
    thick = replace(PLATE, thickness=10.0)
    assert sound_powers(forces, CASING, thick)["plate"][0] < 1e-6 * damped


def test_a_machine_on_very_soft_mounts_moves_as_a_free_one() -> None:
    """Lifted by F/(omega m), rocked about its feet by M/(omega I), which its shaft follows."""
    soft = replace(PLATE, mount_stiffness=1e-3)
    order, moment = 40.0, 1.5
    omega = order * SPEED
    lifted = only(order, **{NET_Y: 5.0})
    free = sound_powers(lifted, CASING, None)["motion"]
    assert sound_powers(lifted, CASING, soft)["motion"] == pytest.approx(free, rel=1e-5)
    inertia = CASING.mass * (0.4 * CASING.radius**2 + PLATE.shaft_height**2)
    rocked = moment / (omega * inertia) * PLATE.shaft_height
    expected = free * (rocked / (5.0 / (omega * CASING.mass))) ** 2
    found = sound_powers(only(order, **{NET_MOMENT: moment}), CASING, soft)["motion"]
    assert found == pytest.approx(expected, rel=1e-5)


def test_losses_of_mounts_calm_the_resonance_on_them() -> None:
    """Of a machine on two springs, whose feet give a plate the less the more the mounts take."""
    stiffness = 1e6
    order = np.sqrt(2.0 * stiffness / CASING.mass) / SPEED
    lifted = only(order, **{NET_Y: 5.0})
    powers = [
        sound_powers(
            lifted, CASING, replace(PLATE, mount_stiffness=stiffness, mount_loss_factor=loss)
        )["plate"][0]
        for loss in (1e-9, 0.02, 0.1, 0.5)
    ]
    assert np.all(np.diff(powers) < 0.0)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.5])
def test_on_a_rigid_floor_mounts_carry_a_machine_as_two_damped_springs(ratio: float) -> None:
    """j omega F / (2 k (1 + j eta) - omega^2 m), and likewise about the axis between the feet."""
    stiffness, loss = 1e6, 0.2
    omega = ratio * float(np.sqrt(2.0 * stiffness / CASING.mass))
    floor = replace(PLATE, thickness=1e3, mount_stiffness=stiffness, mount_loss_factor=loss)
    complex_stiffness = stiffness * (1.0 + 1j * loss)
    inertia = CASING.mass * (0.4 * CASING.radius**2 + PLATE.shaft_height**2)
    lifted = 5.0 * omega / (2.0 * complex_stiffness - omega**2 * CASING.mass)
    turning = 0.5 * complex_stiffness * PLATE.foot_distance**2 - omega**2 * inertia
    rocked = 1.5 * omega / turning * PLATE.shaft_height
    free = sound_powers(only(omega / SPEED, **{NET_Y: 5.0}), CASING, None)["motion"]
    for forces, velocity in (({NET_Y: 5.0}, lifted), ({NET_MOMENT: 1.5}, rocked)):
        found = sound_powers(only(omega / SPEED, **forces), CASING, floor)["motion"]
        expected = free * (abs(velocity) / (5.0 / (omega * CASING.mass))) ** 2
        assert found == pytest.approx(expected, rel=1e-4, abs=0.0)


def test_twice_the_force_is_six_decibels() -> None:
    names = {NET_X: 1.0, NET_Y: 2.0, NET_MOMENT: 0.3}
    once = sound_powers(only(50.0, **names), CASING, PLATE)
    twice = sound_powers(only(50.0, **{n: 2.0 * v for n, v in names.items()}), CASING, PLATE)
    for name in ("motion", "plate"):
        assert twice[name] == pytest.approx(4.0 * once[name])


def test_numbers_of_casing_plate_and_orders_by_hand() -> None:
    casing = Casing(mass=4.0, surface=0.04 * np.pi, stiffness=1e8)
    assert casing.radius == pytest.approx(0.1)
    # two halves of 2 kg: sqrt(4 * 1e8 / 4)
    assert casing.resonance == pytest.approx(1e4)
    assert PLATE.mass_per_area == pytest.approx(78.5)
    forces = replace(only(3.0), speed=100.0 * np.pi)
    assert forces.frequency == pytest.approx([150.0])
    np.testing.assert_array_equal(orders_up_to(1000.0, SPEED), np.arange(1, 42))


def test_the_feet_hold_the_torque_of_a_pump_and_of_a_motor_against_each_other() -> None:
    pump = run_of_a_rotor()
    one, other = (
        casing_forces(data, [BODY], WIDTH).net[NET_MOMENT]
        for data in (pump, pump.assign_attrs(mode="motor"))
    )
    np.testing.assert_array_equal(one, -other)


def test_the_last_order_below_ten_kilohertz_band_is_kept() -> None:
    """A third octave of 10 kHz ends at 11 220 Hz: order 44 of a shaft at 250 rev/s is 11 kHz."""
    data = run_of_a_rotor()
    quick = data.assign(shaft_speed=0.0 * data["shaft_speed"] + 500.0 * np.pi)
    assert casing_forces(quick, [BODY], WIDTH).order[-1] == 44


@pytest.mark.parametrize("order", [30.0, 80.0])
@pytest.mark.parametrize("phase", [1.0, -1.0])
def test_a_plate_radiates_the_share_of_its_losses_that_is_sound(order: float, phase: float) -> None:
    """Of two feet in phase and against each other, below the critical frequency and above."""
    bending, mass = PLATE.bending_stiffness, PLATE.mass_per_area
    omega = order * SPEED
    wave_number = np.array([np.sqrt(omega) * (mass / bending) ** 0.25])
    ratio = float(plate_transfer_ratio(wave_number, PLATE.foot_distance).real[0])
    brought = 3.0**2 * plate_point_mobility(bending, mass) * (1.0 + phase * ratio)
    critical = plate_critical_frequency(bending, mass)
    frequency = omega / (2.0 * np.pi)
    sigma = float(plate_radiation_efficiency(np.array([frequency]), critical, 0.8, 0.6)[0])
    sound = AIR_DENSITY * SOUND_SPEED * sigma / (omega * 78.5)
    near = float(plate_near_field_power(3.0**2, mass)) if frequency < critical else 0.0
    net = {NET_Y: 6.0} if phase > 0.0 else {NET_MOMENT: 3.0 * PLATE.foot_distance}
    found = sound_powers(only(order, **net), replace(CASING, mass=1e-9), PLATE)["plate"]
    assert found == pytest.approx(brought * sound / (0.02 + sound) + near, rel=1e-6)


@pytest.mark.parametrize("phase", [1.0, -1.0])
def test_mounts_and_plate_give_way_one_behind_the_other(phase: float) -> None:
    """F = F_blocked / (1 + j omega m Y), v = F Y, Y = Y_0 (1 + phase v(d)/v(0)) + j omega / k.

    The mass that each force moves is half of the machine, or its inertia over (d/sqrt 2)^2.
    """
    order, stiffness = 30.0, 2e7
    omega = order * SPEED
    bending, area = PLATE.bending_stiffness, PLATE.mass_per_area
    wave_number = np.array([np.sqrt(omega) * (area / bending) ** 0.25])
    ratio = complex(plate_transfer_ratio(wave_number, PLATE.foot_distance)[0])
    spring = stiffness * (1.0 + 0.1j)
    mobility = plate_point_mobility(bending, area) * (1.0 + phase * ratio) + 1j * omega / spring
    inertia = CASING.mass * (0.4 * CASING.radius**2 + PLATE.shaft_height**2)
    moved = 0.5 * CASING.mass if phase > 0.0 else 2.0 * inertia / PLATE.foot_distance**2
    velocity = 4.0 / (1.0 + 1j * omega * moved * mobility) * mobility
    if phase < 0.0:
        # the feet go up and down against each other and the shaft swings above them
        velocity *= 2.0 * PLATE.shaft_height / PLATE.foot_distance
    net = {NET_Y: 8.0} if phase > 0.0 else {NET_MOMENT: 4.0 * PLATE.foot_distance}
    mounted = replace(PLATE, mount_stiffness=stiffness)
    found = sound_powers(only(order, **net), CASING, mounted)["motion"]
    free = sound_powers(only(order, **{NET_Y: 5.0}), CASING, None)["motion"]
    expected = free * (abs(velocity) / (5.0 / (omega * CASING.mass))) ** 2
    assert found == pytest.approx(expected, rel=1e-9)
