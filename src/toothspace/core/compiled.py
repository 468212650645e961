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

# Numba reads the variable once, perhaps before this module was imported.
numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]


from toothspace.core.compilation.parts import Formula, Kernel
from toothspace.core.compilation.records import passed_by_address

def njit(*args, **options):
    if options.get("parallel"):
        return numba.njit(**options)
    options.pop("cache", None)
    options.pop("no_cpython_wrapper", None)
    options.pop("no_cfunc_wrapper", None)
    if args:
        return Kernel(args[0], None, {})
    return lambda function: Kernel(function, None, options)

prange = numba.prange
kernel = njit(error_model="numpy", _nrt=False, nogil=True)
merged = njit(error_model="numpy", _nrt=False, forceinline=True)

_formulas = []

def inlined(function):
    _formulas.append(Formula(function))
    return function

def announce_first_compilation() -> None:
    pass
