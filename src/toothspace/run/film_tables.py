"""Tables of reduced films: how a machine takes them in place of its closed forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace.closures.journal_friction import FrictionCurve, FrictionCurves
from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_table import LateralTable

if TYPE_CHECKING:
    import xarray as xr

KINDS = "film_kinds"
"""Attribute of the file that lists the kinds of films in it."""
JOURNAL_SIZES = ("diameter", "length", "radial_clearance")
_SAME_SIZE = 1e-6
_NEEDED = {
    "journal": ("friction_terms", "load", *JOURNAL_SIZES),
    "lateral": (
        "force_share",
        "moment_share",
        "pressure_difference",
        "shaft_speed",
        "torque",
        "pressure_torque",
        "asperity_torque",
        "leakage_factor",
        "lag",
        "converged",
        "closed_torque",
        "torque_unit",
        "viscosity",
    ),
}
"""Variables of every kind of film, without the name of the kind."""


def with_film_tables(
    description: MachineDescription, path: str | Path
) -> tuple[MachineDescription, tuple[str, ...]]:
    """Machine that takes its films from tables.

    Raises CaseError if the file holds no film tables, or those of another machine.

    Parameters
    ----------
    description : MachineDescription
        Machine with closed-form films.
    path : str or Path
        NetCDF file of ``toothspace reduce``.

    Returns
    -------
    MachineDescription
        The machine with every kind of film in the file replaced.
    tuple of str
        Interfaces that were replaced.
    """
    try:
        tables = read_dataset(path, "a NetCDF file of 'toothspace reduce'")
    except CaseError as error:
        raise error.read_for("run.film_tables") from error
    kinds = str(tables.attrs.get(KINDS, "")).split()
    if not kinds or not set(kinds) <= APPLIED.keys():
        found = f"{path} with {' '.join(kinds) or 'no films'}"
        raise CaseError("run.film_tables", found, f"tables of {', '.join(sorted(APPLIED))} films")
    for kind in kinds:
        missing = [name for name in _NEEDED[kind] if f"{kind}_{name}" not in tables]
        if missing:
            found = f"{path} without {kind}_{missing[0]}"
            allowed = "a file that this version's 'toothspace reduce' made"
            raise CaseError("run.film_tables", found, allowed)
        description = APPLIED[kind](description, tables)
    return description, tuple(kinds)


def with_journal_friction(
    description: MachineDescription, tables: xr.Dataset
) -> MachineDescription:
    """Machine whose journal bearings have the friction curves of tables."""
    known, journals = [str(name) for name in tables["journal"].values], []
    for journal in description.journals:
        if journal.body not in known:
            found = f"bearings of {', '.join(known)}"
            raise CaseError("run.film_tables", found, f"a table for {journal.body}")
        row = tables.sel(journal=journal.body)
        for name in JOURNAL_SIZES:
            given, size = float(row[f"journal_{name}"]), float(getattr(journal, name))
            if not np.isclose(given, size, rtol=_SAME_SIZE):
                raise CaseError(
                    "run.film_tables",
                    f"a bearing with {name} {given:.6g} m",
                    f"that of the case, {size:.6g} m",
                )
        journals.append(replace(journal, friction=friction_curves(row)))
    return replace(description, journals=tuple(journals))


def friction_curves(row: xr.Dataset) -> FrictionCurves:
    """Friction curves of one bearing of a table over its load."""
    terms = row["journal_friction_terms"].values
    return FrictionCurves(
        tuple(float(load) for load in row["journal_load"].values),
        tuple(FrictionCurve(*(float(term) for term in one)) for one in terms),
    )


def with_lateral_loads(description: MachineDescription, tables: xr.Dataset) -> MachineDescription:
    """Machine whose lateral films take drag and leakage from tables over axial loads.

    Raises CaseError if the machine has no floating bearing, or the tables are of another size.
    """
    balance = description.lateral_balance
    if balance is None:
        allowed = "a machine with a floating part in balance"
        raise CaseError("run.film_tables", "tables of lateral films", allowed)
    if description.parts_spaces:
        allowed = "teeth whose spaces are one chamber each"
        raise CaseError("run.film_tables", "tables of lateral films", allowed)
    for name, size in lateral_sizes(description).items():
        found = float(tables[f"lateral_{name}"])
        if not np.isclose(found, size, rtol=_SAME_SIZE):
            raise CaseError(
                "run.film_tables",
                f"lateral films with {name} {found:.6g} (SI units)",
                f"that of the case, {size:.6g}",
            )
    if not bool(tables["lateral_converged"].all()):
        raise CaseError("run.film_tables", "loads without an equilibrium", "none")
    own = {name: tables[f"lateral_{name}"] for name in _NEEDED["lateral"]}
    drag = own["pressure_torque"] - own["asperity_torque"]
    axes = ("force_share", "moment_share", "pressure_difference", "shaft_speed")
    over = [own[name].dims[0] for name in axes]
    values: dict[str, Any] = {
        "leakage_factor": own["leakage_factor"],
        "shear_share": (own["torque"] - own["pressure_torque"]) / own["closed_torque"],
        "drag_share": drag / own["torque_unit"],
        "asperity_share": own["asperity_torque"] / own["torque_unit"],
        "lag_number": own["lag"] * own["pressure_difference"] / own["viscosity"],
    }
    table = LateralTable(
        force_share=own["force_share"].values,
        moment_share=own["moment_share"].values,
        pressure=own["pressure_difference"].values,
        slide=(own["viscosity"] * own["shaft_speed"]).values,
        **{name: value.transpose(*over).values for name, value in values.items()},
    )
    return replace(description, lateral_table=table)


def lateral_sizes(description: MachineDescription) -> dict[str, float]:
    """Sizes that tables of lateral films belong to: areas [m2], closed-form height [m]."""
    balance = description.lateral_balance
    assert balance is not None
    return {
        "face_area": balance.floating.face.area,
        "high_pressure_area": balance.floating.high_pressure.area,
        "height": description.laterals[0].height,
    }


Applied = Callable[[MachineDescription, "xr.Dataset"], MachineDescription]
APPLIED: Mapping[str, Applied] = {"journal": with_journal_friction, "lateral": with_lateral_loads}
"""How each kind of film in a file enters the machine."""
