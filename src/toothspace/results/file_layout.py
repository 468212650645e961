"""Layout of the files of results, and tables of a machine as text or NetCDF."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from toothspace.core.files import write_text
from toothspace.core.finding import Finding
from toothspace.core.netcdf import write_dataset
from toothspace.core.status import Event
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.results.ledger import ENERGY_ENTRIES, TRAPPED, Ledger
from toothspace.results.performance import by_label
from toothspace.results.variables import dataset_from

STATISTICS = "statistics_"
"""Beginning of the attributes that hold statistics."""
PROVENANCE = "provenance"
"""Attribute that lists the names of those that make the provenance."""
FINDINGS = "findings"
"""Attribute that lists the warnings of the run with all their parts, as JSON."""
_EVENT_FIELDS = ("event_shaft_angle", "event_time", "event_kind", "event_label")
_LEDGER_FIELDS = (
    "ledger_mass",
    "ledger_energy",
    "ledger_label",
    "window_duration",
    "window_shaft_angle",
)

EXTRA_VARIABLES = (*_LEDGER_FIELDS, *_EVENT_FIELDS, "mass_entry", "energy_entry")
"""Variables of the file that do not belong to the samples."""


def write_result(
    path: str | Path,
    data: xr.Dataset,
    ledger: Ledger,
    events: tuple[Event, ...],
    attributes: Mapping[str, str],
    statistics: Mapping[str, float],
    provenance: Mapping[str, str],
) -> Path:
    """Write a result to one NetCDF file, atomically; an existing one is replaced.

    The file written.
    """
    columns = dict(zip(_EVENT_FIELDS, zip(*events, strict=True), strict=False))
    event_data = dataset_from({name: np.asarray(values) for name, values in columns.items()}, {})
    labels = {**ENERGY_ENTRIES, **ledger.path_losses}
    values: dict[str, ArrayLike] = {
        "ledger_mass": list(ledger.mass.values()),
        "ledger_energy": list(ledger.energy.values()),
        "ledger_label": [labels.get(name, name) for name in ledger.energy],
        "window_duration": ledger.duration,
        "window_shaft_angle": ledger.shaft_angle,
    }
    entries = {"mass_entry": list(ledger.mass), "energy_entry": list(ledger.energy)}
    dataset = xr.merge(
        [data, dataset_from(values, entries), event_data],
        combine_attrs="drop_conflicts",
        join="exact",
        compat="no_conflicts",
    )
    dataset.attrs = {
        **data.attrs,
        **attributes,
        **{f"{STATISTICS}{key}": float(value) for key, value in statistics.items()},
        **provenance,
        PROVENANCE: " ".join(provenance),
    }
    return write_dataset(dataset, path)


def read_ledger(dataset: xr.Dataset) -> Ledger:
    """Ledger of a file."""
    energy = by_label(dataset["ledger_energy"])
    names = dataset["ledger_label"].values if "ledger_label" in dataset else list(energy)
    labels = {name: str(label) for name, label in zip(energy, names, strict=True)}
    return Ledger(
        duration=float(dataset["window_duration"]),
        shaft_angle=float(dataset["window_shaft_angle"]),
        mass=by_label(dataset["ledger_mass"]),
        energy=energy,
        path_losses={
            k: v for k, v in labels.items() if k not in ENERGY_ENTRIES and not k.startswith(TRAPPED)
        },
    )


def read_warnings(attributes: Mapping[str, str]) -> tuple[Finding, ...]:
    """Warnings of a file, of an older one as lines of text."""
    if FINDINGS in attributes:
        return tuple(Finding(**entry) for entry in json.loads(attributes[FINDINGS]))
    lines = attributes.get("warnings", "").splitlines()
    return tuple(Finding("warning", line) for line in lines)


def read_events(dataset: xr.Dataset) -> tuple[Event, ...]:
    """Events of a file, in the order of time."""
    if "event_time" not in dataset:
        return ()
    columns = [dataset[name].values.tolist() for name in _EVENT_FIELDS]
    return tuple(Event(*row) for row in zip(*columns, strict=True))


def save_tables(description: MachineDescription, path: str | Path) -> Path:
    """Write the tables of a machine to one NetCDF file; returns its path.

    Parameters
    ----------
    path : str or Path
        File to write.
    """
    from toothspace.core.netcdf import write_dataset

    return write_dataset(description.to_dataset(), path)


def save_tables_txt(description: MachineDescription, folder: str | Path) -> list[Path]:
    """Write one plain text file per chamber family, path and contact, and one per outline.

    The files written. Columns are separated by blanks; lines starting with ``#`` say what they are
    and in which unit.

    Parameters
    ----------
    folder : str or Path
        Folder to write to; made if it is missing.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    files = []
    for table in description.angle_tables():
        header = [
            f"{table.meaning} {table.name}",
            f"table angle = phase + {table.angle_ratio:.9g} * shaft angle",
            "phase of each member [rad]: " + " ".join(f"{phase:.9g}" for phase in table.phases),
            "  ".join(f"{column.name} [{column.units}]" for column in table.columns),
        ]
        values = np.column_stack([column.values for column in table.columns])
        path = target / f"{table.name}.txt"
        files.append(_write_table_text(path, values, "\n".join(header)))
    for name, points in description.outlines.items():
        path = target / f"outline_{name}.txt"
        files.append(_write_table_text(path, points, f"outline of {name}\nx [m]  y [m]"))
    return files


def _write_table_text(path: Path, values: Array, header: str) -> Path:
    # complete under its name, or absent
    text = io.StringIO()
    np.savetxt(text, values, fmt="%.9e", header=header)
    return write_text(path, text.getvalue())
