"""What ``toothspace.films`` offers, imported on first use."""

from __future__ import annotations

from toothspace.closures.journal_friction import FrictionCurve
from toothspace.films.definitions import Groove, Lobes, RoughSurfaces
from toothspace.films.field_files import film_dataset, save_film, save_film_vtk
from toothspace.films.journal.bearing import JournalBearing
from toothspace.films.journal.mixed_lubrication import (
    FrictionSweep,
    fit_friction_curve,
    machine_bearing,
    save_friction_table,
    sweep_friction,
)
from toothspace.films.journal.shaft_motion import (
    Orbit,
    OrbitSettings,
    critical_mass,
    shaft_orbit,
    threshold_speed,
)
from toothspace.films.journal.solution import JournalBearingSolution
from toothspace.films.plane.pad import Pad, PadSolution, Pocket
from toothspace.films.plane.ring import LateralFilm, LateralSolution
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.summaries import bearing_summary, grid_report, pad_summary
from toothspace.films.thermal import HeatBalance, HeatedFilm, solve_heated

__all__ = [
    "FilmFluid",
    "FrictionCurve",
    "FrictionSweep",
    "Groove",
    "HeatBalance",
    "HeatedFilm",
    "JournalBearing",
    "JournalBearingSolution",
    "LateralFilm",
    "LateralSolution",
    "Lobes",
    "Orbit",
    "OrbitSettings",
    "Pad",
    "PadSolution",
    "Pocket",
    "RoughSurfaces",
    "bearing_summary",
    "critical_mass",
    "film_dataset",
    "fit_friction_curve",
    "grid_report",
    "machine_bearing",
    "pad_summary",
    "save_film",
    "save_film_vtk",
    "save_friction_table",
    "shaft_orbit",
    "solve_heated",
    "sweep_friction",
    "threshold_speed",
]
