"""The one model of a case: TOML, tables or Python in, units in, SI inside.

=============== ==========================================================
module          responsibility
=============== ==========================================================
case            the whole case: made, changed, written, hashed, its JSON Schema
document        text of a file to tables with places, values of key paths laid over them, and
                tables to text
case_tables     tables of a case file, and what several keys must fulfil together
shipped         cases that come with the package
fingerprint     hashes of content, and what is kept by them
conditions      fluid, operating point, numerical settings of the run
presets         fidelity presets, their models and the keys that one of them reads
stand_alone     journal bearing and film without a machine
=============== ==========================================================
"""

from __future__ import annotations

from toothspace.case.case import Case, load_case
from toothspace.case.conditions import FluidChoice, OperatingPoint, RunSettings
from toothspace.case.stand_alone import FilmCase, JournalBearingCase
from toothspace.circuit.circuit import Circuit

__all__ = [
    "Case",
    "Circuit",
    "FilmCase",
    "FluidChoice",
    "JournalBearingCase",
    "OperatingPoint",
    "RunSettings",
    "load_case",
]
