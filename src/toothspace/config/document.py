"""Text of a case file to tables, and tables back to normalised text."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from toothspace.core.errors import CaseError

_LARGEST_FILE = 5_000_000
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
    allowed = "an existing TOML file"
    if path.is_dir():
        raise CaseError(f"{label}: case file: found a directory, allowed {allowed}")
    try:
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no such file"
        raise CaseError(f"{label}: case file: found {reason!r}, allowed {allowed}") from error
    if len(content) > _LARGEST_FILE:
        found = f"{len(content)} bytes"
        raise CaseError(f"{label}: case file: found {found}, allowed at most {_LARGEST_FILE}")
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
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        allowed = "TOML 1.0 with every key once"
        raise CaseError(f"{label}: syntax: found {reason!r}, allowed {allowed}") from error


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
