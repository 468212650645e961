"""Films of a machine, solved over their range and reduced to tables for the lumped preset."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, final

import numpy as np
import xarray as xr

from toothspace import api
from toothspace.case import Case
from toothspace.closures.journal_friction import FrictionCurve
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress, part, tell
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.journal.mixed_lubrication import (
    FrictionSweep,
    fit_friction_curve,
    machine_bearing,
    sweep_friction,
)
from toothspace.model.description import LumpedJournalBearing, MachineDescription
from toothspace.model.quasi_static import mean_force
from toothspace.simulation.elastic import lateral_settings
from toothspace.simulation.film_tables import JOURNAL_SIZES, KINDS, lateral_sizes
from toothspace.simulation.lateral.reduction import reduce_lateral
from toothspace.simulation.lumped import run_in_machine
from toothspace.simulation.setup import Setup, provenance_of

LOAD_LEVELS = (1.0 / 30.0, 0.1, 1.0 / 3.0, 1.0, 3.0)
"""Loads of the sweeps over the mean load of the condition. [-]"""
SOMMERFELD_NUMBERS = (*np.geomspace(0.001, 0.2, 16), 2.0)
"""Points of the sweep; the last gives the line of the full film. [-]"""


def reduce_films(
    case: Case, kinds: Sequence[str] = (), progress: Progress | None = None
) -> xr.Dataset:
    """Solve the films of a machine and reduce them to tables.

    Parameters
    ----------
    case : Case
        Case with a machine and a condition.
    kinds : sequence of str
        Kinds of films, names of :data:`REDUCED`; all that the machine has if empty.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    xarray.Dataset
        Tables that ``run.film_tables`` reads; names begin with the kind of film.

    Raises
    ------
    CaseError
        If the case has no machine, or the machine no such film.
    """
    setup = api.set_up(case)
    able = [kind for kind, found in REDUCED.items() if found.has(setup.description)]
    wanted = list(kinds) or able
    for kind in wanted or ["none"]:
        if kind not in able:
            allowed = ", ".join(able) or "a machine with journal bearings"
            raise CaseError(f"--film: found {kind!r}, allowed {allowed}")
    parts = []
    for k, kind in enumerate(wanted):
        own = part(progress, kind, k / len(wanted), (k + 1) / len(wanted))
        parts.append(REDUCED[kind].reduce(setup, own))
    tables = xr.merge(parts, join="exact", compat="no_conflicts", combine_attrs="drop_conflicts")
    tables.attrs |= {KINDS: " ".join(wanted), **provenance_of(case)}
    return tables


def reduce_summary(tables: xr.Dataset) -> dict[str, Any]:
    """Numbers of tables with unit suffixes, for the command line."""
    kinds = str(tables.attrs[KINDS]).split()
    numbers: dict[str, Any] = {"films": kinds}
    for kind in kinds:
        numbers |= REDUCED[kind].summary(tables)
    done = all(bool(tables[f"{kind}_converged"].all()) for kind in kinds)
    numbers["status"] = (Status.DONE if done else Status.NOT_CONVERGED).name.lower()
    return numbers


def reduce_journals(setup: Setup, progress: Progress | None = None) -> xr.Dataset:
    """Friction of every journal bearing over load and Sommerfeld number.

    Parameters
    ----------
    setup : Setup
        Machine, fluid and condition; the loads are shares of its mean pressure load.

    Returns
    -------
    xarray.Dataset
        Sweeps, and the terms of :class:`FrictionCurve` that fit them, per body.

    Notes
    -----
    Solved with mass-conserving cavitation, average flow and asperity contact of both rough
    walls. The load is that of quasi-static chamber pressures; the mesh force is part of it
    where the machine ties the bodies by a rigid mesh.
    """
    description = setup.description
    force = mean_force(description, setup.condition)
    viscosity = float(setup.fluid.dynamic_viscosity)
    sweeps: list[list[FrictionSweep]] = []
    loads: list[list[float]] = []
    for number, journal in enumerate(description.journals):
        tell(progress, number / len(description.journals), f"friction of {journal.body}")
        mean = _load_of(description, journal, force)
        bearing = machine_bearing(journal, viscosity)
        loads.append([part * mean for part in LOAD_LEVELS])
        sweeps.append(
            [
                sweep_friction(bearing, load=load, sommerfeld_numbers=SOMMERFELD_NUMBERS)
                for load in loads[-1]
            ]
        )
    return _journal_tables(description, sweeps, loads)


def _load_of(description: MachineDescription, journal: LumpedJournalBearing, force: Array) -> float:
    """Mean load on one bearing. [N]."""
    places = [description.motion_index(journal.body, axis) for axis in ("x", "y")]
    load = float(np.hypot(*force[places])) / journal.count
    if not load > 0.0:
        allowed = "a pressure difference that loads its bearings"
        raise CaseError(f"operating_point: found no load on {journal.body}, allowed {allowed}")
    return load


def _journal_tables(
    description: MachineDescription, sweeps: list[list[FrictionSweep]], loads: list[list[float]]
) -> xr.Dataset:
    over = ("journal", "journal_load_level", "journal_point")
    columns = {
        "sommerfeld_number": "Load parameter (eta N / P) (R / c)^2",
        "friction_coefficient": "Friction torque over load and radius",
        "contact_share": "Part of the load that asperities carry",
        "eccentricity_ratio": "Eccentricity over clearance",
    }
    values: dict[str, Any] = {
        f"journal_{name}": (over, _of_sweeps(sweeps, name), _about("1", text))
        for name, text in columns.items()
    }
    values["journal_converged"] = (
        over[:2],
        _of_sweeps(sweeps, "converged"),
        _about("1", "All equilibria found"),
    )
    values["journal_load"] = (over[:2], loads, _about("N", "Load on one bearing"))
    values["journal_friction_terms"] = (
        (*over[:2], "friction_term"),
        [
            [fit_friction_curve(s.sommerfeld_number, s.friction_coefficient).terms for s in row]
            for row in sweeps
        ],
        _about("1", "boundary exp(-S/decay) + rise tanh(S/transition) + offset; line S beyond"),
    )
    for name in JOURNAL_SIZES:
        sizes = [getattr(journal, name) for journal in description.journals]
        values[f"journal_{name}"] = ("journal", sizes, _about("m", name.replace("_", " ")))
    names = [f.name for f in fields(FrictionCurve)]
    bodies = [journal.body for journal in description.journals]
    levels = ("journal_load_level", list(LOAD_LEVELS), _about("1", "Load over that of the case"))
    return xr.Dataset(
        values, {"journal": bodies, "journal_load_level": levels, "friction_term": names}
    )


def _of_sweeps(sweeps: list[list[FrictionSweep]], name: str) -> Array:
    return np.array([[getattr(sweep, name) for sweep in row] for row in sweeps])


def _about(units: str, meaning: str) -> dict[str, str]:
    return {"units": units, "long_name": meaning}


def _journal_summary(tables: xr.Dataset) -> dict[str, Any]:
    """Curve of each body at the load of the case: terms, level at rest, minimum and slope."""
    numbers: dict[str, Any] = {}
    for body in tables["journal"].values:
        loads = tables["journal_load"].sel(journal=body).values
        row = tables.sel(journal=body).sel(journal_load_level=1.0, method="nearest")
        curve = FrictionCurve(*(float(term) for term in row["journal_friction_terms"].values))
        number, friction = curve.minimum()
        numbers[f"{body}_load_N"] = float(row["journal_load"])
        numbers[f"{body}_loads_N"] = [float(load) for load in loads]
        numbers[f"{body}_friction_terms"] = list(curve.terms)
        numbers[f"{body}_boundary_friction"] = curve.boundary_level
        numbers[f"{body}_lowest_friction"] = friction
        numbers[f"{body}_lowest_at_sommerfeld_number"] = number
        numbers[f"{body}_full_film_slope"] = curve.full_film_slope()
    return numbers


def reduce_lateral_films(setup: Setup, progress: Progress | None = None) -> xr.Dataset:
    """Torque and leakage beside the gears over force and moment on the floating bearing.

    Parameters
    ----------
    setup : Setup
        Machine with a floating bearing, fluid and condition.

    Returns
    -------
    xarray.Dataset
        Tables over ``lateral_force`` and ``lateral_moment``.
    """
    case = setup.case
    # the films of this machine are what is to be found
    machine = run_in_machine(
        api.set_up(replace(case, run=replace(case.run, film_tables=None))), progress
    )
    found = reduce_lateral(
        machine.description,
        setup.fluid,
        lambda changed: machine.solve(setup.condition, changed),
        lateral_settings(case),
        progress,
    )
    over = ("lateral_force", "lateral_moment")
    columns = {
        "torque": ("N m", "Torque of the lateral films at the shaft"),
        "extra_torque": ("N m", "Torque beyond the closed form"),
        "pressure_torque": ("N m", "Part of the torque that viscosity and speed do not change"),
        "leakage_factor": ("1", "Leakage over that of the closed form"),
        "smallest_gap": ("m", "Smallest gap"),
        "converged": ("1", "Whether the bearing is in equilibrium"),
    }
    values: dict[str, Any] = {
        f"lateral_{name}": (over, getattr(found, name), _about(*text))
        for name, text in columns.items()
    }
    for name, size in lateral_sizes(setup.description).items():
        units = "m" if name == "height" else "m2"
        values[f"lateral_{name}"] = ((), size, _about(units, name.replace("_", " ")))
    viscosity = float(setup.fluid.dynamic_viscosity)
    scalars = {
        "viscosity": (viscosity, "Pa s", "Viscosity"),
        "shaft_speed": (setup.condition.shaft_speed, "rad/s", "Shaft speed"),
        "closed_torque": (found.closed_torque, "N m", "Torque of the closed form"),
        "condition_force": (found.load[0], "N", "Axial force at the condition"),
        "condition_moment": (found.load[1], "N m", "Moment about x at the condition"),
    }
    for name, (value, units, text) in scalars.items():
        values[f"lateral_{name}"] = ((), value, _about(units, text))
    force = ("lateral_force", found.force, _about("N", "Axial force, away from the gears"))
    moment = ("lateral_moment", found.moment, _about("N m", "Moment about x on the bearing"))
    return xr.Dataset(values, {"lateral_force": force, "lateral_moment": moment})


def _lateral_summary(tables: xr.Dataset) -> dict[str, Any]:
    """Ranges of the loads, the torques and the factors."""
    numbers: dict[str, Any] = {"lateral_points": int(tables["lateral_torque"].size)}
    for name, unit in (
        ("force", "N"),
        ("moment", "N_m"),
        ("extra_torque", "N_m"),
        ("pressure_torque", "N_m"),
        ("leakage_factor", ""),
    ):
        values = tables[f"lateral_{name}"].values
        label = f"lateral_{name}_{unit}" if unit else f"lateral_{name}"
        numbers[label] = [float(np.nanmin(values)), float(np.nanmax(values))]
    numbers["lateral_condition_force_N"] = float(tables["lateral_condition_force"])
    return numbers


@final
@dataclass(frozen=True)
class ReducedFilm:
    """One kind of film: whether a machine has it, its tables, and their summary."""

    has: Callable[[MachineDescription], bool]
    reduce: Callable[[Setup, Progress | None], xr.Dataset]
    summary: Callable[[xr.Dataset], dict[str, Any]]


REDUCED: Mapping[str, ReducedFilm] = {
    "journal": ReducedFilm(
        has=lambda description: bool(description.journals),
        reduce=reduce_journals,
        summary=_journal_summary,
    ),
    "lateral": ReducedFilm(
        has=lambda description: description.lateral_balance is not None,
        reduce=reduce_lateral_films,
        summary=_lateral_summary,
    ),
}
"""Kinds of films by name; each has its counterpart in ``films.film_tables.APPLIED``.

The names in the tables of a kind begin with it, and ``<kind>_converged`` is among them.
"""
