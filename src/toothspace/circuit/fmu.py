"""Units of other programs (FMI) beside a circuit: controllers, loads and supplies, by FMPy.

A unit is stepped from one communication point to the next with inputs that hold, and what it then
gives is reached along a straight line by the opening, speed, torque or flow that it sets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, final

from toothspace.core.errors import CaseError
from toothspace.core.keys import FilePath, KeyTable, Number, Row, Text, declare, items, quantity
from toothspace.core.units import compatible, to_si

TOLD = {"pressure": "Pa", "speed": "rad/s", "angle": "rad"}
"""What a unit can be told, with its SI unit; all but pressures are those of the shaft."""
SET = {"opening": "1", "speed": "rad/s", "torque": "N m", "flow": "m^3/s"}
"""Keys of elements that a unit can set, with their SI units."""

_NEEDED = 'units of other programs need FMPy: pip install "toothspace[fmi]"'


@final
@dataclass(frozen=True, kw_only=True)
class ForeignUnit(KeyTable):
    """``kind = "fmu"``: unit of another program that is told values of the run and sets keys."""

    file: Path = declare(
        FilePath(
            suffixes=(".fmu",),
            doc="Unit for co-simulation of FMI 2.0 or 3.0: native code that runs with your rights.",
        )
    )
    step: float = quantity("s", "Time from one communication to the next.", above=0, high=10)
    inputs: tuple[tuple[str, str], ...] = items(
        Row(items=(Text(), Text())),
        "Pairs of an input of the unit and what it is told: ELEMENT.pressure, "
        "machine.inlet.pressure, machine.outlet.pressure, shaft.speed or shaft.angle.",
        default=(),
    )
    outputs: tuple[tuple[str, str], ...] = items(
        Row(items=(Text(), Text())),
        "Pairs of an output of the unit and the key that it sets: ELEMENT.opening, .speed, "
        ".torque or .flow. What the case says is the value at the start.",
    )
    parameters: tuple[tuple[str, float], ...] = items(
        Row(items=(Text(), Number())),
        "Pairs of a parameter of the unit and its value, in the unit's own unit.",
        default=(),
    )

    def check_links(self, name: str, elements: Mapping[str, Any], ports: Sequence[str]) -> None:
        """Raise CaseError for what the circuit has not, or what a unit cannot set."""
        for _, target in self.outputs:
            element, _, key = target.rpartition(".")
            if key not in SET or not hasattr(elements.get(element), key):
                allowed = f"ELEMENT.KEY of an element with one of the keys {', '.join(SET)}"
                raise CaseError(f"{name}.outputs", repr(target), allowed)
        places = [*elements, *ports]
        for _, told in self.inputs:
            place, _, what = told.rpartition(".")
            if not (what == "pressure" and place in places) and told not in (
                "shaft.speed",
                "shaft.angle",
            ):
                allowed = "ELEMENT.pressure, shaft.speed or shaft.angle"
                raise CaseError(f"{name}.inputs", repr(told), allowed)


@final
@dataclass(frozen=True)
class LinkedUnit:
    """A unit with the places of the run that it is joined to."""

    name: str
    keys: ForeignUnit
    told: tuple[tuple[str, str, str], ...]
    """Input of the unit, what it is told, and the node of a pressure."""
    sets: tuple[tuple[str, str, int], ...]
    """Output of the unit, what it sets, and the row of the element; -1 for the shaft."""


class Instance:
    """A unit at work.

    Parameters
    ----------
    unit : LinkedUnit
        What it is and what it is joined to.

    Raises
    ------
    CaseError
        If FMPy is missing, or the file is not such a unit.
    """

    def __init__(self, unit: LinkedUnit) -> None:
        try:
            import fmpy
            from fmpy.simulation import instantiate_fmu
        except ImportError as error:
            raise CaseError(f"circuit.{unit.name}", _NEEDED) from error
        self._unit, self._folder = unit, TemporaryDirectory(ignore_cleanup_errors=True)
        path = str(unit.keys.file)
        try:
            about = fmpy.read_model_description(path)
            if about.coSimulation is None or about.fmiVersion[:1] not in "23":
                raise ValueError(f"FMI {about.fmiVersion} without co-simulation")
            fmpy.extract(path, self._folder.name)
            self._variables = {v.name: v for v in about.modelVariables}
            self._told = self._scaled([(v, TOLD[what]) for v, what, _ in unit.told], "inputs")
            self._sets = self._scaled([(v, SET[what]) for v, what, _ in unit.sets], "outputs")
            parameters = self._scaled([(v, "") for v, _ in unit.keys.parameters], "parameters")
            self._fmu = instantiate_fmu(self._folder.name, about, fmi_type="CoSimulation")
        except CaseError:
            self._folder.cleanup()
            raise
        except Exception as error:
            self._folder.cleanup()
            found = f"{unit.keys.file.name}, which cannot be used ({_short(error)})"
            allowed = "a unit for co-simulation of FMI 2.0 or 3.0 with a binary for this system"
            raise CaseError(f"circuit.{unit.name}.file", found, allowed) from error
        self._second = about.fmiVersion.startswith("2")
        self._write(parameters, [value for _, value in unit.keys.parameters])
        self._begun = False

    def begin(self, values: Sequence[float]) -> None:
        """Initialise with what the unit is told at the start. [SI]."""
        if self._second:
            self._fmu.setupExperiment(startTime=0.0)
        self._fmu.enterInitializationMode()
        self._write(self._told, values)
        self._fmu.exitInitializationMode()
        self._begun = True

    def step(self, time: float, values: Sequence[float]) -> list[float]:
        """Step from a time [s] with what the unit is told; what it sets then. [SI].

        Raises CaseError if the unit fails.
        """
        try:
            if not self._begun:
                self.begin(values)
            self._write(self._told, values)
            self._fmu.doStep(time, self._unit.keys.step)
            read = self._fmu.getReal if self._second else self._fmu.getFloat64
            found = read([number for number, _ in self._sets])
        except Exception as error:
            found_text = f"a unit that fails at {time:.6g} s ({_short(error)})"
            path = f"circuit.{self._unit.name}.file"
            raise CaseError(path, found_text, "one that takes its steps") from error
        return [float(value) * scale for value, (_, scale) in zip(found, self._sets, strict=True)]

    def close(self) -> None:
        """End the unit and remove what was unpacked."""
        try:
            if self._begun:
                self._fmu.terminate()
            self._fmu.freeInstance()
        except Exception:
            # what has failed in its step may fail here as well
            pass
        self._folder.cleanup()

    def _write(self, variables: Sequence[tuple[int, float]], values: Sequence[float]) -> None:
        if variables:
            write = self._fmu.setReal if self._second else self._fmu.setFloat64
            scaled = [value / scale for value, (_, scale) in zip(values, variables, strict=True)]
            write([number for number, _ in variables], scaled)

    def _scaled(self, wanted: Sequence[tuple[str, str]], key: str) -> list[tuple[int, float]]:
        """References of variables, and SI units in one of theirs."""
        found = []
        for name, unit in wanted:
            variable = self._variables.get(name)
            path = f"circuit.{self._unit.name}.{key}"
            if variable is None or variable.type not in ("Real", "Float64"):
                reals = [v.name for v in self._variables.values() if v.type in ("Real", "Float64")]
                known = [n for n in reals if self._variables[n].causality == key[:-1]]
                raise CaseError(path, repr(name), f"one of {', '.join(known) or 'none'}")
            declared, factor = getattr(variable, "unit", None) or "", 1.0
            text = declared.replace(".", " ")
            if unit and unit != "1" and text and text != "1":
                with suppress(CaseError):  # a unit that nobody knows counts as none
                    fits = compatible(text, unit)
                    factor = to_si(1.0, text) - to_si(0.0, text) if fits else 0.0
            if factor == 0.0:
                raise CaseError(path, f"{name!r} in {declared}", f"a variable in {unit}")
            found.append((variable.valueReference, factor))
        return found


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
