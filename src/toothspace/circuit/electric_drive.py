"""Electric motor with inverter and speed controller on the shaft.

The controller works in samples, as those of inverters do: it knows the speed of its last sample
and its torque is reached along a straight line to the next one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, final

import numpy as np

from toothspace.circuit.history import SpeedHistory
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, file_path, forbid, number, quantity
from toothspace.core.signals import read_grid
from toothspace.core.types import Array


class ElectricPower(NamedTuple):
    """Powers of motor and inverter at samples. [W]."""

    electric: Array
    """Drawn from the supply, negative where it is fed back."""
    motor_loss: Array
    """In copper and iron; with a table of losses all that it gives."""
    inverter_loss: Array
    """In the inverter; zero with a table of losses."""


@dataclass(frozen=True, kw_only=True)
class ElectricMotor(KeyTable):
    """Motor with inverter: torque that the voltage leaves, and losses over torque and speed."""

    peak_torque: float = quantity("N m", "Largest torque at low speed.", above=0, high=1e5)
    corner_speed: float = quantity(
        "rpm", "Speed to which the voltage allows the peak torque.", above=0, high=50000
    )
    no_load_speed: float = quantity(
        "rpm", "Speed at which the voltage leaves no torque.", above=0, high=50000
    )
    voltage_ratio: float = number(
        "Voltage of the supply over that of both speeds.", low=0.1, high=2, default=1.0
    )
    copper_loss: float = quantity(
        "W", "In the windings at peak torque; grows with its square.", low=0, high=1e6, default=0.0
    )
    iron_loss: float = quantity(
        "W", "At the corner speed; grows with its square.", low=0, high=1e6, default=0.0
    )
    inverter_loss: float = quantity(
        "W", "Of the inverter at peak torque; grows with it.", low=0, high=1e6, default=0.0
    )
    standby_loss: float = quantity(
        "W", "Of the inverter without torque.", low=0, high=1e5, default=0.0
    )
    losses: Path | None = file_path(
        "Measured losses of motor and inverter instead: columns speed [rpm], torque [N m] and "
        "loss [W] of a full grid, for either sign of both.",
        ".csv",
    )

    def __post_init__(self) -> None:
        if self.no_load_speed <= self.corner_speed:
            found = f"{self.no_load_speed * 30.0 / np.pi:g} rpm"
            raise CaseError("no_load_speed", found, "a speed above corner_speed")
        if self.losses is not None:
            given = [
                name
                for name in ("copper_loss", "iron_loss", "inverter_loss", "standby_loss")
                if getattr(self, name) > 0.0
            ]
            if given:
                forbid(self, "because losses is given", given[0])
            _ = self._table

    @cached_property
    def _table(self) -> tuple[Array, Array, Array] | None:
        """Speeds [rad/s], torques [N m] and losses [W] of the file."""
        if self.losses is None:
            return None
        return read_grid(self.losses, {"speed": "rpm", "torque": "N m", "loss": "W"})

    def torque_limit(self, speed: Any) -> Any:
        r"""Largest torque with the rotation that the voltage leaves at a speed. [N m].

        Parameters
        ----------
        speed : float or ndarray
            Speed of the shaft. [rad/s]

        Notes
        -----
        A resistance and a voltage that grows with the speed:

        .. math:: T = \min\left(\hat T,\; \hat T\,
            \frac{(U/U_n)\,\omega_0 - |\omega|}{\omega_0 - \omega_c}\right) \ge 0

        Validity: no field weakening. Torque against the rotation is limited by its peak alone.
        """
        slope = self.peak_torque / (self.no_load_speed - self.corner_speed)
        left = slope * (self.voltage_ratio * self.no_load_speed - np.abs(speed))
        return np.clip(left, 0.0, self.peak_torque)

    def limited(self, torque: float, speed: float) -> float:
        """Torque [N m] that motor and voltage give of a wanted one at a speed [rad/s]."""
        ahead = float(self.torque_limit(speed))
        high, low = (ahead, -self.peak_torque) if speed >= 0.0 else (self.peak_torque, -ahead)
        return min(max(torque, low), high)

    def powers(self, torque: Any, speed: Any) -> ElectricPower:
        r"""Electric power and losses at torques and speeds.

        Parameters
        ----------
        torque, speed : float or ndarray
            Torque of the motor [N m] and speed of the shaft [rad/s].

        Notes
        -----
        .. math:: P_{el} = T \omega + P_{Cu} (T/\hat T)^2 + P_{Fe} (\omega/\omega_c)^2
            + P_0 + P_I\,|T|/\hat T

        Validity: constant resistance; iron without the share that grows with the speed alone; a
        table of losses is bilinear and flat outside.
        """
        torque, speed = np.asarray(torque, dtype=float), np.asarray(speed, dtype=float)
        if self._table is not None:
            from scipy.interpolate import RegularGridInterpolator

            speeds, torques, losses = self._table
            places = np.broadcast_arrays(
                np.clip(np.abs(speed), speeds[0], speeds[-1]),
                np.clip(np.abs(torque), torques[0], torques[-1]),
            )
            table = RegularGridInterpolator((speeds, torques), losses)
            motor, inverter = np.asarray(table(np.stack(places, -1))), np.zeros_like(torque * speed)
        else:
            load = torque / self.peak_torque
            motor = self.copper_loss * load**2 + self.iron_loss * (speed / self.corner_speed) ** 2
            inverter = self.standby_loss + self.inverter_loss * np.abs(load) + 0.0 * speed
        return ElectricPower(torque * speed + motor + inverter, motor, inverter)


@final
@dataclass(frozen=True, kw_only=True)
class ElectricDrive(ElectricMotor, SpeedHistory):
    """``kind = "electric_drive"``: motor with inverter that holds a speed over time."""

    inertia: float = quantity("kg m^2", "Of the rotor.", above=0, high=1000)
    step: float = quantity(
        "s", "From one sample of the controller to the next.", above=0, high=1, default=1e-3
    )
    proportional: float = quantity(
        "N m s/rad", "Torque per missing speed.", low=0, high=1e6, default=0.0
    )
    integral: float = quantity("N m/rad", "Torque per missing angle.", low=0, high=1e6, default=0.0)

    def __post_init__(self) -> None:
        ElectricMotor.__post_init__(self)
        SpeedHistory.__post_init__(self)
        if self.proportional == self.integral == 0.0:
            raise CaseError("proportional", "0 N m s/rad", "a gain, here or as integral")


@final
@dataclass(frozen=True)
class LinkedDrive:
    """A drive on the shaft: like a unit of another program it receives a value and sets another."""

    name: str
    keys: ElectricDrive
    told: tuple[tuple[str, str, str], ...] = (("speed", "speed", ""),)
    """Name, the value that it receives, and the node of a pressure."""
    sets: tuple[tuple[str, str, int], ...] = (("torque", "torque", -1),)
    """Name, what it sets, and -1 for the shaft."""


@final
class SpeedController:
    """Controller at work: proportional and integral, with a limit that stops the integral.

    Parameters
    ----------
    drive : ElectricDrive
        Keys of the drive.
    """

    def __init__(self, drive: ElectricDrive) -> None:
        self._drive = drive
        self._held = 0.0

    def step(self, time: float, values: Sequence[float]) -> list[float]:
        """Torque that the drive takes from the shaft at the next sample. [N m].

        Parameters
        ----------
        time : float
            Time of this sample. [s]
        values : sequence of float
            Speed of the shaft. [rad/s]
        """
        drive, speed = self._drive, values[0]
        wanted = np.interp(time + drive.step, *drive.speed_over_time.T)
        missing = float(wanted) - speed
        held = self._held + drive.integral * drive.step * missing
        asked = drive.proportional * missing + held
        given = drive.limited(asked, speed)
        # what the limit cuts off is not stored up
        if given == asked:
            self._held = held
        return [-given]

    def close(self) -> None:
        """Nothing is held."""
