"""Many cases over varied keys."""

from __future__ import annotations

from toothspace.case import Case
from toothspace.case.study import SweepStudy
from toothspace.studies.points import collected, point, status_of
from toothspace.studies.study import StudyContext, StudyResult
from toothspace.studies.tabulate import point_lists, points_dataset, points_table, provenance
from toothspace.studies.variation import axes_of, grid, samples, written_values


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case at all points of ``study.vary``.

    Parameters
    ----------
    case : Case
        Case with ``kind = "sweep"``.
    context : StudyContext
        Progress, workers and records.

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
    label = str(case.source or "case")
    axes = axes_of(study.vary, label)
    if study.method == "grid":
        rows = grid(axes, label)
    else:
        assert study.sample_count is not None
        rows = samples(axes, study.method, study.sample_count, study.seed)
    points = [point(case, written_values(axes, row)) for row in rows]
    records = collected(points, context)
    data = points_dataset(axes, rows, records)
    shape = [len(axis.values) for axis in axes] if study.method == "grid" else [len(rows)]
    data.attrs["varied"] = " ".join(axis.path for axis in axes)
    data.attrs["shape"] = " ".join(map(str, shape))
    return StudyResult(
        kind="sweep",
        title=case.title,
        status=status_of(records),
        data=data,
        numbers=point_lists(axes, rows, records),
        tables=(points_table(axes, rows, records),),
        provenance=provenance(case),
    )
