"""Studies by the value of ``study.kind``, which is the name of their module.

Each module has a function ``run(case, context) -> StudyResult``: the case has a table
``[study]`` of its kind, the context gives progress, workers and records of finished points. An
interrupt by the user ends a study with the points that are finished.
"""

from __future__ import annotations

import time
from dataclasses import replace
from importlib import import_module
from pathlib import Path

from toothspace.case import Case
from toothspace.case.study import study_kind
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.studies.records import FILE_NAME, Records
from toothspace.studies.study import StudyContext, StudyResult
from toothspace.studies.workers import Workers


def kind_of(case: Case) -> str:
    """Return the kind of the study of a case.

    Raises
    ------
    CaseError
        If the case has no study.
    """
    if case.study is None:
        allowed = "a table [study] with its kind"
        raise CaseError(f"{case.label}: study: found nothing, allowed {allowed}")
    return study_kind(case.study)


def run_study(
    case: Case,
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
    case : Case
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
    from toothspace.run.run import provenance_of

    kind = kind_of(case)
    module = import_module(f"toothspace.studies.{kind}")
    started = time.perf_counter()
    records = Records(None if folder is None else Path(folder) / FILE_NAME, resume=resume)
    try:
        with Workers(workers, scheduler) as pool:
            result: StudyResult = module.run(case, StudyContext(progress, pool, records))
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
