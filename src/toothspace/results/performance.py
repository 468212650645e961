r"""Efficiencies, mean values and temperatures of a run, from its samples and its ledger.

The geometric displacement :math:`V` is the single-flank one, density :math:`\rho` is taken
at the inlet pressure, and powers come from the ledger, not from samples.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.core.units import ZERO_CELSIUS
from toothspace.model.path_category import DRAIN
from toothspace.results import ripple
from toothspace.results.ledger import Ledger, loss_causes

if TYPE_CHECKING:
    import xarray as xr


_LITRE_PER_MINUTE = 6e4
_LEAST_ROWS = 2
_BAR = 1e5
_TURN = 2.0 * np.pi
_VAPOUR = 1e-4

DRAIN_HEAT = (DRAIN.account, "journal_viscous", "journal_asperity", "shaft_seal")
"""Losses that warm the drain flow; films on the gear faces exchange theirs with the chambers."""
LATERAL = {
    "lateral_leakage_L_per_min": ("lateral_leakage", 6e4),
    "lateral_torque_N_m": ("lateral_torque", 1.0),
    "axial_load_N": ("lateral_axial_force", 1.0),
    "axial_moment_N_m": ("lateral_axial_moment", 1.0),
    "smallest_film_um": ("lateral_smallest_gap", 1e6),
    "floating_side_gap_um": ("floating_side_gap", 1e6),
    "solid_side_gap_um": ("solid_side_gap", 1e6),
    "contact_force_N": ("lateral_contact_force", 1.0),
    "real_contact_area_mm2": ("lateral_real_contact_area", 1e6),
    "contact_share": ("lateral_contact_share", 1.0),
    "wear_power_W_per_mm2": ("lateral_wear_power", 1e-6),
    "housing_friction_N": ("lateral_housing_friction", 1.0),
    "hold_down_force_N": ("solid_bearing_seat_force", 1.0),
    "tipping_margin_mm": ("solid_bearing_seat_margin", 1e3),
    # former names of these two
    "seat_force_N": ("solid_bearing_seat_force", 1.0),
    "seat_margin_mm": ("solid_bearing_seat_margin", 1e3),
    "force_balance_error": ("lateral_equilibrium_residual", 1.0),
    "preload_N": ("floating_bearing_preload", 1.0),
    "face_deflection_um": ("film_deformation_largest", 1e6),
    "face_deflection_error_um": ("film_deformation_error", 1e6),
    "film_temperature_rise_K": ("lateral_temperature_rise", 1.0),
}
"""Statistics of lateral films and the size of their unit in that of the number. By its name."""
PRESSURE = "pressure_leakage_"
"""Before the name of a path: what pressure drives back through it."""
DRAG = "drag_leakage_"
"""Before the name of a path: what moving walls drag through it, negative where they deliver."""
COMPRESSION = "compression_flow"
GAS = "gas_flow"
PORT_VOLUMES = "port_volume_flow"
EXCHANGE = "mesh_exchange_flow"
LABELS: Mapping[str, str] = {
    COMPRESSION: "compression of the liquid in the chambers",
    GAS: "free gas and vapour in the chambers",
    PORT_VOLUMES: "kept in port volumes and lines",
    EXCHANGE: "timing, and exchange through ports, grooves and the mesh",
}
"""Parts of the lost flow besides the leakage of paths, with a readable name."""


def volumetric_efficiency(data: xr.Dataset, ledger: Ledger) -> float:
    r"""Volumetric efficiency, referred to the density at the inlet. [-].

    Notes
    -----
    .. math:: \eta_v = \frac{m_{out}}{\rho(p_{in})\, V \varphi}\ \text{(pump)},\qquad
              \eta_v = \frac{\rho(p_{in})\, V \varphi}{m_{in}}\ \text{(motor)}

    with masses over a window in which the shaft turns by :math:`\varphi`. Forward drag in
    the tip gaps may lift it above 1 by a few tenths of a percent near zero pressure difference.
    """
    ideal = float(data["inlet_density"]) * float(data["displacement"]) * ledger.shaft_angle
    if _is_motor(data):
        return _ratio(ideal, ledger.mass.get("inlet", 0.0))
    return _ratio(ledger.mass.get("outlet", 0.0), ideal)


def overall_efficiency(data: xr.Dataset, ledger: Ledger) -> float:
    r"""Delivered over supplied energy of the ledger. [-].

    Notes
    -----
    Port energy over shaft energy in a pump, the inverse in a motor. The energy of an
    external drain counts with the ports, so the result does not depend on the pressure
    that enthalpies are counted from.
    """
    if _is_motor(data):
        return _ratio(ledger.shaft_energy, ledger.port_energy)
    return _ratio(ledger.port_energy, ledger.shaft_energy)


def hydromechanical_efficiency(data: xr.Dataset, ledger: Ledger) -> float:
    """Overall over volumetric efficiency. [-]."""
    return _ratio(overall_efficiency(data, ledger), volumetric_efficiency(data, ledger))


def mean_flow_rate(data: xr.Dataset, ledger: Ledger) -> float:
    """Mass flow over density at the working port: pump outlet, motor inlet. [m3/s]."""
    side = ripple.working_side(data)
    mass = ledger.mass.get(side, 0.0)
    return _ratio(mass, ledger.duration * float(data[f"{side}_density"]))


def mean_torque(data: xr.Dataset, ledger: Ledger) -> float:
    """Mean shaft torque from the ledger, absorbed by a pump, delivered by a motor. [N m]."""
    sign = -1.0 if _is_motor(data) else 1.0
    return sign * _ratio(ledger.shaft_energy, ledger.shaft_angle)


def outlet_temperature(data: xr.Dataset, ledger: Ledger) -> float:
    r"""Mean temperature at the outlet. [K].

    Notes
    -----
    That of the heat network, if the run has one, else :math:`\Delta T = P_{loss}/(\dot m c_p)`:
    an external drain takes the heat of :data:`DRAIN_HEAT` with it; an internal one returns it
    to the stream.
    """
    if "temperature" in data:
        return float(data["temperature"].sel(heat_node="outlet"))
    heat = ledger.loss_energy
    if ledger.mass.get("drain", 0.0) > 0.0:
        heat -= _drain_heat(ledger)
    mass = ledger.mass.get("outlet", 0.0)
    return float(data["fluid_temperature"]) + _rise(data, heat, mass)


def drain_temperature(data: xr.Dataset, ledger: Ledger) -> float:
    """Mean temperature of the drain flow, external or internal. [K].

    That of the heat network, if the run has one, else an upper bound without any heat that is
    conducted into bodies and casing.
    """
    if "temperature" in data:
        return float(data["temperature"].sel(heat_node="drain"))
    mass = ledger.duration * drain_flow(data, ledger)
    return float(data["fluid_temperature"]) + _rise(data, _drain_heat(ledger), mass)


def drain_flow(data: xr.Dataset, ledger: Ledger) -> float:
    """Mean mass flow from the chambers to the drain, external or internal. [kg/s]."""
    outside = ledger.mass.get("drain", 0.0)
    if outside:
        return outside / ledger.duration
    if "drain_flow_rate" not in data:
        return 0.0
    return float(data["drain_flow_rate"].mean()) * float(data["inlet_density"])


def _rise(data: xr.Dataset, heat: float, mass: float) -> float:
    if heat == 0.0:
        return 0.0
    if mass < 0.0:
        return float("nan")  # a stream that runs backwards brings no heat
    return _ratio(heat, mass * float(data["specific_heat_capacity"]))


def summary_numbers(data: xr.Dataset, ledger: Ledger) -> dict[str, float]:
    """Return the summary numbers of a run, in engineering units named by their suffix."""
    data = ripple.distinct_samples(data)
    lowest, highest = ripple.extremes(data, "chamber_pressure")
    numbers = {
        "displacement_cm3_per_rev": float(data["displacement"]) * _TURN * 1e6,
        "mean_flow_L_per_min": mean_flow_rate(data, ledger) * _LITRE_PER_MINUTE,
        "mean_torque_N_m": mean_torque(data, ledger),
        "volumetric_efficiency": volumetric_efficiency(data, ledger),
        "hydromechanical_efficiency": hydromechanical_efficiency(data, ledger),
        "overall_efficiency": overall_efficiency(data, ledger),
        "flow_ripple_percent": ripple.flow_ripple_percent(data),
        "pressure_ripple_bar": ripple.pressure_ripple(data) / _BAR,
        "torque_ripple_percent": ripple.torque_ripple_percent(data),
        "max_chamber_pressure_bar": float(np.max(highest)) / _BAR,
        "min_chamber_pressure_bar": float(np.min(lowest)) / _BAR,
        "cavitation_index_W": vapour_collapse_power(data),
    }
    if "contact_force" in data:
        # of elastic teeth the contact ratio under load
        numbers["mean_loaded_contacts"] = mean_loaded_contacts(data)
    if "axial_force" in data:
        # of the body on which it is largest
        forces = np.asarray(data["axial_force"].mean("shaft_angle"))
        numbers["axial_force_N"] = float(forces[np.argmax(np.abs(forces))])
    numbers["mass_balance_error"] = ledger.mass_balance_error
    numbers["energy_balance_error"] = ledger.energy_balance_error
    torque = means_by_label(data, "torque_loss")
    causes = dict.fromkeys(("trapping", "throttling", "leakage", "friction", "other"), 0.0)
    for entry in loss_causes(ledger):
        causes[entry.cause] += entry.power
    lost = lost_flow_rate(data, ledger)
    parts = parts_of(data)
    leakage = leakages_of(parts) or means_by_label(data, "leakage")
    parts = parts or {EXCHANGE: lost - sum(leakage.values())}
    flows = {**{f"leakage_{k}": v for k, v in leakage.items()}, "lost_flow": lost, **parts}
    duration = ledger.duration
    operating = {
        "shaft_speed_rpm": _ratio(ledger.shaft_angle, duration) * 60.0 / _TURN,
        "inlet_pressure_bar": float(data["inlet_pressure"].mean()) / _BAR,
        "outlet_pressure_bar": float(data["outlet_pressure"].mean()) / _BAR,
        "shaft_power_W": abs(_ratio(ledger.shaft_energy, duration)),
        "hydraulic_power_W": abs(_ratio(ledger.port_energy, duration)),
        "power_loss_W": _ratio(ledger.loss_energy, duration),
        "inlet_temperature_degC": float(data["fluid_temperature"]) - ZERO_CELSIUS,
        "outlet_temperature_degC": outlet_temperature(data, ledger) - ZERO_CELSIUS,
        "drain_temperature_degC": drain_temperature(data, ledger) - ZERO_CELSIUS,
    }
    if "temperature" in data:
        films = data["temperature"][data["heat_node"].str.contains("_film.")]
        if films.size:
            operating["highest_film_temperature_degC"] = float(films.max()) - ZERO_CELSIUS
    return {
        **numbers,
        **operating,
        **{f"power_loss_{cause}_W": power for cause, power in causes.items()},
        **{f"{k}_L_per_min": v * _LITRE_PER_MINUTE for k, v in flows.items()},
        **{f"torque_loss_{k}_N_m": v for k, v in torque.items()},
    }


def transient_numbers(data: xr.Dataset, ledger: Ledger) -> dict[str, float]:
    """Return the summary numbers of a run over time; means are over the whole run."""
    side = ripple.working_side(data)
    speed = np.asarray(data["shaft_speed_highest"])
    extremes = {}
    if "chamber_pressure" in data:
        highest, lowest = (data[f"chamber_pressure_{end}"] for end in ("highest", "lowest"))
        extremes["max_chamber_pressure_bar"] = float(highest.max()) / _BAR
        extremes["min_chamber_pressure_bar"] = float(lowest.min()) / _BAR
    electric = {}
    if "electric_power" in data and data.sizes["time"] >= _LEAST_ROWS:
        lost = data["drive_motor_loss"] + data["drive_inverter_loss"]
        electric = {
            "electric_energy_J": _integral(data, np.asarray(data["electric_power"])),
            "drive_loss_energy_J": _integral(data, np.asarray(lost)),
        }
    return {
        "displacement_cm3_per_rev": float(data["displacement"]) * _TURN * 1e6,
        "duration_s": ledger.duration,
        "revolutions": ledger.shaft_angle / _TURN,
        "max_shaft_speed_rpm": float(speed.max()) * 60.0 / _TURN,
        "mean_flow_L_per_min": float(data[f"{side}_flow_rate"].mean()) * _LITRE_PER_MINUTE,
        "mean_torque_N_m": float(data["shaft_torque"].mean()),
        "max_pressure_difference_bar": float(data["pressure_difference_highest"].max()) / _BAR,
        **extremes,
        "mass_balance_error": ledger.mass_balance_error,
        "energy_balance_error": ledger.energy_balance_error,
        "supply_energy_J": ledger.energy.get("supply", 0.0),
        "shaft_energy_J": -ledger.shaft_energy,
        "loss_energy_J": ledger.loss_energy,
        **electric,
    }


def _integral(data: xr.Dataset, rows: Array) -> float:
    """Integral over the time of a run of rows that are means of samples at ends of steps."""
    time = np.asarray(data["time"])
    width = float(time[1] - time[0])
    # sums over ends of steps less half of what the ends of the run differ by: trapezia
    step = 2.0 * float(time[0]) - width
    first, last = 1.5 * rows[0] - 0.5 * rows[1], 1.5 * rows[-1] - 0.5 * rows[-2]
    return float(width * rows.sum() - 0.5 * step * (last - first))


def lost_flow_rate(data: xr.Dataset, ledger: Ledger) -> float:
    """Flow that the volumetric efficiency lacks, at the density of the inlet. [m3/s]."""
    density, displacement = float(data["inlet_density"]), float(data["displacement"])
    return lost_flow_of(ledger, density, displacement, motor=_is_motor(data))


def lost_flow_of(ledger: Ledger, density: float, displacement: float, *, motor: bool) -> float:
    r"""Flow that a machine of a displacement [m3/rad] lacks, or a motor takes beyond it. [m3/s].

    Notes
    -----
    .. math:: Q_{lost} = V \omega - \dot m_{out} / \rho(p_{in})\ \text{(pump)},\qquad
              Q_{lost} = \dot m_{in} / \rho(p_{in}) - V \omega\ \text{(motor)}

    Its parts are those of :mod:`toothspace.results.performance`.
    """
    mass = ledger.mass.get("inlet" if motor else "outlet", 0.0)
    lost = density * displacement * ledger.shaft_angle - mass
    return _ratio(-lost if motor else lost, density * ledger.duration)


def mean_loaded_contacts(data: xr.Dataset) -> float:
    """Mean number of contacts that carry. [-]."""
    if "contact_loaded_share" in data:
        return float(data["contact_loaded_share"].sum())
    return float((data["contact_force"] > 0.0).sum("contact").mean())


def means_by_label(data: xr.Dataset, name: str) -> Mapping[str, float]:
    """Mean over the samples of a variable with one label dimension, by label.

    Mean by label, empty if the result lacks the variable. [unit of the variable]

    Parameters
    ----------
    name : str
        Variable such as ``leakage`` or ``torque_loss``.
    """
    if name not in data:
        return {}
    return by_label(data[name].mean(str(data[name].dims[0])))


def by_label(array: xr.DataArray) -> dict[str, float]:
    """Values over one label dimension, by label. [unit of the array]."""
    labels = array[array.dims[0]].values
    return {str(label): float(value) for label, value in zip(labels, array.values, strict=True)}


def vapour_collapse_power(data: xr.Dataset) -> float:
    r"""Mean power that collapsing vapour sets free, an index of cavitation damage. [W].

    Notes
    -----
    .. math:: P = \overline{\sum_i p_h \max\left(0, -\mathrm{d}V_{v,i}/\mathrm{d}t\right)}

    with the vapour volume of every chamber and the high port pressure that drives its collapse.
    Damage begins at a share of it that depends on material and place; without vapour it is zero.

    References
    ----------
    .. [1] R. Fortes-Patella, J.-L. Reboud, L. Briancon-Marjollet, "A phenomenological and
       numerical model for scaling the flow agressiveness in cavitation erosion", EROCAV
       Workshop, Val de Reuil, 2004.
    """
    if "vapour_collapse_power" in data:
        return float(data["vapour_collapse_power"])
    if "chamber_vapour_fraction" not in data or "chamber_volume" not in data:
        return 0.0
    high = max(float(data[f"{port}_pressure"].mean()) for port in ripple.PORTS)
    fraction, volume = data["chamber_vapour_fraction"], data["chamber_volume"]
    return collapse_power(np.asarray(fraction), np.asarray(volume), np.asarray(data["time"]), high)


def collapse_power(fraction: Array, volume: Array, times: Array, high: float) -> float:
    """Mean power of collapsing vapour under a high pressure [Pa], see above. [W]."""
    vapour = np.where(fraction > _VAPOUR, fraction, 0.0) * volume
    collapsed = float(np.sum(np.maximum(-np.diff(vapour, axis=0), 0.0)))
    return _ratio(high * collapsed, float(times[-1] - times[0]))


def _drain_heat(ledger: Ledger) -> float:
    return sum(ledger.energy.get(name, 0.0) for name in DRAIN_HEAT)


def _is_motor(data: xr.Dataset) -> bool:
    return data.attrs.get("mode") == "motor"


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator != 0.0 else float("nan")


def lateral_numbers(data: xr.Dataset, statistics: Mapping[str, float]) -> dict[str, float]:
    """Numbers of a run with solved or tabulated lateral films, names with unit suffix.

    Parameters
    ----------
    data : xarray.Dataset
        Samples of the last revolution.
    statistics : mapping of str to float
        Numbers of the films in SI units; without them and tables the result is empty.
    """
    numbers = {
        name: statistics[key] * unit for name, (key, unit) in LATERAL.items() if key in statistics
    }
    if "axial_load" in data:
        numbers["axial_load_N"] = float(data["axial_load"].mean())
    if "lateral_leakage" in statistics:
        position = float(data["bearing_position"].mean()) * 1e6
        numbers = {"bearing_position_um": position, **numbers}
    return numbers


def parts_of(data: xr.Dataset) -> dict[str, float]:
    """Parts of the lost flow of a result, empty if it has none. [m3/s]."""
    if "lost_flow" not in data:
        return {}
    return {
        str(name): float(value)
        for name, value in zip(data["flow_part"].values, data["lost_flow"].values, strict=True)
    }


def leakages_of(parts: Mapping[str, float]) -> dict[str, float]:
    """Leakage of every path, by pressure and drag together. [unit of the parts]."""
    found: dict[str, float] = {}
    for before in (PRESSURE, DRAG):
        for name, value in parts.items():
            if name.startswith(before):
                path = name.removeprefix(before)
                found[path] = found.get(path, 0.0) + value
    return found
