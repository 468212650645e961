"""Simulator of hydraulic gear machines: external gear pumps and motors, and gerotors.

>>> import toothspace as ts
>>> case = ts.load_case("cases/egm12_motor.toml")  # doctest: +SKIP
>>> solution = ts.simulate(case)  # doctest: +SKIP
>>> solution.summary()["volumetric_efficiency"]  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.1.0"

_PUBLIC = {
    "load_case": "toothspace.api",
    "describe": "toothspace.api",
    "simulate": "toothspace.api",
    "simulate_all": "toothspace.api",
    "Case": "toothspace.case",
    "Solution": "toothspace.results.solution",
    "load_solution": "toothspace.results.io",
    "Status": "toothspace.core.status",
    "CaseError": "toothspace.core.errors",
    "GeometryError": "toothspace.core.errors",
    "ToothspaceError": "toothspace.core.errors",
}
_SUBPACKAGES = ("films",)

__all__ = [*_PUBLIC, *_SUBPACKAGES, "__version__"]


def __getattr__(name: str) -> Any:
    """Import public names on first use, so that the command line answers at once."""
    if name in _PUBLIC:
        return getattr(importlib.import_module(_PUBLIC[name]), name)
    if name in _SUBPACKAGES:
        return importlib.import_module(f"toothspace.{name}")
    raise AttributeError(f"module 'toothspace' has no attribute {name!r}")
