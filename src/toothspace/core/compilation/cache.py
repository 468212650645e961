"""Compiled entries kept on disk, found again by what they are made of.

An entry is one file. Its name holds a digest of the sources behind the function, its options and
signature, the processor and the versions of Python, Numba and NumPy: neither the place of the
package nor the time of a file matters, and several checkouts share one folder. A file is written
under another name and then moved, so that processes do not disturb each other; what is damaged
is compiled again.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, final

import numba
import numpy as np
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

from toothspace.core.compilation.sources import compiled_folder, digest_of_sources, name_of

_DIGEST = hashlib.sha256().digest_size
_SECONDS_KEPT = 60 * 24 * 3600.0
_UNREADABLE = (OSError, ValueError, KeyError, EOFError, pickle.PickleError, AttributeError)


@final
class EntryCache:
    """Entries of one function on disk, in the place of Numba's own cache.

    Parameters
    ----------
    function : callable
        What is compiled; functions outside the package are not kept.
    options : mapping
        Compiler options.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        module, _, rest = function.__module__.partition(".")
        self._kept = module == "toothspace" and "<locals>" not in function.__qualname__
        self._module = rest
        self._name = name_of(function)
        self._options = repr(sorted((key, _stable(value)) for key, value in options.items()))

    @property
    def cache_path(self) -> str | None:
        """Folder of the entries."""
        return str(compiled_folder()) if self._kept else None

    def load_overload(self, sig: Any, target_context: Any) -> CompileResult | None:
        """Return the entry of a signature, nothing if there is none that is sound."""
        if not self._kept:
            return None
        path = self._path(sig, target_context.codegen())
        try:
            data = path.read_bytes()
            if hashlib.sha256(data[_DIGEST:]).digest() != data[:_DIGEST]:
                raise ValueError("damaged")
            # what compiling needs beyond the memory manager is loaded when something is compiled
            rtsys.initialize(target_context)
            result = CompileResult._rebuild(target_context, *pickle.loads(data[_DIGEST:]))
        except _UNREADABLE:
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return result

    def save_overload(self, sig: Any, result: CompileResult) -> None:
        """Keep an entry; a folder that cannot be written costs the next start, no more."""
        if not self._kept or result.library.has_dynamic_globals:
            return
        *parts, environments = result._reduce()
        # one without constants is never asked, and would load the module that it stands for
        data = dumps((*parts, tuple(each for each in environments if each.consts)))
        path = self._path(sig, result.codegen)
        try:
            _write(path, hashlib.sha256(data).digest() + data)
        except OSError as error:
            warnings.warn(f"compiled code is not kept in {path.parent}: {error}", stacklevel=2)
            return
        _forget_old(path.parent, f"{self._name}-")

    def _path(self, sig: Any, codegen: Any) -> Path:
        key = (
            digest_of_sources(self._module),
            self._options,
            str(sig),
            codegen.magic_tuple(),
            (sys.version, numba.__version__, np.__version__),
        )
        digest = hashlib.sha256(repr(key).encode()).hexdigest()[:24]
        return compiled_folder() / f"{self._name}-{digest}"

    def flush(self) -> None:
        """Numba's own cache can be emptied; entries here are left to age."""


def _stable(option: Any) -> str:
    """Text of an option; the order of a set changes from process to process."""
    return repr(sorted(option) if isinstance(option, (set, frozenset)) else option)


def _write(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".new-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _forget_old(folder: Path, beginning: str) -> None:
    """Remove entries of a function that were not used for long."""
    limit = time.time() - _SECONDS_KEPT
    for path in folder.glob(f"{beginning}*"):
        with contextlib.suppress(OSError):
            if path.stat().st_mtime < limit:
                path.unlink()
