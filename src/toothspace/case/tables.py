"""Tables of a case file, one below the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, final

from toothspace.case.conditions import FluidChoice, HeatSettings, OperatingPoint, RunSettings
from toothspace.case.stand_alone import FILMS, FilmKeys, JournalBearingCase
from toothspace.case.study import STUDIES
from toothspace.circuit.circuit import Circuit
from toothspace.core.keys import KeyTable, Variant, declare, integer, table, text
from toothspace.core.registry import machine_modules

SCHEMA_VERSION = 1


@final
class _MachineTypes(Mapping[str, type]):
    """Class of the keys ``[machine]`` of every installed machine type, imported when asked for."""

    def __getitem__(self, name: str) -> type:
        return import_module(f"{machine_modules()[name]}.parameters").PARAMETERS

    def __iter__(self) -> Iterator[str]:
        return iter(machine_modules())

    def __len__(self) -> int:
        return len(machine_modules())

    def name_of(self, spec: type) -> str:
        """Return the machine type whose keys a class holds, empty for other classes."""
        package = spec.__module__.removesuffix(".parameters")
        named = (name for name, module in machine_modules().items() if module == package)
        return next((name for name in named if self[name] is spec), "")


MACHINE_TABLES = _MachineTypes()
MACHINE_KEY = Variant(
    tag="type",
    variants=MACHINE_TABLES,
    name_of_table=MACHINE_TABLES.name_of,
    doc="The machine; keys by its type.",
)


@dataclass(frozen=True, kw_only=True)
class CaseTables(KeyTable):
    """Keys and tables of a case; :class:`~toothspace.case.case.Case` says what each means."""

    schema: int = integer(
        "Version of the case file's keys.",
        low=SCHEMA_VERSION,
        high=SCHEMA_VERSION,
        default=SCHEMA_VERSION,
    )
    title: str = text("What this case is.", default="")
    machine: Any = declare(MACHINE_KEY, None)
    fluid: FluidChoice | None = table(FluidChoice, "Fluid and temperature.", default=None)
    operating_point: OperatingPoint | None = table(
        OperatingPoint, "Steady condition.", default=None
    )
    circuit: Circuit | None = table(
        Circuit, "Transient condition: elements and connections.", default=None
    )
    bearing: JournalBearingCase | None = table(
        JournalBearingCase, "Stand-alone journal bearing.", default=None
    )
    film: FilmKeys | None = declare(
        Variant(tag="kind", variants=FILMS, doc="Stand-alone film."), None
    )
    study: Any = declare(
        Variant(tag="kind", variants=STUDIES, doc="Study that drives the condition."), None
    )
    heat: HeatSettings = table(
        HeatSettings,
        "Temperatures of oil, bodies and films at an operating point.",
        default=HeatSettings(),
    )
    run: RunSettings = table(RunSettings, "Fidelity and numerical settings.", default=RunSettings())
