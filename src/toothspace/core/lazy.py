"""Things that are made on first use, and packages that a user may lack."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import Any, Generic, TypeVar, final, overload

from toothspace.core.errors import GeometryError

_Item = TypeVar("_Item")


@final
@dataclass(frozen=True, eq=False)
class Lazy(Generic[_Item]):
    """One thing that is made once, when it is asked for first."""

    make: Callable[[], _Item]
    """Gives it; a function of a module with its arguments, so that it can be pickled."""

    @cached_property
    def value(self) -> _Item:
        """The thing itself."""
        return self.make()


@final
@dataclass(frozen=True, eq=False)
class LazySequence(Sequence[_Item]):
    """Items that are made once, when they are asked for first."""

    make: Callable[[], Sequence[_Item]]
    """Gives the items; a function of a module with its arguments, so that it can be pickled."""

    @cached_property
    def _items(self) -> tuple[_Item, ...]:
        return tuple(self.make())

    @overload
    def __getitem__(self, index: int) -> _Item: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[_Item]: ...
    def __getitem__(self, index: int | slice) -> _Item | Sequence[_Item]:
        return self._items[index]

    def __len__(self) -> int:
        return len(self._items)


@final
@dataclass(frozen=True, eq=False)
class LazyMapping(Mapping[str, _Item]):
    """Values by name that are made once, when they are asked for first."""

    make: Callable[[], Mapping[str, _Item]]
    """Gives the mapping; a function of a module with its arguments, so that it can be pickled."""

    @cached_property
    def _values(self) -> dict[str, _Item]:
        return dict(self.make())

    def __getitem__(self, name: str) -> _Item:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)


def package_of_extra(name: str, extra: str, use: str) -> Any:
    """Import a package that the lean installation leaves out.

    Raises GeometryError if it is missing: how to install it.

    Parameters
    ----------
    extra : str
        Extra that brings it.
    use : str
        What asks for it, to begin the message.
    """
    try:
        return import_module(name)
    except ImportError as error:
        needed = f'allowed after pip install "toothspace[{extra}]"'
        raise GeometryError(f"{use} but not the package for it, {needed}") from error
