"""Functions compiled by Numba at run time.

Where the installed Numba is not one that :mod:`toothspace.core.compilation.parts` is tested
with, or ``TOOTHSPACE_COMPILATION=plain`` is set, Numba compiles every function on its own: the
results are the same, the first use takes minutes.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from multiprocessing import parent_process
from pathlib import Path
from typing import Any

import numba
from numba.extending import overload, register_jitable

from toothspace.core.compilation.library import Way, way
from toothspace.core.compilation.marks import hand_over
from toothspace.core.compilation.records import register_record
from toothspace.core.compilation.sources import cache_root, digest_of_sources

TESTED = ("0.68",)
"""Numba releases that the parts are tested with."""


def _parts_wanted() -> bool:
    if way() == Way.PLAIN:
        return False
    if numba.__version__.rpartition(".")[0] in TESTED:
        return True
    if parent_process() is None:
        known = f"tested with {', '.join(TESTED)}"
        slow = "the first use of every function compiles, some minutes in all"
        sys.stderr.write(f"Numba {numba.__version__} ({known}): {slow}\n")
    return False


PARTS = _parts_wanted()
"""Whether inner functions are compiled as parts of what Python calls."""

if PARTS:
    from toothspace.core.compilation.parts import Formula, Kernel

    _formulas: dict[Any, Formula] = {}

    def compiled(function: Callable[..., Any], options: dict[str, Any]) -> Any:
        """Compile a function without the interpreter; options are those of ``numba.njit``."""
        return Kernel(function, None, options)

    def register_formula(function: Callable[..., Any]) -> None:
        """Compile a plain function where compiled code calls it."""
        _formulas[function] = Formula(function)

else:
    # Numba follows no calls into other modules; it reads the variable once, perhaps before
    os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_root() / f"compiled-{digest_of_sources()}"))
    numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

    def compiled(function: Callable[..., Any], options: dict[str, Any]) -> Any:
        """Compile a function without the interpreter; options are those of ``numba.njit``."""
        kept = Path(function.__code__.co_filename).is_file()
        return numba.njit(function, cache=kept, **options)

    register_formula = register_jitable


def register_stand_in(function: Callable[..., Any], choose: Callable[..., Any]) -> None:
    """Compile what a rule chooses by the types of the arguments in place of a plain function."""
    overload(function, strict=False)(choose)


hand_over({"formula": register_formula, "stand_in": register_stand_in, "record": register_record})
