"""Cases that come with the package: listed, found by name, copied as a start."""

from __future__ import annotations

import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path

from toothspace.case.document import text_values
from toothspace.core.errors import CaseError
from toothspace.core.keys import suggestion
from toothspace.library import shipped_folder


def cases() -> dict[str, str]:
    """Return the titles of all shipped cases by name."""
    found = {}
    for path in sorted(shipped_folder("cases").glob("*.toml")):
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
        found[path.stem] = str(tables.get("title", ""))
    return found


def shipped_case(name: str) -> Path:
    """Return the file of a shipped case.

    Raises CaseError if there is none of that name.
    """
    names = [path.stem for path in sorted(shipped_folder("cases").glob("*.toml"))]
    if name not in names:
        raise CaseError("case", f"{name!r}", suggestion(name, names))
    return shipped_folder("cases") / f"{name}.toml"


def copy_case(name: str, folder: Path, *, replace: bool = False) -> list[Path]:
    """Copy a shipped case with the files that it names, its base included.

    The files written, the case first.

    Raises CaseError if there is no such case, or a file exists.

    Parameters
    ----------
    folder : Path
        Where to; made if it is not there.
    replace : bool
        Whether files that exist are replaced.
    """
    home = shipped_folder("cases")
    sources = list(dict.fromkeys(_with_files(shipped_case(name))))
    targets = [folder / source.relative_to(home) for source in sources]
    for target in targets:
        if target.exists() and not replace:
            raise CaseError(target, "a file", "a new name, or --force to replace it")
    for source, target in zip(sources, targets, strict=True):
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
    return targets


def _with_files(path: Path) -> Iterator[Path]:
    yield path
    for _, text in text_values(tomllib.loads(path.read_text(encoding="utf-8"))):
        named = path.parent / text
        if "." in text and len(text) < 200 and named.is_file():
            yield from _with_files(named) if named.suffix == ".toml" else [named]
