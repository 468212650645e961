"""Tables of a case file, and what several of their keys must fulfil together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

from toothspace.case.conditions import FluidChoice, HeatSettings, OperatingPoint, RunSettings
from toothspace.case.document import CONDITIONS
from toothspace.case.presets import PRESETS, Preset
from toothspace.case.stand_alone import FILMS, FilmKeys, JournalBearingCase, LateralFilmCase
from toothspace.circuit.circuit import Circuit
from toothspace.core.errors import CaseError, Problem
from toothspace.core.keys import KeyTable, Variant, declare, integer, table, text
from toothspace.core.registry import MACHINE_KEYS, STUDY_KEYS
from toothspace.core.units import format_si
from toothspace.model.operating_point import OperatingCondition

_MACHINE = 'a table [machine] with type = "external_gear" or another and mode = "pump" or "motor"'
_FLUID = 'a table [fluid] with name = "iso_vg_46" or another and temperature = "50 degC"'

SCHEMA_VERSION = 1


MACHINE_KEY = Variant(
    tag="type",
    variants=MACHINE_KEYS,
    name_of_table=MACHINE_KEYS.name_of,
    doc="The machine; keys by its type.",
)
STUDY_KEY = Variant(
    tag="kind",
    variants=STUDY_KEYS,
    name_of_table=STUDY_KEYS.name_of,
    doc="Study that drives the condition.",
)
LEAST_LOAD = 5e3
"""Smallest mean pressure drop that a load orifice can be sized for. [Pa]."""


@dataclass(frozen=True, kw_only=True)
class CaseTables(KeyTable):
    """Keys and tables of a case; :class:`~toothspace.case.case.Case` says what each means."""

    schema: int = integer(
        "Version of the case file's keys.",
        low=SCHEMA_VERSION,
        high=SCHEMA_VERSION,
        default=SCHEMA_VERSION,
    )
    title: str = text("What this case is.", default="")
    machine: Any = declare(MACHINE_KEY, None)
    fluid: FluidChoice | None = table(FluidChoice, "Fluid and temperature.", default=None)
    operating_point: OperatingPoint | None = table(
        OperatingPoint, "Steady condition.", default=None
    )
    circuit: Circuit | None = table(
        Circuit, "Transient condition: elements and connections.", default=None
    )
    bearing: JournalBearingCase | None = table(
        JournalBearingCase, "Stand-alone journal bearing.", default=None
    )
    film: FilmKeys | None = declare(
        Variant(tag="kind", variants=FILMS, doc="Stand-alone film."), None
    )
    study: Any = declare(STUDY_KEY, None)
    heat: HeatSettings = table(
        HeatSettings,
        "Temperatures of oil, bodies and films at an operating point.",
        default=HeatSettings(),
    )
    run: RunSettings = table(RunSettings, "Fidelity and numerical settings.", default=RunSettings())


def broken_rules(case: CaseTables) -> Iterator[Problem]:
    """Yield what is wrong with title, condition, parts, fluid and pressures of a case."""
    if not case.title:
        yield Problem("title", "nothing", "a text that is not empty")
    given = [name for name in CONDITIONS if getattr(case, name) is not None]
    if len(given) != 1:
        found = " and ".join(f"[{name}]" for name in given) or "none of them"
        allowed = f"exactly one of {', '.join(f'[{name}]' for name in CONDITIONS)}"
        yield Problem(given[1] if given else "operating_point", found, allowed)
        if not given:
            yield from _parts(case)
        return
    if case.study is not None and given[0] not in CONDITIONS[:2]:
        allowed = "a study only with [operating_point] or [circuit]"
        yield Problem("study", f"a study with [{given[0]}]", allowed)
    yield from _parts(case)
    preset = case.run.preset
    if case.circuit is not None and not preset.over_time:
        allowed = f"{_presets(one for one in PRESETS.values() if one.over_time)} with a [circuit]"
        yield Problem("run.fidelity", repr(preset.name), allowed)
    if case.run.film_tables is not None and not preset.reads("film_tables"):
        allowed = f"fidelity {_presets(p for p in PRESETS.values() if p.reads('film_tables'))}"
        yield Problem("run.film_tables", f"tables with {preset.name!r}", allowed)
    # the choice of warm films alone stands in cases that also run without losses, or over time
    given_heat = replace(case.heat, model="network") != HeatSettings()
    if given_heat and (given[0] != "operating_point" or not preset.has_losses):
        found = f"a table [heat] with [{given[0]}] and fidelity {preset.name!r}"
        warm = _presets(one for one in PRESETS.values() if one.has_losses)
        yield Problem("heat", found, f"[operating_point] and fidelity {warm}")
    elif case.heat.model == "coupled" and case.run.film_oil_share > 0.0:
        found = f"{case.run.film_oil_share:g} with heat.model = 'coupled'"
        yield Problem("run.film_oil_share", found, "0: the heat network warms the lateral films")
    if case.fluid is not None:
        yield from _fluid(case)
    if case.operating_point is not None:
        yield from _pressure_order(case)
        point, least = case.operating_point, OperatingCondition.load_pressure + LEAST_LOAD
        if point.outlet_load == "orifice" and point.outlet_pressure < least:
            allowed = f"at least {_bar(least)} with outlet_load 'orifice', behind which is air"
            yield Problem("operating_point.outlet_pressure", _bar(point.outlet_pressure), allowed)


def missing_tables(tables: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield the tables that a case of a machine must have and this one has not."""
    if {"bearing", "film"} & set(tables):
        return
    if not {"operating_point", "circuit"} & set(tables):
        allowed = f"exactly one of {', '.join(f'[{name}]' for name in CONDITIONS)}"
        yield Problem("operating_point", "none of them", allowed)
    if "machine" not in tables:
        yield Problem("machine", "nothing", _MACHINE)
    if "fluid" not in tables:
        yield Problem("fluid", "nothing", _FLUID)


def _presets(found: Iterable[Preset]) -> str:
    return " or ".join(repr(preset.name) for preset in found)


def _parts(case: CaseTables) -> Iterator[Problem]:
    stand_alone = case.bearing or case.film
    if stand_alone is None or isinstance(stand_alone, LateralFilmCase):
        if case.machine is None:
            yield Problem("machine", "nothing", _MACHINE)
    elif case.machine is not None:
        yield Problem("machine", "a machine", "no machine with a stand-alone film")
    if stand_alone is None:
        if case.fluid is None:
            yield Problem("fluid", "nothing", _FLUID)
        return
    path = f"{'bearing' if case.bearing is not None else 'film'}.dynamic_viscosity"
    if stand_alone.dynamic_viscosity is None and case.fluid is None:
        yield Problem(path, "nothing", "a viscosity such as '0.01 Pa s', or a table [fluid]")
    if stand_alone.dynamic_viscosity is not None and case.fluid is not None:
        yield Problem(path, "a value beside [fluid]", "one of both")


def _fluid(case: CaseTables) -> Iterator[Problem]:
    from toothspace.model.fluid import fluid_law

    fluid = case.fluid
    assert fluid is not None
    temperatures = {"fluid.temperature": fluid.temperature}
    table = getattr(case.machine, "part_tables", {}).get("running_in")
    running_in = table and attrgetter(table)(case.machine)
    if running_in:
        temperatures[f"machine.{table}.temperature"] = running_in.temperature
    law: Any = None
    for path, temperature in temperatures.items():
        try:
            law = law or fluid_law(fluid.source, temperature)
            if temperature != fluid.temperature:
                fluid_law(fluid.source, temperature)
        except CaseError as error:
            problem = error.problems[0]
            yield problem if path == "fluid.temperature" else problem._replace(key=path)
            return
    lowest = law.vapour_pressure
    allowed = f"above the vapour pressure of the fluid, {_bar(lowest)}, absolute"
    found: dict[str, float] = {}
    if case.operating_point is not None:
        found["operating_point.inlet_pressure"] = case.operating_point.inlet_pressure
        found["operating_point.outlet_pressure"] = case.operating_point.outlet_pressure
    drain = getattr(case.machine, "drain_pressure", None)
    if drain is not None:
        found["machine.drain_pressure"] = drain
    for name, element in case.circuit.elements.items() if case.circuit else ():
        if hasattr(element, "pressure"):
            found[f"circuit.{name}.pressure"] = element.pressure
    for path, pressure in found.items():
        if pressure <= lowest:
            yield Problem(path, _bar(pressure), allowed)


def _bar(pressure: float) -> str:
    return format_si(pressure, "bar")


def _pressure_order(case: CaseTables) -> Iterator[Problem]:
    """Refuse at once what a study of a floating bearing would meet after hours, too."""
    point, study, mode = case.operating_point, case.study, getattr(case.machine, "mode", "")
    assert point is not None
    given = [("operating_point.outlet_pressure", point.inlet_pressure, point.outlet_pressure)]
    if hasattr(study, "port_pressures"):
        given += study.port_pressures(point.inlet_pressure)
    for path, inlet, outlet in given:
        if mode == "pump" and outlet < inlet:
            allowed = f"at least the inlet pressure of the pump, {_bar(inlet)}"
            yield Problem(path, _bar(outlet), allowed)
        if mode == "motor" and inlet < outlet and path.startswith("study"):
            allowed = f"at most the inlet pressure of the motor, {_bar(inlet)}"
            yield Problem(path, _bar(outlet), allowed)
        elif mode == "motor" and inlet < outlet:
            allowed = f"at least the outlet pressure of the motor, {_bar(outlet)}"
            yield Problem("operating_point.inlet_pressure", _bar(inlet), allowed)
