"""The ideal machine: rigid fluid, no leakage, no friction."""

from __future__ import annotations

import numpy as np

from toothspace.closures.density import mixture_density
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.core.types import Array, BoolArray
from toothspace.model.description import MachineDescription
from toothspace.results.ledger import ledger_from
from toothspace.results.solution import Solution
from toothspace.results.variables import dataset_from
from toothspace.run.run import Run
from toothspace.solver.cyclic import DENSE, SEEN
from toothspace.solver.lost_flow import openings
from toothspace.solver.outcome import attributes_of

_JOINING_GAP = 5e-6
_SECTIONS = 48
"""Sections along the width of helical teeth."""


def simulate(run: Run, progress: Progress | None = None) -> Solution:
    """Kinematic flow and torque of a case; done at once, so progress is not reported."""
    del progress
    case, description, condition = run.case, run.machine, run.condition
    fluid, speed = run.fluid, condition.shaft_speed
    density = float(mixture_density(condition.inlet_pressure, fluid.feed_gas_mass_fraction, fluid))
    shaft_angle = np.linspace(0.0, 2.0 * np.pi, case.run.samples_per_revolution + 1)
    dense_angle = np.linspace(0.0, 2.0 * np.pi, DENSE // SEEN + 1)
    close = _waves(run, dense_angle)
    chambers = close.pop("chamber_pressure")
    volumes = [
        f.volume(f.phases + f.angle_ratio * shaft_angle[:, None]) for f in description.families
    ]
    extremes = {f"{name}_minimum": values.min(axis=0) for name, values in close.items()}
    extremes |= {f"{name}_maximum": values.max(axis=0) for name, values in close.items()}
    values = {
        "shaft_angle": shaft_angle,
        "time": shaft_angle / speed,
        "shaft_speed": np.full_like(shaft_angle, speed),
        **_waves(run, shaft_angle),
        "chamber_pressure_minimum": chambers.min(axis=0),
        "chamber_pressure_maximum": chambers.max(axis=0),
        **extremes,
        "dense_angle": dense_angle,
        **{f"dense_{name}": values for name, values in close.items()},
        "chamber_volume": np.concatenate([part[..., 0] for part in volumes], axis=1),
        "displacement": np.asarray(description.displacement),
        "inlet_density": np.asarray(density),
        "outlet_density": np.asarray(density),
        "specific_heat_capacity": np.asarray(fluid.specific_heat_capacity),
        **run.values,
    }
    data = dataset_from(
        values,
        {"chamber": description.chamber_labels, "body": [b.name for b in description.bodies]},
        attributes=attributes_of(description, case.title),
    )
    volume = float(np.trapezoid(close["outlet_flow_rate"], dense_angle)) / speed
    ledger = ledger_from(
        {
            "mass_inlet": density * volume,
            "mass_outlet": density * volume,
            "shaft": volume * (condition.outlet_pressure - condition.inlet_pressure),
            "port_inlet": volume * condition.inlet_pressure,
            "port_outlet": volume * condition.outlet_pressure,
        },
        2.0 * np.pi / speed,
        2.0 * np.pi,
    )
    return Solution(Status.DONE, data, ledger, {"revolutions": 1.0}, run.provenance)


def _waves(run: Run, shaft_angle: Array) -> dict[str, Array]:
    """Torque, flows and pressures over the angle, by result variable. [SI]."""
    description, condition = run.machine, run.condition
    dual_flank = run.case.run.flank_sealing == "dual"
    to_outlet = outlet_members(description, shaft_angle, dual_flank=dual_flank)
    if description.winding is None:
        outflow = _outflow(description, shaft_angle, dual_flank=dual_flank)
    else:
        # every section delivers as that of spur gears, at its own place
        section, twist = description.winding.section, description.winding.twist
        parts = [
            _outflow(section, shaft_angle + lead, dual_flank=dual_flank)
            for lead in twist * ((np.arange(_SECTIONS) + 0.5) / _SECTIONS - 0.5)
        ]
        outflow = np.mean(parts, axis=0)
    torque = (condition.outlet_pressure - condition.inlet_pressure) * outflow
    inlet, outlet = condition.inlet_pressure, condition.outlet_pressure
    return {
        "shaft_torque": -torque if description.mode == "motor" else torque,
        "inlet_flow_rate": outflow * condition.shaft_speed,
        "outlet_flow_rate": outflow * condition.shaft_speed,
        "inlet_pressure": np.full_like(shaft_angle, inlet),
        "outlet_pressure": np.full_like(shaft_angle, outlet),
        "chamber_pressure": np.where(to_outlet, outlet, inlet),
    }


def _outflow(description: MachineDescription, shaft_angle: Array, *, dual_flank: bool) -> Array:
    """Volume delivered per shaft angle. [m3/rad]."""
    to_outlet = outlet_members(description, shaft_angle, dual_flank=dual_flank)
    rate = _volume_rates(description, shaft_angle)
    return np.asarray(-np.sum(np.where(to_outlet, rate, 0.0), axis=1))


def outlet_members(
    description: MachineDescription, shaft_angle: Array, *, dual_flank: bool
) -> BoolArray:
    """Which chambers deliver to the outlet; shape (angles, chambers). [-].

    Each group of joined chambers belongs to the port to which it is wider open; a group
    between two contacts, open to none, belongs to the outlet while it shrinks: relief grooves
    are taken as perfectly timed.
    """
    ports = openings(description, shaft_angle)
    preference = ports[..., 1] - ports[..., 0]
    rate = _volume_rates(description, shaft_angle)
    group = np.tile(np.arange(description.chamber_count), (shaft_angle.size, 1))
    if not dual_flank:
        for path in description.paths:
            if path.category.role == "mesh":
                geometry = path.geometry(path.phases + path.angle_ratio * shaft_angle[:, None])
                open_gap = (geometry[..., 0] > _JOINING_GAP) & (geometry[..., 1] > 0.0)
                partner = path.partners(shaft_angle)
                for column in np.flatnonzero(open_gap.any(axis=0)):
                    rows = np.flatnonzero(open_gap[:, column])
                    a, b = group[rows, path.nodes_a[column]], group[rows, partner[rows, column]]
                    first, second = np.minimum(a, b)[:, None], np.maximum(a, b)[:, None]
                    group[rows] = np.where(group[rows] == second, first, group[rows])
    total = np.zeros_like(preference)
    shrinking = np.zeros_like(preference)
    every = np.arange(shaft_angle.size)[:, None]
    np.add.at(total, (every, group), preference)
    np.add.at(shrinking, (every, group), -rate)
    total, shrinking = total[every, group], shrinking[every, group]
    return np.where(np.abs(total) > 1e-15, total, shrinking) > 0.0


def _volume_rates(description: MachineDescription, shaft_angle: Array) -> Array:
    parts = [
        f.angle_ratio * f.volume.derivative(f.phases + f.angle_ratio * shaft_angle[:, None])
        for f in description.families
    ]
    return np.concatenate([part[..., 0] for part in parts], axis=1)
