"""Tables of measured or prescribed signals: columns ``name [unit]`` of a CSV file or workbook."""

from __future__ import annotations

import csv
import re
import reprlib
from collections.abc import Mapping
from io import BytesIO
from itertools import islice
from pathlib import Path

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import read_bytes
from toothspace.core.lazy import package_of_extra
from toothspace.core.types import Array
from toothspace.core.units import compatible, to_si

_LARGEST_FILE = 50_000_000
_LONGEST_SHEET = 1_048_576
"""Rows of a sheet of Excel."""
_HEADER = re.compile(r"\s*(\w+)\s*\[(.+)\]\s*")


def read_columns(path: Path, wanted: Mapping[str, str]) -> dict[str, Array]:
    """Read the wanted columns of a CSV file in SI units.

    Values in SI units, shape (rows,).

    Raises CaseError if a column is missing, has another dimension, or holds something not finite.

    Parameters
    ----------
    path : Path
        File with a header of ``name [unit]``, separated by commas or semicolons.
    wanted : mapping of name to unit
        Columns that must be there, with a unit of their dimension, ``1`` for none.
    """
    rows = read_rows(path)
    names, found = _names(rows), {}
    for name, dimension in wanted.items():
        if name not in names:
            known = ", ".join(names) or "none"
            raise CaseError(f"{path}: columns", known, f"one named '{name} [{dimension}]'")
        place, unit = names[name]
        require_unit(path, name, unit, dimension)
        values = np.array([read_number(path, row, place, name) for row in rows[1:]])
        if values.size == 0:
            raise CaseError(f"{path}: {name}", "no rows", "at least one")
        found[name] = values
        if unit != "1":
            found[name] = np.array([to_si(value, unit) for value in values])
    return found


def column_names(path: Path) -> list[str]:
    """Return the names of the columns of a CSV file that have a unit.

    Raises CaseError if it is no CSV file.
    """
    return list(_names(read_rows(path)))


def read_rows(path: Path) -> list[list[str]]:
    """Return the cells of a CSV file or of the first sheet of a workbook, without empty rows.

    Raises CaseError if it is neither; GeometryError if a workbook needs the extra ``excel``.

    Parameters
    ----------
    path : Path
        File in CSV with commas or semicolons, or ``.xlsx``.
    """
    sheet = path.suffix.lower() == ".xlsx"
    if sheet:
        openpyxl = package_of_extra("openpyxl", "excel", f"{path}: found a workbook")
    allowed = "a workbook of Excel" if sheet else "a CSV file in UTF-8"
    content = read_bytes(path, str(path), allowed, _LARGEST_FILE)
    if sheet:
        try:
            # values in place of formulas
            book = openpyxl.load_workbook(BytesIO(content), read_only=True, data_only=True)
            cells = islice(book.worksheets[0].iter_rows(values_only=True), _LONGEST_SHEET)
            rows = [["" if cell is None else str(cell) for cell in row] for row in cells]
        except Exception as error:  # what a damaged workbook raises is up to its reader
            raise CaseError(path, "a file that cannot be read as one", allowed) from error
        return [row for row in rows if any(row)]
    try:
        text = content.decode("utf-8-sig")
        separator = ";" if ";" in text.partition("\n")[0] else ","
        return [row for row in csv.reader(text.splitlines(), delimiter=separator) if any(row)]
    except (csv.Error, UnicodeDecodeError) as error:
        raise CaseError(path, error, allowed) from error


def _names(rows: list[list[str]]) -> dict[str, tuple[int, str]]:
    """Place and unit of every column that has a name and a unit."""
    heads = [_HEADER.fullmatch(cell) for cell in rows[0]] if rows else []
    return {head[1]: (k, head[2]) for k, head in enumerate(heads) if head}


def require_unit(path: Path, name: str, unit: str, wanted: str) -> None:
    """Refuse a column whose unit is of another dimension than the one wanted.

    Raises
    ------
    CaseError
        With both units.
    """
    try:
        fits = unit == wanted or ("1" not in {unit, wanted} and compatible(unit, wanted))
    except CaseError:
        fits = False
    if not fits:
        raise CaseError(f"{path}: {name}", f"the unit {reprlib.repr(unit)}", f"{wanted!r}")


def read_number(path: Path, row: list[str], place: int, name: str) -> float:
    """Return the number of a column in a row. [unit of the column].

    Raises CaseError if it is none, or not finite.
    """
    try:
        value = float(row[place])
    except (IndexError, ValueError):
        value = float("nan")
    if not np.isfinite(value):
        found = row[place] if place < len(row) else "nothing"
        raise CaseError(f"{path}: {name}", reprlib.repr(found), "a number in every row")
    return value


def read_grid(path: Path, units: Mapping[str, str]) -> tuple[Array, Array, Array]:
    """Read a table over two axes, each pair of their values once.

    Values of both axes, and the table over them. [SI]

    Parameters
    ----------
    path : Path
        CSV file with three columns.
    units : mapping of str to str
        Columns and units of their dimensions: both axes, then the values.

    Raises
    ------
    CaseError
        As :func:`read_columns`, and if pairs are missing or doubled.
    """
    columns = read_columns(path, units)
    first, second, values = (columns[name] for name in units)
    axes = np.unique(first), np.unique(second)
    order = np.lexsort((second, first))
    full = [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]
    given = first[order], second[order]
    if min(map(len, axes)) < 2 or not all(map(np.array_equal, given, full)):
        one, two, _ = units
        raise CaseError(
            path,
            f"{len(values)} rows at {len(axes[0])} values of {one} and {len(axes[1])} of {two}",
            "each pair once and at least two of both",
        )
    return *axes, values[order].reshape(len(axes[0]), len(axes[1]))


def read_signal(path: Path, name: str, unit: str) -> Array:
    """Read one signal over time; times must increase.

    Time [s] and signal [SI], shape (rows, 2).

    Parameters
    ----------
    path : Path
        CSV file with the columns ``time [s]`` and the signal.
    name, unit : str
        Column of the signal and a unit of its dimension.

    Raises
    ------
    CaseError
        As :func:`read_columns`, and if times do not increase.
    """
    columns = read_columns(path, {"time": "s", name: unit})
    if np.any(np.diff(columns["time"]) <= 0.0):
        raise CaseError(f"{path}: time", "times that fall or repeat", "increasing ones")
    return np.column_stack([columns["time"], columns[name]])
