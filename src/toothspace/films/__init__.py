"""Stand-alone thin films.

==================  ==========================================================
module              responsibility
==================  ==========================================================
rough_surfaces      average flow and contact of rough walls
reynolds            gap heights to cell balances, and their variation
journal_film        geometry and integrals of the film round a shaft
journal_bearing     :class:`JournalBearing`, the input
journal_solver      film for a given motion of the shaft
journal_solution    fields, loads, flows, stiffness and damping
cavitation          names of the cavitation models
equilibrium         position of the shaft under a load
mixed_lubrication   friction over speed and its reduction to a formula
shaft_motion        stability threshold and transient orbit
plane_film          films between nearly parallel faces on any grid
pad                 :class:`Pad`: rectangular pads with pocket or step
lateral             :class:`LateralFilm`: rings and discs, masked by given pressures
cases               ``[bearing]`` and ``[film]`` tables to named numbers
==================  ==========================================================
"""

from __future__ import annotations

from toothspace.films.cases import bearing_summary, pad_summary, solve_bearing, solve_film
from toothspace.films.journal_bearing import JournalBearing
from toothspace.films.journal_film import Groove
from toothspace.films.journal_solution import JournalBearingSolution
from toothspace.films.lateral import LateralFilm, LateralSolution
from toothspace.films.mixed_lubrication import (
    FrictionCurve,
    FrictionSweep,
    fit_friction_curve,
    sweep_friction,
)
from toothspace.films.pad import Pad, PadSolution, Pocket
from toothspace.films.plane_film import FilmFluid
from toothspace.films.rough_surfaces import RoughSurfaces
from toothspace.films.shaft_motion import (
    Orbit,
    OrbitSettings,
    critical_mass,
    shaft_orbit,
    threshold_speed,
)

__all__ = [
    "FilmFluid",
    "FrictionCurve",
    "FrictionSweep",
    "Groove",
    "JournalBearing",
    "JournalBearingSolution",
    "LateralFilm",
    "LateralSolution",
    "Orbit",
    "OrbitSettings",
    "Pad",
    "PadSolution",
    "Pocket",
    "RoughSurfaces",
    "bearing_summary",
    "critical_mass",
    "fit_friction_curve",
    "pad_summary",
    "shaft_orbit",
    "solve_bearing",
    "solve_film",
    "sweep_friction",
    "threshold_speed",
]
