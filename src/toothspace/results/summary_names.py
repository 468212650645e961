"""Names of summary numbers: the unit that each ends with, and those that runs give."""

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
    "compression_flow_L_per_min", "gas_flow_L_per_min", "port_volume_flow_L_per_min",
    "bearing_position_um", "loaded_contacts_two_or_more", "loaded_contacts_three_or_more",
    "contact_span", *LATERAL,
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
BY_LABEL = ("leakage_", "pressure_leakage_", "drag_leakage_", "torque_loss_", "power_loss_")
"""Beginnings of the names that end with a path or a mechanism of the machine."""


UNITS: Mapping[str, str] = {
    "cm3_per_rev": "cm3/rev", "L_per_min": "L/min", "N_m": "N m", "percent": "%", "bar": "bar",
    "rpm": "rpm", "degC": "degC", "deg": "deg", "W": "W", "um": "um", "mm": "mm", "N": "N",
    "mm2": "mm2", "s": "s", "MPa": "MPa", "K": "K", "mrad": "mrad", "W_per_mm2": "W/mm2",
    "um_bar": "um bar", "mm3": "mm3", "kN": "kN", "J": "J",
}  # fmt: skip
"""Units by the suffix of a name."""


def stem_and_unit(name: str) -> tuple[str, str]:
    """Split a name such as ``mean_flow_L_per_min`` from its unit, ``1`` if it has none."""
    suffix = max((s for s in UNITS if name.endswith(f"_{s}")), key=len, default="")
    return name.removesuffix(f"_{suffix}"), UNITS.get(suffix, "1")


def unit_of(name: str) -> str:
    """Return the unit that the suffix of a name says, ``1`` if it has none."""
    return stem_and_unit(name)[1]


def label_of(name: str) -> str:
    """Return a name with its unit for a reader, such as ``mean flow (L/min)``."""
    stem, unit = stem_and_unit(name)
    words = stem.replace("_", " ")
    return words if unit == "1" else f"{words} ({unit})"


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
            raise CaseError(f"{key}", f"{name!r}, which is no result", allowed).in_file(label)
