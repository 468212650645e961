"""Numbers of solved films under the names of the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from toothspace.films.journal.shaft_motion import Orbit, critical_mass
from toothspace.films.journal.solution import JournalBearingSolution
from toothspace.films.plane.pad import PadSolution
from toothspace.films.plane.ring import FaceFilms, LateralSolution
from toothspace.films.thermal import HeatedFilm

_LITRES_PER_MINUTE = 6e4
_PASCAL_PER_BAR = 1e5
_ZERO_CELSIUS = 273.15


def bearing_summary(film: JournalBearingSolution) -> dict[str, Any]:
    """Numbers of a journal film with unit suffixes."""
    # largest stable mass per bearing and the whirl there, none if every mass is stable
    mass, whirl = float("inf"), 0.0
    if np.trace(film.damping) > 0.0 and np.linalg.det(film.damping) > 0.0:
        mass, whirl = critical_mass(film.stiffness, film.damping)
    speed = abs(film.speed.shaft)
    found = np.isfinite(mass) and speed > 0.0
    if film.solved.mesh.weight > 1.0:
        tilted = {}
    else:
        stiffness, damping = film.coefficients()
        tilted = {"stiffness_4x4": stiffness.tolist(), "damping_4x4": damping.tolist()}
    return {
        "force_x_N": float(film.force[0]),
        "force_y_N": float(film.force[1]),
        "moment_x_N_m": float(film.moment[0]),
        "moment_y_N_m": float(film.moment[1]),
        "friction_torque_N_m": film.friction_torque,
        "bush_friction_torque_N_m": film.bush_friction_torque,
        "contact_friction_torque_N_m": film.contact_torque,
        "contact_load_N": float(np.hypot(*film.contact_force)),
        "power_loss_W": film.power_loss,
        "eccentricity_x": float(film.eccentricity[0]),
        "eccentricity_y": float(film.eccentricity[1]),
        "eccentricity_ratio": film.eccentricity_ratio,
        "attitude_angle_deg": float(np.degrees(film.attitude_angle)),
        "sommerfeld_number": _finite(film.sommerfeld_number),
        "sommerfeld_number_din": _finite(film.sommerfeld_number_din),
        "side_flow_L_per_min": film.side_flow * _LITRES_PER_MINUTE,
        "end_flow_L_per_min": (film.end_flow * _LITRES_PER_MINUTE).tolist(),
        "supply_flow_L_per_min": film.supply_flow * _LITRES_PER_MINUTE,
        "max_pressure_bar": film.max_pressure / _PASCAL_PER_BAR,
        "min_film_um": film.min_gap_height * 1e6,
        "cavitated_fraction": film.cavitated_fraction,
        "mass_balance_error": film.mass_balance_error,
        "stiffness_N_per_m": film.stiffness.tolist(),
        "damping_N_s_per_m": film.damping.tolist(),
        **tilted,
        **{
            "critical_mass_kg": _finite(mass),
            "whirl_frequency_ratio": whirl / speed if found else None,
        },
        "status": film.status.name.lower(),
    }


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
        "power_loss_W": sum(film.power_loss for film in films),
        "drain_flow_L_per_min": sum(film.inner_flow for film in films) * _LITRES_PER_MINUTE,
        "max_pressure_bar": max(film.max_pressure for film in films) / _PASCAL_PER_BAR,
        "min_film_um": float(min(film.gap_height.min() for film in films)) * 1e6,
        "contact_load_N": sum(film.contact_load for film in films),
        "cavitated_fraction": max(film.cavitated_fraction for film in films),
        "mass_balance_error": worst.mass_balance_error,
        "status": faces.status.name.lower(),
    }


def pad_summary(film: PadSolution) -> dict[str, Any]:
    """Numbers of a pad with unit suffixes."""
    return {
        "load_N": film.load,
        "center_of_pressure_x_mm": _finite(film.center_of_pressure * 1e3),
        "friction_N": film.friction,
        "resting_friction_N": film.resting_friction,
        "contact_friction_N": film.contact_friction,
        "contact_load_N": film.contact_load,
        "power_loss_W": film.power_loss,
        "max_pressure_bar": film.max_pressure / _PASCAL_PER_BAR,
        "inlet_flow_L_per_min": film.inlet_flow * _LITRES_PER_MINUTE,
        "outlet_flow_L_per_min": film.outlet_flow * _LITRES_PER_MINUTE,
        "side_flow_L_per_min": film.side_flow * _LITRES_PER_MINUTE,
        "cavitated_fraction": film.cavitated_fraction,
        "mass_balance_error": film.mass_balance_error,
        "pressure_centerline_bar": (film.pressure_centerline / _PASCAL_PER_BAR).tolist(),
        "status": film.status.name.lower(),
    }


def ring_summary(film: LateralSolution) -> dict[str, Any]:
    """Numbers of a ring or disc with unit suffixes; the load is that of the absolute pressure."""
    stiffness, damping = film.coefficients()
    return {
        "load_N": float(film.load[0]),
        "moment_x_N_m": float(film.load[1]),
        "moment_y_N_m": float(film.load[2]),
        "friction_torque_N_m": film.friction_torque,
        "resting_friction_torque_N_m": film.resting_friction_torque,
        "contact_friction_torque_N_m": film.contact_torque,
        "contact_load_N": film.contact_load,
        "power_loss_W": film.power_loss,
        "inner_flow_L_per_min": film.inner_flow * _LITRES_PER_MINUTE,
        "outer_flow_L_per_min": film.outer_flow * _LITRES_PER_MINUTE,
        "max_pressure_bar": film.max_pressure / _PASCAL_PER_BAR,
        "min_film_um": float(film.gap_height.min()) * 1e6,
        "cavitated_fraction": film.cavitated_fraction,
        "mass_balance_error": film.mass_balance_error,
        "stiffness": stiffness.tolist(),
        "damping": damping.tolist(),
        "status": film.status.name.lower(),
    }


def heat_summary(heated: HeatedFilm[Any]) -> dict[str, Any]:
    """Heat balance of a film with unit suffixes."""
    return {
        "mean_temperature_degC": heated.mean_temperature - _ZERO_CELSIUS,
        "outlet_temperature_degC": heated.outlet_temperature - _ZERO_CELSIUS,
        "dynamic_viscosity_Pa_s": heated.dynamic_viscosity,
        "dissipated_power_W": heated.film.dissipated_power,
        "outflow_L_per_min": heated.film.outflow * _LITRES_PER_MINUTE,
    }


def orbit_summary(orbit: Orbit, clearance: float) -> dict[str, Any]:
    """Path of the shaft over time with unit suffixes."""
    return {
        "time_s": orbit.time.tolist(),
        "orbit_x_um": (1e6 * orbit.position[:, 0]).tolist(),
        "orbit_y_um": (1e6 * orbit.position[:, 1]).tolist(),
        "orbit_force_x_N": orbit.force[:, 0].tolist(),
        "orbit_force_y_N": orbit.force[:, 1].tolist(),
        "orbit_max_eccentricity_ratio": float(np.hypot(*orbit.position.T).max() / clearance),
    }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


_CHECKS = frozenset({"mass_balance_error", "wall_time_s"})
"""Numbers that say how a solution went."""

Grid = tuple[int, int]


def grid_report(
    solve: Callable[[Grid], Mapping[str, Any]], grid: Grid, given: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Numbers of a film on half, once and twice its cells along each direction.

    Parameters
    ----------
    solve : callable
        Numbers by name for a grid.
    grid : tuple of int
        Grid of the film. [-]
    given : mapping, optional
        Numbers on that grid, if they are known already.

    Returns
    -------
    dict
        ``grids``, then for every number that is not zero on the finest grid its values ``half``,
        ``given`` and ``twice``, the ``order`` of their convergence (None where the differences
        do not fall), and the relative ``error`` of the given grid at the order 2 that films
        converge with, so 4/3 of its difference from the finest. [-]

    References
    ----------
    .. [1] P. J. Roache, Perspective: a method for uniform reporting of grid refinement studies,
       J. Fluids Eng. 116 (1994) 405-413.
    """
    rows, lanes = grid
    grids = (max(rows // 2, 1), max(lanes // 2, 1)), grid, (2 * rows, 2 * lanes)
    found = [solve(grids[0]), solve(grid) if given is None else given, solve(grids[2])]
    report: dict[str, Any] = {"grids": [list(cells) for cells in grids]}
    for name, value in found[2].items():
        if isinstance(value, float) and value != 0.0 and name not in _CHECKS:
            values = [numbers.get(name) for numbers in found]
            if all(isinstance(number, float) for number in values):
                half, once, twice = (float(number or 0.0) for number in values)
                coarse, fine = abs(once - half), abs(twice - once)
                report[name] = {
                    "half": half,
                    "given": once,
                    "twice": twice,
                    "order": float(np.log2(coarse / fine)) if coarse > fine > 0.0 else None,
                    "error": 4.0 / 3.0 * fine / abs(twice),
                }
    return report
