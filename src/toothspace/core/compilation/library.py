"""The library of compiled code: where it is, whether it fits the sources, which way is taken.

The library is built ahead for a processor that every computer of its kind can stand in for, and
holds a table of its entries with the types that each was compiled for and a digest of the
sources. Without it, or where the sources have changed since, Numba compiles at run time.
"""

from __future__ import annotations

import ctypes
import json
import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib.machinery import ExtensionFileLoader
from importlib.metadata import version
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from typing import Any

from toothspace.core.compilation.sources import PACKAGE, digest_of_modules
from toothspace.core.errors import CaseError

FOLDER = PACKAGE / "native"
"""Folder of the library."""

FILES = {"win32": "toothspace.dll", "darwin": "libtoothspace.dylib"}
LIBRARY = FILES.get(sys.platform, "libtoothspace.so")
"""File name of the library on this system."""

CALLER = "caller.pyd" if sys.platform == "win32" else "caller.abi3.so"
"""File name of what calls its entries with arguments of Python."""

UNIT = LIBRARY.replace("toothspace", "toothspace_unit")
"""File name of the library that is the binary of every unit of a whole machine."""

MODEL = "model.o"
UNIT_SOURCES = (
    *("toothspace.h", "machine.c", "reshape.c", "digest.c"),
    *("unit.h", "unit.c", "fmi2.c", "fmi3.c"),
)
"""What that library is linked from: object code of the model, and sources in C."""

NEEDED = 'compiled code is missing, allowed after pip install "toothspace[jit]"'
"""What is said where neither the library nor Numba can be had."""


class Way(StrEnum):
    """How compiled functions come to their machine code."""

    LIBRARY = "library"
    JUST_IN_TIME = "jit"
    PLAIN = "plain"
    MISSING = "missing"


@dataclass(frozen=True)
class Native:
    """One entry of the library: address and types of what it takes and gives."""

    address: int
    types: bytes
    results: bytes


@dataclass(frozen=True)
class Library:
    """The library in this process."""

    entries: Mapping[str, Native]
    target: str
    digest: str
    call: Any


@cache
def chosen() -> tuple[Way, str, Library | None]:
    """Way that is taken, the reason in words, and the library where it is that.

    ``TOOTHSPACE_COMPILATION`` asks for another one: ``jit``, or ``plain``, which compiles every
    function on its own.
    """
    asked = os.environ.get("TOOTHSPACE_COMPILATION", "")
    if asked not in {"", Way.LIBRARY, Way.JUST_IN_TIME, Way.PLAIN}:
        raise CaseError("TOOTHSPACE_COMPILATION", asked, "library, jit or plain")
    if asked in {Way.PLAIN, Way.JUST_IN_TIME}:
        return Way(asked), "TOOTHSPACE_COMPILATION asks for it", None
    found = _opened()
    if isinstance(found, Library):
        return Way.LIBRARY, f"{FOLDER / LIBRARY} for {found.target}", found
    if find_spec("numba") is None:
        return Way.MISSING, found, None
    return Way.JUST_IN_TIME, found, None


def way() -> Way:
    """Which way compiled functions come to their machine code."""
    return chosen()[0]


def compiles_first() -> str:
    """Why code is compiled as it is used although there is a library; empty where it is not."""
    taken, reason, _ = chosen()
    unused = taken is Way.JUST_IN_TIME and (FOLDER / LIBRARY).is_file()
    return reason if unused and not os.environ.get("TOOTHSPACE_COMPILATION") else ""


def compiler_version() -> str:
    """Version of Numba where that compiles; the target of the library where that is used."""
    found = chosen()[2]
    if found is not None:
        return f"none, library for {found.target}"
    return version("numba")


def _opened() -> Library | str:
    """Open the library, or say why not."""
    path = FOLDER / LIBRARY
    if not path.is_file():
        return f"no {path}"
    try:
        library = ctypes.CDLL(str(path))
        table = json.loads(ctypes.c_char_p.in_dll(library, "toothspace_table").value or b"{}")
        loader = ExtensionFileLoader("caller", str(FOLDER / CALLER))
        spec = spec_from_file_location("caller", loader.path, loader=loader)
        if spec is None:
            return f"{loader.path} is no extension"
        caller = module_from_spec(spec)
        loader.exec_module(caller)
    except (OSError, ValueError, ImportError) as error:
        return f"{path} cannot be used: {error}"
    if digest_of_modules(table["modules"]) != table["digest"]:
        return f"{path} was built from other sources"
    count = len(table["entries"])
    addresses = (ctypes.c_void_p * count).in_dll(library, "toothspace_functions")
    entries = {
        entry["name"]: Native(addresses[k] or 0, _short(entry["types"]), entry["results"].encode())
        for k, entry in enumerate(table["entries"])
    }
    return Library(entries, table["target"], table["digest"], caller.call)


def _short(types: str) -> bytes:
    """Types without the names of classes."""
    return re.sub(r"[\w.]+\(", "(", types).encode()
