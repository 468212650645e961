"""Types of arguments as text: numbers, arrays and tuples of them.

``f8`` is a number, ``V232`` a structure of so many bytes, ``f8[2C]`` an array of two dimensions
with its rows one after another and ``f8[2C]r`` one that may be read-only; ``(f8,i8)`` is a tuple
and ``model.walls.Wall(f8,i8)`` a named one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from toothspace.core.compilation.sources import name_of

ENTRIES = Path(__file__).with_name("entries.txt")
"""The list of entries."""

_STRUCTURES = ("numerics.ndf_types.CONTROL",)
"""NumPy types with fields; the number of bytes tells them apart."""

_TOKEN = re.compile(r"[\w.]*\(|\w+(?:\[\w+\]r?)?|[,)]")


@dataclass(frozen=True)
class Scalar:
    """A number."""

    dtype: str


@dataclass(frozen=True)
class ArrayType:
    """An array of some layout in memory."""

    dtype: str
    dimensions: int
    layout: str
    readonly: bool


@dataclass(frozen=True)
class TupleType:
    """A tuple, and its class where it is a named one."""

    class_name: str
    members: tuple[Type, ...]

    def load(self) -> Any:
        """Class of a named tuple."""
        module, name = self.class_name.rsplit(".", 1)
        return getattr(import_module(f"toothspace.{module}"), name)


def dtype_of(text: str) -> np.dtype[Any]:
    """NumPy type of a number or structure."""
    if not text.startswith("V"):
        return np.dtype(text)
    for name in _STRUCTURES:
        module, constant = name.rsplit(".", 1)
        found: np.dtype[Any] = getattr(import_module(f"toothspace.{module}"), constant)
        if f"V{found.itemsize}" == text:
            return found
    raise TypeError(f"no structure has the size of {text}")


Type = Scalar | ArrayType | TupleType


class _Read(NamedTuple):
    type: Type
    rest: list[str]


def parsed(text: str) -> Type:
    """Read the text of a type."""
    return _parsed(_TOKEN.findall(text)).type


def _parsed(tokens: list[str]) -> _Read:
    token, rest = tokens[0], tokens[1:]
    if token.endswith("("):
        members: list[Type] = []
        while rest[0] != ")":
            member, rest = _parsed(rest[1:] if rest[0] == "," else rest)
            members.append(member)
        return _Read(TupleType(token[:-1], tuple(members)), rest[1:])
    if "[" not in token:
        return _Read(Scalar(token), rest)
    dtype, _, form = token.partition("[")
    return _Read(ArrayType(dtype, int(form[0]), form[1], form.endswith("r")), rest)


def text_of(value: Any) -> str:
    """Text of the type of an argument."""
    if isinstance(value, np.ndarray):
        flags = value.flags
        layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
        readable = "" if flags.writeable else "r"
        return f"{value.dtype.str[1:]}[{value.ndim}{layout}]{readable}"
    if isinstance(value, tuple):
        named = "" if type(value) is tuple else name_of(type(value))
        return f"{named}({','.join(map(text_of, value))})"
    if isinstance(value, bool | np.bool_):
        return "b1"
    if isinstance(value, int | np.integer):
        return "i8"
    if isinstance(value, float):
        return "f8"
    raise TypeError(f"no entry takes {type(value).__name__}")


def read_entries() -> dict[str, str]:
    """Types of the arguments of every entry, by its name."""
    if not ENTRIES.is_file():
        return {}
    lines = ENTRIES.read_text(encoding="utf-8").splitlines()
    return {
        name: types for name, types in (line.split() for line in lines if line[:1] not in ("#", ""))
    }
