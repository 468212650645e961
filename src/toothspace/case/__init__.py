"""Frozen input of one simulation, in SI units.

=============== ==========================================================
module          responsibility
=============== ==========================================================
case            the whole case, its text and its hash
conditions      fluid, operating point, numerical settings of the run
circuit         circuit elements and their connections
study           named studies
stand_alone     journal bearing and film without a machine
=============== ==========================================================
"""

from __future__ import annotations

from toothspace.case.case import Case
from toothspace.case.circuit import Circuit
from toothspace.case.conditions import FluidChoice, OperatingPoint, RunSettings
from toothspace.case.stand_alone import FilmCase, JournalBearingCase

__all__ = [
    "Case",
    "Circuit",
    "FilmCase",
    "FluidChoice",
    "JournalBearingCase",
    "OperatingPoint",
    "RunSettings",
]
