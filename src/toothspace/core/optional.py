"""Packages that come with an extra of the installation."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from toothspace.core.errors import GeometryError


def package_of_extra(name: str, extra: str, use: str) -> Any:
    """Import a package that the lean installation leaves out.

    Parameters
    ----------
    extra : str
        Extra that brings it.
    use : str
        What asks for it, to begin the message.

    Raises
    ------
    GeometryError
        If it is missing: how to install it.
    """
    try:
        return import_module(name)
    except ImportError as error:
        needed = f'allowed after pip install "toothspace[{extra}]"'
        raise GeometryError(f"{use} but not the package for it, {needed}") from error
