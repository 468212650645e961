"""Depths of running-in kept on disk, beside the compiled code and keyed by its sources."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from toothspace.core.compiled import CACHE_FOLDER
from toothspace.core.types import Array

_MOST_FILES = 2000


def folder() -> Path:
    """Folder of the stored depths."""
    return CACHE_FOLDER.parent / CACHE_FOLDER.name.replace("compiled", "running-in")


def load(key: str) -> dict[str, Array] | None:
    """Return the depths stored under a key, or None. [m]."""
    try:
        with (folder() / f"{key}.npz").open("rb") as file, np.load(file) as data:
            return {name: data[name] for name in data.files}
    except (OSError, BadZipFile, ValueError, EOFError):
        return None


def save(key: str, depths: dict[str, Array]) -> None:
    """Store depths [m]; a file is complete or not there. A full disk is no error."""
    target = folder() / f"{key}.npz"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        _forget_oldest(target.parent)
        handle, draft = tempfile.mkstemp(dir=target.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez(file, **depths)  # type: ignore[arg-type]
            Path(draft).replace(target)
        finally:
            Path(draft).unlink(missing_ok=True)
    except OSError:
        return


def _forget_oldest(place: Path) -> None:
    files = list(place.glob("*.npz"))
    if len(files) >= _MOST_FILES:
        files.sort(key=lambda path: path.stat().st_mtime)
        for path in files[: _MOST_FILES // 10]:
            path.unlink(missing_ok=True)
