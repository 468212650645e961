"""Reference data, and runs of shipped cases, in a checkout and in an installed package."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import toothspace
from toothspace import api
from toothspace.case import Case
from toothspace.case.shipped import shipped_case
from toothspace.core.types import Array
from toothspace.results.solution import Solution

_PACKAGE = Path(toothspace.__file__).resolve().parent


def data_file(source: str, name: str = "reference.csv") -> Path:
    """Return the file of published numbers of a source.

    Parameters
    ----------
    source : str
        Folder, by custom author and year.
    name : str
        File in that folder.
    """
    return _PACKAGE / "validation" / "data" / source / name


@cache
def shipped(case: str, *overrides: str) -> Case:
    """Load a shipped case with overrides, once for all claims."""
    return api.load_case(shipped_case(case), overrides)


@cache
def solved(case: str, *overrides: str) -> Solution:
    """Run a shipped case with overrides, once for all claims."""
    return api.simulate(shipped(case, *overrides))


def columns(source: str, name: str = "reference.csv") -> dict[str, Array]:
    """Read the numeric columns of a file of published numbers, by their heading."""
    import csv

    import numpy as np

    rows = list(csv.reader(data_file(source, name).read_text(encoding="utf-8").splitlines()))
    found = {}
    for k, heading in enumerate(rows[0]):
        try:
            found[heading] = np.array([float(row[k].replace(",", ".")) for row in rows[1:]])
        except ValueError:
            continue
    return found
