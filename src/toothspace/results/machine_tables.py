"""Tables of a machine over the angle, as NetCDF and as plain text files."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from toothspace.core.files import write_text
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription


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

    Parameters
    ----------
    folder : str or Path
        Folder to write to; made if it is missing.

    Returns
    -------
    list of Path
        The files written. Columns are separated by blanks; lines starting with ``#`` say
        what they are and in which unit.
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
