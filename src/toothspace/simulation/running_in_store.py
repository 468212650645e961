"""Depths of running-in kept on disk, keyed by the sources of the package."""

from __future__ import annotations

from pathlib import Path

from toothspace.core.array_store import keep_arrays, load_arrays
from toothspace.core.compiled import cache_root, digest_of_sources
from toothspace.core.types import Array

_MOST_FILES = 2000


def folder() -> Path:
    """Folder of the stored depths."""
    return cache_root() / f"running-in-{digest_of_sources()}"


def load(key: str) -> dict[str, Array] | None:
    """Return the depths stored under a key, or None. [m]."""
    return load_arrays(folder() / f"{key}.npz")


def save(key: str, depths: dict[str, Array]) -> None:
    """Store depths. [m]."""
    keep_arrays(folder() / f"{key}.npz", depths, _MOST_FILES)
