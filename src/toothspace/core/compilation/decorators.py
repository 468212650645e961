"""What marks a function as compiled code, a class as a record that such code reads.

The marks cost nothing and load no compiler: they are handed to Numba when it is first asked to
compile, which is never where the library holds every entry.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from toothspace.core.compilation.entry import Entry
from toothspace.core.compilation.library import Way, chosen, way
from toothspace.core.compilation.marks import mark

_Record = TypeVar("_Record", bound=type)


def njit(function: Any = None, /, **options: Any) -> Any:
    """Compile a function without the interpreter; options are those of ``numba.njit``."""
    if function is None:
        return partial(njit, **options)
    if way() in {Way.LIBRARY, Way.MISSING}:
        return Entry(function, options, chosen()[2])
    from toothspace.core.compilation.jit import compiled

    return compiled(function, options)


def inlined(function: Any) -> Any:
    """Mark a formula that stays plain Python and is compiled where compiled code calls it."""
    mark("formula", function)
    return function


def stand_in(function: Callable[..., Any]) -> Callable[[Any], Any]:
    """Mark a rule that chooses what compiled code calls in place of a plain function.

    The rule gets the types of the arguments: an array has ``ndim``, a number has not.
    """

    def marked(choose: Any) -> Any:
        mark("stand_in", function, choose)
        return choose

    return marked


def passed_by_address(record: _Record) -> _Record:
    """Mark a named-tuple class whose instances compiled code reads from one block of memory."""
    mark("record", record)
    return record


kernel = njit(error_model="numpy", _nrt=False, nogil=True)
"""Compiles a function that allocates nothing: arrays pass without reference counting."""

merged = njit(error_model="numpy", _nrt=False, forceinline=True)
"""A kernel that becomes part of its callers: handing it its arguments costs more than its work."""
