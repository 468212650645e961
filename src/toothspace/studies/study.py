"""How a study is declared, what it is given and what it gives back."""

from __future__ import annotations

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.case import Case
from toothspace.core import registry
from toothspace.core.errors import CaseError
from toothspace.core.files import plain, write_text
from toothspace.core.keys import suggestion
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.studies.records import Records
from toothspace.studies.workers import Workers

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from toothspace.plotting.style import StudyFigure

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

    def _repr_html_(self) -> str:
        from toothspace.plotting.style import figure_to_svg

        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(name)}</th>"
            f"<td>{f'{value:.5g}' if isinstance(value, float) else escape(str(value))}</td></tr>"
            for name, value in self.summary().items()
            if isinstance(value, (int, float, str))
        )
        drawn = study_figures(self.kind, self.data)
        names = ", ".join(f"plot.{one.name}()" for one in drawn)
        first = figure_to_svg(drawn[0].figure) if drawn else ""
        head = f"<h4>{escape(self.title or self.kind)}</h4><p>{escape(self.status.value)}</p>"
        return f"{head}<table>{rows}</table><div>{first}</div><p>{escape(names)}</p>"

    @property
    def plot(self) -> StudyFigures:
        """Figures of the study, such as ``result.plot.sweep()``."""
        return StudyFigures(self.kind, self.data)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the numbers of the points as columns; ``attrs["units"]`` holds their units.

        The rows are what most variables of the data extend over: points, or the grid of a map.
        """
        kinds = Counter(variable.dims for variable in self.data.data_vars.values() if variable.dims)
        if not kinds:
            allowed = "a study with points that are finished"
            raise CaseError("study", "no numbers to list", allowed)
        rows = kinds.most_common(1)[0][0]
        names = [name for name, one in self.data.data_vars.items() if one.dims == rows]
        frame: pd.DataFrame = self.data[names].to_dataframe()
        units = {str(name): str(self.data[name].attrs.get("units", "1")) for name in names}
        frame.attrs["units"] = units
        return frame

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


def _no_figures(_data: xr.Dataset) -> list[StudyFigure]:
    return []


@final
@dataclass(frozen=True)
class Study:
    """A study, as its module declares it in ``STUDY``: the name of the module is its kind."""

    keys: type
    """Keys of its table ``[study]``; an object of it is ``case.study``."""
    run: Callable[[Case, StudyContext], StudyResult]
    """Computes it for a case with these keys."""
    figures: Callable[[xr.Dataset], list[StudyFigure]] = _no_figures
    """What can be drawn from its data."""


def study_figures(kind: str, data: xr.Dataset) -> list[StudyFigure]:
    """Return all figures that the data of a study can give; none for an unknown kind.

    Parameters
    ----------
    kind : str
        Value of ``study.kind``.
    data : xarray.Dataset
        Its data, see :class:`StudyResult`.
    """
    declared = registry.study(kind) if kind in registry.study_modules() else None
    found: list[StudyFigure] = [] if declared is None else declared.figures(data)
    return found


@final
@dataclass(frozen=True)
class StudyFigures:
    """Figures of a study by their names; each is an object of Matplotlib."""

    kind: str
    """Value of ``study.kind``."""
    data: xr.Dataset
    """Its data."""

    def __repr__(self) -> str:
        return f"<StudyFigures: {', '.join(self.names())}>"

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.names()]

    def __getattr__(self, name: str) -> Callable[[], Figure]:
        if name.startswith("_") or name not in self.names():
            raise AttributeError(name)
        return partial(self.figure, name)

    def names(self) -> list[str]:
        """Return the names of the figures that the data can give."""
        return [one.name for one in study_figures(self.kind, self.data)]

    def figure(self, name: str) -> Figure:
        """Return the figure of a name."""
        found = {one.name: one.figure for one in study_figures(self.kind, self.data)}
        if name not in found:
            raise CaseError("figure", f"{name!r}", suggestion(name, found) or "none")
        return found[name]
