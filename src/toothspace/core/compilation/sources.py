"""What compiled code is made of: digests of the sources, and the folder where it is kept."""

from __future__ import annotations

import atexit
import hashlib
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).resolve().parents[2]
"""Folder of the package."""

_LOADING = {f"core.compilation.{name}" for name in ("cache", "entry", "jit", "library", "notice")}
"""Modules that find compiled code and are no part of it."""

_IMPORT = re.compile(r"^\s*from toothspace\.([\w.]+) import (\([^)]*\)|.*)", re.MULTILINE)


def name_of(made: Callable[..., Any]) -> str:
    """Name of a function or class within the package."""
    return f"{made.__module__}.{made.__qualname__}".removeprefix("toothspace.")


@cache
def _texts() -> dict[str, str]:
    """Names and texts of all modules of the package."""
    return {
        ".".join(path.relative_to(PACKAGE).with_suffix("").parts): path.read_text("utf-8")
        for path in PACKAGE.rglob("*.py")
    }


@cache
def _imports(module: str) -> frozenset[str]:
    """Modules of the package that a module imports."""
    texts = _texts()
    found: set[str] = set()
    for place, names in _IMPORT.findall(texts[module]):
        # a name may be that of a module of a package
        found |= {place, *(f"{place}.{name}" for name in re.findall(r"\w+", names))}
    return frozenset(found & texts.keys() - _LOADING)


def with_imports(found: Iterable[str]) -> dict[str, str]:
    """Texts of modules and of all that these import."""
    texts = _texts()
    reached = set(found) & texts.keys()
    ahead = list(reached)
    while ahead:
        imported = _imports(ahead.pop())
        ahead += imported - reached
        reached |= imported
    return {name: texts[name] for name in reached}


def digest_of_texts(texts: dict[str, str]) -> str:
    """Digest of named texts, in whatever order they come."""
    digest = hashlib.sha256()
    for name, text in sorted(texts.items()):
        digest.update(f"{name}\n{text}".encode())
    return digest.hexdigest()[:16]


def digest_of_modules(names: Iterable[str]) -> str:
    """Digest of these modules alone; empty where one is missing."""
    try:
        return digest_of_texts(
            {name: (PACKAGE / f"{name.replace('.', '/')}.py").read_text("utf-8") for name in names}
        )
    except OSError:
        return ""


@cache
def digest_of_sources(module: str | None = None) -> str:
    """Digest of the sources behind a module, or of the whole package with its library."""
    if module:
        return digest_of_texts(with_imports({module}))
    digest = hashlib.sha256()
    for path in sorted({*_files(PACKAGE, ".py"), *_files(PACKAGE / "library", ".toml")}):
        digest.update(path.removeprefix(str(PACKAGE)).encode())
        digest.update(Path(path).read_bytes())
    return digest.hexdigest()[:16]


def _files(folder: str | Path, ending: str) -> Iterator[str]:
    """Files below a folder; as every run asks for them, without a ``Path`` of each."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir():
                yield from _files(entry.path, ending)
            elif entry.name.endswith(ending):
                yield entry.path


def cache_root() -> Path:
    """Folder of all that is kept: ``TOOTHSPACE_CACHE``, or one in the user's cache folder."""
    base = os.environ.get("TOOTHSPACE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else _user_cache()) / "toothspace"


@cache
def _user_cache() -> Path:
    """The user's cache folder; one for this process alone, where the user has no home."""
    try:
        return Path.home() / ".cache"
    except RuntimeError:
        made = tempfile.mkdtemp(prefix="toothspace-")
        atexit.register(shutil.rmtree, made, ignore_errors=True)
        return Path(made)


def compiled_folder() -> Path:
    """Folder of the compiled entries."""
    return cache_root() / "compiled"
