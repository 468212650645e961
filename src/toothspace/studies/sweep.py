"""Many cases over varied keys."""

from __future__ import annotations

from toothspace.case import Case
from toothspace.case.study import SweepStudy
from toothspace.studies.points import collected, point, status_of
from toothspace.studies.study import StudyContext, StudyResult
from toothspace.studies.tabulate import point_lists, points_dataset, points_table
from toothspace.studies.variation import axes_of, grid, samples, written_values


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
    axes = axes_of(study.vary, case.label)
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
