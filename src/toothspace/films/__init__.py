"""Stand-alone thin films.

==================  ==========================================================
module              responsibility
==================  ==========================================================
reynolds            gap heights to cell balances, and their variation
journal_film        geometry and integrals of the film round a shaft
journal_bearing     :class:`JournalBearing` and its solution
equilibrium         position of the shaft under a load
==================  ==========================================================
"""

from __future__ import annotations

from toothspace.films.cases import bearing_summary, solve_bearing
from toothspace.films.journal_bearing import JournalBearing, JournalBearingSolution
from toothspace.films.journal_film import Groove

__all__ = [
    "Groove",
    "JournalBearing",
    "JournalBearingSolution",
    "bearing_summary",
    "solve_bearing",
]
