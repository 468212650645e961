"""Runs the study of a case. An interrupt by the user ends it with the points that are finished."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from toothspace.case import Case, load_case
from toothspace.core import registry
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.run.run import provenance_of
from toothspace.studies.records import FILE_NAME, Records
from toothspace.studies.study import StudyContext, StudyResult
from toothspace.studies.workers import Workers


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
