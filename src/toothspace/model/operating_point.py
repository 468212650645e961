"""Operating condition of one run, as the model needs it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np

from toothspace.circuit.network import CircuitNetwork
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.types import Array


@final
@dataclass(frozen=True, kw_only=True)
class OperatingCondition:
    """Speed, port pressures and numerical tolerance of a run at prescribed speed."""

    shaft_speed: float
    """Shaft speed, positive. [rad/s]"""
    inlet_pressure: float
    outlet_pressure: float
    drain_pressure: float = 1e5
    """Absolute pressures of the ports. [Pa]"""
    load_area: float = 0.0
    """Throat area of a load orifice behind the outlet volume; zero holds the outlet pressure
    constant. [m2]
    """
    load_node: str = "outlet"
    """Node that the load orifice drains: the outlet or the far end of a line."""
    load_pressure: float = 1e5
    """Pressure behind the load orifice. [Pa]"""
    radial_load: tuple[float, float] = (0.0, 0.0)
    """External force on the shaft of the drive gear, x and y. [N]"""
    radial_motion: bool = True
    """Whether the bodies may move in their bearings."""
    compliant_mesh: bool = False
    """Whether contacts are compliant even where the machine offers a rigid mesh."""
    relative_tolerance: float = 1e-6
    """Relative tolerance of pressures. [-]"""
    circuit: CircuitNetwork | None = None
    """Circuit round the machine. Ports in it take their pressures from it; the pressures above stay
    those at which the bearing blocks seat and tolerances are scaled.
    """
    free_shaft: FreeShaft | None = None
    """Shaft that moves freely; None holds the shaft speed."""
    speed_schedule: Array = field(default_factory=lambda: np.zeros((0, 2)))
    """Time [s] and prescribed shaft speed [rad/s], joined by straight lines; without rows the speed
    stays as it is. Shape (knots, 2).
    """
    shaft_angle: float = 0.0
    """Shaft angle at the start. [rad]"""

    @property
    def over_time(self) -> bool:
        """Whether speed or circuit are meant to change over time."""
        return self.free_shaft is not None or len(self.speed_schedule) > 0

    def port_pressures(self, drain: str) -> Array:
        """Pressures of inlet, outlet and drain, joined to a port or outside. [Pa]."""
        known = {"inlet": self.inlet_pressure, "outlet": self.outlet_pressure}
        end = known.get(drain, self.drain_pressure)
        return np.array([self.inlet_pressure, self.outlet_pressure, end])
