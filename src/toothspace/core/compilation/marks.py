"""What the compiler must know of functions and classes, noted until it is loaded."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

_noted: list[tuple[str, tuple[Any, ...]]] = []
_register: dict[str, Callable[..., None]] = {}


def mark(kind: str, *what: Any) -> None:
    """Note what the compiler must know, or tell it where it is loaded."""
    if _register:
        _register[kind](*what)
    else:
        _noted.append((kind, what))


def hand_over(register: Mapping[str, Callable[..., None]]) -> None:
    """Tell the compiler all that was noted, and from now on at once."""
    _register.update(register)
    for kind, what in _noted:
        mark(kind, *what)
    _noted.clear()
