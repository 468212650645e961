"""Named arrays kept on disk between runs; a file that is not as it was written counts as none."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.files import draft_of

_DIGEST = "digest"


def load_arrays(path: Path) -> dict[str, Any] | None:
    """Return the arrays of a file by name; None if it is missing, damaged or another's."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
        kept = arrays.pop(_DIGEST)
    except Exception:  # a damaged file fails anywhere in the libraries below
        return None
    return arrays if kept.tobytes() == _digest(arrays).tobytes() else None


def save_arrays(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays by name to a file that is complete or not there; a full disk is no error."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with draft_of(path) as draft, draft.open("wb") as file:
            np.savez(file, **{**arrays, _DIGEST: _digest(arrays)})
    except OSError:
        return


def keep_arrays(path: Path, arrays: Mapping[str, Any], most_files: int) -> None:
    """Save arrays in a folder of at most so many files, of which the oldest are forgotten."""
    files = list(path.parent.glob("*.npz"))
    if len(files) >= most_files:
        # another process may forget the same files
        files.sort(key=lambda file: file.stat().st_mtime if file.exists() else 0.0)
        for oldest in files[: most_files // 10]:
            oldest.unlink(missing_ok=True)
    save_arrays(path, arrays)


def _digest(arrays: Mapping[str, Any]) -> Any:
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {np.shape(arrays[name])}".encode())
        digest.update(array.tobytes())
    return np.frombuffer(digest.digest(), dtype=np.uint8)
