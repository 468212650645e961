"""Many cases over varied keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace import api
from toothspace.case import Case, load_case
from toothspace.core.files import path_of
from toothspace.core.keys import (
    KeyTable,
    choice,
    declare,
    forbid,
    integer,
    require,
)
from toothspace.core.progress import Progress
from toothspace.plotting.style import (
    BLUE,
    StudyFigure,
    key_title,
    number_panels,
    shown_numbers,
    shown_unit,
    spread,
    styled,
)
from toothspace.studies.points import (
    collected,
    point,
    point_lists,
    points_dataset,
    points_table,
    status_of,
)
from toothspace.studies.study import Study, StudyContext, StudyResult, run_study
from toothspace.studies.variation import VARY, axes_of, check_vary, grid, samples, written_values

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@final
@dataclass(frozen=True, kw_only=True)
class SweepStudy(KeyTable):
    """``kind = "sweep"``: many cases over varied keys."""

    vary: Mapping[str, Any] = declare(VARY)
    method: str = choice(
        "How points are placed.", "grid", "latin_hypercube", "sobol", default="grid"
    )
    sample_count: int | None = integer(
        "Points of latin_hypercube and sobol.", low=1, high=10**6, default=None
    )
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        check_vary(self.vary)
        if self.method == "grid":
            forbid(self, 'because method = "grid" takes the points from vary', "sample_count")
        else:
            require(self, f'with method = "{self.method}"', "sample_count")


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case at all points of ``study.vary``.

    Returns
    -------
    StudyResult
        Summary numbers over ``point``; with ``method = "grid"`` the last key runs fastest.

    Raises
    ------
    CaseError
        If no point can be run.
    """
    study = case.study
    assert isinstance(study, SweepStudy)
    axes = axes_of(study.vary, case.label, case)
    if study.method == "grid":
        rows = grid(axes, case.label)
    else:
        assert study.sample_count is not None
        rows = samples(axes, study.method, study.sample_count, study.seed)
    points = [point(case, written_values(axes, row)) for row in rows]
    records = collected(points, context)
    data = points_dataset(axes, rows, records)
    values = {axis.path: [axis.written(row[k]) for row in rows] for k, axis in enumerate(axes)}
    shape = [len(axis.values) for axis in axes] if study.method == "grid" else [len(rows)]
    data.attrs["varied"] = " ".join(axis.path for axis in axes)
    data.attrs["shape"] = " ".join(map(str, shape))
    return StudyResult(
        status=status_of(records),
        data=data,
        numbers=point_lists(values, records),
        tables=(points_table(axes, rows, records),),
    )


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Main numbers over the varied keys."""
    axes = [p for p in data.attrs["varied"].split() if data[p].dtype.kind in "fiu"]
    shape = [int(size) for size in data.attrs["shape"].split()]
    if not axes or not shown_numbers(data):
        return []
    if len(axes) == len(shape) <= 2:
        caption = f"Results over {axes[0]}" + (f", one line per {axes[1]}." if axes[1:] else ".")
        return [StudyFigure("sweep", caption, sweep_lines(data, axes, shape))]
    return [
        StudyFigure(f"sweep_{path}", f"All points over {path}.", scatter(data, path))
        for path in axes
    ]


@styled
def sweep_lines(data: xr.Dataset, paths: Sequence[str], shape: Sequence[int]) -> Figure:
    """Main numbers over the first varied key, one line per value of the second."""
    sizes = (*shape, 1)[:2]
    x = data[paths[0]].values.reshape(sizes)
    second = data[paths[1]].values.reshape(sizes)[0] if len(paths) > 1 else None
    unit = shown_unit(data, paths[-1])
    figure, panels = number_panels(data)
    for axes, name in panels:
        values = data[name].values.reshape(sizes)
        for k in spread(sizes[1]):
            label = f"{second[k]:.4g} {unit}" if second is not None else None
            axes.plot(x[:, k], values[:, k], "o-", ms=3, label=label)
        axes.set_xlabel(key_title(data, paths[0]))
    if second is not None:
        panels[0][0].legend(title=paths[1].rpartition(".")[2].replace("_", " ").capitalize())
    return figure


@styled
def scatter(data: xr.Dataset, path: str) -> Figure:
    """Main numbers of all points over one varied key."""
    figure, panels = number_panels(data)
    for axes, name in panels:
        axes.plot(data[path].values, data[name].values, ".", color=BLUE, ms=4)
        axes.set_xlabel(key_title(data, path))
    return figure


STUDY = Study(SweepStudy, run, figures)


def sweep(
    case: api.AnyCase,
    vary: Mapping[str, Any],
    *,
    workers: int = 1,
    folder: str | Path | None = None,
    progress: Progress | None = None,
) -> StudyResult:
    """Run a case at all combinations of values; the last key runs fastest.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case with an operating point or a circuit; its own study does not count.
    vary : mapping of key path to values
        Lists, or ``{"from": ..., "to": ..., "count": ...}``; values as in a case file.
    workers : int
        Processes.
    folder : str or Path, optional
        Folder of the results; finished points found there are not run again.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    StudyResult
        Summary numbers over ``point`` in ``data``.

    Raises
    ------
    CaseError
        If no point can be run.
    """
    study = replace(load_case(case), study=SweepStudy(vary=vary))
    place = None if folder is None else path_of(folder, "folder", "a folder")
    resume = place is not None and place.is_dir()
    return run_study(
        study, place, progress=progress, workers=api.process_count(workers), resume=resume
    )
