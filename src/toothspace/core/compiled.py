"""Decorators that compile functions, and where compiled code is kept.

Every module that compiles takes them from here. See :mod:`toothspace.core.compilation` for
what they do.
"""

from __future__ import annotations

from toothspace.core.compilation.decorators import (
    inlined,
    kernel,
    merged,
    njit,
    passed_by_address,
    stand_in,
)
from toothspace.core.compilation.notice import compile_seconds
from toothspace.core.compilation.sources import cache_root, digest_of_sources

__all__ = [
    "cache_root",
    "compile_seconds",
    "digest_of_sources",
    "inlined",
    "kernel",
    "merged",
    "njit",
    "passed_by_address",
    "stand_in",
]
