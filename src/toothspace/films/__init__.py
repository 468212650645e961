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
tilted_equilibrium  the same under a moment, free to tilt
mixed_lubrication   friction over speed and its reduction to a formula
film_tables         tables of reduced films in place of closed forms
shaft_motion        stability threshold and transient orbit
plane_film          films between nearly parallel faces on any grid
pad                 :class:`Pad`: rectangular pads with pocket or step
lateral             :class:`LateralFilm`: rings and discs, masked by given pressures
journal_map         impedance of journal films for the machine model
face_conductance    conductances of the film on a toothed face
solved_machine      machine whose closed-form films are replaced by solved ones
machine_faces       film on one face of every body of a machine
thermal             bulk heat balance of a film
field_files         NetCDF and VTK files of the fields
cases               ``[bearing]`` and ``[film]`` tables to solved films
summaries           solved films to named numbers
grid_report         how far these numbers depend on the grid
==================  ==========================================================
"""

from __future__ import annotations

from toothspace.closures.journal_friction import FrictionCurve
from toothspace.films.cases import solve_bearing, solve_film
from toothspace.films.field_files import film_dataset, save_film, save_film_vtk
from toothspace.films.film_fluid import FilmFluid
from toothspace.films.grid_report import grid_report
from toothspace.films.journal_bearing import JournalBearing
from toothspace.films.journal_film import Groove, Lobes
from toothspace.films.journal_solution import JournalBearingSolution
from toothspace.films.lateral import LateralFilm, LateralSolution
from toothspace.films.mixed_lubrication import (
    FrictionSweep,
    fit_friction_curve,
    machine_bearing,
    save_friction_table,
    sweep_friction,
)
from toothspace.films.pad import Pad, PadSolution, Pocket
from toothspace.films.rough_surfaces import RoughSurfaces
from toothspace.films.shaft_motion import (
    Orbit,
    OrbitSettings,
    critical_mass,
    shaft_orbit,
    threshold_speed,
)
from toothspace.films.summaries import bearing_summary, pad_summary
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
    "solve_bearing",
    "solve_film",
    "solve_heated",
    "sweep_friction",
    "threshold_speed",
]
