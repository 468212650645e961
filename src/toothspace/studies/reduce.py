"""Films of a machine, solved over their range and reduced to tables for the lumped preset."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
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
from toothspace.floating.reduction import (
    COLUMNS,
    LateralReduction,
    LoadedCondition,
    load_shares,
    loaded_condition,
    reduce_lateral,
)
from toothspace.model.description import MachineDescription
from toothspace.model.quasi_static import mean_force
from toothspace.run.elastic import lateral_settings
from toothspace.run.film_tables import JOURNAL_SIZES, KINDS, lateral_sizes
from toothspace.run.run import Marches, Run, provenance_of

LOAD_LEVELS = (1.0 / 30.0, 0.1, 1.0 / 3.0, 1.0, 3.0)
"""Loads of the sweeps over the mean load of the condition. [-]"""
SOMMERFELD_NUMBERS = (*np.geomspace(0.001, 0.2, 16), 2.0)
"""Points of the sweep; the last gives the line of the full film. [-]"""
Grid = tuple[Sequence[float], Sequence[float]]
"""Pressure differences [Pa] and shaft speeds [rad/s] of lateral films."""


def reduce_films(
    case: Case,
    kinds: Sequence[str] = (),
    progress: Progress | None = None,
    *,
    pressures: Sequence[float] = (),
    speeds: Sequence[float] = (),
) -> xr.Dataset:
    """Solve the films of a machine and reduce them to tables.

    Tables that ``run.film_tables`` reads; names begin with the kind of film.

    Raises CaseError if the case has no machine, or the machine no such film.

    Parameters
    ----------
    case : Case
        Case with a machine and a condition.
    kinds : sequence of str
        Kinds of films, names of :data:`REDUCED`; all that the machine has if empty.
    progress : callable, optional
        Called with the finished share and a short text.
    pressures, speeds : sequence of float
        Pressure differences [Pa] and shaft speeds [rad/s] at which lateral films are solved; those
        of the case if empty.
    """
    run = api.prepare(case)
    able = [kind for kind, found in REDUCED.items() if found.has(run.machine)]
    wanted = list(kinds) or able
    for kind in wanted or ["none"]:
        if kind not in able:
            allowed = ", ".join(able) or "a machine with journal bearings"
            raise CaseError("--film", f"{kind!r}", allowed)
    parts = []
    for k, kind in enumerate(wanted):
        own = part(progress, kind, k / len(wanted), (k + 1) / len(wanted))
        parts.append(REDUCED[kind].reduce(run, own, (pressures, speeds)))
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


def reduce_journals(run: Run, progress: Progress | None = None) -> xr.Dataset:
    """Friction of every journal bearing over load and Sommerfeld number.

    Sweeps, and the terms of :class:`FrictionCurve` that fit them, per body.

    Parameters
    ----------
    run : Run
        Machine, fluid and condition; the loads are shares of its mean pressure load.

    Notes
    -----
    Solved with mass-conserving cavitation, average flow and asperity contact of both rough
    walls. The load is that of quasi-static chamber pressures; the mesh force is part of it
    where the machine ties the bodies by a rigid mesh.
    """
    description = run.machine
    force = mean_force(description, run.condition)
    viscosity = float(run.fluid.dynamic_viscosity)
    sweeps: list[list[FrictionSweep]] = []
    loads: list[list[float]] = []
    for number, journal in enumerate(description.journals):
        tell(progress, number / len(description.journals), f"friction of {journal.body}")
        places = [description.motion_index(journal.body, axis) for axis in ("x", "y")]
        mean = float(np.hypot(*force[places])) / journal.count
        if not mean > 0.0:
            allowed = "a pressure difference that loads its bearings"
            raise CaseError("operating_point", f"no load on {journal.body}", allowed)
        bearing = machine_bearing(journal, viscosity)
        loads.append([part * mean for part in LOAD_LEVELS])
        sweeps.append(
            [
                sweep_friction(bearing, load=load, sommerfeld_numbers=SOMMERFELD_NUMBERS)
                for load in loads[-1]
            ]
        )
    return _journal_tables(description, sweeps, loads)


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


def reduce_lateral_films(
    run: Run, progress: Progress | None = None, grid: Grid = ((), ())
) -> xr.Dataset:
    """Torque and leakage beside the faces over load, pressure difference and shaft speed.

    Tables over ``lateral_force_share``, ``lateral_moment_share``, ``lateral_pressure_difference``
    and ``lateral_shaft_speed``. Opening forces that lift the bearing off its films at all of the
    others are left out.

    Raises CaseError if the case has no operating point.

    Parameters
    ----------
    run : Run
        Machine with a floating bearing, fluid and condition.
    grid : tuple of sequence of float, optional
        Pressure differences [Pa] and shaft speeds [rad/s]; those of the condition where empty.
    """
    case, balance = run.case, run.machine.lateral_balance
    assert balance is not None
    if case.operating_point is None:
        raise CaseError("--film", "lateral films", "with an [operating_point]")
    # the films of this machine are what is to be found
    bare = api.prepare(replace(case, run=replace(case.run, film_tables=None)))
    ready, at = bare.worn(progress).with_films(progress), run.condition
    inward = balance.high_node == run.machine.inlet_node
    high, low = (at.inlet_pressure, at.outlet_pressure)[:: 1 if inward else -1]
    grid = sorted(grid[0] or (high - low,)), sorted(grid[1] or (at.shaft_speed,))
    plain, fluid = ready.machine, run.fluid
    pairs = list(product(*grid))
    count = len(pairs)
    conditions: list[LoadedCondition] = []
    for number, (rise, speed) in enumerate(pairs):
        tell(
            progress, 0.5 * number / len(pairs), f"films and chambers, {number + 1} of {len(pairs)}"
        )
        inlet, outlet = (low + rise, low) if inward else (low, low + rise)
        condition = replace(at, shaft_speed=speed, inlet_pressure=inlet, outlet_pressure=outlet)
        march = Marches(replace(ready, condition=condition))
        conditions.append(loaded_condition(plain, fluid, march, lateral_settings(case)))
    shares = load_shares(conditions)
    found: list[LateralReduction] = []
    for number, loaded in enumerate(conditions):
        done = (0.5 + 0.5 * (number + k) / count for k in (0, 1))
        own = part(progress, f"loads, {number + 1} of {count}", *done)
        found.append(reduce_lateral(loaded, plain, fluid, shares, own))
    return _lateral_tables(run, grid, shares, found)


def _lateral_tables(
    run: Run, grid: Grid, shares: tuple[Array, Array], found: list[LateralReduction]
) -> xr.Dataset:
    over = (
        "lateral_force_share",
        "lateral_moment_share",
        "lateral_pressure_difference",
        "lateral_shaft_speed",
    )
    shape = tuple(map(len, grid))

    def laid(values: list[Any]) -> Array:
        """Values of all conditions, with pressure and speed last."""
        stacked = np.array(values)
        return np.moveaxis(stacked.reshape(*shape, *stacked.shape[1:]), (0, 1), (-2, -1))

    values: dict[str, Any] = {
        f"lateral_{name}": (over, laid([one.columns[name] for one in found]), _about(*text))
        for name, text in COLUMNS.items()
    }
    at = [one.condition for one in found]
    of_condition: dict[str, tuple[list[float], str, str]] = {
        "closed_torque": ([one.closed_torque for one in found], "N m", "Torque of the closed form"),
        "force_unit": ([c.force_unit for c in at], "N", "Force of share one"),
        "torque_unit": ([c.force_unit * c.reach for c in at], "N m", "Moment of share one"),
        "condition_force": ([c.load[0] for c in at], "N", "Axial force at the condition"),
        "condition_moment": ([c.load[1] for c in at], "N m", "Moment about x at the condition"),
    }
    for name, (numbers, units, text) in of_condition.items():
        values[f"lateral_{name}"] = (over[2:], laid(numbers), _about(units, text))
    for name, size in lateral_sizes(run.machine).items():
        units = "m" if name == "height" else "m2"
        values[f"lateral_{name}"] = ((), size, _about(units, name.replace("_", " ")))
    viscosity = float(run.fluid.dynamic_viscosity)
    values["lateral_viscosity"] = ((), viscosity, _about("Pa s", "Viscosity"))
    axes = {
        over[0]: (shares[0], "1", "Axial force, away from the faces, over force_unit"),
        over[1]: (shares[1], "1", "Moment about x over torque_unit"),
        over[2]: (grid[0], "Pa", "Pressure difference behind the bearing"),
        over[3]: (grid[1], "rad/s", "Shaft speed"),
    }
    tables = xr.Dataset(
        values, {name: (name, v, _about(unit, text)) for name, (v, unit, text) in axes.items()}
    )
    tables["lateral_extra_torque"] = tables["lateral_torque"] - tables["lateral_closed_torque"]
    tables["lateral_extra_torque"].attrs = _about("N m", "Torque beyond the closed form")
    return tables.isel(lateral_force_share=~tables["lateral_lifted"].all(over[1:]).values)


def _lateral_summary(tables: xr.Dataset) -> dict[str, Any]:
    """Ranges of the loads, the torques and the factors."""
    numbers: dict[str, Any] = {"lateral_points": int(tables["lateral_torque"].size)}
    for name, scale, label in (
        ("force_share", 1.0, "force_share"),
        ("moment_share", 1.0, "moment_share"),
        ("pressure_difference", 1e-5, "pressure_difference_bar"),
        ("shaft_speed", 30.0 / np.pi, "shaft_speed_rpm"),
        ("extra_torque", 1.0, "extra_torque_N_m"),
        ("pressure_torque", 1.0, "pressure_torque_N_m"),
        ("leakage_factor", 1.0, "leakage_factor"),
        ("lag", 1e3, "lag_ms"),
        ("condition_force", 1.0, "condition_force_N"),
    ):
        values = scale * tables[f"lateral_{name}"].values
        numbers[f"lateral_{label}"] = [float(np.nanmin(values)), float(np.nanmax(values))]
    return numbers


@final
@dataclass(frozen=True)
class ReducedFilm:
    """One kind of film: whether a machine has it, its tables, and their summary."""

    has: Callable[[MachineDescription], bool]
    reduce: Callable[[Run, Progress | None, Grid], xr.Dataset]
    summary: Callable[[xr.Dataset], dict[str, Any]]


REDUCED: Mapping[str, ReducedFilm] = {
    "journal": ReducedFilm(
        has=lambda description: bool(description.journals),
        reduce=lambda run, progress, _: reduce_journals(run, progress),
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
