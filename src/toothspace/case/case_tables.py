"""Tables of a case file, one below the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from toothspace.case.conditions import FluidChoice, HeatSettings, OperatingPoint, RunSettings
from toothspace.case.stand_alone import FILMS, FilmKeys, JournalBearingCase
from toothspace.circuit.circuit import Circuit
from toothspace.core.keys import KeyTable, Variant, declare, integer, table, text
from toothspace.core.registry import MACHINE_KEYS, STUDY_KEYS

SCHEMA_VERSION = 1


MACHINE_KEY = Variant(
    tag="type",
    variants=MACHINE_KEYS,
    name_of_table=MACHINE_KEYS.name_of,
    doc="The machine; keys by its type.",
)
STUDY_KEY = Variant(
    tag="kind",
    variants=STUDY_KEYS,
    name_of_table=STUDY_KEYS.name_of,
    doc="Study that drives the condition.",
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
    study: Any = declare(STUDY_KEY, None)
    heat: HeatSettings = table(
        HeatSettings,
        "Temperatures of oil, bodies and films at an operating point.",
        default=HeatSettings(),
    )
    run: RunSettings = table(RunSettings, "Fidelity and numerical settings.", default=RunSettings())
