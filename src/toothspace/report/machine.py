"""The machine of a result, rebuilt from the case that the result carries."""

from __future__ import annotations

from pathlib import Path

from toothspace.advice.findings import findings_of
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.finding import Finding
from toothspace.model.description import MachineDescription
from toothspace.results.solution import Solution

NOT_REBUILT = (
    "The machine could not be rebuilt from the case in the result, so its section and design "
    "rules are missing: "
)


def case_of(solution: Solution) -> Case:
    """Return the case that a result carries; files are looked for beside the case file.

    Raises
    ------
    CaseError
        If a file is gone, or the case is none of this version.
    """
    folder = Path(solution.provenance.get("case_file", "")).parent
    return Case.from_toml(solution.provenance.get("case_toml", ""), folder)


def machine_of(solution: Solution) -> tuple[MachineDescription | None, str]:
    """Describe the machine of a result.

    Parameters
    ----------
    solution : Solution
        Result with ``case_toml``, ``case_hash`` and ``case_file`` in its provenance.

    Returns
    -------
    MachineDescription or None
        None if it cannot be rebuilt, for example because a profile file is gone.
    str
        Why not; empty if it was.
    """
    from toothspace import api

    try:
        case = case_of(solution)
        if case.hash != solution.provenance.get("case_hash", case.hash):
            return None, NOT_REBUILT + "files that the case names have changed since the run."
        return api.describe(case), ""
    except CaseError as error:
        return None, f"{NOT_REBUILT}{error}"


def findings_of_result(solution: Solution) -> tuple[Finding, ...]:
    """What is to be known of a result, with the machine rebuilt where it does not hold it."""
    held = getattr(solution, "findings", None)
    return findings_of(solution, *machine_of(solution)) if held is None else held
