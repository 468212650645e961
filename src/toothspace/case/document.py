"""Text of a case file to tables with the line of every key, changed by key paths, and back."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, final

from toothspace.core.errors import CaseError, joined
from toothspace.core.files import read_bytes
from toothspace.core.frozen import Points
from toothspace.core.keys import is_table, shown
from toothspace.library import shipped_folder

BASE = "base"
"""Key at the top of a case file: the case file that it is based on."""

_LARGEST_FILE = 5_000_000
_MOST_BASES = 10
_DEEPEST = 20
_LARGEST_INTEGER = 2**63 - 1
_LONGEST_PLACE = 80
_LONGEST_PATH = 10_000
_NAME_END = re.compile(r"[.\[]")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_NAME = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_NAME}(?:\s*\.\s*{_NAME})*)\s*\]")
_ENTRY = re.compile(rf"\s*({_NAME}(?:\s*\.\s*{_NAME})*)\s*=")
_TAGS = ("type", "kind")
_OTHER_FILES = {
    **dict.fromkeys((".step", ".stp", ".stl", ".dxf"), "a drawing, which 'toothspace gear' reads"),
    ".nc": "a result, which 'toothspace report' reads",
}
"""What files are that no case can be, by their ending."""
CONDITIONS = ("operating_point", "circuit", "bearing", "film")
"""Tables of which a case has exactly one."""
ALTERNATIVES = (
    ("run.until", "run.revolutions"),
    ("machine.gears.normal_backlash", "machine.gears.center_distance"),
    ("fluid.name", "fluid.table", "fluid.data_sheet"),
    ("bearing.eccentricity", "bearing.load"),
    CONDITIONS,
)
"""Keys that exclude each other: one that is given takes the others out."""
_PATH = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+){0,19}")


@final
class BaseText(str):
    """Text from a base file; a file path in it is relative to ``folder``."""

    folder: Path

    def __new__(cls, text: str, folder: Path) -> BaseText:
        """Keep the folder beside the text."""
        made = super().__new__(cls, text)
        made.folder = folder
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return BaseText, (str(self), self.folder)


@final
@dataclass(frozen=True)
class Document:
    """Tables of a case file, with those of the file that it is based on."""

    label: str
    """Name of the file in messages."""
    tables: dict[str, Any]
    """Its keys and values."""
    places: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    """File and line of a key or of the head of a table. By key path."""

    def place(self, key: str) -> tuple[str, int]:
        """Return file and line of a key, or of the table that it is missing in."""
        while key and key not in self.places:
            key = key[: max(key.rfind("."), key.rfind("["), 0)]
        return self.places.get(key, (self.label, 0))

    def refuse(self, error: CaseError) -> CaseError:
        """Return an error with file and line of its problems, in their order."""
        if not self.label:
            return error
        placed = []
        for problem in dict.fromkeys(error.problems):
            file, line = self.place(problem.key)
            placed.append(problem._replace(file=file, line=line))
        placed.sort(key=lambda one: (one.file != self.label, one.file, one.line))
        return error.of(placed)


def read_document(path: Path, label: str) -> Document:
    """Return the tables of a TOML file.

    Raises CaseError if it, or the file that it is based on, is missing, no text in UTF-8 or no
    TOML.

    Parameters
    ----------
    label : str
        Its name in messages.
    """
    return parse_document(_read_text(path, label), label, path.parent)


def _read_text(path: Path, label: str) -> str:
    place = f"{label}: case file"
    allowed = "an existing TOML file"
    if _is_shipped(path):
        allowed += f", or {path.stem}, the shipped case"
    other = _OTHER_FILES.get(path.suffix.lower())
    if other is not None:
        raise CaseError(place, other, allowed)
    content = read_bytes(path, place, allowed, _LARGEST_FILE)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        found = f"byte {error.start} that is not UTF-8"
        raise CaseError("encoding", found, "text in UTF-8").in_file(label) from error


def _is_shipped(path: Path) -> bool:
    return path.stem in {one.stem for one in shipped_folder("cases").glob("*.toml")}


def parse_document(text: str, label: str, folder: Path = Path(), depth: int = 0) -> Document:
    """Return the tables of TOML text, laid over those of its base.

    Raises CaseError if the text or a base is no TOML, or a base leads back to itself.

    Parameters
    ----------
    text : str
        TOML; ``base`` at its top names a case file, or holds ``file`` and ``without``, the
        keys and tables of that file to be left out.
    label : str
        Name of the text in messages.
    folder : Path
        Folder that ``base`` is relative to.
    depth : int
        How many files are based on this one.
    """
    try:
        tables = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        if not isinstance(error, tomllib.TOMLDecodeError | RecursionError):
            reason = "an integer of thousands of digits"
        allowed = "TOML 1.0 with every key once"
        raise CaseError("syntax", f"{reason!r}", allowed).in_file(label) from error
    require_ordinary(tables, label)
    places = {key: (label, line) for key, line in _lines(text) if _stands(tables, key)}
    own = Document(label, tables, places)
    return own if BASE not in tables else _on_base(own, folder, depth)


def _on_base(own: Document, folder: Path, depth: int) -> Document:
    tables = dict(own.tables)
    raw = tables.pop(BASE)
    given = {"file": raw} if isinstance(raw, str) else raw
    allowed = "the name of a case file, or {file = ..., without = [key paths]}"
    if (
        not isinstance(given, dict)
        or not {"file"} <= set(given) <= {"file", "without"}
        or not isinstance(given["file"], str)
        or not isinstance(given.get("without", []), list)
        or not all(isinstance(path, str) for path in given.get("without", []))
    ):
        raise own.refuse(CaseError(BASE, shown(raw), allowed))
    if depth >= _MOST_BASES:
        found, allowed = f"{_MOST_BASES} bases on each other", "a base that ends in a whole case"
        raise own.refuse(CaseError(BASE, found, allowed))
    path = folder / given["file"]
    if not path.is_file():
        found = f"{shown(given['file'])}, which is no file"
        allowed = "a case file, relative to this one"
        if _is_shipped(path):
            allowed += f"; 'toothspace init {path.stem}' copies the shipped one"
        raise own.refuse(CaseError(BASE, found, allowed))
    below = parse_document(_read_text(path, str(path)), str(path), path.parent, depth + 1)
    found_tables = _in_folder(below.tables, path.parent)
    for left_out in given.get("without", []):
        try:
            found_tables = without(found_tables, left_out)
        except CaseError as error:
            refused = error.changed(lambda one: one._replace(key=f"{BASE}.without"))
            raise own.refuse(refused) from error
    remove_alternatives(found_tables, _leaves(tables))
    return Document(own.label, _laid_over(found_tables, tables), {**below.places, **own.places})


def _in_folder(value: Any, folder: Path) -> Any:
    """The same tables whose texts know the folder that a file path in them is relative to."""
    if isinstance(value, dict):
        return {key: _in_folder(item, folder) for key, item in value.items()}
    if isinstance(value, list):
        return [_in_folder(item, folder) for item in value]
    return BaseText(value, folder) if type(value) is str else value


def _laid_over(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Tables with those above in their place; a table of another kind replaces the whole one."""
    found = dict(below)
    for name, value in above.items():
        lower = found.get(name)
        if isinstance(value, dict) and isinstance(lower, dict):
            same_kind = all(value.get(tag, lower.get(tag)) == lower.get(tag) for tag in _TAGS)
            value = _laid_over(lower, value) if same_kind else value
        found[name] = value
    return found


def _leaves(tables: Mapping[str, Any], path: str = "") -> Iterator[str]:
    for name, value in tables.items():
        yield f"{path}{name}"
        if isinstance(value, dict):
            yield from _leaves(value, f"{path}{name}.")


def text_values(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Yield the key paths and texts of tables, in lists as well."""
    if isinstance(value, str):
        yield key, value
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from text_values(item, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list):
        for number, item in enumerate(value):
            yield from text_values(item, f"{key}[{number}]")


def _lines(text: str) -> Iterator[tuple[str, int]]:
    """Key paths and lines of what looks like an entry or the head of a table."""
    table, counts, fence = "", dict[str, int](), ""
    for number, line in enumerate(text.splitlines(), start=1):
        if fence:
            fence = "" if line.count(fence) % 2 else fence
            continue
        fence = next((quotes for quotes in ('"""', "'''") if line.count(quotes) % 2), "")
        if head := _HEADER.match(line):
            table = _path(head[2])
            if head[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                table = f"{table}[{counts[table]}]"
            yield table, number
        elif entry := _ENTRY.match(line):
            yield f"{table}.{_path(entry[1])}" if table else _path(entry[1]), number


def _path(names: str) -> str:
    return ".".join(name.strip().strip("\"'") for name in re.findall(_NAME, names))


def _stands(tables: Any, path: str) -> bool:
    """Whether a key path leads to something; a name with dots may stand for several."""
    if not path:
        return True
    if path.startswith("["):
        index, _, rest = path[1:].partition("]")
        inside = isinstance(tables, list) and int(index) < len(tables)
        return inside and _stands(tables[int(index)], rest.removeprefix("."))
    if not isinstance(tables, dict) or len(path) > _LONGEST_PATH:
        return False
    ends = (*(match.start() for match in _NAME_END.finditer(path)), len(path))
    return any(
        path[:end] in tables and _stands(tables[path[:end]], path[end:].removeprefix("."))
        for end in ends
    )


def require_ordinary(tables: Mapping[str, Any], label: str) -> None:
    """Refuse values that no case needs and that the stages behind could not take.

    Parameters
    ----------
    label : str
        Name of the case file in messages.

    Raises
    ------
    CaseError
        For tables too deep, integers beyond 64 bits, and text that is no Unicode text or holds
        the character NUL.
    """
    waiting: list[tuple[str, Any, int]] = [("", tables, 0)]
    while waiting:
        path, value, depth = waiting.pop()
        if depth > _DEEPEST:
            raise CaseError(
                f"{label}: {path[:_LONGEST_PLACE]}",
                f"tables deeper than {_DEEPEST}",
                f"at most {_DEEPEST}",
            )
        if isinstance(value, Mapping):
            for key, item in value.items():
                _require_text(str(key), label, path)
                waiting.append((f"{path}.{key}" if path else str(key), item, depth + 1))
        elif isinstance(value, (list, tuple)):
            waiting += [(f"{path}[{k}]", item, depth + 1) for k, item in enumerate(value)]
        elif isinstance(value, str):
            _require_text(value, label, path)
        elif isinstance(value, int) and abs(value) > _LARGEST_INTEGER:
            found = f"an integer of {value.bit_length()} bits"
            raise CaseError(f"{path}", found, "at most 64").in_file(label)


def _require_text(text: str, label: str, path: str) -> None:
    place = f"{label}: {path or 'key'}"
    if "\0" in text:
        raise CaseError(place, "the character NUL", "text without it")
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise CaseError(place, "bytes that are not UTF-8", "Unicode text")


def document_text(tables: Mapping[str, Any]) -> str:
    """Return tables as normalised TOML text, in the order of their keys."""
    lines: list[str] = []
    _append_table(lines, tables, ())
    return "\n".join(lines).strip() + "\n"


def _append_table(lines: list[str], table: Mapping[str, Any], path: tuple[str, ...]) -> None:
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    if path and (plain or not table):
        lines.extend(["", f"[{'.'.join(map(_key, path))}]"])
    lines.extend(f"{_key(key)} = {_value(value)}" for key, value in plain.items())
    for key, value in table.items():
        if isinstance(value, Mapping):
            _append_table(lines, value, (*path, key))


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _text(key)


def _text(text: str) -> str:
    # JSON escapes are TOML escapes, except for DEL which TOML wants escaped
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Points):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, Mapping):
        pairs = ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items())
        return f"{{{pairs}}}"
    return str(value)


def split_override(override: str) -> tuple[str, Any]:
    """Return key path and value of ``key.path=value``.

    The value is TOML; anything else is taken as text, so that ``machine.gears.module=3 mm``
    needs no inner quotes.

    Raises CaseError if it has no key or no value.
    """
    path, equals, value = (part.strip() for part in str(override).partition("="))
    if not equals or not value or not _PATH.fullmatch(path):
        raise CaseError("--set", repr(override), "key.path=value")
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return path, value
    return path, parsed["value"] if list(parsed) == ["value"] else value


def with_values(tables: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables with values of key paths replaced, in their order.

    Raises CaseError if a path is no key path, or leads through a value.

    Parameters
    ----------
    tables : mapping
        Tables of a case; not changed.
    values : mapping of key path to value
        Values as they would stand in a case file; None takes the key out.
    """
    changed: Any = dict(tables)
    for path, value in values.items():
        if not isinstance(path, str) or not _PATH.fullmatch(path):
            allowed = "a key path such as fluid.name"
            raise CaseError(str(path), "no key path", allowed)
        changed = without(changed, path) if value is None else _with(changed, path, value)
        remove_alternatives(changed, [path] if value is not None else [])
    return dict(changed)


def _with(table: Any, path: str, value: Any, above: str = "") -> Any:
    if is_table(table):
        found = f"{joined(above, path)} below an object"
        raise CaseError(joined(above, path), found, "a path through tables")
    if not isinstance(table, Mapping):
        found = f"{joined(above, path)} below a value"
        allowed = f"a path through tables, but {above} is a value"
        raise CaseError(joined(above, path), found, allowed)
    name, _, rest = path.partition(".")
    inner = _with(table.get(name, {}), rest, value, joined(above, name)) if rest else value
    return {**table, name: inner}


def without(tables: Mapping[str, Any], path: str) -> dict[str, Any]:
    """Return tables without what stands at a key path, if anything does."""
    name, _, rest = path.partition(".")
    found = dict(tables)
    if not rest:
        found.pop(name, None)
    elif isinstance(found.get(name), Mapping):
        found[name] = without(found[name], rest)
    return found


def remove_alternatives(tables: dict[str, Any], given: Iterable[str]) -> None:
    """Take out of tables what excludes a given key."""
    names = set(given)
    for group in ALTERNATIVES:
        if names & set(group):
            for path in set(group) - names:
                changed = without(tables, path)
                tables.clear()
                tables.update(changed)
