"""Overrides of the command line, ``key.path=value``."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from copy import deepcopy
from typing import Any

from toothspace.config.document import require_ordinary
from toothspace.core.errors import CaseError

ALTERNATIVES = (
    ("run.until", "run.revolutions"),
    ("machine.gears.normal_backlash", "machine.gears.center_distance"),
    ("fluid.name", "fluid.table"),
    ("bearing.eccentricity", "bearing.load"),
)
"""Keys that exclude each other: an override of one takes the other out."""

_PATH = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+){0,19}")


def apply_overrides(tables: dict[str, Any], overrides: Iterable[str], label: str) -> dict[str, Any]:
    """Return tables with overrides applied, in their order.

    Parameters
    ----------
    tables : dict
        Tables of a case file; not changed.
    overrides : iterable of str
        ``key.path=value``; the value is TOML, anything else is taken as text, so that
        ``machine.gears.module=3 mm`` needs no inner quotes.
    label : str
        Name of the case file in messages.

    Raises
    ------
    CaseError
        If an override has no key, no value, or leads through a value.
    """
    changed = deepcopy(tables)
    for override in overrides:
        path, value = _split(override, label)
        require_ordinary({"--set": value}, label)
        _insert(changed, path, value, label)
        _remove_alternative(changed, ".".join(path))
    return changed


def apply_values(tables: dict[str, Any], values: Mapping[str, Any], label: str) -> dict[str, Any]:
    """Return tables with values of key paths replaced.

    Parameters
    ----------
    tables : dict
        Tables of a case file; not changed.
    values : mapping of key path to value
        Values as they would stand in a case file.
    label : str
        Name of the case file in messages.

    Raises
    ------
    CaseError
        If a path is no key path, or leads through a value.
    """
    changed = deepcopy(tables)
    for path, value in values.items():
        if not _PATH.fullmatch(path):
            raise CaseError(
                f"{label}: study: found {path!r}, allowed a key path such as fluid.name"
            )
        _insert(changed, path.split("."), value, label)
        _remove_alternative(changed, path)
    return changed


def _remove_alternative(tables: dict[str, Any], given: str) -> None:
    for pair in ALTERNATIVES:
        if given in pair:
            *folders, name = pair[1 - pair.index(given)].split(".")
            table = tables
            for folder in folders:
                table = table.get(folder, {})
            table.pop(name, None)


def _split(override: str, label: str) -> tuple[list[str], Any]:
    path, equals, value = (part.strip() for part in override.partition("="))
    if not equals or not value or not _PATH.fullmatch(path):
        raise CaseError(f"{label}: --set: found {override!r}, allowed key.path=value")
    return path.split("."), _value(value)


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if list(parsed) == ["value"] else text


def _insert(tables: dict[str, Any], path: list[str], value: Any, label: str) -> None:
    table = tables
    for depth, name in enumerate(path[:-1], start=1):
        table = table.setdefault(name, {})
        if not isinstance(table, dict):
            found = f"{'.'.join(path)} below a value"
            allowed = f"a path through tables, but {'.'.join(path[:depth])} is a value"
            raise CaseError(f"{label}: {'.'.join(path)}: found {found}, allowed {allowed}")
    table[path[-1]] = value
