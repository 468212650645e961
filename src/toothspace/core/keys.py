"""Declaration of the keys of a case file on the fields of frozen dataclasses.

One field states unit, allowed range and meaning once; reading, messages, the JSON Schema and
the documentation are derived from it.

>>> from dataclasses import dataclass
>>> @dataclass(frozen=True, kw_only=True)
... class Casing:
...     radial_clearance: float = quantity("um", "Bore radius minus tip radius.", above=0, high=500)
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field, fields
from typing import Any, final

from toothspace.core.errors import CaseError

_METADATA = "toothspace.key"


@final
class KeyRuleError(CaseError):
    """A rule between keys is broken; raised by ``__post_init__`` with the key relative to it.

    Parameters
    ----------
    key : str
        Key path relative to the dataclass, empty for the table itself.
    found, allowed : str
        What stands there and what may stand there.
    """

    def __init__(self, key: str, found: str, allowed: str) -> None:
        super().__init__(f"{key}: found {found}, allowed {allowed}")
        self.key, self.found, self.allowed = key, found, allowed


def require(owner: object, reason: str, *names: str) -> None:
    """Refuse a missing key that another choice makes compulsory."""
    for name in names:
        if getattr(owner, name) is None:
            raise KeyRuleError(name, "nothing", f"this key is compulsory {reason}")


def forbid(owner: object, reason: str, *names: str) -> None:
    """Refuse a key that contradicts another one."""
    for name in names:
        if getattr(owner, name) is not None:
            raise KeyRuleError(name, "a value", f"leave this key out {reason}")


@dataclass(frozen=True, kw_only=True)
class Key:
    """What stands behind one key; ``doc`` is its meaning in one sentence."""

    doc: str = ""


@final
@dataclass(frozen=True, kw_only=True)
class Quantity(Key):
    """Text with a unit; bounds are numbers in the display unit, ``above`` is exclusive."""

    unit: str
    low: float | None = None
    high: float | None = None
    above: float | None = None


@final
@dataclass(frozen=True, kw_only=True)
class Number(Key):
    """Dimensionless number."""

    low: float | None = None
    high: float | None = None
    above: float | None = None


@final
@dataclass(frozen=True, kw_only=True)
class Integer(Key):
    """Whole number."""

    low: int
    high: int


@final
@dataclass(frozen=True, kw_only=True)
class Choice(Key):
    """One of a few words; ``former`` are old spellings, accepted for one version."""

    options: tuple[str, ...]
    former: Mapping[str, str] = field(default_factory=dict)

    def present(self, word: Any, path: str) -> Any:
        """Present spelling of a word behind a key path; a former one is announced."""
        if not isinstance(word, str) or word not in self.former:
            return word
        sys.stderr.write(
            f"{path}: {word!r} is now spelled {self.former[word]!r}; "
            "the next version refuses the old spelling.\n"
        )
        return self.former[word]


@final
@dataclass(frozen=True, kw_only=True)
class Text(Key):
    """Any text that is not empty."""


@final
@dataclass(frozen=True, kw_only=True)
class Flag(Key):
    """True or false."""


@final
@dataclass(frozen=True, kw_only=True)
class FilePath(Key):
    """A file next to the case file that must exist; ``suffixes`` in lower case."""

    suffixes: tuple[str, ...]


@final
@dataclass(frozen=True, kw_only=True)
class Items(Key):
    """List of equal items."""

    item: Key
    low: int = 1
    high: int = 10000


@final
@dataclass(frozen=True, kw_only=True)
class Row(Key):
    """List of a fixed number of items, each of its own kind."""

    items: tuple[Key, ...]


@final
@dataclass(frozen=True, kw_only=True)
class Grid(Key):
    """List of values, or ``{from, to, count}``, read to a tuple of values."""

    item: Quantity | Number


@final
@dataclass(frozen=True, kw_only=True)
class Table(Key):
    """Sub-table read to a frozen dataclass."""

    spec: type


@final
@dataclass(frozen=True, kw_only=True)
class Variant(Key):
    """Sub-table whose key ``tag`` chooses the dataclass."""

    tag: str
    variants: Mapping[str, type]


@final
@dataclass(frozen=True, kw_only=True)
class Named(Key):
    """Sub-table with free names, each holding an item of one kind."""

    item: Key


@final
@dataclass(frozen=True, kw_only=True)
class Free(Key):
    """Any value, kept as it stands."""


def declare(key: Key, default: Any = MISSING) -> Any:
    """Declare a dataclass field that is read from a key; without default it is compulsory."""
    return field(metadata={_METADATA: key}, default=default)


def quantity(
    unit: str,
    doc: str,
    *,
    low: float | None = None,
    high: float | None = None,
    above: float | None = None,
    default: float | Any | None = MISSING,
) -> Any:
    """Declare a quantity; bounds in ``unit``, default in SI units."""
    return declare(Quantity(doc=doc, unit=unit, low=low, high=high, above=above), default)


def number(
    doc: str,
    *,
    low: float | None = None,
    high: float | None = None,
    above: float | None = None,
    default: float | Any | None = MISSING,
) -> Any:
    """Declare a dimensionless number. [-]."""
    return declare(Number(doc=doc, low=low, high=high, above=above), default)


def integer(doc: str, *, low: int, high: int, default: int | Any | None = MISSING) -> Any:
    """Declare a whole number. [-]."""
    return declare(Integer(doc=doc, low=low, high=high), default)


def choice(
    doc: str,
    *options: str,
    default: str | Any | None = MISSING,
    former: Mapping[str, str] | None = None,
) -> Any:
    """Declare a choice of words; ``former`` spellings are accepted, with a note."""
    return declare(Choice(doc=doc, options=options, former=former or {}), default)


def text(doc: str, *, default: str | Any | None = MISSING) -> Any:
    """Declare a text."""
    return declare(Text(doc=doc), default)


def file_path(doc: str, *suffixes: str, default: Any = None) -> Any:
    """Declare a file, given relative to the case file."""
    return declare(FilePath(doc=doc, suffixes=suffixes), default)


def table(spec: type, doc: str, *, default: Any = MISSING) -> Any:
    """Declare a sub-table read to the dataclass ``spec``."""
    return declare(Table(doc=doc, spec=spec), default)


def keys_of(spec: type) -> dict[str, tuple[Key, Field[Any]]]:
    """Return the declared keys of a dataclass with their fields, in order."""
    return {f.name: (f.metadata[_METADATA], f) for f in fields(spec) if _METADATA in f.metadata}


def is_required(declared: Field[Any]) -> bool:
    """Tell whether a declared field has no default."""
    return declared.default is MISSING and declared.default_factory is MISSING
