"""Numbers by which a thing made of numbers is known again: a machine, a film, a run."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

Traits = dict[str, float | str]
DIGITS = 9
"""Digits that are kept."""


def traits(thing: Any, without: Sequence[str] = (), *, ordered: bool = True) -> Traits:
    """One number for every array, and all numbers and words, by their places.

    An array is known by its root mean square and, where the order of its numbers is to be known,
    by a weighted mean on top, which is smaller.

    Parameters
    ----------
    thing : object
        Numbers, words, arrays, mappings, sequences and dataclasses of them; an item with a name
        stands under it.
    without : sequence of str
        Fields that are left out.
    """
    found: Traits = {}
    for place, value in _leaves(thing, "", frozenset(without)):
        if isinstance(value, str):
            found[place] = value
            continue
        numbers = np.asarray(value, float).ravel()
        numbers = numbers[np.isfinite(numbers)]
        if not numbers.size:
            continue
        known = float(numbers[0])
        if np.ndim(value):
            known = float(np.sqrt(np.mean(numbers**2)))
            if ordered:
                known += float(np.mean(np.cos(np.sqrt(2.0) * np.arange(numbers.size)) * numbers))
        found[place] = float(f"{known:.{DIGITS}g}")
    return found


def _leaves(thing: Any, place: str, without: frozenset[str]) -> Iterator[tuple[str, Any]]:
    items: Iterator[tuple[str, Any]] = iter(())
    if dataclasses.is_dataclass(thing):
        kept = [entry for entry in dataclasses.fields(thing) if entry.name not in without]
        items = ((x.name, getattr(thing, x.name)) for x in kept if not _at_default(x, thing))
    elif isinstance(thing, Mapping):
        items = ((str(name), value) for name, value in thing.items())
    elif isinstance(thing, tuple | list) and all(isinstance(x, float | int) for x in thing):
        yield place, np.array(thing, float)
    elif isinstance(thing, Sequence) and not isinstance(thing, str):
        items = ((str(getattr(value, "name", k)), value) for k, value in enumerate(thing))
    elif isinstance(thing, str | float | int | np.number | np.ndarray):
        yield place, thing
    for name, value in items:
        yield from _leaves(value, f"{place}.{name}" if place else name, without)


def _at_default(entry: dataclasses.Field[Any], thing: Any) -> bool:
    """Whether a field holds the number or word that it holds where none is given."""
    value = getattr(thing, entry.name)
    return isinstance(value, str | float | int) and value == entry.default
