"""The tables ``[bearing]`` and ``[film]`` of a case: solved films and their numbers."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from inspect import signature
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

import numpy as np

from toothspace.case import Case
from toothspace.case.stand_alone import (
    FilmCase,
    FilmKeys,
    JournalBearingCase,
    LateralFilmCase,
    RingFilmCase,
    ShaftOrbit,
)
from toothspace.core.compiled import compile_seconds
from toothspace.core.errors import CaseError
from toothspace.core.files import require_ending
from toothspace.core.status import Status
from toothspace.films import summaries
from toothspace.films.field_files import FilmSolution, save_film, save_film_vtk
from toothspace.films.journal.bearing import JournalBearing
from toothspace.films.journal.shaft_motion import OrbitSettings, shaft_orbit
from toothspace.films.journal.solution import JournalBearingSolution
from toothspace.films.plane.pad import Pad, PadSolution, Pocket
from toothspace.films.plane.ring import (
    FaceFilms,
    FaceSetting,
    LateralFilm,
    LateralSolution,
    solve_faces,
)
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.thermal import solve_heated
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.run.heating import film_heating, liquid_of

T = TypeVar("T")

FILE_SUFFIXES: Mapping[str, Callable[[FilmSolution, Path], None]] = {
    ".nc": save_film,
    ".vts": save_film_vtk,
}
"""How the fields of a film are written, by the ending of the file."""

_SUMMARIES: Mapping[type, Callable[[Any], dict[str, Any]]] = {
    JournalBearingSolution: summaries.bearing_summary,
    PadSolution: summaries.pad_summary,
    LateralSolution: summaries.ring_summary,
    FaceFilms: summaries.faces_summary,
}


def solve(
    case: Case,
    table: Literal["bearing", "film"],
    describe: Callable[[Case], MachineDescription],
    fields: Path | None,
) -> dict[str, Any]:
    """Solve the film of a table of a case; see :func:`toothspace.api.solve_film`.

    ``describe`` gives the machine of a case, for a film on its faces.
    """
    keys: FilmKeys | None = getattr(case, table)
    if keys is None:
        raise CaseError(table, "nothing", f"a table [{table}]").in_file(case.label)
    if fields is not None:
        require_ending(fields, "-o", tuple(FILE_SUFFIXES))
    started = time.perf_counter() - compile_seconds()
    # film at its viscosity, and the numbers of its heat balance if there is one
    solve = _film_at(case, keys, describe)
    if keys.heat is None:
        if keys.dynamic_viscosity is None and case.fluid is None:
            allowed = "allowed are a viscosity or a [fluid]"
            raise CaseError(f"dynamic_viscosity: found nothing, {allowed}")
        given = keys.dynamic_viscosity
        film, heat = solve(liquid_of(case).dynamic_viscosity if given is None else float(given)), {}
    else:
        if case.fluid is None:
            raise CaseError(f"{table}.heat", "no fluid", "the viscosity of a table [fluid]")
        heating = film_heating(case, keys.heat.oil_share)
        try:
            heated = solve_heated(solve, heating.viscosity, heating.balance)
        except CaseError as error:
            raise error.under(table if error.problems[0].key == "heat" else "") from error
        film, heat = heated.film, summaries.heat_summary(heated)
    summary = _SUMMARIES[type(film)](film) | heat
    if isinstance(keys, JournalBearingCase) and keys.orbit is not None:
        summary |= _orbit(cast(JournalBearingSolution, film), keys.orbit, keys)
    if fields is not None:
        faces = isinstance(film, FaceFilms)
        for name, one in zip(film.bodies, film.films, strict=True) if faces else [("", film)]:
            path = fields.with_stem(f"{fields.stem}_{name}") if name else fields
            FILE_SUFFIXES[fields.suffix.lower()](one, path)
    return {**summary, "wall_time_s": time.perf_counter() - compile_seconds() - started}


def _film_at(
    case: Case, keys: FilmKeys, describe: Callable[[Case], MachineDescription]
) -> Callable[[float], Any]:
    """Film of a table, or those of all bodies of a machine, at a viscosity [Pa s]."""
    match keys:
        case JournalBearingCase():
            if keys.heat is not None and keys.orbit is not None:
                raise CaseError("bearing.heat", "an orbit", "a steady film")
            return lambda mu: _journal_film(_made(JournalBearing, keys, mu), keys)
        case FilmCase():
            p = keys.pocket
            pocket = None if p is None else Pocket(p.depth, p.x, p.length, p.width)
            return lambda mu: _made(Pad, keys, mu, pocket=pocket).solve(
                speed=keys.speed, squeeze_velocity=keys.squeeze_velocity
            )
        case RingFilmCase():
            return lambda mu: _made(LateralFilm, keys, mu).solve(
                shaft_speed=keys.shaft_speed, squeeze_velocity=keys.squeeze_velocity
            )
        case _:
            assert isinstance(keys, LateralFilmCase)
            machine = describe(case)
            condition = OperatingCondition(
                shaft_speed=keys.shaft_speed,
                inlet_pressure=keys.inlet_pressure,
                outlet_pressure=keys.outlet_pressure,
                drain_pressure=machine.drain_pressure,
            )
            return lambda mu: solve_faces(machine, condition, _made(FaceSetting, keys, mu))


def _journal_film(bearing: JournalBearing, keys: JournalBearingCase) -> JournalBearingSolution:
    if keys.load is not None:
        return bearing.equilibrium(
            load=keys.load,
            shaft_speed=keys.shaft_speed,
            bush_speed=keys.bush_speed,
            moment=keys.moment,
        )
    assert keys.eccentricity is not None
    return bearing.solve(
        eccentricity=keys.eccentricity,
        shaft_speed=keys.shaft_speed,
        velocity=keys.velocity,
        tilt=keys.tilt,
        bush_speed=keys.bush_speed,
    )


def _orbit(
    film: JournalBearingSolution, orbit: ShaftOrbit, keys: JournalBearingCase
) -> dict[str, Any]:
    """Path of the shaft from the place and velocity of the case under load and unbalance."""
    speed = keys.shaft_speed
    load = np.zeros(2) if keys.load is None else np.asarray(keys.load)
    pull = orbit.unbalance * speed**2
    place = film.motion.place[:2]
    found = shaft_orbit(
        film.bearing,
        mass=orbit.mass,
        load=lambda t: (
            float(load[0] + pull * np.cos(speed * t)),
            float(load[1] + pull * np.sin(speed * t)),
        ),
        shaft_speed=speed,
        settings=OrbitSettings(
            position=(float(place[0]), float(place[1])),
            velocity=keys.velocity,
            duration=orbit.duration,
            time_step=orbit.time_step,
            film_memory=orbit.film_memory,
        ),
    )
    status = film.status if found.converged else Status.NOT_CONVERGED
    summary = summaries.orbit_summary(found, film.bearing.radial_clearance)
    return {**summary, "status": status.name.lower()}


def _made(of: Callable[..., T], keys: FilmKeys, dynamic_viscosity: float, **other: Any) -> T:
    """Film of a table: its keys have the names of the parameters."""
    known = set(signature(of).parameters)
    compressible = keys.density == "dowson_higginson"
    given = {
        **vars(keys),
        "dynamic_viscosity": dynamic_viscosity,
        "compressible": compressible,
        "fluid": FilmFluid(dynamic_viscosity, keys.pressure_viscosity, compressible),
        **other,
    }
    return of(**{name: value for name, value in given.items() if name in known})
