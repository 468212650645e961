"""Values of key paths in tables: overrides of the command line, and values of Python."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from toothspace.core.errors import CaseError, joined
from toothspace.core.keys import is_table

CONDITIONS = ("operating_point", "circuit", "bearing", "film")
"""Tables of which a case has exactly one."""

ALTERNATIVES = (
    ("run.until", "run.revolutions"),
    ("machine.gears.normal_backlash", "machine.gears.center_distance"),
    ("fluid.name", "fluid.table"),
    ("bearing.eccentricity", "bearing.load"),
    CONDITIONS,
)
"""Keys that exclude each other: one that is given takes the others out."""

_PATH = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+){0,19}")


def split_override(override: str) -> tuple[str, Any]:
    """Return key path and value of ``key.path=value``.

    The value is TOML; anything else is taken as text, so that ``machine.gears.module=3 mm``
    needs no inner quotes.

    Raises
    ------
    CaseError
        If it has no key or no value.
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

    Parameters
    ----------
    tables : mapping
        Tables of a case; not changed.
    values : mapping of key path to value
        Values as they would stand in a case file; None takes the key out.

    Raises
    ------
    CaseError
        If a path is no key path, or leads through a value.
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
