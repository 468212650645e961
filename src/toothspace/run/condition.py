"""Fluid and operating condition of a case."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from toothspace.case import Case
from toothspace.case.conditions import FluidChoice
from toothspace.circuit.circuit import build_circuit
from toothspace.circuit.network import led_history
from toothspace.circuit.restrictions import ReliefValve
from toothspace.circuit.shaft_loads import shaft_of, speed_of
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.errors import CaseError
from toothspace.core.finding import Finding
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import (
    GasModel,
    TableFit,
    fluid_law,
    highest_pressure,
    liquid_at,
    temperature_range,
)
from toothspace.model.operating_point import OperatingCondition

LINE_END = "line_end"
"""Node at the far end of a line at the outlet, before its load."""

_EXPECTED_PRESSURE = 50e5
_THICKEST = 1.62e-3
_DENSITY_FIT, _VISCOSITY_FIT = 0.01, 0.1
_BEYOND_BREAKAWAY = 1.5


def fluid_keys(case: Case) -> FluidChoice:
    """``[fluid]`` of a case.

    Raises CaseError if it has none.
    """
    if case.fluid is None:
        raise CaseError("fluid", "none", "a case with a [fluid] table")
    return case.fluid


def fluid_of(case: Case, temperature: float | None = None) -> FluidLaw:
    """Constants of the fluid of a case.

    Parameters
    ----------
    case : Case
        Case with a fluid.
    temperature : float, optional
        Temperature; that of the case if not given. [K]
    """
    choice = fluid_keys(case)
    gas = GasModel(
        choice.gas_law,
        choice.free_air_fraction,
        choice.dissolved_air_fraction,
        choice.saturation_pressure,
        choice.release_time,
        choice.absorption_time,
    )
    asked = choice.temperature if temperature is None else temperature
    return fluid_law(choice.source, asked, gas)


def fluid_limits(case: Case) -> tuple[float, tuple[float, float]]:
    """Pressure up to which, temperatures between which a fluid is known. [Pa], [K]."""
    choice = fluid_keys(case)
    highest = highest_pressure(choice.source, choice.temperature)
    return highest, temperature_range(choice.source)


def fluid_findings(case: Case, fluid: FluidLaw) -> Iterator[Finding]:
    """Say where the liquid is thicker than gear machines take, or its table is fitted badly.

    References
    ----------
    .. [1] Parker Hannifin, PGP/PGM 300 Series service manual HY09-SM300/US: 7500 SSU (1620 mm2/s)
       at most when gear pumps and motors start.
    """
    viscosity = fluid.dynamic_viscosity / fluid.reference_density
    if viscosity > _THICKEST:
        found, allowed = (f"{1e6 * value:.4g} mm2/s" for value in (viscosity, _THICKEST))
        yield Finding(
            "limit",
            f"The liquid has {found} at its temperature; gear pumps and motors start with up to "
            f"{allowed} (Parker HY09-SM300): spaces may not fill, and films warm more than a run "
            "at one temperature knows.",
            quantity="Kinematic viscosity of the liquid",
            found=found,
            allowed=f"up to {allowed}",
            advice="Raise fluid.temperature or take a thinner oil.",
        )
    choice = fluid_keys(case)
    fit = liquid_at(choice.source, choice.temperature)
    if not isinstance(fit, TableFit):
        return
    for name, error, largest in (
        ("densities", fit.density_error, _DENSITY_FIT),
        ("viscosities", fit.viscosity_error, _VISCOSITY_FIT),
    ):
        if error > largest:
            yield Finding(
                "warning",
                f"The law of the fluid misses {name} of its table by up to {100 * error:.2g} %.",
                quantity=f"Fit of the {name} of the fluid",
                found=f"{100 * error:.2g} %",
                allowed=f"up to {100 * largest:g} %",
                advice="Give the table isotherms about the pressures of the run only, close to "
                "fluid.temperature.",
            )


def condition_of(
    case: Case, description: MachineDescription, fluid: FluidLaw | None = None
) -> OperatingCondition:
    """Condition of a case, of its operating point or of its circuit.

    Raises CaseError if the case has neither.

    Parameters
    ----------
    case : Case
        Case with one of both.
    description : MachineDescription
        Its machine.
    fluid : FluidLaw, optional
        Its fluid, computed if not given.
    """
    law = fluid_of(case) if fluid is None else fluid
    if case.circuit is not None:
        return _circuit_condition(case, description, law)
    if case.operating_point is None:
        allowed = "a case with an [operating_point] or a [circuit]"
        raise CaseError("operating_point", "none", allowed)
    point = case.operating_point
    line, end, orifice = None, "outlet", point.outlet_load == "orifice"
    if point.line is not None:
        motor = description.mode == "motor"
        port = "inlet" if motor else "outlet"
        end = "supply" if motor else LINE_END if orifice else "load"
        pressure = point.inlet_pressure if motor else point.outlet_pressure
        volume = description.port_volumes[0 if motor else 1]
        line = point.line.at_port(port, volume, pressure, end, law)
    return OperatingCondition(
        shaft_speed=point.shaft_speed,
        inlet_pressure=point.inlet_pressure,
        outlet_pressure=point.outlet_pressure,
        drain_pressure=description.drain_pressure,
        load_node="outlet" if end == "supply" else end,
        circuit=line,
        radial_load=point.shaft_radial_load,
        compliant_mesh=case.run.mesh == "elastic",
        relative_tolerance=case.run.relative_tolerance,
    )


def _circuit_condition(
    case: Case, description: MachineDescription, fluid: FluidLaw
) -> OperatingCondition:
    """Condition of a case with a circuit, at the pressure that it is expected to reach."""
    keys = case.circuit
    assert keys is not None
    circuit = build_circuit(keys, description.port_volumes, fluid)
    shaft, speed = shaft_of(keys.elements.values()), speed_of(keys.elements.values())
    if speed is not None and circuit.leads("speed"):
        speed = led_history(speed)
    if shaft is not None and circuit.leads("torque"):
        shaft = replace(shaft, load_history=led_history(shaft.load_history))
    low = circuit.supply_pressure
    elements = keys.elements.values()
    relief = [e.opening_pressure for e in elements if isinstance(e, ReliefValve)]
    expected = max(relief, default=_EXPECTED_PRESSURE)
    startup = description.startup
    high = low + (
        expected
        if startup is None or startup.law == "interfaces" or speed_of(elements) is not None
        else min(expected, _BEYOND_BREAKAWAY * startup.torque / description.displacement)
    )
    shaft_speed = keys.initial_shaft_speed if speed is None else float(speed[0, 1])
    high_inlet = (description.mode == "motor") == (shaft_speed >= 0.0)
    return OperatingCondition(
        shaft_speed=shaft_speed,
        inlet_pressure=high if high_inlet else low,
        outlet_pressure=low if high_inlet else high,
        drain_pressure=description.drain_pressure,
        compliant_mesh=case.run.mesh == "elastic",
        relative_tolerance=case.run.relative_tolerance,
        circuit=circuit,
        free_shaft=shaft,
        speed_schedule=np.zeros((0, 2)) if speed is None else speed,
        shaft_angle=keys.initial_shaft_angle,
    )
