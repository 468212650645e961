"""Declaration of the keys of a case on the fields of frozen dataclasses.

One field states unit, allowed range and meaning once; reading, checking, writing, messages, the
JSON Schema and the documentation follow from it. Every construction of a :class:`KeyTable`
checks its values: a number behind a key with a unit is in SI units, a text or a
:class:`toothspace.core.units.Quantity` carries its unit.

>>> from dataclasses import dataclass, is_dataclass
>>> @dataclass(frozen=True, kw_only=True)
... class Casing(KeyTable):
...     radial_clearance: float = quantity("um", "Bore radius minus tip radius.", above=0, high=500)
>>> Casing(radial_clearance="20 um").radial_clearance
2e-05
"""

from __future__ import annotations

import difflib
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass, replace
from numbers import Integral, Real
from pathlib import Path
from typing import Any, NoReturn, final

from toothspace.core.errors import CaseError, Problem, joined
from toothspace.core.frozen import Columns, FrozenDict, Points
from toothspace.core.units import (
    as_text,
    dimension_name,
    exact_text,
    format_si,
    parse_quantity,
    to_si,
)

_METADATA = "toothspace.key"
_MOST_UNKNOWN = 20
_LONGEST_FOUND = 80
_QUANTITY_PATTERN = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(\s*|\s+1/)[A-Za-zµμ°].*$"

Schema = dict[str, Any]


def require(owner: object, reason: str, *names: str) -> None:
    """Refuse a missing key that another choice makes compulsory."""
    problems = Problems()
    for name in names:
        if getattr(owner, name) is None:
            wanted = keys_of(type(owner))[name][0].allowed()
            problems.append(Problem(name, "nothing", f"{wanted}; this key is compulsory {reason}"))
    problems.settle()


def forbid(owner: object, reason: str, *names: str) -> None:
    """Refuse a key that contradicts another one."""
    for name in names:
        if getattr(owner, name) is not None:
            raise CaseError(name, "a value", f"leave this key out {reason}")


def instead_of(owner: object, name: str, *others: str) -> None:
    """Ask for other keys where one is not given, and refuse them beside it."""
    if getattr(owner, name) is None:
        require(owner, f"unless {name} is given", *others)
    else:
        forbid(owner, f"because {name} is given", *others)


def shown(raw: Any) -> str:
    """Return a value as a short text on one line."""
    text = f"{str(raw).lower()} (true or false)" if isinstance(raw, bool) else repr(raw)
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST_FOUND else f"{text[:_LONGEST_FOUND]}..."


class Problems(list[Problem]):
    """Problems of several keys, raised together once all of them are read."""

    def of(self, path: str, read: Callable[[Any, Source], Any], raw: Any, source: Source) -> Any:
        """Return what ``read`` returns for a value; keep its problems under a path."""
        try:
            return read(raw, replace(source, path=joined(source.path, path)))
        except CaseError as error:
            self.extend(p._replace(key=joined(path, p.key)) for p in error.problems)

    def settle(self) -> None:
        """Raise what was kept, if anything was.

        Raises
        ------
        CaseError
            With all problems.
        """
        if self:
            raise CaseError.of(self)


@final
@dataclass(frozen=True)
class Source:
    """Where values come from."""

    folder: Path = Path()
    """Folder that file paths are relative to."""
    in_si: bool = False
    """Whether a bare number behind a key with a unit counts as SI (Python objects) or is refused
    (case files).
    """
    path: str = ""
    """Key path of the value that is read."""


_PYTHON = Source(in_si=True)

FileText = Callable[[Path], str]
"""How a file is written: its path as text, or a text that stands for its content."""


@dataclass(frozen=True, kw_only=True)
class Key:
    """What stands behind one key; ``doc`` is its meaning in one sentence."""

    doc: str = ""

    def allowed(self) -> str:
        """Return in words what may stand behind the key, with its range."""
        return "any value"

    def read(self, raw: Any, source: Source) -> Any:
        """Return a value in SI units.

        Raises
        ------
        CaseError
            With the key relative to this one.
        """
        raise NotImplementedError

    def written(self, value: Any, file_text: FileText) -> Any:
        """Return a value as it would stand in a case file; the inverse of :meth:`read`."""
        return value

    def schema(self) -> Schema:
        """Return the JSON Schema of the value."""
        return {}

    def holds(self, value: Any) -> bool:
        """Tell whether an object is a value of the key already."""
        return False

    def fail(self, found: str) -> NoReturn:
        """Refuse what was found."""
        raise CaseError("", found, self.allowed())


@dataclass(frozen=True, kw_only=True)
class Bounded:
    """Number between bounds, which are in the display unit; ``above`` is exclusive."""

    low: float | None = None
    high: float | None = None
    above: float | None = None

    def inside(self, value: float, bound: Callable[[float], float] = float) -> bool:
        """Tell whether a value lies between the bounds, converted to its unit."""
        if not math.isfinite(value):
            return False
        # bounds in display units are compared with a rounding allowance
        slack = 1e-12 * abs(value)
        return not (
            (self.above is not None and value <= bound(self.above))
            or (self.low is not None and value < bound(self.low) - slack)
            or (self.high is not None and value > bound(self.high) + slack)
        )

    def limits(self, unit: str = "") -> str:
        """Return the bounds in words, to be put behind what is allowed."""
        parts = []
        if self.above is not None:
            parts.append(f"above {self.above:g}{unit}")
        if self.low is not None:
            parts.append(f"from {self.low:g}{unit}")
        if self.high is not None:
            parts.append(f"{'to' if self.low is not None else 'at most'} {self.high:g}{unit}")
        text = " ".join(parts) if self.low is not None else ", ".join(parts)
        return f", {text}" if text else ""

    def bounds(self) -> Schema:
        """Return the bounds as JSON Schema names them."""
        names = "minimum", "exclusiveMinimum", "maximum"
        pairs = zip(names, (self.low, self.above, self.high), strict=True)
        return {name: bound for name, bound in pairs if bound is not None}


def _is_number(raw: Any) -> bool:
    return isinstance(raw, Real) and not isinstance(raw, bool)


@final
@dataclass(frozen=True, kw_only=True)
class QuantityKey(Bounded, Key):
    """Text with a unit."""

    unit: str

    def allowed(self) -> str:
        name = dimension_name(self.unit)
        if self.doc.startswith("Absolute") and name == "a pressure":
            name = "an absolute pressure"
        example = f"{name} with its unit in quotes, such as '1 {self.unit}'"
        return f"{example}{self.limits(f' {self.unit}')}"

    def read(self, raw: Any, source: Source) -> float:
        given = as_text(raw)
        if source.in_si and _is_number(given):
            value, found = float(given), format_si(float(given), self.unit)
        else:
            if not isinstance(given, str):
                self.fail(f"{shown(given)}{' without a unit' if _is_number(given) else ''}")
            try:
                value, found = parse_quantity(given, self.unit, self.allowed()), shown(given)
            except CaseError as error:
                self.fail(error.problems[0].found)
        if not self.inside(value, lambda bound: to_si(bound, self.unit)):
            self.fail(found)
        return value

    def written(self, value: float, file_text: FileText) -> str:
        return exact_text(value, self.unit)

    def schema(self) -> Schema:
        text = {"type": "string", "pattern": _QUANTITY_PATTERN, "x-unit": self.unit}
        return {**text, **{f"x-{name}": bound for name, bound in self.bounds().items()}}


@final
@dataclass(frozen=True, kw_only=True)
class Number(Bounded, Key):
    """Dimensionless number."""

    def allowed(self) -> str:
        return f"a number without unit{self.limits()}"

    def read(self, raw: Any, source: Source) -> float:
        if not _is_number(raw) or abs(raw) > 1e300 or not self.inside(float(raw)):
            self.fail(shown(raw))
        return float(raw)

    def schema(self) -> Schema:
        return {"type": "number", **self.bounds()}


@final
@dataclass(frozen=True, kw_only=True)
class Integer(Key):
    """Whole number."""

    low: int
    high: int

    def allowed(self) -> str:
        return f"a whole number, from {self.low} to {self.high}"

    def read(self, raw: Any, source: Source) -> int:
        whole = isinstance(raw, Integral) and not isinstance(raw, bool)
        if not whole or not self.low <= int(raw) <= self.high:
            self.fail(shown(raw))
        return int(raw)

    def schema(self) -> Schema:
        return {"type": "integer", "minimum": self.low, "maximum": self.high}


@final
@dataclass(frozen=True, kw_only=True)
class Choice(Key):
    """One of a few words; ``former`` are old spellings, accepted for one version."""

    options: tuple[str, ...]
    former: Mapping[str, str] = field(default_factory=dict)

    def allowed(self) -> str:
        return " or ".join(f"'{option}'" for option in self.options)

    def read(self, raw: Any, source: Source) -> str:
        if isinstance(raw, str) and raw in self.former:
            sys.stderr.write(
                f"{source.path}: {raw!r} is now spelled {self.former[raw]!r}; "
                "the next version refuses the old spelling.\n"
            )
            return self.former[raw]
        if not isinstance(raw, str) or raw not in self.options:
            self.fail(shown(raw))
        return str(raw)

    def schema(self) -> Schema:
        return {"type": "string", "enum": [*self.options, *self.former]}


@final
@dataclass(frozen=True, kw_only=True)
class Text(Key):
    """Any text that is not empty."""

    def allowed(self) -> str:
        return "a text that is not empty"

    def read(self, raw: Any, source: Source) -> str:
        if not isinstance(raw, str) or not raw.strip():
            self.fail(shown(raw))
        return str(raw)

    def schema(self) -> Schema:
        return {"type": "string", "minLength": 1}


@final
@dataclass(frozen=True, kw_only=True)
class Flag(Key):
    """True or false."""

    def allowed(self) -> str:
        return "true or false"

    def read(self, raw: Any, source: Source) -> bool:
        if not isinstance(raw, bool):
            self.fail(shown(raw))
        return raw

    def schema(self) -> Schema:
        return {"type": "boolean"}


@final
@dataclass(frozen=True, kw_only=True)
class FilePath(Key):
    """A file next to the case file that must exist; ``suffixes`` in lower case.

    With ``points`` the points of a closed curve may stand in its place, with ``columns`` a table
    of headings and values.
    """

    suffixes: tuple[str, ...]
    points: bool = False
    columns: bool = False

    def allowed(self) -> str:
        other = ", or a list of at least three points [x, y]" if self.points else ""
        other += ", or a table of its headings with lists of numbers" if self.columns else ""
        endings = ", ".join(self.suffixes)
        return f"a file that exists ({endings}), relative to the case file{other}"

    def read(self, raw: Any, source: Source) -> Path | Points | Columns:
        if isinstance(raw, (Points, Columns)):
            return raw
        if not isinstance(raw, (str, Path)) and (self.points or self.columns):
            try:
                return Points(raw) if self.points else Columns(raw)
            except (AttributeError, TypeError, ValueError):
                self.fail(shown(raw))
        if not isinstance(raw, (str, Path)) or not str(raw).strip() or "\0" in str(raw):
            self.fail(shown(raw))
        name = shown(str(raw))
        try:
            file = (getattr(raw, "folder", source.folder) / Path(raw)).resolve()
        except (OSError, RuntimeError):
            self.fail(f"{name}, whose links lead back to themselves")
        if file.suffix.lower() not in self.suffixes:
            self.fail(f"{name} with the ending {shown(file.suffix)}")
        wrong = ""
        try:
            if file.is_dir():
                wrong = "is a directory"
            elif not file.is_file():
                wrong = "is a device or pipe" if file.exists() else "does not exist"
            elif not file.stat().st_size:
                wrong = "is empty"
        except OSError as error:
            wrong = f"cannot be read ({error.strerror})"
        if wrong:
            self.fail(f"{name}, which {wrong}")
        return file

    def written(self, value: Path | Points | Columns, file_text: FileText) -> Any:
        if isinstance(value, Columns):
            return {name: list(values) for name, values in value.columns.items()}
        return value.tolist() if isinstance(value, Points) else file_text(value)

    def schema(self) -> Schema:
        names = [suffix.lstrip(".") for suffix in self.suffixes]
        endings = "|".join([*names, *(name.upper() for name in names)])
        file = {"type": "string", "pattern": rf"\.({endings})$"}
        if self.columns:
            numbers = {"type": "array", "items": {"type": "number"}}
            return {"anyOf": [file, {"type": "object", "additionalProperties": numbers}]}
        if not self.points:
            return file
        pair = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
        return {"anyOf": [file, {"type": "array", "items": pair, "minItems": 3}]}


def _sequence(raw: Any) -> list[Any] | None:
    """Items of a list, tuple or array; None for anything else."""
    if hasattr(raw, "tolist"):
        raw = raw.tolist()
    return list(raw) if isinstance(raw, (list, tuple)) else None


def _each(pairs: Iterable[tuple[Key, Any]], source: Source) -> tuple[Any, ...]:
    problems = Problems()
    values = [problems.of(f"[{k}]", key.read, item, source) for k, (key, item) in enumerate(pairs)]
    problems.settle()
    return tuple(values)


@final
@dataclass(frozen=True, kw_only=True)
class Items(Key):
    """List of equal items."""

    item: Key
    low: int = 1
    high: int = 10000

    def allowed(self) -> str:
        return f"a list of {self.low} to {self.high} items, each {self.item.allowed()}"

    def read(self, raw: Any, source: Source) -> tuple[Any, ...]:
        items = _sequence(raw)
        if items is None or not self.low <= len(items) <= self.high:
            self.fail(shown(raw))
        return _each(((self.item, item) for item in items), source)

    def written(self, value: tuple[Any, ...], file_text: FileText) -> list[Any]:
        return [self.item.written(item, file_text) for item in value]

    def schema(self) -> Schema:
        size = {"minItems": self.low, "maxItems": self.high}
        return {"type": "array", "items": self.item.schema(), **size}


@final
@dataclass(frozen=True, kw_only=True)
class Row(Key):
    """List of a fixed number of items, each of its own kind."""

    items: tuple[Key, ...]

    def allowed(self) -> str:
        return f"a list of {len(self.items)} items: {'; '.join(k.allowed() for k in self.items)}"

    def read(self, raw: Any, source: Source) -> tuple[Any, ...]:
        items = _sequence(raw)
        if items is None or len(items) != len(self.items):
            self.fail(shown(raw))
        return _each(zip(self.items, items, strict=True), source)

    def written(self, value: tuple[Any, ...], file_text: FileText) -> list[Any]:
        return [k.written(item, file_text) for k, item in zip(self.items, value, strict=True)]

    def schema(self) -> Schema:
        items = [item.schema() for item in self.items]
        size = len(items)
        return {"type": "array", "prefixItems": items, "minItems": size, "maxItems": size}


@final
@dataclass(frozen=True, kw_only=True)
class Grid(Key):
    """List of values, or ``{from, to, count}``, read to a tuple of values."""

    item: QuantityKey | Number

    def allowed(self) -> str:
        return f"a list or {{from, to, count}} of: {self.item.allowed()}"

    def read(self, raw: Any, source: Source) -> tuple[float, ...]:
        if not isinstance(raw, Mapping):
            return Items(item=self.item).read(raw, source)
        parts = {"from": self.item, "to": self.item, "count": Integer(low=2, high=10000)}
        problems = Problems()
        _keep_unknown(problems, raw, parts)
        problems.extend(Problem(n, "nothing", self.allowed()) for n in parts if n not in raw)
        values = {
            name: problems.of(name, key.read, raw[name], source)
            for name, key in parts.items()
            if name in raw
        }
        problems.settle()
        first, last, count = values["from"], values["to"], values["count"]
        return tuple(first + (last - first) * k / (count - 1) for k in range(count))

    def written(self, value: tuple[float, ...], file_text: FileText) -> list[Any]:
        return [self.item.written(item, file_text) for item in value]

    def schema(self) -> Schema:
        item = self.item.schema()
        span = {
            "type": "object",
            "properties": {"from": item, "to": item, "count": {"type": "integer", "minimum": 2}},
            "required": ["from", "to", "count"],
            "additionalProperties": False,
        }
        return {"anyOf": [{"type": "array", "items": item, "minItems": 1}, span]}


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return the known name nearest to one that is not known, or all; for messages."""
    names = list(known)
    near = difflib.get_close_matches(name, names, n=1)
    return f"{near[0]} (did you mean that?)" if near else ", ".join(names)


def _keep_unknown(problems: Problems, raw: Mapping[str, Any], known: Iterable[str]) -> None:
    """Record unknown keys, with the nearest known one."""
    names = dict.fromkeys(known)
    unknown = [name for name in raw if name not in names]
    for name in unknown[:_MOST_UNKNOWN]:
        hint = suggestion(str(name), names) or "no keys"
        shown_name = str(name) if str(name).isprintable() else repr(name)
        problems.append(Problem(shown_name, "an unknown key", hint))
    if len(unknown) > _MOST_UNKNOWN:
        found = f"{len(unknown) - _MOST_UNKNOWN} more unknown keys"
        problems.append(Problem("", found, ", ".join(names) or "no keys"))


@final
@dataclass(frozen=True, kw_only=True)
class Table(Key):
    """Sub-table read to a frozen dataclass."""

    spec: type

    def allowed(self) -> str:
        return f"a table with the keys {', '.join(keys_of(self.spec))}"

    def read(self, raw: Any, source: Source) -> Any:
        if isinstance(raw, KeyTable):
            return raw if isinstance(raw, self.spec) else self.fail(shown(raw))
        # an object of a plain class was not checked when it was made
        given = _read_again(raw) if isinstance(raw, self.spec) else self.values(raw, source)
        return self.spec(**given)

    def values(self, raw: Any, source: Source) -> dict[str, Any]:
        """Return the values of the fields that are given.

        Raises
        ------
        CaseError
            With all keys that are unknown, missing or refused.
        """
        if not isinstance(raw, Mapping):
            self.fail(shown(raw))
        declared = keys_of(self.spec)
        # sub-tables with free names, by the field that holds them, and the other keys
        named: dict[str, Any] = {}
        rest: Mapping[str, Any] = raw
        for name, (key, _) in declared.items():
            if isinstance(key, Named) and key.beside:
                others = [item for item in raw.items() if item[0] not in declared]
                free = {n: v for n, v in others if isinstance(v, Mapping) or key.item.holds(v)}
                named = {name: free}
                rest = {n: v for n, v in raw.items() if n not in free}
                break
        problems = Problems()
        _keep_unknown(problems, rest, (n for n in declared if n not in named))
        values = {}
        for name, (key, dataclass_field) in declared.items():
            given = named.get(name, rest.get(name))
            if given is not None:
                values[name] = problems.of("" if name in named else name, key.read, given, source)
            elif dataclass_field.default is MISSING:
                missing = Problems()
                if isinstance(key, Table):
                    missing.of(name, key.read, {}, source)
                if not missing:
                    missing.append(Problem(name, "nothing", key.allowed()))
                problems += missing
        problems.settle()
        return values

    def written(self, value: Any, file_text: FileText) -> dict[str, Any]:
        """Keys that are compulsory or differ from their default."""
        found: dict[str, Any] = {}
        for name, (key, dataclass_field) in keys_of(self.spec).items():
            one = getattr(value, name)
            if one is not None and one != dataclass_field.default:
                text = key.written(one, file_text)
                found |= text if isinstance(key, Named) and key.beside else {name: text}
        return found

    def schema(self) -> Schema:
        properties: Schema = {}
        required: list[str] = []
        others: Any = False
        for name, (key, dataclass_field) in keys_of(self.spec).items():
            if isinstance(key, Named) and key.beside:
                others = key.item.schema()
                continue
            properties[name] = described(key)
            default = dataclass_field.default
            if default is MISSING:
                required.append(name)
            elif default is not None and isinstance(key, QuantityKey):
                properties[name]["default"] = format_si(default, key.unit)
            elif default is not None and isinstance(key, (Number, Integer, Choice, Text, Flag)):
                properties[name]["default"] = default
        return {
            "type": "object",
            "properties": properties,
            "required": required,
            "additionalProperties": others,
        }


def _read_again(table: Any) -> dict[str, Any]:
    """Values of an object that differ from their defaults, checked, texts with units in SI."""
    problems, values = Problems(), {}
    for name, (key, declared) in keys_of(type(table)).items():
        value = getattr(table, name)
        if value is not declared.default:
            values[name] = problems.of(name, key.read, value, _PYTHON)
    problems.settle()
    return values


@final
@dataclass(frozen=True, kw_only=True)
class Variant(Key):
    """Sub-table whose key ``tag`` chooses the dataclass.

    ``name_of_table`` gives the value of the tag where ``variants`` imports what it is asked for.
    """

    tag: str
    variants: Mapping[str, type]
    name_of_table: Callable[[type], str] | None = None

    def name_of(self, value: Any) -> str:
        """Return the value of the tag that stands for an object, empty for others."""
        if self.name_of_table is not None:
            return self.name_of_table(type(value))
        return next((name for name, spec in self.variants.items() if type(value) is spec), "")

    def holds(self, value: Any) -> bool:
        """Tell whether an object is one of the variants."""
        return bool(self.name_of(value))

    def allowed(self) -> str:
        return f"a table with {self.tag} = one of {', '.join(self.variants)}"

    def read(self, raw: Any, source: Source) -> Any:
        if not isinstance(raw, Mapping):
            return raw if self.holds(raw) else self.fail(shown(raw))
        name, kinds = raw.get(self.tag), self.variants
        if not isinstance(name, str) or name not in kinds:
            found = "nothing" if name is None else shown(name)
            raise CaseError(self.tag, found, " or ".join(f"'{kind}'" for kind in kinds))
        rest = {other: value for other, value in raw.items() if other != self.tag}
        return Table(spec=kinds[name]).read(rest, source)

    def written(self, value: Any, file_text: FileText) -> dict[str, Any]:
        return {self.tag: self.name_of(value), **Table(spec=type(value)).written(value, file_text)}

    def schema(self) -> Schema:
        kinds = []
        for name, spec in self.variants.items():
            schema = Table(spec=spec).schema()
            schema["properties"] = {self.tag: {"const": name}, **schema["properties"]}
            schema["required"] = [self.tag, *schema["required"]]
            kinds.append(schema)
        return {"oneOf": kinds}


@final
@dataclass(frozen=True, kw_only=True)
class Named(Key):
    """Sub-table with free names, each holding an item of one kind.

    With ``beside`` the names stand in the table of the field itself, beside its other keys.
    """

    item: Key
    beside: bool = False

    def allowed(self) -> str:
        return "a table"

    def read(self, raw: Any, source: Source) -> FrozenDict:
        if not isinstance(raw, Mapping):
            self.fail(shown(raw))
        problems = Problems()
        values = {
            name: problems.of(str(name), self.item.read, value, source)
            for name, value in raw.items()
        }
        problems.settle()
        return FrozenDict(values)

    def written(self, value: Mapping[str, Any], file_text: FileText) -> dict[str, Any]:
        return {name: self.item.written(item, file_text) for name, item in value.items()}

    def schema(self) -> Schema:
        return {"type": "object", "additionalProperties": self.item.schema()}


@final
@dataclass(frozen=True, kw_only=True)
class Free(Key):
    """Any value, kept as it stands."""

    def read(self, raw: Any, source: Source) -> Any:
        if isinstance(raw, Mapping):
            return FrozenDict({name: self.read(value, source) for name, value in raw.items()})
        items = _sequence(raw)
        return as_text(raw) if items is None else tuple(self.read(i, source) for i in items)

    def written(self, value: Any, file_text: FileText) -> Any:
        if isinstance(value, Mapping):
            return {name: self.written(item, file_text) for name, item in value.items()}
        return [self.written(i, file_text) for i in value] if isinstance(value, tuple) else value


def described(key: Key) -> Schema:
    """Return the schema of a key with its meaning and what it allows in words."""
    nested = isinstance(key, (Table, Variant, Free))
    allowed = "" if nested else f" Allowed: {key.allowed()}."
    return {"description": f"{key.doc}{allowed}".strip(), **key.schema()}


class KeyTable:
    """Base of the frozen dataclasses that hold the keys of a case.

    Every construction, :func:`dataclasses.replace` included, checks each value along its
    declaration before the table's own rules in ``__post_init__``. A class of the physics whose
    fields are keys is a plain dataclass: its values are checked where a case takes them.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        rules: Callable[[Any], None] | None = cls.__dict__.get("__post_init__")
        if rules is None and hasattr(cls, "__post_init__"):
            return  # the base checks the values and its own rules

        def checked(self: Any) -> None:
            for name, value in _read_again(self).items():
                object.__setattr__(self, name, value)
            if rules is not None:
                rules(self)

        cls.__post_init__ = checked  # type: ignore[attr-defined]


def declare(key: Key, default: Any = MISSING) -> Any:
    """Declare a dataclass field that is read from a key; without default it is compulsory."""
    return field(metadata={_METADATA: key}, default=default)


def again(spec: type, name: str, default: Any = MISSING) -> Any:
    """Declare a key of another table once more, with a default of its own."""
    return declare(keys_of(spec)[name][0], default)


def optional(spec: type, name: str) -> Any:
    """Declare a key of another table once more, without the default that it has there."""
    key = keys_of(spec)[name][0]
    meaning = key.doc.partition("; default")[0].rstrip(".")
    return declare(replace(key, doc=f"{meaning}."), None)


def quantity(unit: str, doc: str, *, default: Any = MISSING, **bounds: float) -> Any:
    """Declare a quantity; ``low``, ``high`` and ``above`` in ``unit``, default in SI units."""
    return declare(QuantityKey(doc=doc, unit=unit, **bounds), default)


def number(doc: str, *, default: Any = MISSING, **bounds: float) -> Any:
    """Declare a dimensionless number with ``low``, ``high`` and ``above``. [-]."""
    return declare(Number(doc=doc, **bounds), default)


def integer(doc: str, *, low: int, high: int, default: Any = MISSING) -> Any:
    """Declare a whole number. [-]."""
    return declare(Integer(doc=doc, low=low, high=high), default)


def choice(
    doc: str, *options: str, default: Any = MISSING, former: Mapping[str, str] | None = None
) -> Any:
    """Declare a choice of words; ``former`` spellings are accepted, with a note."""
    return declare(Choice(doc=doc, options=options, former=former or {}), default)


def flag(doc: str, *, default: Any = MISSING) -> Any:
    """Declare true or false."""
    return declare(Flag(doc=doc), default)


def pair(item: Key, doc: str, *, default: Any = MISSING) -> Any:
    """Declare two values of one kind."""
    return declare(Row(items=(item, item), doc=doc), default)


def items(item: Key, doc: str, *, default: Any = MISSING, **counts: int) -> Any:
    """Declare a list of values of one kind, their number with ``low`` and ``high``."""
    return declare(Items(item=item, doc=doc, **counts), default)


def grid(item: QuantityKey | Number, doc: str, *, default: Any = MISSING) -> Any:
    """Declare values of one kind: a list, or ``from``, ``to`` and ``count``."""
    return declare(Grid(item=item, doc=doc), default)


def text(doc: str, *, default: Any = MISSING) -> Any:
    """Declare a text."""
    return declare(Text(doc=doc), default)


def file_path(doc: str, *suffixes: str, default: Any = None, **instead: bool) -> Any:
    """Declare a file, relative to the case file, with ``points`` or ``columns`` in its place."""
    return declare(FilePath(doc=doc, suffixes=suffixes, **instead), default)


def table(spec: type, doc: str, *, default: Any = MISSING) -> Any:
    """Declare a sub-table read to the dataclass ``spec``."""
    return declare(Table(doc=doc, spec=spec), default)


def is_table(value: object) -> bool:
    """Whether an object holds keys."""
    return is_dataclass(value) and bool(keys_of(type(value)))


def keys_of(spec: type) -> dict[str, tuple[Key, Field[Any]]]:
    """Return the declared keys of a dataclass with their fields, in order."""
    return {f.name: (f.metadata[_METADATA], f) for f in fields(spec) if _METADATA in f.metadata}
