"""The tables ``[bearing]`` and ``[film]`` of a case: solved films and their numbers."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.case import Case
from toothspace.case.stand_alone import (
    FilmCase,
    FilmTable,
    JournalBearingCase,
    LateralFilmCase,
    PlaneFilmKeys,
    RingFilmCase,
    ShaftOrbit,
)
from toothspace.core.compiled import compile_seconds
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.films.field_files import FilmSolution, save_film, save_film_vtk
from toothspace.films.journal.bearing import JournalBearing
from toothspace.films.journal.geometry import Groove, Lobes
from toothspace.films.journal.shaft_motion import OrbitSettings, shaft_orbit
from toothspace.films.journal.solution import JournalBearingSolution
from toothspace.films.lateral.rigid_faces import FaceFilms, FaceSetting, solve_faces
from toothspace.films.plane.pad import Pad, Pocket
from toothspace.films.plane.ring import LateralFilm
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.reynolds.rough_surfaces import RoughSurfaces
from toothspace.films.summaries import (
    bearing_summary,
    faces_summary,
    heat_summary,
    orbit_summary,
    pad_summary,
    ring_summary,
)
from toothspace.films.thermal import Film, solve_heated
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.simulation.heating import film_heating, liquid_of

FILE_SUFFIXES: Mapping[str, Callable[[FilmSolution, Path], None]] = {
    ".nc": save_film,
    ".vts": save_film_vtk,
}
"""How the fields of a film are written, by the ending of the file."""


@final
@dataclass(frozen=True)
class CaseFilms:
    """Films of a case by name, and their numbers."""

    films: Mapping[str, FilmSolution]
    """Solved films; one without a name, or one per body."""
    summary: dict[str, Any]
    """Numbers with unit suffixes."""


def solve_bearing(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[bearing]`` of a case; see :func:`toothspace.api.solve_bearing`."""
    keys = case.bearing
    assert keys is not None
    return _solved(lambda: _solve_journal(case, keys), fields)


def solve_film(
    case: Case, machine: MachineDescription | None, fields: Path | None = None
) -> dict[str, Any]:
    """Solve the table ``[film]`` of a case; see :func:`toothspace.api.solve_film`.

    Parameters
    ----------
    case : Case
        Case with a ``film``.
    machine : MachineDescription or None
        Machine whose faces the film is on; None for a film without a machine.
    fields : Path, optional
        File for the fields.
    """
    return _solved(lambda: _solve(case, machine), fields)


def _solve(case: Case, machine: MachineDescription | None) -> CaseFilms:
    match case.film:
        case JournalBearingCase() as keys:
            return _solve_journal(case, keys)
        case FilmCase() as keys:
            return _solve_pad(case, keys)
        case RingFilmCase() as keys:
            return _solve_ring(case, keys)
        case LateralFilmCase() as keys:
            assert machine is not None
            return _solve_faces(case, keys, machine)
    raise AssertionError("a case with a film")


def _solved(solve: Callable[[], CaseFilms], fields: Path | None) -> dict[str, Any]:
    if fields is not None and fields.suffix.lower() not in FILE_SUFFIXES:
        allowed = ", ".join(FILE_SUFFIXES)
        raise CaseError(f"-o: found the ending {fields.suffix!r}, allowed {allowed}")
    started = time.perf_counter() - compile_seconds()
    found = solve()
    if fields is not None:
        for name, film in found.films.items():
            path = fields.with_stem(f"{fields.stem}_{name}") if name else fields
            FILE_SUFFIXES[fields.suffix.lower()](film, path)
    return {**found.summary, "wall_time_s": time.perf_counter() - compile_seconds() - started}


def _heated(
    case: Case, keys: FilmTable, solve: Callable[[float], Film], place: str = "film"
) -> tuple[Film, dict[str, Any]]:
    """Film at its viscosity, and the numbers of its heat balance if there is one."""
    if keys.heat is None:
        return solve(_viscosity(case, keys)), {}
    if case.fluid is None:
        raise CaseError(f"{place}.heat: found no fluid, allowed the viscosity of a table [fluid]")
    heating = film_heating(case, keys.heat.oil_share)
    try:
        heated = solve_heated(solve, heating.viscosity, heating.balance)
    except CaseError as error:
        if str(error).startswith("heat:"):
            raise CaseError(f"{place}.{error}") from error
        raise
    return heated.film, heat_summary(heated)


def _solve_journal(case: Case, keys: JournalBearingCase) -> CaseFilms:
    if keys.heat is not None and keys.orbit is not None:
        raise CaseError("bearing.heat: found an orbit, allowed a steady film")
    film, heat = _heated(
        case,
        keys,
        lambda viscosity: _journal_film(_bearing(keys, viscosity), keys),
        "bearing",
    )
    summary = bearing_summary(film) | heat
    if keys.orbit is not None:
        summary |= _orbit(film, keys.orbit, keys)
    return CaseFilms({"": film}, summary)


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
    summary = orbit_summary(found, film.bearing.radial_clearance)
    return {**summary, "status": status.name.lower()}


def _solve_pad(case: Case, keys: FilmCase) -> CaseFilms:
    film, heat = _heated(
        case,
        keys,
        lambda viscosity: _pad(keys, viscosity).solve(
            speed=keys.speed, squeeze_velocity=keys.squeeze_velocity
        ),
    )
    return CaseFilms({"": film}, pad_summary(film) | heat)


def _solve_ring(case: Case, keys: RingFilmCase) -> CaseFilms:
    film, heat = _heated(
        case,
        keys,
        lambda viscosity: _ring(keys, viscosity).solve(
            shaft_speed=keys.shaft_speed, squeeze_velocity=keys.squeeze_velocity
        ),
    )
    return CaseFilms({"": film}, ring_summary(film) | heat)


def _ring(keys: RingFilmCase, dynamic_viscosity: float) -> LateralFilm:
    return LateralFilm(
        inner_radius=keys.inner_radius,
        outer_radius=keys.outer_radius,
        side_gap=keys.side_gap,
        fluid=_film_fluid(keys, dynamic_viscosity),
        tilt=keys.tilt,
        grid=keys.grid,
        inner_pressure=keys.inner_pressure,
        outer_pressure=keys.outer_pressure,
        surfaces=_surfaces(keys),
        cavitation=keys.cavitation,
        cavitation_pressure=keys.cavitation_pressure,
    )


def _solve_faces(case: Case, keys: LateralFilmCase, machine: MachineDescription) -> CaseFilms:
    faces, heat = _heated(case, keys, lambda viscosity: _machine_faces(keys, machine, viscosity))
    films = dict(zip(faces.bodies, faces.films, strict=True))
    return CaseFilms(films, faces_summary(faces) | heat)


def _machine_faces(
    keys: LateralFilmCase, description: MachineDescription, dynamic_viscosity: float
) -> FaceFilms:
    condition = OperatingCondition(
        shaft_speed=keys.shaft_speed,
        inlet_pressure=keys.inlet_pressure,
        outlet_pressure=keys.outlet_pressure,
        drain_pressure=description.drain_pressure,
    )
    setting = FaceSetting(
        side_gap=keys.side_gap,
        fluid=_film_fluid(keys, dynamic_viscosity),
        tilt=keys.tilt,
        shaft_angle=keys.shaft_angle,
        surfaces=_surfaces(keys),
        cavitation=keys.cavitation,
        cavitation_pressure=keys.cavitation_pressure,
        grid=keys.grid,
    )
    return solve_faces(description, condition, setting)


def _film_fluid(keys: PlaneFilmKeys, dynamic_viscosity: float) -> FilmFluid:
    compressible = keys.density == "dowson_higginson"
    return FilmFluid(dynamic_viscosity, keys.pressure_viscosity, compressible)


def _surfaces(keys: FilmTable) -> RoughSurfaces | None:
    """Rough surfaces of a film table; the keys have the names of the parameters."""
    return None if keys.surfaces is None else RoughSurfaces(**vars(keys.surfaces))


def _pad(keys: FilmCase, dynamic_viscosity: float) -> Pad:
    pocket = None
    if keys.pocket is not None:
        p = keys.pocket
        pocket = Pocket(p.depth, p.x, p.length, p.width)
    return Pad(
        length=keys.length,
        width=keys.width,
        inlet_height=keys.inlet_height,
        outlet_height=keys.outlet_height,
        fluid=_film_fluid(keys, dynamic_viscosity),
        pocket=pocket,
        grid=keys.grid,
        cavitation=keys.cavitation,
        ambient_pressure=keys.ambient_pressure,
        cavitation_pressure=keys.cavitation_pressure,
        side_condition=keys.side_condition,
        surfaces=_surfaces(keys),
    )


def _bearing(keys: JournalBearingCase, dynamic_viscosity: float) -> JournalBearing:
    grooves = tuple(
        Groove(g.angle, g.width, g.length, g.pressure, g.position) for g in keys.grooves
    )
    return JournalBearing(
        diameter=keys.diameter,
        length=keys.length,
        radial_clearance=keys.radial_clearance,
        dynamic_viscosity=dynamic_viscosity,
        grid=keys.grid,
        cavitation=keys.cavitation,
        grooves=grooves,
        end_pressure=keys.end_pressure,
        cavitation_pressure=keys.cavitation_pressure,
        end_condition=keys.end_condition,
        surfaces=_surfaces(keys),
        lobes=None if keys.lobes is None else Lobes(**vars(keys.lobes)),
        supply=keys.supply,
        pressure_viscosity=keys.pressure_viscosity,
        compressible=keys.density == "dowson_higginson",
    )


def _viscosity(case: Case, keys: FilmTable) -> float:
    """Dynamic viscosity of a film table, or of the fluid of the case at its temperature. [Pa s]."""
    if keys.dynamic_viscosity is not None:
        return float(keys.dynamic_viscosity)
    if case.fluid is None:
        raise CaseError("dynamic_viscosity: found nothing, allowed are a viscosity or a [fluid]")
    return liquid_of(case).dynamic_viscosity
