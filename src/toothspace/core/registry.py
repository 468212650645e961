"""What is found by name: machine types, and views of a result that rooms above it give."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from toothspace.core.errors import CaseError

ENTRY_POINT_GROUP = "toothspace.machines"


def machine_type_names() -> list[str]:
    """Return the names of all installed machine types."""
    return sorted(machine_modules())


def machine_type(name: str) -> Any:
    """Return the machine type of a name.

    Raises
    ------
    CaseError
        If no installed package provides it.
    """
    modules = machine_modules()
    if name in modules:
        return import_module(modules[name]).MACHINE
    allowed = ", ".join(machine_type_names())
    raise CaseError(f"machine.type: found {name!r}, allowed {allowed}")


def optional_part(name: str, part: str) -> Any:
    """Return the module of a machine type that not all have, None without.

    Parameters
    ----------
    name : str
        Machine type.
    part : str
        ``export`` with a function ``export_profiles``, ``case_draft`` with ``draft_case`` or
        ``designs`` with ``evaluate_designs``.
    """
    module = f"{machine_modules()[name]}.{part}"
    return import_module(module) if find_spec(module) else None


@cache
def machine_modules() -> dict[str, str]:
    """Return the package that provides each machine type, by name.

    The package holds a module ``parameters`` with the class ``PARAMETERS`` of its case keys, and
    the modules of :func:`optional_part`.
    """
    folder = Path(__file__).resolve().parent.parent / "machines"
    built_in = {
        file.parent.name: f"toothspace.machines.{file.parent.name}"
        for file in sorted(folder.glob("*/parameters.py"))
    }
    shipped = {point.name: point.module for point in entry_points(group=ENTRY_POINT_GROUP)}
    return dict(sorted((shipped | built_in).items()))


VIEWS: Mapping[str, str] = {
    "case": "toothspace.api:case_of",
    "machine": "toothspace.api:machine_of",
    "findings": "toothspace.advice.findings:findings_of",
    "figures": "toothspace.plotting.catalogue:available_figures",
    "report": "toothspace.report:write_report",
    "card": "toothspace.report.card:solution_card",
}
"""Functions of a solution in rooms above the results, which therefore import none of them."""


def view(name: str) -> Any:
    """Return a function of :data:`VIEWS`, imported on first use."""
    module, _, function = VIEWS[name].partition(":")
    return getattr(import_module(module), function)
