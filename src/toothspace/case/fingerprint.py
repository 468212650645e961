"""Fingerprints: hashes of what a result depends on, and what is kept by them."""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

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


def cached_by_hash(
    kept: dict[str, _Made], most: int, make: Callable[[], _Made], *content: Any
) -> _Made:
    """Return what was made of a content before, or make it; the oldest beyond ``most`` goes."""
    key = fingerprint(*content)
    if key not in kept:
        made = make()
        while len(kept) >= most:
            del kept[next(iter(kept))]
        kept[key] = made
    return kept[key]


def has_files(value: Any) -> bool:
    """Whether a path stands anywhere in dataclasses, mappings and sequences."""
    if is_dataclass(value):
        return any(has_files(getattr(value, entry.name)) for entry in fields(value))
    if isinstance(value, Mapping):
        return any(map(has_files, value.values()))
    return isinstance(value, Path) or (
        isinstance(value, tuple | list) and any(map(has_files, value))
    )


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
