"""What several keys of a case must fulfil together."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from toothspace.case import Case, OperatingPoint
from toothspace.case.stand_alone import LateralFilmCase
from toothspace.case.study import BalanceSweepStudy, HysteresisStudy, NosePressureStudy
from toothspace.config.reader import Reader, pressure_text
from toothspace.core.errors import CaseError
from toothspace.model.operating_point import OperatingCondition

LEAST_LOAD = 5e3
"""Smallest mean pressure drop that a load orifice can be sized for. [Pa]."""

CONDITIONS = ("operating_point", "circuit", "bearing", "film")


def check_together(case: Case, reader: Reader) -> None:
    """Check conditions, fluid and pressures of a case.

    Raises
    ------
    CaseError
        One line with file, key, what was found and what is allowed.
    """
    _check_condition(case, reader)
    _check_parts(case, reader)
    if case.run.film_tables is not None and case.run.fidelity != "lumped":
        reader.fail("run.film_tables", f"tables with {case.run.fidelity!r}", "fidelity 'lumped'")
    if case.fluid is not None:
        _check_fluid(case, reader)
    if case.operating_point is not None:
        _check_pressure_order(case, reader)
        _check_study_pressures(case, reader)
        _check_load(case.operating_point, reader)


def _check_condition(case: Case, reader: Reader) -> None:
    given = [name for name in CONDITIONS if getattr(case, name) is not None]
    if len(given) != 1:
        found = " and ".join(f"[{name}]" for name in given) or "none of them"
        allowed = f"exactly one of {', '.join(f'[{name}]' for name in CONDITIONS)}"
        reader.fail(given[1] if given else "operating_point", found, allowed)
    if case.study is not None and given[0] not in CONDITIONS[:2]:
        allowed = "a study only with [operating_point] or [circuit]"
        reader.fail("study", f"a study with [{given[0]}]", allowed)


def _check_parts(case: Case, reader: Reader) -> None:
    stand_alone = case.bearing or case.film
    if stand_alone is None or isinstance(stand_alone, LateralFilmCase):
        if case.machine is None:
            reader.fail("machine", "nothing", "a table [machine] with type and mode")
    elif case.machine is not None:
        reader.fail("machine", "a machine", "no machine with a stand-alone film")
    if stand_alone is None and case.fluid is None:
        reader.fail("fluid", "nothing", "a table [fluid] with name and temperature")
    if stand_alone is not None:
        _check_viscosity(case, stand_alone, reader)


def _check_viscosity(case: Case, film: Any, reader: Reader) -> None:
    name = "bearing" if case.bearing is not None else "film"
    path = f"{name}.dynamic_viscosity"
    if film.dynamic_viscosity is None and case.fluid is None:
        reader.fail(path, "nothing", "a viscosity such as '0.01 Pa s', or a table [fluid]")
    if film.dynamic_viscosity is not None and case.fluid is not None:
        reader.fail(path, "a value beside [fluid]", "one of both")


def _check_fluid(case: Case, reader: Reader) -> None:
    law = _fluid_law(case, case.fluid.temperature, reader)  # type: ignore[union-attr]
    lowest = law.vapour_pressure
    allowed = f"above the vapour pressure of the fluid, {pressure_text(lowest)}, absolute"
    for path, pressure in _pressures(case).items():
        if pressure <= lowest:
            reader.fail(path, pressure_text(pressure), allowed)
    wear_in = getattr(getattr(case.machine, "casing", None), "wear_in", None)
    if wear_in is not None:
        _fluid_law(case, wear_in.temperature, reader, "machine.casing.wear_in.temperature")


def _fluid_law(case: Case, temperature: float, reader: Reader, path: str = "") -> Any:
    from toothspace.model.fluid import fluid_law

    fluid = case.fluid
    assert fluid is not None
    try:
        return fluid_law(fluid.source, temperature)
    except CaseError as error:
        _, _, reason = str(error).partition(": ")
        text = f"{path}: {reason}" if path else str(error)
        raise CaseError(f"{reader.label}: {text}") from error


def _pressures(case: Case) -> dict[str, float]:
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
    return found


def _check_pressure_order(case: Case, reader: Reader) -> None:
    point, mode = case.operating_point, getattr(case.machine, "mode", "")
    assert point is not None
    inlet, outlet = point.inlet_pressure, point.outlet_pressure
    if mode == "pump" and outlet < inlet:
        allowed = f"at least the inlet pressure of the pump, {pressure_text(inlet)}"
        reader.fail("operating_point.outlet_pressure", pressure_text(outlet), allowed)
    if mode == "motor" and inlet < outlet:
        allowed = f"at least the outlet pressure of the motor, {pressure_text(outlet)}"
        reader.fail("operating_point.inlet_pressure", pressure_text(inlet), allowed)


def _check_study_pressures(case: Case, reader: Reader) -> None:
    """Refuse at once what a study of a floating bearing would meet after hours."""
    mode = getattr(case.machine, "mode", "")
    for path, inlet, outlet in _study_pressures(case):
        if mode == "pump" and outlet < inlet:
            allowed = f"at least the inlet pressure of the pump, {pressure_text(inlet)}"
            reader.fail(path, pressure_text(outlet), allowed)
        if mode == "motor" and inlet < outlet:
            allowed = f"at most the inlet pressure of the motor, {pressure_text(inlet)}"
            reader.fail(path, pressure_text(outlet), allowed)


def _study_pressures(case: Case) -> Iterator[tuple[str, float, float]]:
    """Key path, inlet and outlet pressure of the points of a floating bearing. [Pa]."""
    study, base = case.study, case.operating_point
    assert base is not None
    if isinstance(study, HysteresisStudy | BalanceSweepStudy):
        for k, outlet in enumerate(study.outlet_pressures):
            yield f"study.outlet_pressures[{k}]", base.inlet_pressure, outlet
    if isinstance(study, NosePressureStudy):
        for k, one in enumerate(study.conditions):
            inlet = one.inlet_pressure or base.inlet_pressure
            yield f"study.conditions[{k}].outlet_pressure", inlet, one.outlet_pressure


def _check_load(point: OperatingPoint, reader: Reader) -> None:
    found, least = point.outlet_pressure, OperatingCondition.load_pressure + LEAST_LOAD
    if point.outlet_load == "orifice" and found < least:
        allowed = f"at least {pressure_text(least)} with outlet_load 'orifice', behind which is air"
        reader.fail("operating_point.outlet_pressure", pressure_text(found), allowed)
