"""LU factors of small sparse matrices whose pattern never changes."""

from __future__ import annotations
