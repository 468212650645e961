"""Names of summary numbers, known before a run: what objectives, targets and limits may name."""

from __future__ import annotations

from collections.abc import Mapping

from toothspace.core.errors import CaseError
from toothspace.core.keys import suggestion
from toothspace.results.performance import LATERAL

STEADY = (
    "displacement_cm3_per_rev", "mean_flow_L_per_min", "mean_torque_N_m", "volumetric_efficiency",
    "hydromechanical_efficiency", "overall_efficiency", "flow_ripple_percent",
    "pressure_ripple_bar", "torque_ripple_percent", "max_chamber_pressure_bar",
    "min_chamber_pressure_bar", "cavitation_index_W", "mean_loaded_contacts",
    "mass_balance_error", "energy_balance_error", "shaft_speed_rpm", "inlet_pressure_bar",
    "outlet_pressure_bar", "shaft_power_W", "hydraulic_power_W", "power_loss_W",
    "inlet_temperature_degC", "outlet_temperature_degC", "drain_temperature_degC",
    "highest_film_temperature_degC", "lost_flow_L_per_min", "mesh_exchange_flow_L_per_min",
    "bearing_position_um", *LATERAL,
)  # fmt: skip
"""Of a run at an operating point; films add some."""
OVER_TIME = (
    "startup_pressure_bar", "max_running_pressure_bar", "startup_pressure_ratio",
    "breakaway_time_s", "breakaway_pressure_bar", "settled_pressure_bar",
    "startup_to_settled_ratio", "displacement_cm3_per_rev", "duration_s", "revolutions",
    "max_shaft_speed_rpm", "mean_flow_L_per_min", "mean_torque_N_m",
    "max_pressure_difference_bar", "max_chamber_pressure_bar", "min_chamber_pressure_bar",
    "mass_balance_error", "energy_balance_error", "supply_energy_J", "shaft_energy_J",
    "loss_energy_J", "real_time_factor",
)  # fmt: skip
"""Of a run with a circuit."""
BY_LABEL = ("leakage_", "torque_loss_", "power_loss_")
"""Beginnings of the names that end with a path or a mechanism of the machine."""


def require_known(wanted: Mapping[str, str], label: str, *, over_time: bool) -> None:
    """Refuse a name that no run gives.

    Parameters
    ----------
    wanted : mapping of str to str
        Names of summary numbers by the key that asks for them.
    label : str
        Name of the case in messages.
    over_time : bool
        Whether the case has a circuit.

    Raises
    ------
    CaseError
        With the nearest known name.
    """
    known = OVER_TIME if over_time else STEADY
    for key, name in wanted.items():
        if name not in known and (over_time or not name.startswith(BY_LABEL)):
            allowed = suggestion(name, known)
            raise CaseError(
                f"{label}: {key}: found {name!r}, which is no result, allowed {allowed}"
            )
