"""What marks a function as compiled code.

Where the installed Numba is not one that :mod:`toothspace.core.compilation.parts` is tested
with, or ``TOOTHSPACE_COMPILATION=plain`` is set, Numba compiles every function on its own: the
results are the same, the first use takes minutes.
"""

from __future__ import annotations

import os
import sys
from multiprocessing import parent_process
from typing import Any

import numba
from numba.extending import register_jitable

from toothspace.core.compilation.cache import cache_root, digest_of_sources

TESTED = ("0.68",)
"""Numba releases that the parts are tested with."""


def _parts_wanted() -> bool:
    if os.environ.get("TOOTHSPACE_COMPILATION") == "plain":
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

    def njit(function: Any = None, /, **options: Any) -> Any:
        """Compile a function without the interpreter; options are those of ``numba.njit``."""
        if function is not None:
            return Kernel(function)
        return lambda target: Kernel(target, None, options)

    def inlined(function: Any) -> Any:
        """Mark a formula that stays plain Python and is compiled where compiled code calls it."""
        _formulas[function] = Formula(function)
        return function

else:
    # Numba follows no calls into other modules; it reads the variable once, perhaps before
    os.environ.setdefault("NUMBA_CACHE_DIR", str(cache_root() / f"compiled-{digest_of_sources()}"))
    numba.config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]

    def njit(function: Any = None, /, **options: Any) -> Any:
        """Compile a function without the interpreter; options are those of ``numba.njit``."""
        return numba.njit(function, cache=True, **options)

    inlined = register_jitable


kernel = njit(error_model="numpy", _nrt=False, nogil=True)
"""Compiles a function that allocates nothing: arrays pass without reference counting."""

merged = njit(error_model="numpy", _nrt=False, forceinline=True)
"""A kernel that becomes part of its callers: handing it its arguments costs more than its work."""
