"""Exceptions that a user sees as one clear line."""

from __future__ import annotations


class ToothspaceError(Exception):
    """Base of every error that the package raises on purpose."""


class CaseError(ToothspaceError):
    """A case file asks for the impossible: names file, key, value found and what is allowed."""


class GeometryError(CaseError):
    """A profile or machine geometry cannot be built: names what was found and what is allowed."""
