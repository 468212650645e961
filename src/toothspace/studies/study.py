"""How a study is declared and run, what it is given and what it gives back."""

from __future__ import annotations

import csv
import errno
import io
import json
import math
import os
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.case import Case, load_case
from toothspace.core import registry
from toothspace.core.errors import CaseError
from toothspace.core.files import plain, write_text
from toothspace.core.interrupts import interrupts_held
from toothspace.core.keys import suggestion
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.run.run import provenance_of
from toothspace.studies.workers import Workers

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from toothspace.plotting.style import StudyFigure


Row = Sequence[float | str]


DONE = "done"
BAD_INPUT = "bad_input"
FAILED = "failed"
INTERRUPTED = "interrupted"
NOT_RUN = "not_run"

FILE_NAME = "points.jsonl"
"""Name of the file in the folder of a study: one finished point per line."""

PREVIOUS_FILE_NAME = "points_previous.jsonl"
"""What a study that starts anew makes of the points of the one before."""


@final
@dataclass(frozen=True)
class Record:
    """What one point of a study gave."""

    key: str
    """Hash of what was computed."""
    status: str
    """Status of the run in lower case, ``bad_input``, or ``failed`` after an unexpected error."""
    numbers: Mapping[str, Any] = field(default_factory=dict)
    """Summary numbers, or what else the study evaluates; empty if there are none."""
    message: str = ""
    """Why the point failed, in one line; empty if it did not."""
    wall_time: float = math.nan
    """Time that it took. [s]"""

    @property
    def succeeded(self) -> bool:
        """Whether the point did what was asked."""
        return self.status == DONE

    def number(self, name: str) -> float:
        """Return a number of the point, NaN if it has none of that name. [unit of the name]."""
        value = self.numbers.get(name)
        return float(value) if isinstance(value, (int, float)) else math.nan


@final
class Records:
    """Records by key, in memory and, with a file, on disk from the first one that is added.

    Parameters
    ----------
    path : Path or None
        File of one record per line; None keeps them in memory only.
    resume : bool
        Whether successful records that the file holds already count; otherwise it starts anew.
    """

    def __init__(self, path: Path | None = None, *, resume: bool = False) -> None:
        self.path = path
        self._resume = resume
        self._begun = path is None
        self._own_folder = path is not None and not path.parent.exists()
        self._found: dict[str, Record] = {}
        if path is None:
            return
        if resume and path.is_file():
            found = {}
            for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
                try:
                    record = Record(**json.loads(line))
                except (ValueError, TypeError):
                    continue  # a line that a crash cut short
                if record.succeeded:
                    found[record.key] = record
            self._found = found
        path.parent.mkdir(parents=True, exist_ok=True)
        if not os.access(path.parent, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path.parent))

    def withdraw(self) -> None:
        """Remove the folder again if it was made for these records and nothing is in it."""
        if self.path is not None and self._own_folder and not any(self.path.parent.iterdir()):
            self.path.parent.rmdir()

    def get(self, key: str) -> Record | None:
        """Return the record of a key, or None."""
        return self._found.get(key)

    def add(self, record: Record) -> None:
        """Keep a record; a reader never sees half of it as a whole line."""
        if not self._begun and self.path is not None:
            if self.path.is_file() and self.path.stat().st_size and not self._resume:
                # a forgotten --resume must not cost hours of computing
                self.path.replace(self.path.with_name(PREVIOUS_FILE_NAME))
            write_text(self.path, "".join(_line(record) for record in self._found.values()))
            self._begun = True
        self._found[record.key] = record
        if self.path is not None:
            with interrupts_held(), self.path.open("a", encoding="utf-8") as file:
                file.write(_line(record))

    def __len__(self) -> int:
        """Return the number of records."""
        return len(self._found)


def failed_count(records: Sequence[Record]) -> int:
    """Return the number of points that were tried and failed. [-]."""
    return sum(not record.succeeded and record.status != INTERRUPTED for record in records)


def _line(record: Record) -> str:
    return json.dumps(asdict(record)) + "\n"


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

    def counted(self, done: int, budget: int, known: str) -> StudyContext:
        """Return it with progress that counts points against a budget and tells what is known."""
        report = self.progress
        if report is None:
            return self

        def progress(_share: float, text: str) -> None:
            report(min(done / budget, 1.0), f"{text}, {known}")

        return StudyContext(progress, self.workers, self.records)


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
        from toothspace.plotting.style import figure_to_svg, html_table

        numbers = self.summary().items()
        rows = html_table({k: v for k, v in numbers if isinstance(v, (int, float, str))})
        drawn = study_figures(self.kind, self.data)
        names = ", ".join(f"plot.{one.name}()" for one in drawn)
        first = figure_to_svg(drawn[0].figure) if drawn else ""
        head = f"<h4>{escape(self.title or self.kind)}</h4><p>{escape(self.status.value)}</p>"
        return f"{head}{rows}<div>{first}</div><p>{escape(names)}</p>"

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


def run_study(
    case: Case | str | Path,
    folder: str | Path | None = None,
    *,
    progress: Progress | None = None,
    workers: int = 1,
    scheduler: str = "",
    resume: bool = False,
) -> StudyResult:
    """Run the study of a case.

    Parameters
    ----------
    case : Case, str or Path
        Case with a table ``[study]``.
    folder : str or Path, optional
        Keeps finished points while the study runs, and the result at its end.
    progress : callable, optional
        Called with the finished share and a short text.
    workers : int
        Processes that share the points. [-]
    scheduler : str
        Address of a Dask scheduler instead of processes.
    resume : bool
        Whether to take finished points from the folder.

    Returns
    -------
    StudyResult
        Complete or not, see its status.

    Raises
    ------
    CaseError
        If the case asks for the impossible.
    """
    case = load_case(case)
    kind = case.study_kind
    if not kind:
        allowed = "a table [study] with its kind"
        raise CaseError("study", "nothing", allowed).in_file(case.label)
    case.check()
    started = time.perf_counter()
    records = Records(None if folder is None else Path(folder) / FILE_NAME, resume=resume)
    try:
        with Workers(workers, scheduler) as pool:
            result: StudyResult = registry.study(kind).run(
                case, StudyContext(progress, pool, records)
            )
    except (CaseError, KeyboardInterrupt):
        records.withdraw()
        raise
    result = replace(
        result,
        kind=kind,
        title=case.title,
        provenance=provenance_of(case),
        wall_time=time.perf_counter() - started,
    )
    if folder is not None:
        result.save(folder)
    return result
