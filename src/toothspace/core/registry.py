"""What is found by name: machine types, studies, and views of a result from rooms above it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, final

from toothspace.core.errors import CaseError

ENTRY_POINT_GROUP = "toothspace.machines"
STUDIES = "toothspace.studies"
"""Package of the studies, and group of entry points."""
OPTIONAL = {
    "export_profiles": "cad",
    "draft_case": "cad",
    "evaluate_designs": "designs",
    "new_case": "new_case",
}
"""Functions that not all machine types have, and the module of its package that holds each."""


@final
@dataclass(frozen=True, eq=False)
class Declared(Mapping[str, type]):
    """Classes of keys that modules declare, by name; a module is imported when it is asked for."""

    _modules: Callable[[], Mapping[str, str]]
    """Modules that may declare one, by name."""
    _keys: Callable[[Any], type | None]
    """Takes the class from a module; None where there is none."""

    def __getitem__(self, name: str) -> type:
        found = self._keys(import_module(self._modules()[name]))
        if found is None:
            raise KeyError(name)
        return found

    def __iter__(self) -> Iterator[str]:
        return (name for name in self._modules() if name in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def name_of(self, keys: type) -> str:
        """Return the name under which a class is declared, empty for other classes."""
        modules = self._modules()
        names = sorted(modules, key=lambda name: modules[name] != keys.__module__)
        return next((name for name in names if self.get(name) is keys), "")


def machine_type_names() -> list[str]:
    """Return the names of all installed machine types."""
    return sorted(machine_modules())


def machine_type(name: str) -> Any:
    """Return the machine type of a name.

    Raises CaseError if no installed package provides it.
    """
    modules = machine_modules()
    if name in modules:
        return import_module(modules[name]).MACHINE
    allowed = ", ".join(machine_type_names())
    raise CaseError("machine.type", f"{name!r}", allowed)


def optional_function(name: str, function: str) -> Any:
    """Return a function of :data:`OPTIONAL` of a machine type, None if it has none."""
    module = f"{machine_modules()[name]}.{OPTIONAL[function]}"
    return getattr(import_module(module), function, None) if find_spec(module) else None


@cache
def machine_modules() -> dict[str, str]:
    """Return the package that provides each machine type, by name.

    The package holds a module ``parameters`` with the class ``PARAMETERS`` of its case keys, and
    the functions of :data:`OPTIONAL`.
    """
    folder = Path(__file__).resolve().parent.parent / "machines"
    built_in = {
        file.parent.name: f"toothspace.machines.{file.parent.name}"
        for file in sorted(folder.glob("*/parameters.py"))
    }
    shipped = {point.name: point.module for point in entry_points(group=ENTRY_POINT_GROUP)}
    return dict(sorted((shipped | built_in).items()))


def machine_key_modules() -> dict[str, str]:
    """Return the module with the keys of each machine type, by name."""
    return {name: f"{package}.parameters" for name, package in machine_modules().items()}


@cache
def study_modules() -> dict[str, str]:
    """Return the modules that may declare a study in ``STUDY``, by name.

    Those of the package of studies, and others by entry points; some help the studies.
    """
    package = find_spec(STUDIES)
    folders = package.submodule_search_locations if package else None
    own = {one.name: f"{STUDIES}.{one.name}" for one in iter_modules(folders)}
    shipped = {point.name: point.module for point in entry_points(group=STUDIES)}
    return dict(sorted((shipped | own).items()))


def study(name: str) -> Any:
    """Return the declaration of a study, None if the module of that name has none."""
    return getattr(import_module(study_modules()[name]), "STUDY", None)


MACHINE_KEYS = Declared(machine_key_modules, lambda module: module.PARAMETERS)
"""Class of the keys ``[machine]`` of every installed machine type."""
STUDY_KEYS = Declared(
    study_modules, lambda module: module.STUDY.keys if hasattr(module, "STUDY") else None
)
"""Class of the keys ``[study]`` of every study."""


VIEWS: Mapping[str, str] = {
    "case": "toothspace.api:case_of",
    "machine": "toothspace.api:machine_of",
    "describe": "toothspace.api:describe",
    "findings": "toothspace.advice.findings:findings_of",
    "figures": "toothspace.plotting.catalogue:available_figures",
    "machine_figure": "toothspace.plotting.catalogue:machine_figure",
    "report": "toothspace.report:write_report",
    "bench": "toothspace.report.view_page:solution_page",
    "card": "toothspace.report.card:solution_card",
    "case_card": "toothspace.report.card:case_card",
}
"""Functions of a case or a solution in rooms above them, which they therefore do not import."""


def view(name: str) -> Any:
    """Return a function of :data:`VIEWS`, imported on first use."""
    module, _, function = VIEWS[name].partition(":")
    return getattr(import_module(module), function)
