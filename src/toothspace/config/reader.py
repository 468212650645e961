"""Tables of a case file to frozen dataclasses, along their declared keys."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn, final

from toothspace.config.allowed import allowed_text
from toothspace.core import keys
from toothspace.core.errors import CaseError
from toothspace.core.units import format_si, parse_quantity, to_si

_LONGEST_FOUND = 80


def shown(raw: Any) -> str:
    """Return a value as a short text on one line."""
    text = f"{str(raw).lower()} (true or false)" if isinstance(raw, bool) else repr(raw)
    return text if len(text) <= _LONGEST_FOUND else f"{text[:_LONGEST_FOUND]}..."


def joined(path: str, key: str) -> str:
    """Return the path of a key inside a table."""
    return f"{path}.{key}" if path and key else path or key


@final
@dataclass
class Reader:
    """Reads values and names file and key in every message.

    Parameters
    ----------
    label : str
        Name of the case file in messages.
    folder : Path
        Folder that file paths are relative to.
    """

    label: str
    folder: Path
    files: list[Path] = field(default_factory=list)

    def fail(self, path: str, found: str, allowed: str) -> NoReturn:
        """Raise the one-line :class:`CaseError` of a key."""
        raise CaseError(f"{self.label}: {path}: found {found}, allowed {allowed}")

    def read(self, key: keys.Key, raw: Any, path: str) -> Any:
        """Read one value.

        Raises
        ------
        CaseError
            With file, key, what was found and what is allowed.
        """
        return _READERS[type(key)](self, key, raw, path)

    def table(self, spec: type, raw: Any, path: str) -> Any:
        """Read a sub-table to the dataclass ``spec``."""
        declared = keys.keys_of(spec)
        if not isinstance(raw, dict):
            self.fail(path, shown(raw), f"a table with the keys {', '.join(declared)}")
        self.refuse_unknown(raw, list(declared), path)
        values = {}
        for name, (key, dataclass_field) in declared.items():
            if name in raw:
                values[name] = self.read(key, raw[name], joined(path, name))
            elif keys.is_required(dataclass_field):
                self.fail(joined(path, name), "nothing", allowed_text(key))
        return self.build(spec, values, path)

    def build(self, spec: type, values: Mapping[str, Any], path: str) -> Any:
        """Make the dataclass and name the file where one of its own rules is broken."""
        try:
            return spec(**values)
        except keys.KeyRuleError as error:
            self.fail(joined(path, error.key), error.found, error.allowed)

    def refuse_unknown(self, raw: Mapping[str, Any], known: list[str], path: str) -> None:
        """Refuse keys that nobody reads, with the nearest known one."""
        for name in raw:
            if name not in known:
                near = difflib.get_close_matches(name, known, n=1)
                hint = f"{near[0]} (did you mean that?)" if near else ", ".join(known) or "no keys"
                self.fail(joined(path, name), "an unknown key", hint)


def _quantity(reader: Reader, key: keys.Quantity, raw: Any, path: str) -> float:
    allowed = allowed_text(key)
    if not isinstance(raw, str):
        without = " without a unit" if isinstance(raw, (int, float)) else ""
        reader.fail(path, f"{shown(raw)}{without}", allowed)
    try:
        value = parse_quantity(raw, key.unit, allowed)
    except CaseError as error:
        raise CaseError(f"{reader.label}: {path}: {error}") from error
    if not _inside(value, key, lambda bound: to_si(bound, key.unit)):
        reader.fail(path, shown(raw), allowed)
    return value


def _number(reader: Reader, key: keys.Number, raw: Any, path: str) -> float:
    if isinstance(raw, bool) or not isinstance(raw, (int, float)):
        reader.fail(path, shown(raw), allowed_text(key))
    if abs(raw) > 1e300 or not _inside(float(raw), key, float):
        reader.fail(path, shown(raw), allowed_text(key))
    return float(raw)


def _inside(
    value: float, key: keys.Quantity | keys.Number, bound: Callable[[float], float]
) -> bool:
    # bounds in display units are compared with a rounding allowance
    if not math.isfinite(value):
        return False
    slack = 1e-12 * abs(value)
    return not (
        (key.above is not None and value <= bound(key.above))
        or (key.low is not None and value < bound(key.low) - slack)
        or (key.high is not None and value > bound(key.high) + slack)
    )


def _integer(reader: Reader, key: keys.Integer, raw: Any, path: str) -> int:
    if isinstance(raw, bool) or not isinstance(raw, int) or not key.low <= raw <= key.high:
        reader.fail(path, shown(raw), allowed_text(key))
    return raw


def _choice(reader: Reader, key: keys.Choice, raw: Any, path: str) -> str:
    raw = key.present(raw, f"{reader.label}: {path}")
    if not isinstance(raw, str) or raw not in key.options:
        reader.fail(path, shown(raw), allowed_text(key))
    return raw


def _text(reader: Reader, key: keys.Text, raw: Any, path: str) -> str:
    if not isinstance(raw, str) or not raw.strip():
        reader.fail(path, shown(raw), allowed_text(key))
    return raw


def _flag(reader: Reader, key: keys.Flag, raw: Any, path: str) -> bool:
    if not isinstance(raw, bool):
        reader.fail(path, shown(raw), allowed_text(key))
    return raw


def _file(reader: Reader, key: keys.FilePath, raw: Any, path: str) -> Path:
    allowed = allowed_text(key)
    if not isinstance(raw, str) or not raw.strip() or "\0" in raw:
        reader.fail(path, shown(raw), allowed)
    file = reader.folder / raw
    if file.suffix.lower() not in key.suffixes:
        reader.fail(path, f"{shown(raw)} with the ending {shown(file.suffix)}", allowed)
    wrong = _fault_of(file)
    if wrong:
        reader.fail(path, f"{shown(raw)}, which {wrong}", allowed)
    reader.files.append(file)
    return file


def _fault_of(file: Path) -> str:
    """What is wrong with a file to be read; empty if nothing is."""
    try:
        if file.is_dir():
            return "is a directory"
        if not file.is_file():
            return "is a device or pipe" if file.exists() else "does not exist"
        return "" if file.stat().st_size else "is empty"
    except OSError as error:
        return f"cannot be read ({error.strerror})"


def _items(reader: Reader, key: keys.Items, raw: Any, path: str) -> tuple[Any, ...]:
    if not isinstance(raw, list) or not key.low <= len(raw) <= key.high:
        reader.fail(path, shown(raw), allowed_text(key))
    return tuple(reader.read(key.item, item, f"{path}[{k}]") for k, item in enumerate(raw))


def _row(reader: Reader, key: keys.Row, raw: Any, path: str) -> tuple[Any, ...]:
    if not isinstance(raw, list) or len(raw) != len(key.items):
        reader.fail(path, shown(raw), allowed_text(key))
    pairs = enumerate(zip(key.items, raw, strict=True))
    return tuple(reader.read(item, value, f"{path}[{k}]") for k, (item, value) in pairs)


def _grid(reader: Reader, key: keys.Grid, raw: Any, path: str) -> tuple[float, ...]:
    if not isinstance(raw, dict):
        values: tuple[float, ...] = reader.read(keys.Items(item=key.item), raw, path)
        return values
    reader.refuse_unknown(raw, ["from", "to", "count"], path)
    for name in ("from", "to", "count"):
        if name not in raw:
            reader.fail(joined(path, name), "nothing", allowed_text(key))
    first = reader.read(key.item, raw["from"], joined(path, "from"))
    last = reader.read(key.item, raw["to"], joined(path, "to"))
    count = _integer(reader, keys.Integer(low=2, high=10000), raw["count"], joined(path, "count"))
    return tuple(first + (last - first) * k / (count - 1) for k in range(count))


def _table(reader: Reader, key: keys.Table, raw: Any, path: str) -> Any:
    return reader.table(key.spec, raw, path)


def _variant(reader: Reader, key: keys.Variant, raw: Any, path: str) -> Any:
    if not isinstance(raw, dict):
        reader.fail(path, shown(raw), allowed_text(key))
    tag = joined(path, key.tag)
    options = " or ".join(f"'{name}'" for name in key.variants)
    name = raw.get(key.tag)
    if name is None:
        reader.fail(tag, "nothing", options)
    if not isinstance(name, str) or name not in key.variants:
        reader.fail(tag, shown(name), options)
    rest = {other: value for other, value in raw.items() if other != key.tag}
    return reader.table(key.variants[name], rest, path)


def _named(reader: Reader, key: keys.Named, raw: Any, path: str) -> dict[str, Any]:
    if not isinstance(raw, dict):
        reader.fail(path, shown(raw), allowed_text(key))
    return {name: reader.read(key.item, value, joined(path, name)) for name, value in raw.items()}


def _free(_reader: Reader, _key: keys.Free, raw: Any, _path: str) -> Any:
    return raw


_READERS: Mapping[type, Callable[[Reader, Any, Any, str], Any]] = {
    keys.Quantity: _quantity,
    keys.Number: _number,
    keys.Integer: _integer,
    keys.Choice: _choice,
    keys.Text: _text,
    keys.Flag: _flag,
    keys.FilePath: _file,
    keys.Items: _items,
    keys.Row: _row,
    keys.Grid: _grid,
    keys.Table: _table,
    keys.Variant: _variant,
    keys.Named: _named,
    keys.Free: _free,
}


def pressure_text(value: float) -> str:
    """Return a pressure as text in bar."""
    return format_si(value, "bar")
