"""Noise of a steady run: forces on the casing in orders of the shaft, and the sound they make."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.closures.sound import (
    AIR_DENSITY,
    SOUND_SPEED,
    plate_bending_stiffness,
    plate_critical_frequency,
    plate_near_field_power,
    plate_point_mobility,
    plate_radiation_efficiency,
    plate_transfer_ratio,
    radiated_power,
    sphere_radiation_efficiency,
)
from toothspace.core.keys import number, quantity
from toothspace.core.types import Array, ComplexArray
from toothspace.results.ripple import PORTS, harmonics

if TYPE_CHECKING:
    import xarray as xr

    from toothspace.model.description import Body

HIGHEST_FREQUENCY = 1000.0 * 10.0**1.05
"""Upper edge of the third octave of 10 kHz. [Hz]"""
NET_X, NET_Y, NET_MOMENT = "net_x", "net_y", "net_moment_z"
"""Forces of the whole machine on its feet (x towards the outlet, y from gear to gear)."""
_NARROWING = 0.3
"""Poisson's ratio of the casing. [-]"""
RADIATORS = ("deformation", "motion", "plate")
"""What radiates: casing that deforms, casing that moves as a whole, plate under it."""


@final
@dataclass(frozen=True, kw_only=True)
class Casing:
    """``[study.casing]``: the casing as two halves on a spring."""

    mass: float = quantity("kg", "Of casing, covers and gears.", above=0, high=10000)
    surface: float = quantity("cm^2", "Outer surface, that of a sphere.", above=0, high=1e6)
    stiffness: float = quantity(
        "N/m", "Force per elongation between journals and bores.", above=0, high=1e13
    )
    loss_factor: float = number(
        "Loss factor of the casing with its joints.", above=0, high=1, default=0.05
    )

    @property
    def radius(self) -> float:
        """Radius of a sphere of that surface. [m]."""
        return math.sqrt(self.surface / (4.0 * math.pi))

    @property
    def resonance(self) -> float:
        """Angular frequency at which both halves swing against each other. [rad/s]."""
        return 2.0 * math.sqrt(self.stiffness / self.mass)


@final
@dataclass(frozen=True, kw_only=True)
class Plate:
    """``[study.plate]``: a plate under the feet, normal to the line of the gear centres."""

    length: float = quantity("mm", "Length.", above=0, high=20000)
    width: float = quantity("mm", "Width.", above=0, high=20000)
    thickness: float = quantity("mm", "Thickness.", above=0, high=500)
    loss_factor: float = number(
        "Loss factor with its joints, without radiation.", above=0, high=1, default=0.02
    )
    youngs_modulus: float = quantity("GPa", "Of the plate.", above=0, high=2000, default=2.1e11)
    poisson_ratio: float = number("Of the plate.", above=0, high=0.5, default=0.3)
    density: float = quantity("kg/m^3", "Of the plate.", above=0, high=30000, default=7850.0)
    foot_distance: float = quantity("mm", "Distance of the feet, along x.", above=0, high=5000)
    shaft_height: float = quantity(
        "mm", "Height of the middle of the casing above the plate.", above=0, high=5000
    )
    mount_stiffness: float | None = quantity(
        "N/m", "Of an elastic mount under each foot; none: rigid.", above=0, high=1e12, default=None
    )
    mount_loss_factor: float = number(
        "Loss factor of elastic mounts.", above=0, high=1, default=0.1
    )

    @property
    def mass_per_area(self) -> float:
        """Mass per area. [kg/m2]."""
        return self.density * self.thickness

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness per width. [N m]."""
        return plate_bending_stiffness(self.youngs_modulus, self.poisson_ratio, self.thickness)


@final
@dataclass(frozen=True)
class CasingForces:
    r"""Forces on the casing as complex peak amplitudes in orders of the shaft.

    Notes
    -----
    Without the inertia of the oil, pressures on all walls of the tooth spaces and on the areas
    :math:`A_p` through which the ports leave sum to zero. What the gears do not get, the casing
    gets; journals hand it over. So the forces of pressures and journals on a closed casing sum
    to the inertia of the gears, of mass :math:`m_b` and velocity :math:`v_b`:

    .. math::

        F_{net} = -\sum_b (F_{p,b} + F_{j,b}) - (p_{out} A_p - p_{in} A_p)\,e_x
                = -\sum_b m_b \dot v_b - (p_{out} - p_{in}) A_p\,e_x, \qquad M_{net} = T

    with the shaft torque :math:`T` that the feet hold (the moment of the gears' inertia is left
    out). Pairs of forces inside, which deform it, sum to nothing.
    """

    order: Array
    """Orders of the shaft, above zero, shape (orders,). [-]"""
    speed: float
    """Mean speed of the shaft. [rad/s]"""
    inside: Mapping[str, ComplexArray]
    """Forces of pairs that deform the casing: of each journal on it along x and y, thrust of
    each helical gear on its face and pressure of the tooth spaces on a cover along z. [N]"""
    pressure: Mapping[str, ComplexArray]
    """Reaction on the casing of pressure and teeth on each gear along x and y. [N]"""
    net: Mapping[str, ComplexArray]
    """``net_x``, ``net_y`` [N] and ``net_moment_z`` about the shaft [N m]."""

    @property
    def frequency(self) -> Array:
        """Frequencies of the orders. [Hz]."""
        return self.order * self.speed / (2.0 * math.pi)


def orders_up_to(highest_frequency: float, speed: float) -> Array:
    """Whole orders of a shaft speed [rad/s] up to a frequency [Hz], from 1. [-]."""
    return np.arange(1.0, math.floor(2.0 * math.pi * highest_frequency / speed) + 1.0)


def casing_forces(
    data: xr.Dataset, bodies: Sequence[Body], face_width: float, port_diameter: float = 0.0
) -> CasingForces:
    r"""Forces on the casing in a steady run, see :class:`CasingForces`.

    Parameters
    ----------
    data : xarray.Dataset
        Result of a steady run with forces of bodies and chamber pressures, with at least two
        samples in a period of the highest order.
    bodies : sequence of Body
        Bodies of the machine, whose mass counts. [kg]
    face_width : float
        Width of the gears, so that :math:`V_i/b` is the face of a space. [m]
    port_diameter : float
        Diameter of the ports where hoses, which carry no force, end; zero for pipes. [m]

    Raises
    ------
    ValueError
        If the samples are too few for order 1.
    """
    speed = float(data["shaft_speed"].mean())
    angle = np.asarray(data["shaft_angle"])
    resolved = math.floor(math.pi / float(np.median(np.diff(angle))) - 1e-6)
    highest = orders_up_to(HIGHEST_FREQUENCY, speed)
    order = highest[highest <= resolved]
    if order.size == 0:
        raise ValueError("too few samples for a spectrum in orders")

    def parts(signal: xr.DataArray) -> ComplexArray:
        return harmonics(angle, np.asarray(signal), order)

    inside: dict[str, ComplexArray] = {}
    pressure: dict[str, ComplexArray] = {}
    net = {axis: np.zeros(order.size, dtype=complex) for axis in "xy"}
    for body in bodies:
        for axis in "xy":
            place = {"body": body.name, "axis": axis}
            inside[f"journal_{body.name}_{axis}"] = -parts(data["journal_force"].sel(place))
            pressure[f"pressure_{body.name}_{axis}"] = -parts(data["body_force"].sel(place))
            velocity = parts(data["body_velocity"].sel(place))
            net[axis] = net[axis] - 1j * order * speed * body.mass * velocity
        if "axial_force" in data:
            thrust = parts(data["axial_force"].sel(body=body.name))
            inside[f"thrust_{body.name}_z"] = thrust
    on_cover = data["chamber_pressure"] * data["chamber_volume"] / face_width
    inside["cover_z"] = parts(on_cover.sum("chamber"))
    area = 0.25 * math.pi * port_diameter**2
    leaving, entering = (parts(data[f"{port}_pressure"]) for port in reversed(PORTS))
    net_x = net["x"] - area * (leaving - entering)
    torque = parts(data["shaft_torque"]) * (-1.0 if data.attrs.get("mode") == "motor" else 1.0)
    return CasingForces(
        order=order,
        speed=speed,
        inside={name: values for name, values in inside.items() if np.any(values)},
        pressure={name: values for name, values in pressure.items() if np.any(values)},
        net={NET_X: net_x, NET_Y: net["y"], NET_MOMENT: torque},
    )


def blocked_foot_forces(forces: CasingForces, plate: Plate) -> tuple[ComplexArray, ComplexArray]:
    r"""Vertical forces of two rigidly held feet. [N].

    That of both in phase, and that of both against each other. [N]

    Parameters
    ----------
    forces : CasingForces
        Forces on the casing. [N]
    plate : Plate
        Plate under it, of which the distances of the feet count. [m]

    Notes
    -----
    :math:`F_+ = F_y/2` and :math:`F_- = (M_z - h F_x)/d` with shaft height :math:`h` and foot
    distance :math:`d`.
    """
    moment = forces.net[NET_MOMENT] - plate.shaft_height * forces.net[NET_X]
    return 0.5 * forces.net[NET_Y], moment / plate.foot_distance


def sound_powers(forces: CasingForces, casing: Casing, plate: Plate | None) -> dict[str, Array]:
    r"""Sound power of every order, by what radiates it.

    Keys are those of :data:`RADIATORS`, without a plate without that. [W]

    Parameters
    ----------
    forces : CasingForces
        Forces on the casing. [N]
    casing : Casing
        Casing.
    plate : Plate or None
        Plate under it; None: it hangs freely.

    Notes
    -----
    *Deformation.* Two halves of mass :math:`m/2` on a spring :math:`K`; every pair of forces
    inside draws them apart by :math:`x`. The surface is that of a sphere of the radius :math:`a`
    which stretches evenly along one axis and narrows across it by Poisson's ratio
    :math:`\nu = 0.3`, with the normal velocity
    :math:`\frac{\omega x}{2} (\cos^2\theta - \nu \sin^2\theta)`. It radiates as monopole and
    quadrupole:

    .. math::

        x = \frac{F}{K\,(1 - \omega^2/\omega_0^2 + j \eta)}, \qquad \omega_0^2 = 4 K/m, \qquad
        W = \rho_0 c_0 S \sum_i \tfrac{1}{2} \left|\frac{\omega x_i}{2}\right|^2 \left[
            \left(\frac{1 - 2\nu}{3}\right)^2 \sigma_0
            + \frac{1}{5} \left(\frac{2 + 2\nu}{3}\right)^2 \sigma_2 \right] .

    *Motion.* The rigid casing follows the net force and rocks about its feet (moment of inertia
    :math:`m (0.4 a^2 + h^2)`), against mobility :math:`Y_\pm = Y_0 [1 \pm v(d)/v(0)]` of the
    plate under two feet and of their mounts of stiffness :math:`k`:

    .. math::

        F_+ = \frac{F_y/2}{1 + \frac{1}{2} j\omega m\,(Y_+ + j\omega/k)}, \qquad
        F_- = \frac{(M_z - h F_x)/d}{1 + 2 j\omega (J/d^2)(Y_- + j\omega/k)},

    and radiates as an oscillating sphere. *Plate.* The power that both feet bring into it is lost
    by damping and by sound to one side, to which the near fields of the feet add:

    .. math::

        P = |F_+|^2 \Re Y_+ + |F_-|^2 \Re Y_-, \qquad
        W = P\,\frac{\eta_r}{\eta + \eta_r} + W_{near}, \qquad
        \eta_r = \frac{\rho_0 c_0 \sigma}{\omega m''} .

    The models of casing and feet are assumptions of ours; radiation and mobilities have their
    sources in :mod:`toothspace.closures.sound`. Powers of forces inside are added, as if they
    had no common phase.
    """
    omega = forces.order * forces.speed
    wave_number = omega / SOUND_SPEED
    soft = 1.0 - (omega / casing.resonance) ** 2 + 1j * casing.loss_factor
    square = np.sum([np.abs(force) ** 2 for force in forces.inside.values()], axis=0)
    half = 0.5 * omega / (casing.stiffness * np.abs(soft))
    monopole, quadrupole = (1.0 - 2.0 * _NARROWING) / 3.0, 2.0 * (1.0 + _NARROWING) / 3.0
    pulsating, stretching, rigid = (
        sphere_radiation_efficiency(degree, wave_number, casing.radius) for degree in (0, 2, 1)
    )
    breathing = monopole**2 * pulsating + 0.2 * quadrupole**2 * stretching
    power = {
        "deformation": radiated_power(breathing, casing.surface, 0.5 * half**2 * square),
    }
    push_x, push_y = forces.net[NET_X], forces.net[NET_Y]
    if plate is None:
        motion = np.abs(push_x) ** 2 + np.abs(push_y) ** 2
        square_velocity = motion / (omega * casing.mass) ** 2
    else:
        bending, mass = plate.bending_stiffness, plate.mass_per_area
        point = plate_point_mobility(bending, mass)
        across = plate_transfer_ratio(
            np.sqrt(omega) * (mass / bending) ** 0.25, plate.foot_distance
        )
        together, against = point * (1.0 + across), point * (1.0 - across)
        mount = np.zeros(omega.size, dtype=complex)
        if plate.mount_stiffness is not None:
            stiff = plate.mount_stiffness * (1.0 + 1j * plate.mount_loss_factor)
            mount = 1j * omega / stiff
        inertia = casing.mass * (0.4 * casing.radius**2 + plate.shaft_height**2)
        lift, tilt = blocked_foot_forces(forces, plate)
        lever = 2.0 * inertia / plate.foot_distance**2
        lift = lift / (1.0 + 0.5j * omega * casing.mass * (together + mount))
        tilt = tilt / (1.0 + 1j * omega * lever * (against + mount))
        rocking = 2.0 * tilt * (against + mount) * plate.shaft_height / plate.foot_distance
        square_velocity = np.abs(lift * (together + mount)) ** 2 + np.abs(rocking) ** 2
        both = np.abs(lift) ** 2, np.abs(tilt) ** 2
        brought = both[0] * together.real + both[1] * against.real
        critical = plate_critical_frequency(bending, mass)
        frequency = forces.frequency
        efficiency = plate_radiation_efficiency(frequency, critical, plate.length, plate.width)
        radiating = AIR_DENSITY * SOUND_SPEED * efficiency / (omega * mass)
        near = np.where(frequency < critical, plate_near_field_power(sum(both), mass), 0.0)
        power["plate"] = brought * radiating / (plate.loss_factor + radiating) + near
    power["motion"] = radiated_power(rigid, casing.surface, square_velocity / 6.0)
    return {name: power[name] for name in RADIATORS if name in power}
