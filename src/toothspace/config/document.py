"""Text of a case file to tables, and tables back to normalised text."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from toothspace.core.errors import CaseError
from toothspace.core.files import read_bytes

_LARGEST_FILE = 5_000_000
_DEEPEST = 20
_LARGEST_INTEGER = 2**63 - 1
_LONGEST_PLACE = 80
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def read_document(path: Path, label: str) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Parameters
    ----------
    path : Path
        File.
    label : str
        Its name in messages.

    Raises
    ------
    CaseError
        If it is missing, no text in UTF-8 or no TOML.
    """
    return parse_document(_read_text(path, label), label)


def _read_text(path: Path, label: str) -> str:
    place = f"{label}: case file"
    content = read_bytes(path, place, "an existing TOML file", _LARGEST_FILE)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        found = f"byte {error.start} that is not UTF-8"
        raise CaseError(f"{label}: encoding: found {found}, allowed text in UTF-8") from error


def parse_document(text: str, label: str) -> dict[str, Any]:
    """Return the tables of TOML text.

    Raises
    ------
    CaseError
        If the text is no TOML.
    """
    try:
        tables = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        # digits of an integer without end are a ValueError
        reason = " ".join(str(error).split()) or type(error).__name__
        allowed = "TOML 1.0 with every key once"
        raise CaseError(f"{label}: syntax: found {reason!r}, allowed {allowed}") from error
    require_ordinary(tables, label)
    return tables


def require_ordinary(tables: Mapping[str, Any], label: str) -> None:
    """Refuse values that no case needs and that the stages behind could not take.

    Parameters
    ----------
    tables : mapping
        Tables of a case.
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
                f"{label}: {path[:_LONGEST_PLACE]}: found tables deeper than {_DEEPEST}, "
                f"allowed at most {_DEEPEST}"
            )
        if isinstance(value, Mapping):
            for key, item in value.items():
                _require_text(key, label, path)
                waiting.append((f"{path}.{key}" if path else key, item, depth + 1))
        elif isinstance(value, list):
            waiting += [(f"{path}[{k}]", item, depth + 1) for k, item in enumerate(value)]
        elif isinstance(value, str):
            _require_text(value, label, path)
        elif isinstance(value, int) and abs(value) > _LARGEST_INTEGER:
            found = f"an integer of {value.bit_length()} bits"
            raise CaseError(f"{label}: {path}: found {found}, allowed at most 64")


def _require_text(text: str, label: str, path: str) -> None:
    place = f"{label}: {path or 'key'}"
    if "\0" in text:
        raise CaseError(f"{place}: found the character NUL, allowed text without it")
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise CaseError(f"{place}: found bytes that are not UTF-8, allowed Unicode text")


def document_text(tables: Mapping[str, Any]) -> str:
    """Return tables as normalised TOML text, in the order of their keys."""
    lines: list[str] = []
    _append_table(lines, tables, ())
    return "\n".join(lines).strip() + "\n"


def _append_table(lines: list[str], table: Mapping[str, Any], path: tuple[str, ...]) -> None:
    plain = {key: value for key, value in table.items() if not isinstance(value, dict)}
    if path and (plain or not table):
        lines.extend(["", f"[{'.'.join(map(_key, path))}]"])
    lines.extend(f"{_key(key)} = {_value(value)}" for key, value in plain.items())
    for key, value in table.items():
        if isinstance(value, dict):
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
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        pairs = ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items())
        return f"{{{pairs}}}"
    return str(value)
