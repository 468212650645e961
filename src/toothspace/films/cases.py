"""Stand-alone film cases: from their tables to solved films and named numbers."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.core.compiled import compile_seconds
from toothspace.core.errors import CaseError
from toothspace.core.registry import machine_type
from toothspace.core.status import Status
from toothspace.films.field_files import FilmSolution, save_film, save_film_vtk
from toothspace.films.film_fluid import FilmFluid
from toothspace.films.journal_bearing import JournalBearing
from toothspace.films.journal_film import Groove, Lobes
from toothspace.films.journal_solution import JournalBearingSolution
from toothspace.films.lateral import LateralFilm
from toothspace.films.machine_faces import FaceFilms, FaceSetting, solve_faces
from toothspace.films.pad import Pad, Pocket
from toothspace.films.rough_surfaces import RoughSurfaces
from toothspace.films.shaft_motion import OrbitSettings, shaft_orbit
from toothspace.films.summaries import (
    bearing_summary,
    faces_summary,
    heat_summary,
    orbit_summary,
    pad_summary,
    ring_summary,
)
from toothspace.films.thermal import (
    HIGHEST_RISE,
    Film,
    FilmHeating,
    HeatBalance,
    solve_heated,
)
from toothspace.model.fluid import LiquidState, library_liquid, table_liquid
from toothspace.model.operating_point import OperatingCondition

FILE_SUFFIXES: Mapping[str, Callable[[FilmSolution, Path], None]] = {
    ".nc": save_film,
    ".vts": save_film_vtk,
}
"""How the fields of a film are written, by the ending of the file."""
_FIFTIETH = 0.02
"""Accuracy of the highest temperature that a liquid is known at. [K]"""


@final
@dataclass(frozen=True)
class CaseFilms:
    """Films of a case by name, and their numbers."""

    films: Mapping[str, FilmSolution]
    """Solved films; one without a name, or one per body."""
    summary: dict[str, Any]
    """Numbers with unit suffixes."""


def solve_bearing(case: Any, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[bearing]`` of a case.

    Parameters
    ----------
    case : Case
        Case with a ``bearing`` in SI units.
    fields : Path, optional
        File for the fields, NetCDF (.nc) or VTK (.vts).

    Returns
    -------
    dict
        Numbers with unit suffixes; forces and torques act on the shaft by the film.
    """
    return _solved(lambda: _solve_journal(case, case.bearing), fields)


def solve_film(case: Any, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[film]`` of a case.

    Parameters
    ----------
    case : Case
        Case with a ``film`` in SI units.
    fields : Path, optional
        File for the fields, NetCDF (.nc) or VTK (.vts); one per body of a machine.

    Returns
    -------
    dict
        Numbers with unit suffixes; the load of a pad is that of the pressure above ambient.
    """
    return _solved(lambda: _SOLVERS[type(case.film).__name__](case, case.film), fields)


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


def lateral_heating(case: Any) -> FilmHeating | None:
    """How lateral films of a machine warm up, None where they keep the temperature of the fluid.

    Parameters
    ----------
    case : Case
        Case with a fluid and ``run.film_oil_share``.
    """
    share = case.run.film_oil_share
    return _heating(case, share) if share > 0.0 else None


def _heating(case: Any, oil_share: float) -> FilmHeating:
    liquid = _liquid(case)
    balance = HeatBalance(
        supply_temperature=case.fluid.temperature,
        density=liquid.density,
        heat_capacity=liquid.specific_heat_capacity,
        oil_share=oil_share,
        highest_temperature=_hottest(case),
    )
    return FilmHeating(balance, lambda temperature: _liquid(case, temperature).dynamic_viscosity)


def _heated(
    case: Any, keys: Any, solve: Callable[[float], Film], place: str = "film"
) -> tuple[Film, dict[str, Any]]:
    """Film at its viscosity, and the numbers of its heat balance if there is one."""
    if keys.heat is None:
        return solve(_viscosity(case, keys)), {}
    if case.fluid is None:
        raise CaseError(f"{place}.heat: found no fluid, allowed the viscosity of a table [fluid]")
    heating = _heating(case, keys.heat.oil_share)
    try:
        heated = solve_heated(solve, heating.viscosity, heating.balance)
    except CaseError as error:
        if str(error).startswith("heat:"):
            raise CaseError(f"{place}.{error}") from error
        raise
    return heated.film, heat_summary(heated)


def _hottest(case: Any) -> float:
    """Highest temperature that the liquid of a case is known at, within a fiftieth of a kelvin."""
    known, beyond = case.fluid.temperature, case.fluid.temperature + HIGHEST_RISE
    while beyond - known > _FIFTIETH:
        middle = 0.5 * (known + beyond)
        try:
            _liquid(case, middle)
        except CaseError:
            beyond = middle
        else:
            known = middle
    return float(known)


def _solve_journal(case: Any, keys: Any) -> CaseFilms:
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
        summary |= _orbit(film, keys)
    return CaseFilms({"": film}, summary)


def _journal_film(bearing: JournalBearing, keys: Any) -> JournalBearingSolution:
    if keys.load is not None:
        return bearing.equilibrium(
            load=tuple(keys.load),
            shaft_speed=keys.shaft_speed,
            bush_speed=keys.bush_speed,
            moment=None if keys.moment is None else tuple(keys.moment),
        )
    return bearing.solve(
        eccentricity=tuple(keys.eccentricity),
        shaft_speed=keys.shaft_speed,
        velocity=tuple(keys.velocity),
        tilt=tuple(keys.tilt),
        bush_speed=keys.bush_speed,
    )


def _orbit(film: JournalBearingSolution, keys: Any) -> dict[str, Any]:
    """Path of the shaft from the place and velocity of the case under load and unbalance."""
    orbit, speed = keys.orbit, keys.shaft_speed
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
            velocity=tuple(keys.velocity),
            duration=orbit.duration,
            time_step=orbit.time_step,
            film_memory=orbit.film_memory,
        ),
    )
    status = film.status if found.converged else Status.NOT_CONVERGED
    summary = orbit_summary(found, film.bearing.radial_clearance)
    return {**summary, "status": status.name.lower()}


def _solve_pad(case: Any, keys: Any) -> CaseFilms:
    film, heat = _heated(
        case,
        keys,
        lambda viscosity: _pad(keys, viscosity).solve(
            speed=keys.speed, squeeze_velocity=keys.squeeze_velocity
        ),
    )
    return CaseFilms({"": film}, pad_summary(film) | heat)


def _solve_ring(case: Any, keys: Any) -> CaseFilms:
    film, heat = _heated(
        case,
        keys,
        lambda viscosity: _ring(keys, viscosity).solve(
            shaft_speed=keys.shaft_speed, squeeze_velocity=keys.squeeze_velocity
        ),
    )
    return CaseFilms({"": film}, ring_summary(film) | heat)


def _ring(keys: Any, dynamic_viscosity: float) -> LateralFilm:
    return LateralFilm(
        inner_radius=keys.inner_radius,
        outer_radius=keys.outer_radius,
        side_gap=keys.side_gap,
        fluid=_film_fluid(keys, dynamic_viscosity),
        tilt=tuple(keys.tilt),
        grid=tuple(keys.grid),
        inner_pressure=keys.inner_pressure,
        outer_pressure=keys.outer_pressure,
        surfaces=_surfaces(keys),
        cavitation=keys.cavitation,
        cavitation_pressure=keys.cavitation_pressure,
    )


def _solve_faces(case: Any, keys: Any) -> CaseFilms:
    faces, heat = _heated(case, keys, lambda viscosity: _machine_faces(case, viscosity))
    films = dict(zip(faces.bodies, faces.films, strict=True))
    return CaseFilms(films, faces_summary(faces) | heat)


_SOLVERS: Mapping[str, Callable[[Any, Any], CaseFilms]] = {
    "FilmCase": _solve_pad,
    "LateralFilmCase": _solve_faces,
    "RingFilmCase": _solve_ring,
    "JournalBearingCase": _solve_journal,
}
"""Solvers by the class of the table, which a layer above declares."""


def _machine_faces(case: Any, dynamic_viscosity: float) -> FaceFilms:
    keys = case.film
    description = machine_type(case.machine_type).describe(case.machine_spec)
    condition = OperatingCondition(
        shaft_speed=keys.shaft_speed,
        inlet_pressure=keys.inlet_pressure,
        outlet_pressure=keys.outlet_pressure,
        drain_pressure=description.drain_pressure,
    )
    setting = FaceSetting(
        side_gap=keys.side_gap,
        fluid=_film_fluid(keys, dynamic_viscosity),
        tilt=tuple(keys.tilt),
        shaft_angle=keys.shaft_angle,
        surfaces=_surfaces(keys),
        cavitation=keys.cavitation,
        cavitation_pressure=keys.cavitation_pressure,
        grid=tuple(keys.grid),
    )
    return solve_faces(description, condition, setting)


def _film_fluid(keys: Any, dynamic_viscosity: float) -> FilmFluid:
    return FilmFluid(
        dynamic_viscosity,
        getattr(keys, "pressure_viscosity", 0.0),
        getattr(keys, "density", "constant") == "dowson_higginson",
    )


def _surfaces(keys: Any) -> RoughSurfaces | None:
    """Rough surfaces of a film table; the keys have the names of the parameters."""
    given = getattr(keys, "surfaces", None)
    return None if given is None else RoughSurfaces(**vars(given))


def _pad(keys: Any, dynamic_viscosity: float) -> Pad:
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
        grid=tuple(keys.grid),
        cavitation=keys.cavitation,
        ambient_pressure=keys.ambient_pressure,
        cavitation_pressure=keys.cavitation_pressure,
        side_condition=keys.side_condition,
        surfaces=_surfaces(keys),
    )


def _bearing(keys: Any, dynamic_viscosity: float) -> JournalBearing:
    grooves = tuple(
        Groove(g.angle, g.width, g.length, g.pressure, g.position) for g in keys.grooves
    )
    return JournalBearing(
        diameter=keys.diameter,
        length=keys.length,
        radial_clearance=keys.radial_clearance,
        dynamic_viscosity=dynamic_viscosity,
        grid=tuple(keys.grid),
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


def _viscosity(case: Any, keys: Any) -> float:
    """Dynamic viscosity of a film table, or of the fluid of the case at its temperature. [Pa s]."""
    if keys.dynamic_viscosity is not None:
        return float(keys.dynamic_viscosity)
    if case.fluid is None:
        raise CaseError("dynamic_viscosity: found nothing, allowed are a viscosity or a [fluid]")
    return _liquid(case).dynamic_viscosity


def _liquid(case: Any, temperature: float | None = None) -> LiquidState:
    given = case.fluid.temperature if temperature is None else temperature
    if case.fluid.table is not None:
        return table_liquid(case.fluid.table, given)
    return library_liquid(case.fluid.name, given)
