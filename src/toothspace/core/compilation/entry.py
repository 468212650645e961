"""Compiled functions that are looked up in the library when Python calls them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, final

from toothspace.core.compilation.library import NEEDED, Library, Native
from toothspace.core.compilation.sources import name_of
from toothspace.core.errors import CaseError


@final
class Entry:
    """Function whose machine code is in the library.

    What the library does not hold, or holds for other types of arguments, is compiled by Numba
    where that is installed, and is plain Python where it is not.

    Parameters
    ----------
    function : callable
        What is compiled.
    options : mapping
        Compiler options.
    library : Library or None
        Where the code is; nothing where there is neither library nor compiler.
    """

    def __init__(
        self, function: Callable[..., Any], options: dict[str, Any], library: Library | None
    ) -> None:
        self.py_func = function
        self._options = options
        self._library = library
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Call the code of the library, or what stands in for it."""
        found = self._found
        if found is not None:
            native, call = found
            result = call(native.address, native.types, native.results, arguments)
            if result is not NotImplemented:
                return result
        return self._otherwise(*arguments)

    @cached_property
    def _found(self) -> tuple[Native, Any] | None:
        if self._library is None:
            raise CaseError(NEEDED)
        native = self._library.entries.get(name_of(self.py_func))
        return None if native is None else (native, self._library.call)

    @cached_property
    def _numba_type_(self) -> Any:
        """Type under which code that Numba compiles sees this function."""
        return self.just_in_time._numba_type_

    @cached_property
    def just_in_time(self) -> Any:
        """The function as Numba compiles it."""
        from toothspace.core.compilation.jit import compiled

        return compiled(self.py_func, self._options)

    @cached_property
    def _otherwise(self) -> Callable[..., Any]:
        try:
            return self.just_in_time
        except ImportError:
            return self.py_func
