"""Simulator of hydraulic gear machines: external and internal gear pumps and motors, gerotors.

>>> import toothspace as ts
>>> case = ts.load_case("cases/egm12_motor.toml")  # doctest: +SKIP
>>> solution = ts.simulate(case)  # doctest: +SKIP
>>> solution.summary()["volumetric_efficiency"]  # doctest: +SKIP

Names are imported on first use, so that the command line answers at once; type checkers read
them from ``__init__.pyi``.
"""

import importlib
from functools import cache

_PUBLIC = {
    "Case": "toothspace.case",
    "load_case": "toothspace.case",
    "describe": "toothspace.interactive",
    "simulate": "toothspace.interactive",
    "simulate_all": "toothspace.interactive",
    "sweep": "toothspace.interactive",
    "evaluate_designs": "toothspace.interactive",
    "export_fmu": "toothspace.interactive",
    "compare": "toothspace.interactive",
    "Solution": "toothspace.interactive",
    "load_solution": "toothspace.interactive",
    "Quantity": "toothspace.core.units",
    "Status": "toothspace.core.status",
    "CaseError": "toothspace.core.errors",
    "GeometryError": "toothspace.core.errors",
    "ToothspaceError": "toothspace.core.errors",
}
_SUBPACKAGES = ("films",)

__all__ = [*_PUBLIC, *_SUBPACKAGES, "__version__"]


def __getattr__(name: str) -> object:
    """Import a public name on first use."""
    if name in _PUBLIC:
        return getattr(importlib.import_module(_PUBLIC[name]), name)
    if name == "__version__":
        return _version()
    if name in _SUBPACKAGES:
        return importlib.import_module(f"toothspace.{name}")
    raise AttributeError(f"module 'toothspace' has no attribute {name!r}")


@cache
def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("toothspace")
    except PackageNotFoundError:
        return "0+not.installed"


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
