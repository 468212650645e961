"""Results of stand-alone film cases under the names of the command line."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.registry import machine_type
from toothspace.films.journal_bearing import JournalBearing
from toothspace.films.journal_film import Groove
from toothspace.films.journal_solution import JournalBearingSolution
from toothspace.films.machine_faces import FaceFilms, FaceSetting, solve_faces
from toothspace.films.pad import Pad, PadSolution, Pocket
from toothspace.films.plane_film import FilmFluid
from toothspace.films.rough_surfaces import RoughSurfaces
from toothspace.model.fluid import LiquidState, library_liquid, table_liquid
from toothspace.model.operating_point import OperatingCondition

_LITRES_PER_MINUTE = 6e4
_PASCAL_PER_BAR = 1e5


def solve_bearing(case: Any) -> dict[str, Any]:
    """Solve the table ``[bearing]`` of a case.

    Parameters
    ----------
    case : Case
        Case with a ``bearing`` in SI units.

    Returns
    -------
    dict
        Numbers with unit suffixes; forces and torques act on the shaft by the film.
    """
    started = time.perf_counter()
    keys = case.bearing
    bearing = _bearing(keys, _viscosity(case, keys))
    if keys.load is not None:
        film = bearing.equilibrium(load=tuple(keys.load), shaft_speed=keys.shaft_speed)
    else:
        film = bearing.solve(
            eccentricity=tuple(keys.eccentricity),
            shaft_speed=keys.shaft_speed,
            velocity=tuple(keys.velocity),
            tilt=tuple(keys.tilt),
        )
    return {**bearing_summary(film), "wall_time_s": time.perf_counter() - started}


def bearing_summary(film: JournalBearingSolution) -> dict[str, Any]:
    """Numbers of a journal film with unit suffixes."""
    return {
        "force_x_N": float(film.force[0]),
        "force_y_N": float(film.force[1]),
        "moment_x_N_m": float(film.moment[0]),
        "moment_y_N_m": float(film.moment[1]),
        "friction_torque_N_m": film.friction_torque,
        "bush_friction_torque_N_m": film.bush_friction_torque,
        "power_loss_W": film.power_loss,
        "eccentricity_x": float(film.eccentricity[0]),
        "eccentricity_y": float(film.eccentricity[1]),
        "eccentricity_ratio": film.eccentricity_ratio,
        "attitude_angle_deg": float(np.degrees(film.attitude_angle)),
        "sommerfeld_number": _finite(film.sommerfeld_number),
        "sommerfeld_number_din": _finite(film.sommerfeld_number_din),
        "side_flow_L_per_min": film.side_flow * _LITRES_PER_MINUTE,
        "supply_flow_L_per_min": film.supply_flow * _LITRES_PER_MINUTE,
        "max_pressure_bar": film.max_pressure / _PASCAL_PER_BAR,
        "min_film_um": film.min_gap_height * 1e6,
        "cavitated_fraction": film.cavitated_fraction,
        "mass_balance_error": film.mass_balance_error,
        "stiffness_N_per_m": film.stiffness.tolist(),
        "damping_N_s_per_m": film.damping.tolist(),
        "status": film.status.name.lower(),
    }


def solve_film(case: Any) -> dict[str, Any]:
    """Solve the table ``[film]`` of a case.

    Parameters
    ----------
    case : Case
        Case with a ``film`` in SI units.

    Returns
    -------
    dict
        Numbers with unit suffixes; the load is that of the pressure above ambient.
    """
    started = time.perf_counter()
    keys = case.film
    viscosity = _viscosity(case, keys)
    if hasattr(keys, "inlet_height"):
        summary = pad_summary(_pad(keys, viscosity).solve(speed=keys.speed))
    else:
        summary = faces_summary(_machine_faces(case, viscosity))
    return {**summary, "wall_time_s": time.perf_counter() - started}


def faces_summary(faces: FaceFilms) -> dict[str, Any]:
    """Numbers of the films on one face of a machine's bodies with unit suffixes."""
    films = faces.films
    load = faces.load
    worst = max(films, key=lambda film: film.mass_balance_error)
    each = zip(faces.bodies, films, strict=True)
    return {
        "load_N": float(load[0]),
        "moment_x_N_m": float(load[1]),
        "moment_y_N_m": float(load[2]),
        "friction_torque_N_m": {body: film.friction_torque for body, film in each},
        "drain_flow_L_per_min": sum(film.inner_flow for film in films) * _LITRES_PER_MINUTE,
        "max_pressure_bar": max(film.max_pressure for film in films) / _PASCAL_PER_BAR,
        "min_film_um": float(min(film.gap_height.min() for film in films)) * 1e6,
        "contact_load_N": float(
            sum((film.contact_pressure * film.plane.film.grid.area).sum() for film in films)
        ),
        "cavitated_fraction": max(film.cavitated_fraction for film in films),
        "mass_balance_error": worst.mass_balance_error,
        "status": min(films, key=lambda film: film.status.succeeded).status.name.lower(),
    }


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


def pad_summary(film: PadSolution) -> dict[str, Any]:
    """Numbers of a pad with unit suffixes."""
    return {
        "load_N": film.load,
        "center_of_pressure_x_mm": _finite(film.center_of_pressure * 1e3),
        "friction_N": film.friction,
        "max_pressure_bar": film.max_pressure / _PASCAL_PER_BAR,
        "inlet_flow_L_per_min": film.inlet_flow * _LITRES_PER_MINUTE,
        "outlet_flow_L_per_min": film.outlet_flow * _LITRES_PER_MINUTE,
        "side_flow_L_per_min": film.side_flow * _LITRES_PER_MINUTE,
        "cavitated_fraction": film.cavitated_fraction,
        "mass_balance_error": film.mass_balance_error,
        "pressure_centerline_bar": (film.pressure_centerline / _PASCAL_PER_BAR).tolist(),
        "status": film.status.name.lower(),
    }


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
        surfaces=_surfaces(keys),
    )


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _bearing(keys: Any, dynamic_viscosity: float) -> JournalBearing:
    grooves = tuple(Groove(g.angle, g.width, g.length, g.pressure) for g in keys.grooves)
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
        surfaces=_surfaces(keys),
    )


def _viscosity(case: Any, keys: Any) -> float:
    """Dynamic viscosity of a film table, or of the fluid of the case at its temperature. [Pa s]."""
    if keys.dynamic_viscosity is not None:
        return float(keys.dynamic_viscosity)
    if case.fluid is None:
        raise CaseError("dynamic_viscosity: found nothing, allowed are a viscosity or a [fluid]")
    return _liquid(case).dynamic_viscosity


def _liquid(case: Any) -> LiquidState:
    if case.fluid.table is not None:
        return table_liquid(case.fluid.table, case.fluid.temperature)
    return library_liquid(case.fluid.name, case.fluid.temperature)
