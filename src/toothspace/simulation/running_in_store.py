"""Depths of running-in kept on disk, beside the compiled code and keyed by its sources."""

from __future__ import annotations

from pathlib import Path

from toothspace.core.array_store import load_arrays, save_arrays
from toothspace.core.compiled import CACHE_FOLDER
from toothspace.core.types import Array

_MOST_FILES = 2000


def folder() -> Path:
    """Folder of the stored depths."""
    return CACHE_FOLDER.parent / CACHE_FOLDER.name.replace("compiled", "running-in")


def load(key: str) -> dict[str, Array] | None:
    """Return the depths stored under a key, or None. [m]."""
    return load_arrays(folder() / f"{key}.npz")


def save(key: str, depths: dict[str, Array]) -> None:
    """Store depths. [m]."""
    _forget_oldest(folder())
    save_arrays(folder() / f"{key}.npz", depths)


def _forget_oldest(place: Path) -> None:
    files = list(place.glob("*.npz"))
    if len(files) >= _MOST_FILES:
        files.sort(key=_last_change)
        for path in files[: _MOST_FILES // 10]:
            path.unlink(missing_ok=True)


def _last_change(path: Path) -> float:
    # another process may forget the same files
    return path.stat().st_mtime if path.exists() else 0.0
