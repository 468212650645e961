"""Measured columns: signals over time, or one row per steady point."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.signals import read_number, read_rows, require_unit
from toothspace.core.types import Array
from toothspace.core.units import from_si, parse_quantity, to_si
from toothspace.results.variables import VARIABLES, unit_of

_HEADER = re.compile(r"\s*([\w.]+)\s*(?:\[(.+)\])?\s*")
_SHEET_HEADER = re.compile(r"(?:.*\s)?(\w+)\s*(?:[\[(](.+)[\])])?\s*")
"""Words, symbol and unit of a column of a test sheet."""
_DIFFERENCE = "pressure_difference"
_SYMBOLS = {
    "n": "operating_point.shaft_speed",
    "p_1": "operating_point.inlet_pressure",
    "p_2": "operating_point.outlet_pressure",
    "dp": _DIFFERENCE,
    "theta": "fluid.temperature",
    "q_v": "mean_flow_L_per_min",
    "T": "mean_torque_N_m",
    "P_h": "hydraulic_power_W",
    "P_m": "shaft_power_W",
    "eta_v": "volumetric_efficiency",
    "eta_hm": "hydromechanical_efficiency",
    "eta_t": "overall_efficiency",
}
"""Keys and summary numbers by the symbols of a test sheet, after ISO 4409."""
_WRITTEN_UNITS = {
    "1/min": "rpm", "r/min": "rpm", "rev/min": "rpm", "min-1": "rpm", "min^-1": "rpm",
    "°C": "degC", "Nm": "N m", "N·m": "N m", "l/min": "L/min",
}  # fmt: skip
"""Units as test sheets write them."""
_NO_NUMBERS = ("status",)
"""Columns of a sheet that only say whether a row counts."""


@final
@dataclass(frozen=True)
class Measured:
    """Measured columns."""

    times: Array | None
    """Times of signals, None for steady points. [s]"""
    settings: tuple[Mapping[str, Any], ...]
    """Values of case keys for each steady point, as they would stand in a case file."""
    channels: Mapping[str, Array]
    """Signals in SI units, or summary numbers in the unit of their name. Shape (rows,)."""

    @property
    def rows(self) -> int:
        """Number of rows."""
        return next(iter(self.channels.values())).size


@final
@dataclass(frozen=True)
class Signals:
    """Evaluates a case to its signals at given times: a function for points of a study."""

    times: tuple[float, ...]
    """Times. [s]"""
    names: tuple[str, ...]
    """Result variables over time, or ``pressure_difference``."""

    @property
    def label(self) -> str:
        """Says what is evaluated, for the records of points."""
        return f"signals {self.names} {self.times}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Return the signals as lists in SI units, with the status of the run."""
        from toothspace import api

        solution = api.simulate(case)
        found: dict[str, Any] = {}
        time = solution.data["time"].values
        # a run that failed early says nothing about later times
        after_the_end = None if solution.status.succeeded else np.nan
        for name in self.names:
            data = solution.data
            if name == _DIFFERENCE and name not in data:
                values = np.abs(np.asarray(data["inlet_pressure"] - data["outlet_pressure"]))
            else:
                values = np.asarray(data[name])
            found[name] = np.interp(self.times, time, values, right=after_the_end).tolist()
        return {**found, "status": solution.status.name.lower()}


def read_measured(path: Path) -> Measured:
    """Read the measured columns of a calibration.

    Raises CaseError if a column or a number is not understood.

    Parameters
    ----------
    path : Path
        CSV file or workbook with a header of ``name [unit]``. With a column ``time`` the others are
        signals of a result; without it every row is a steady point: columns with a dot in their
        name are keys of the case, the others summary numbers. In place of a name a column may have
        a symbol of ISO 4409, with words before it and a unit in any brackets, such as
        ``flow q_v (L/min)``: ``n``, ``p_1`` and ``p_2`` (absolute, inlet and outlet) or ``dp``,
        ``theta``, ``q_v``, ``T``, ``P_h``, ``P_m``, ``eta_v``, ``eta_hm``, ``eta_t``. Rows with
        another ``status`` than ``done`` are left out.
    """
    rows, head = _counted(read_rows(path)), []
    for cell in rows[0] if rows else []:
        symbol, match = _SHEET_HEADER.fullmatch(cell), _HEADER.fullmatch(cell)
        if symbol is not None and symbol[1] in _SYMBOLS:
            unit = symbol[2] or "1"
            head.append((_SYMBOLS[symbol[1]], _WRITTEN_UNITS.get(unit, unit)))
        elif match is not None:
            head.append((match[1], match[2] or "1"))
        else:
            raise CaseError(f"{path}: columns", f"{cell!r}", "'name [unit]'")
    if len(rows) < 2:
        raise CaseError(path, "no rows", "at least one")
    names = [name for name, _ in head]
    table = np.array(
        [[read_number(path, row, k, name) for k, name in enumerate(names)] for row in rows[1:]]
    )
    if "time" not in names:
        return _steady(path, head, table)
    times: Array = np.zeros(0)
    channels = {}
    for k, (name, unit) in enumerate(head):
        wanted = "s" if name == "time" else "Pa" if name == _DIFFERENCE else _units(path, name)
        require_unit(path, name, unit, wanted)
        column = table[:, k]
        if unit != "1":
            column = np.array([to_si(x, unit) for x in column.tolist()])
        if name == "time":
            times = column
        else:
            channels[name] = column
    if not channels or np.any(np.diff(times) <= 0.0):
        raise CaseError(f"{path}: time: found no signal beside it or times that do not grow")
    return Measured(times, (), channels)


def _counted(rows: list[list[str]]) -> list[list[str]]:
    """Head and rows that count, without columns that say so and without empty ones."""
    if not rows:
        return rows
    said = [k for k, name in enumerate(rows[0]) if name.strip() in _NO_NUMBERS]
    good = [row for row in rows[1:] if all(row[k].strip() == "done" for k in said if k < len(row))]
    filled = {k for row in good for k, cell in enumerate(row) if cell.strip()} - set(said)
    kept = [k for k, name in enumerate(rows[0]) if k in filled or (name.strip() and not good)]
    return [[row[k] for k in kept if k < len(row)] for row in [rows[0], *good]]


def at_ports(case: Case, row: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a row with a port pressure in place of a pressure difference.

    The low-pressure port is that of the row, or of the case.

    Parameters
    ----------
    row : mapping
        Values of a steady point as they would stand in a case file.
    """
    found = dict(row)
    if _DIFFERENCE not in found:
        return found
    rise = parse_quantity(str(found.pop(_DIFFERENCE)), "bar")
    ports = ("inlet_pressure", "outlet_pressure")
    motor = getattr(case.machine, "mode", "pump") == "motor"
    low, high = reversed(ports) if motor else ports
    assert case.operating_point is not None
    given = found.get(f"operating_point.{low}")
    base = getattr(case.operating_point, low) if given is None else parse_quantity(given, "bar")
    found[f"operating_point.{high}"] = f"{from_si(base + rise, 'bar'):.12g} bar"
    return found


def _steady(path: Path, head: list[tuple[str, str]], table: Array) -> Measured:
    keys = [k for k, (name, _) in enumerate(head) if "." in name or name == _DIFFERENCE]
    settings = tuple(
        {
            head[k][0]: float(row[k]) if head[k][1] == "1" else f"{row[k]:.12g} {head[k][1]}"
            for k in keys
        }
        for row in table
    )
    channels = {}
    for k, (name, unit) in enumerate(head):
        if k not in keys:
            column = table[:, k]
            wanted = unit_of(name).replace("cm3", "cm^3").replace("%", "1")
            require_unit(path, name, unit.replace("%", "1"), wanted)
            if unit == "%" and unit_of(name) == "1":
                channels[name] = 0.01 * column
            elif wanted in {"1", unit}:
                channels[name] = column
            else:
                channels[name] = np.array(
                    [from_si(to_si(x, unit), wanted) for x in column.tolist()]
                )
    if not channels:
        allowed = "columns of summary numbers, such as 'mean_flow_L_per_min [L/min]'"
        raise CaseError(f"{path}: columns", [name for name, _ in head], allowed)
    return Measured(None, settings, channels)


def _units(path: Path, name: str) -> str:
    found = VARIABLES.get(name)
    if found is None or found.dimensions != ("sample",):
        known = [v.name for v in VARIABLES.values() if v.dimensions == ("sample",)]
        allowed = ", ".join([*known, _DIFFERENCE])
        raise CaseError(f"{path}: columns", f"{name!r}", allowed)
    return found.units.replace("m3", "m^3")
