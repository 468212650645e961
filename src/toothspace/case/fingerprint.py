"""Fingerprints: hashes of what a result depends on, and what is kept by them."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar, final

import numpy as np

_Made = TypeVar("_Made")


def fingerprint(*values: Any) -> str:
    """Return a hash of the content of values, the same in every process.

    Parameters
    ----------
    *values : object
        Dataclasses, mappings, sequences, arrays, numbers, texts; of a path counts the content
        of its file.
    """
    digest = hashlib.sha256()
    for part in _parts(values):
        digest.update(part)
        digest.update(b"\0")
    return digest.hexdigest()


@final
class KeptByContent(Generic[_Made]):
    """What was made of the contents asked for last.

    Parameters
    ----------
    most : int
        How many are kept.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._kept: dict[str, _Made] = {}

    def get(self, make: Callable[[], _Made], *content: Any) -> _Made:
        """Return what was made of a content, or make it."""
        key = fingerprint(*content)
        if key not in self._kept:
            made = make()
            while len(self._kept) >= self._most:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = made
        return self._kept[key]


def _parts(value: Any) -> Iterator[bytes]:
    if is_dataclass(value) and not isinstance(value, type):
        yield type(value).__qualname__.encode()
        for entry in fields(value):
            yield entry.name.encode()
            yield from _parts(getattr(value, entry.name))
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype.str} {value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, Mapping):
        yield f"mapping {len(value)}".encode()
        for key, item in value.items():
            yield from _parts(key)
            yield from _parts(item)
    elif isinstance(value, (tuple, list)):
        yield f"{type(value).__name__} {len(value)}".encode()
        for item in value:
            yield from _parts(item)
    elif isinstance(value, Path):
        yield value.read_bytes()
    elif isinstance(value, (str, int, float, bool, type(None))):
        yield f"{type(value).__name__} {value!r}".encode()
    else:
        yield pickle.dumps(value)
