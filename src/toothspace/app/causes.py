"""Why the answers of two designs differ: one changed key at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from toothspace.app.answers import Answers
from toothspace.case import Case
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.files import plain
from toothspace.core.progress import Progress, tell

_TITLES = ("title", "schema", "base")
"""Keys that no answer depends on."""


def causes(first: Case, second: Case, progress: Progress | None = None) -> dict[str, Any]:
    r"""Split the differences of the answers of two designs by the keys that differ.

    Parameters
    ----------
    first, second : Case
        Both designs, of one machine.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    dict
        ``first`` and ``second``: numbers of both answers; ``keys``: for each changed key, or keys
        that only change together, ``paths`` and its ``shares`` in every number.

    Raises
    ------
    CaseError
        If a design has no answer.

    Notes
    -----
    The share of a key is the answer of the first design with that key of the second less that of
    the first, :math:`\Delta_k = N(\ldots, x_k', \ldots) - N(x)`. What :math:`N(x') - N(x)` has
    beyond their sum is the interaction of the keys. Answers are quick ones on the casing that the
    first design has run in.
    """
    changed = dict(_differences(first.to_dict(), second.to_dict()))
    alone, together = dict[str, Case](), dict[str, Any]()
    for path, value in changed.items():
        try:
            alone[path] = first.replace({path: value}).check()
        except (CaseError, GeometryError):
            together[path] = value
    steps: list[tuple[tuple[str, ...], Case]] = [((path,), case) for path, case in alone.items()]
    if together:
        # keys that depend on one another, such as a timing and the angles in its place
        try:
            steps.append((tuple(together), first.replace(together).check()))
        except (CaseError, GeometryError):
            steps = [(tuple(changed), second)]
    answers, done = Answers(), 0

    def numbers(case: Case, what: str) -> Mapping[str, float]:
        nonlocal done
        tell(progress, done / (len(steps) + 2), what)
        found = answers.quick(case.at_point({}))
        done += 1
        if not found.status.succeeded:
            raise CaseError(f"There is no answer for {what}: {found.status.value}")
        values = plain(found.summary())
        return {k: v for k, v in values.items() if isinstance(v, int | float)}

    before = numbers(first, "the first variant")
    keys = []
    for count, (paths, case) in enumerate(steps):
        after = numbers(case, f"change {count + 1} of {len(steps)}: {', '.join(paths)}")
        shares = {name: after[name] - value for name, value in before.items() if name in after}
        keys.append({"paths": list(paths), "shares": shares})
    return {"first": before, "second": numbers(second, "the second variant"), "keys": keys}


def _differences(
    first: Mapping[str, Any], second: Mapping[str, Any], path: str = ""
) -> Iterator[tuple[str, Any]]:
    """Keys of the second case that differ, None for those that it lacks."""
    for name in [*first, *(name for name in second if name not in first)]:
        place = f"{path}.{name}" if path else name
        own, other = first.get(name), second.get(name)
        if isinstance(own, Mapping) and isinstance(other, Mapping):
            yield from _differences(own, other, place)
        elif own != other and place not in _TITLES:
            yield place, other
