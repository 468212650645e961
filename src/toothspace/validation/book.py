"""All published claims, and running them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial

from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.progress import Progress, tell
from toothspace.studies.workers import Workers
from toothspace.validation import (
    gerotor,
    lateral,
    motor_startup,
    published_films,
    reference_machines,
)
from toothspace.validation.claim import Claim, Effort, Evidence, Examined

CLAIMS: tuple[Claim, ...] = (
    *published_films.CLAIMS,
    *reference_machines.CLAIMS,
    *reference_machines.SERVICE_MANUAL_CLAIMS,
    *motor_startup.CLAIMS,
    *lateral.CLAIMS,
    *gerotor.CLAIMS,
)
"""Every published number, statement and figure that the package is held against."""


def selected(part: str) -> tuple[Claim, ...]:
    """Return the claims whose key or source contains a text; empty text returns all.

    Raises CaseError if there is none.

    Parameters
    ----------
    part : str
        Part of a name.
    """
    chosen = tuple(c for c in CLAIMS if part in c.key or part in c.source.key)
    if not chosen:
        known = ", ".join(claim.key for claim in CLAIMS)
        raise CaseError("validate", f"no claim {part!r}", f"a part of {known}")
    return chosen


def examine(claim: Claim, effort: Effort = "full") -> Examined:
    """Compute what a claim is about.

    With the trouble in words where the computation failed.

    Parameters
    ----------
    effort : str
        ``short`` for coarse grids and few points, ``full`` for those that tolerances stand for.
    """
    if claim.measure is None:
        return Examined(claim, Evidence())
    begun = time.perf_counter()
    try:
        finding, trouble = claim.measure(effort), ""
    except ToothspaceError as error:
        finding, trouble = Evidence(), str(error)
    return Examined(claim, finding, trouble, time.perf_counter() - begun)


def examine_all(
    claims: Sequence[Claim], effort: Effort, progress: Progress | None = None, workers: int = 1
) -> list[Examined]:
    """Examine claims, the longest first where several processes share them.

    Claims that judge one computation are examined by one process.

    Parameters
    ----------
    workers : int
        Processes.
    """
    if workers <= 1:
        found = []
        for k, claim in enumerate(claims):
            tell(progress, k / len(claims), claim.key)
            found.append(examine(claim, effort))
        return found
    together: dict[str, list[Claim]] = {}
    for claim in sorted(claims, key=lambda claim: -claim.minutes):
        together.setdefault(claim.computed_with or claim.key, []).append(claim)
    groups = list(together.values())
    known = {}
    with Workers(workers) as pool:
        tasks = [[claim.key for claim in group] for group in groups]
        for k, found in pool.each(partial(_found, effort), tasks):
            for claim, one in zip(groups[k], found, strict=True):
                known[claim.key] = Examined(claim, *one)
                tell(progress, len(known) / len(claims), claim.key)
    return [known[claim.key] for claim in claims]


def _found(effort: Effort, keys: Sequence[str]) -> list[tuple[Evidence, str, float]]:
    """What claims give, without the claims, whose functions do not go between processes."""
    by_key = {claim.key: claim for claim in CLAIMS}
    examined = [examine(by_key[key], effort) for key in keys]
    return [(one.finding, one.trouble, one.duration) for one in examined]
