"""Results as NetCDF files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset, write_dataset
from toothspace.core.status import Status
from toothspace.results.ledger import ENERGY_ENTRIES, Ledger
from toothspace.results.solution import Event, Solution
from toothspace.results.variables import dataset_from

DATA_ATTRIBUTES = ("title", "machine", "mode")
"""Attributes of the file that belong to the dataset."""

_STATISTICS = "statistics_"
_PROVENANCE = "provenance"  # attribute that lists the names of those that make the provenance
_EVENT_FIELDS = {"event_shaft_angle": 0, "event_time": 1, "event_kind": 2, "event_label": 3}
_LEDGER_FIELDS = (
    "ledger_mass",
    "ledger_energy",
    "ledger_label",
    "window_duration",
    "window_shaft_angle",
)


def save_solution(solution: Solution, path: str | Path) -> Path:
    """Write a solution to one NetCDF file, atomically.

    Parameters
    ----------
    solution : Solution
        What to write.
    path : str or Path
        File to write; an existing one is replaced.

    Returns
    -------
    Path
        The file written.
    """
    dataset = xr.merge(
        [solution.data, _ledger_dataset(solution.ledger), _event_dataset(solution.events)],
        combine_attrs="drop_conflicts",
        join="exact",
        compat="no_conflicts",
    )
    dataset.attrs = {
        **solution.data.attrs,
        "status": solution.status.name,
        **{f"{_STATISTICS}{key}": float(value) for key, value in solution.statistics.items()},
        **solution.provenance,
        _PROVENANCE: " ".join(solution.provenance),
    }
    return write_dataset(dataset, path)


def load_solution(path: str | Path) -> Solution:
    """Read a solution back.

    Parameters
    ----------
    path : str or Path
        File written by :func:`save_solution`.

    Raises
    ------
    CaseError
        If the file is missing, damaged or not a result of this package.
    """
    dataset = read_dataset(path)
    if "status" not in dataset.attrs or "ledger_energy" not in dataset:
        raise CaseError(f"{path}: not a result of toothspace; expected a file written by run -o")
    try:
        return _solution_of(dataset)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        found = f"a result without a usable {error}"
        raise CaseError(f"{path}: found {found}, allowed one that this version wrote") from error


def _solution_of(dataset: xr.Dataset) -> Solution:
    attributes = dataset.attrs
    statistics = {k: v for k, v in attributes.items() if k.startswith(_STATISTICS)}
    extra = [*_LEDGER_FIELDS, *_EVENT_FIELDS, "mass_entry", "energy_entry"]
    data = dataset.drop_vars(extra, errors="ignore")
    data.attrs = {key: attributes[key] for key in DATA_ATTRIBUTES if key in attributes}
    return Solution(
        status=Status[dataset.attrs["status"]],
        data=data,
        ledger=_read_ledger(dataset),
        statistics={k.removeprefix(_STATISTICS): float(v) for k, v in statistics.items()},
        provenance={key: str(attributes[key]) for key in attributes.get(_PROVENANCE, "").split()},
        events=_read_events(dataset),
    )


def _ledger_dataset(ledger: Ledger) -> xr.Dataset:
    labels = {**ENERGY_ENTRIES, **ledger.path_losses}
    values: dict[str, ArrayLike] = {
        "ledger_mass": list(ledger.mass.values()),
        "ledger_energy": list(ledger.energy.values()),
        "ledger_label": [labels.get(name, name) for name in ledger.energy],
        "window_duration": ledger.duration,
        "window_shaft_angle": ledger.shaft_angle,
    }
    entries = {"mass_entry": list(ledger.mass), "energy_entry": list(ledger.energy)}
    return dataset_from(values, entries)


def _read_ledger(dataset: xr.Dataset) -> Ledger:
    energy = _by_label(dataset, "ledger_energy")
    names = dataset["ledger_label"].values if "ledger_label" in dataset else list(energy)
    labels = {name: str(label) for name, label in zip(energy, names, strict=True)}
    return Ledger(
        duration=float(dataset["window_duration"]),
        shaft_angle=float(dataset["window_shaft_angle"]),
        mass=_by_label(dataset, "ledger_mass"),
        energy=energy,
        path_losses={k: v for k, v in labels.items() if k not in ENERGY_ENTRIES},
    )


def _by_label(dataset: xr.Dataset, name: str) -> Mapping[str, float]:
    array = dataset[name]
    labels = array[array.dims[0]].values
    return {str(label): float(value) for label, value in zip(labels, array.values, strict=True)}


def _event_dataset(events: tuple[Event, ...]) -> xr.Dataset:
    if not events:
        return xr.Dataset()
    columns = list(zip(*events, strict=True))
    values = {name: np.asarray(columns[k]) for name, k in _EVENT_FIELDS.items()}
    return dataset_from(values, {})


def _read_events(dataset: xr.Dataset) -> tuple[Event, ...]:
    if "event_time" not in dataset:
        return ()
    columns = [dataset[name].values.tolist() for name in _EVENT_FIELDS]
    return tuple(Event(*row) for row in zip(*columns, strict=True))
