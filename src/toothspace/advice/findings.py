"""One list of what is to be known of a result, for every place that shows it."""

from __future__ import annotations

from collections.abc import Sequence

from toothspace.advice.limits import CAVITATION, JudgedLimit, limits_of
from toothspace.core.design_check import DesignCheck
from toothspace.core.finding import Finding
from toothspace.model.description import MachineDescription
from toothspace.results.solution import Solution

_ORDER = ("serious", "caution", "note")


def findings_of(
    solution: Solution, description: MachineDescription | None, note: str = ""
) -> tuple[Finding, ...]:
    """List what a reader should know before trusting a result or building its machine.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    description : MachineDescription, optional
        Its machine; without it rules, and limits of its bearings and teeth, are left out.
    note : str, optional
        Why there is no machine.

    Returns
    -------
    tuple of Finding
        Serious ones first; each sentence once.
    """
    limits = [limit_finding(x) for x in limits_of(solution, description) if x.exceeded]
    rules = () if description is None else description.checks
    found = [
        *solution.warnings,
        *limits,
        *_cavitation(solution, limits),
        *(rule_finding(check) for check in rules if not check.passed),
        *([Finding("warning", note, severity="note")] if note else ()),
    ]
    once = {finding.sentence: finding for finding in reversed(found)}
    return tuple(sorted(reversed(once.values()), key=lambda x: _ORDER.index(x.severity)))


def limit_finding(limit: JudgedLimit) -> Finding:
    """A limit that is exceeded as finding."""
    return Finding(
        "limit",
        f"{limit.label} is {limit.value}, allowed {limit.allowed} ({limit.source}).",
        quantity=limit.label,
        found=limit.value,
        allowed=limit.allowed,
        advice=limit.advice,
    )


def rule_finding(check: DesignCheck) -> Finding:
    """A design rule that is not met as finding."""
    return Finding(
        "rule",
        f"{check.label} is {check.shown_value}, allowed {check.allowed}.",
        quantity=check.label,
        found=check.shown_value,
        allowed=check.allowed,
        advice=check.reason,
    )


def _cavitation(solution: Solution, limits: Sequence[Finding]) -> list[Finding]:
    """Begins of cavitation, where no limit tells it by its power."""
    count = sum(event.kind == "cavitation_onset" for event in solution.events)
    if count == 0 or any(limit.quantity == CAVITATION for limit in limits):
        return []
    times = "once" if count == 1 else f"{count} times"
    return [
        Finding(
            "warning",
            f"Cavitation begins {times} in the evaluation window; see events.",
            quantity=CAVITATION,
            found=times,
            allowed="no vapour",
        )
    ]
