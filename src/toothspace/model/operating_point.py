"""Operating condition of one run, as the model needs it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True, kw_only=True)
class OperatingCondition:
    """Speed, port pressures and numerical tolerance of a run at prescribed speed.

    Parameters
    ----------
    shaft_speed : float
        Shaft speed, positive. [rad/s]
    inlet_pressure, outlet_pressure, drain_pressure : float
        Absolute pressures of the ports. [Pa]
    load_area : float
        Throat area of a load orifice behind the outlet volume; zero holds the outlet
        pressure constant. [m2]
    load_pressure : float
        Pressure behind the load orifice. [Pa]
    radial_load : tuple of float
        External force on the shaft of the drive gear, x and y. [N]
    radial_motion : bool
        Whether the bodies may move in their bearings.
    compliant_mesh : bool
        Whether contacts are compliant even where the machine offers a rigid mesh.
    relative_tolerance : float
        Relative tolerance of pressures. [-]
    """

    shaft_speed: float
    inlet_pressure: float
    outlet_pressure: float
    drain_pressure: float = 1e5
    load_area: float = 0.0
    load_pressure: float = 1e5
    radial_load: tuple[float, float] = (0.0, 0.0)
    radial_motion: bool = True
    compliant_mesh: bool = False
    relative_tolerance: float = 1e-6
