"""Results read back from NetCDF files."""

from __future__ import annotations

from pathlib import Path

from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset
from toothspace.core.status import Status
from toothspace.results.file_layout import (
    EXTRA_VARIABLES,
    PROVENANCE,
    STATISTICS,
    read_events,
    read_ledger,
    read_warnings,
)
from toothspace.results.solution import Solution

DATA_ATTRIBUTES = ("title", "machine", "mode")
"""Attributes of the file that belong to the dataset."""


def load_solution(path: str | Path) -> Solution:
    """Read a solution back.

    Parameters
    ----------
    path : str or Path
        File written by :meth:`Solution.save`.

    Raises
    ------
    CaseError
        If the file is missing, damaged or not a result of this package.
    """
    dataset = read_dataset(path, "a NetCDF file of a run or study")
    if "status" not in dataset.attrs or "ledger_energy" not in dataset:
        raise CaseError(f"{path}: not a result of toothspace; expected a file written by run -o")
    try:
        attributes = dataset.attrs
        statistics = {k: v for k, v in attributes.items() if k.startswith(STATISTICS)}
        provenance = {key: str(attributes[key]) for key in attributes.get(PROVENANCE, "").split()}
        data = dataset.drop_vars(EXTRA_VARIABLES, errors="ignore")
        data.attrs = {key: attributes[key] for key in DATA_ATTRIBUTES if key in attributes}
        return Solution(
            status=Status[attributes["status"]],
            data=data,
            ledger=read_ledger(dataset),
            statistics={k.removeprefix(STATISTICS): float(v) for k, v in statistics.items()},
            provenance=provenance,
            events=read_events(dataset),
            warnings=read_warnings(attributes),
        )
    except (KeyError, ValueError, TypeError, IndexError) as error:
        found = f"a result without a usable {error}"
        raise CaseError(path, found, "one that this version wrote") from error
