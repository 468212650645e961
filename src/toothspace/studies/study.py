"""What every study is given and what it gives back."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.core.files import plain, write_text
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.studies.records import Records
from toothspace.studies.workers import Workers

if TYPE_CHECKING:
    import xarray as xr

Row = Sequence[float | str]


@final
@dataclass(frozen=True)
class StudyContext:
    """Where and how a study computes."""

    progress: Progress | None = None
    """Called with the finished share and a short text."""
    workers: Workers = field(default_factory=Workers)
    """Who computes the points."""
    records: Records = field(default_factory=Records)
    """Finished points."""


@final
@dataclass(frozen=True)
class StudyTable:
    """A table of a study, written as CSV; the head names every column with its unit."""

    name: str
    head: tuple[str, ...]
    rows: tuple[Row, ...]

    @classmethod
    def of(cls, name: str, columns: Mapping[str, Sequence[Any]]) -> StudyTable:
        """Table of columns by their heads."""
        return cls(name, tuple(columns), tuple(zip(*columns.values(), strict=True)))

    def to_csv(self) -> str:
        """Return the table as CSV text."""
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(self.head)
        for row in self.rows:
            known = (x if isinstance(x, str) or math.isfinite(x) else "" for x in row)
            writer.writerow([x if isinstance(x, str) else f"{x:.6g}" for x in known])
        return buffer.getvalue()


@final
@dataclass(frozen=True)
class StudyResult:
    """Result of one study, complete or not.

    Parameters
    ----------
    status : Status
        Outcome; what was computed is kept if it failed.
    data : xarray.Dataset
        Numbers of the points, over ``point`` or over the axes of a grid.
    numbers : mapping
        What ``toothspace study --json`` prints: names with unit suffix.
    tables : tuple of StudyTable
        Tables for people.
    kind, title : str
        Value of ``study.kind``, and title of the case; from :func:`run_study`, as what follows.
    provenance : mapping of str to str
        Where it comes from.
    wall_time : float
        Time that it took. [s]
    """

    status: Status
    data: xr.Dataset
    numbers: Mapping[str, Any]
    tables: tuple[StudyTable, ...] = ()
    kind: str = ""
    title: str = ""
    provenance: Mapping[str, str] = field(default_factory=dict)
    wall_time: float = math.nan

    def __repr__(self) -> str:
        sizes = " x ".join(f"{name} {size}" for name, size in self.data.sizes.items())
        return f"<StudyResult {self.kind} {self.title!r}: {self.status.name.lower()}, {sizes}>"

    def summary(self) -> dict[str, Any]:
        """Return the numbers of the study with its status and its wall time."""
        return {**self.numbers, "status": self.status.name.lower(), "wall_time_s": self.wall_time}

    def save(self, folder: str | Path) -> list[Path]:
        """Write ``study.nc``, ``summary.json`` and the tables as CSV into a folder.

        Parameters
        ----------
        folder : str or Path
            Folder, made if it is missing; every file is complete or not there.

        Returns
        -------
        list of Path
            The files written.
        """
        from toothspace.core.netcdf import write_dataset

        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        data = self.data.assign_attrs(
            {**self.provenance, "study": self.kind, "status": self.status.name}
        )
        written = [write_dataset(data, target / "study.nc")]
        text = json.dumps(plain(self.summary()), indent=1, allow_nan=False)
        written.append(write_text(target / "summary.json", text + "\n"))
        for table in self.tables:
            written.append(write_text(target / f"{table.name}.csv", table.to_csv()))
        return written
