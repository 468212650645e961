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
from toothspace.core.units import from_si, to_si
from toothspace.results.variables import VARIABLES, unit_of

_HEADER = re.compile(r"\s*([\w.]+)\s*(?:\[(.+)\])?\s*")
_DIFFERENCE = "pressure_difference"


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
        CSV file with a header of ``name [unit]``. With a column ``time`` the others are signals of
        a result; without it every row is a steady point: columns with a dot in their name are
        keys of the case, the others summary numbers.
    """
    rows, head = read_rows(path), []
    for cell in rows[0] if rows else []:
        match = _HEADER.fullmatch(cell)
        if match is None:
            raise CaseError(f"{path}: columns", f"{cell!r}", "'name [unit]'")
        head.append((match[1], match[2] or "1"))
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


def _steady(path: Path, head: list[tuple[str, str]], table: Array) -> Measured:
    keys = [k for k, (name, _) in enumerate(head) if "." in name]
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
            if wanted in {"1", unit}:
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
