"""Files that are complete or not there, also where a disk is full."""

from __future__ import annotations

import hashlib
import math
import os
import reprlib
import secrets
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import FileIO
from pathlib import Path
from typing import Any

from toothspace.core.errors import CaseError, GeometryError, ToothspaceError
from toothspace.core.interrupts import interrupts_held

_LONGEST_PREFIX = 40
"""A draft takes so much of the name of its target, so that long names fit the file system."""
_DIGEST = "digest"


def named_beside(file: Path, folder: Path) -> str:
    """Name of a file for a case file in a folder: relative, but on another drive."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return file.resolve().as_posix()


@contextmanager
def draft_of(target: str | Path) -> Iterator[Path]:
    """Give an empty file beside a target that becomes the target when all is written.

    Parameters
    ----------
    target : str or Path
        File to create or replace; its folder exists.

    Yields
    ------
    Path
        The draft. It is removed, and the target left as it was, where the body fails.
    """
    target, draft = Path(target), None
    try:
        with interrupts_held():
            name = f".{target.name[:_LONGEST_PREFIX]}.{secrets.token_hex(8)}.part"
            # with the permissions that the user gives to new files
            os.close(os.open(target.parent / name, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666))
            draft = target.parent / name
        yield draft
        with draft.open("rb") as file:
            # a network disk may say only now that it is full
            os.fsync(file.fileno())
        draft.replace(target)
    except BaseException:
        if draft is not None:
            draft.unlink(missing_ok=True)
        raise


def path_of(given: object, name: str, allowed: str) -> Path:
    """Return a text or path as a path.

    Raises CaseError if it is anything else.

    Parameters
    ----------
    name : str
        What it is the path of, for messages.
    allowed : str
        What may be given, for messages.
    """
    if not isinstance(given, (str, os.PathLike)):
        raise CaseError(name, reprlib.repr(given), allowed)
    return Path(given)


def read_bytes(path: Path, label: str, allowed: str, most: int) -> bytes:
    """Return the content of an ordinary file, neither a folder, a pipe nor a device.

    Raises CaseError if it is missing, no ordinary file, larger or unreadable.

    Parameters
    ----------
    label : str
        Its name in messages.
    allowed : str
        What it should be, for messages.
    most : int
        Largest size. [byte]
    """
    try:
        if not path.is_file() and path.exists():
            found = "a directory" if path.is_dir() else "a device or pipe"
            raise CaseError(label, found, allowed)
        size = path.stat().st_size
        if size > most:
            raise CaseError(label, f"{size} bytes", f"at most {most}")
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no such file"
        raise CaseError(label, f"{reason!r}", allowed) from error


@contextmanager
def reading(path: object, allowed: str) -> Iterator[None]:
    """Refuse a file in words whatever its reader stumbles over.

    Parameters
    ----------
    path : object
        File, for the message.
    allowed : str
        What it should be.

    Raises
    ------
    GeometryError
        In place of any error that is none of the package's own: readers of damaged files, and
        libraries below them, fail anywhere.
    """
    try:
        yield
    except (ToothspaceError, MemoryError):
        raise
    except Exception as error:
        found = f"a file that cannot be read as one ({type(error).__name__})"
        raise GeometryError(path, found, allowed) from error


def write_bytes(target: str | Path, content: bytes) -> Path:
    """Write a file that is complete or not there."""
    with draft_of(target) as draft:
        draft.write_bytes(content)
    return Path(target)


def write_text(target: str | Path, text: str) -> Path:
    """Write a text file in UTF-8 that is complete or not there."""
    return write_bytes(target, text.encode("utf-8"))


def write_whole(file: FileIO, content: memoryview | bytes) -> None:
    """Write all of a content to an unbuffered file, which may take it in parts."""
    rest = memoryview(content).cast("B")
    while rest:
        rest = rest[file.write(rest) :]


def require_ending(target: Path, label: str, endings: tuple[str, ...]) -> None:
    """Refuse a file name whose ending promises another format than what is written.

    Raises CaseError if its ending is none of those given.
    """
    if target.suffix.lower() not in endings:
        found = f"the ending {target.suffix!r}" if target.suffix else "a name without ending"
        raise CaseError(f"{target}: {label}", found, ", ".join(endings))


def require_writable(target: Path, option: str, *, replace: bool, endings: tuple[str, ...]) -> Path:
    """Return a file that can be written; nothing is left behind.

    Raises CaseError if it is a folder, its folder is missing or refuses files, its name is too
    long, it exists and must be kept, or it has another ending.

    Parameters
    ----------
    target : Path
        File that is to be written later.
    option : str
        What asked for it, for the message.
    replace : bool
        Whether a file that exists may be replaced.
    endings : tuple of str
        Endings of the formats that are written, as ``.nc``.
    """
    try:
        if target.is_dir():
            raise CaseError(f"{target}: {option}", "a directory", "a file name")
        if not target.parent.is_dir():
            found = f"no folder {target.parent}"
            raise CaseError(f"{target}: {option}", found, "an existing one")
        if target.exists():
            if not target.is_file():
                raise CaseError(f"{target}: {option}", "a device or pipe", "a file name")
            if not replace:
                kept = "a file that exists"
                raise CaseError(f"{target}: {option}", kept, "a new one, or --force")
        # names may be too long or hold what the disk refuses; a kill leaves none of that name
        place = target.parent
        with (
            interrupts_held(),
            tempfile.TemporaryDirectory(dir=place, prefix=".", suffix=".part") as folder,
        ):
            (Path(folder) / target.name).touch()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        found = f"{reason!r} on writing"
        raise CaseError(f"{target}: {option}", found, "a writable place") from error
    require_ending(target, option, endings)
    return target


def plain(value: Any) -> Any:
    """Return a value that JSON can hold; numbers that are not finite become null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)


def load_arrays(path: Path) -> dict[str, Any] | None:
    """Return the arrays of a file by name; None if it is missing, damaged or another's."""
    import numpy as np

    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
        kept = arrays.pop(_DIGEST)
    except Exception:  # a damaged file fails anywhere in the libraries below
        return None
    return arrays if kept.tobytes() == _digest(arrays).tobytes() else None


def save_arrays(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays by name to a file that is complete or not there; a full disk is no error."""
    import numpy as np

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
    import numpy as np

    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {np.shape(arrays[name])}".encode())
        digest.update(array.tobytes())
    return np.frombuffer(digest.digest(), dtype=np.uint8)
