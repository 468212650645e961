"""Numba with a cache folder that follows the package's sources.

Numba's own cache does not notice a change in a function imported from another
module. The cache folder is therefore keyed by a hash of the sources that compiled code is made
of: modules that compile, and all that these import.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent
_IMPORT = re.compile(r"^\s*from toothspace\.([\w.]+) import", re.MULTILINE)
_COMPILED = re.compile(r"^@(\w*kernel|merged|inlined|njit)\b", re.MULTILINE)


def compiled_sources() -> dict[str, str]:
    """Names and texts of all modules that compiled code is made of."""
    texts = {
        ".".join(path.relative_to(_PACKAGE).with_suffix("").parts): path.read_text("utf-8")
        for path in _PACKAGE.rglob("*.py")
    }
    found = {name for name, text in texts.items() if _COMPILED.search(text)}
    ahead = list(found)
    while ahead:
        imported = set(_IMPORT.findall(texts[ahead.pop()])) & texts.keys()
        ahead += imported - found
        found |= imported
    return {name: texts[name] for name in sorted(found)}


def _sources_hash() -> str:
    digest = hashlib.sha256()
    for name, text in compiled_sources().items():
        digest.update(f"{name}\n{text}".encode())
    return digest.hexdigest()[:16]


def _cache_folder() -> Path:
    base = os.environ.get("TOOTHSPACE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    root = Path(base) if base else Path.home() / ".cache"
    return root / "toothspace" / f"compiled-{_sources_hash()}"


CACHE_FOLDER = _cache_folder()
os.environ.setdefault("NUMBA_CACHE_DIR", str(CACHE_FOLDER))

import numba  # noqa: E402  (the cache folder must be set first)
from numba.extending import register_jitable  # noqa: E402

# Numba reads the variable once, perhaps before this module was imported.
numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

njit = numba.njit
prange = numba.prange
kernel = numba.njit(cache=True, error_model="numpy", _nrt=False, nogil=True)
"""Compiles a function that allocates nothing: arrays pass without reference counting."""

merged = numba.njit(cache=True, error_model="numpy", _nrt=False, forceinline=True)
"""A kernel that becomes part of its callers: handing on all arrays costs more than its work."""

inlined = register_jitable
"""Marks a formula that stays plain Python and is compiled where compiled code calls it."""


def announce_first_compilation() -> None:
    """Tell the user once that compiled code is being built and will be kept."""
    if not CACHE_FOLDER.exists():
        sys.stderr.write(
            "First use on this machine: compiling (a minute or two, kept for later).\n"
        )


__all__ = [
    "CACHE_FOLDER",
    "announce_first_compilation",
    "inlined",
    "kernel",
    "merged",
    "njit",
    "prange",
]
