r"""Friction of a journal bearing from boundary to full film, and its reduction to a formula."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import final

import numpy as np
from scipy.optimize import least_squares

from toothspace.closures.journal_friction import (
    FULL_FILM_NUMBER,
    FrictionCurve,
    boundary_friction_term,
    film_friction_fit,
    sommerfeld_number,
)
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.journal.bearing import JournalBearing
from toothspace.model.description import LumpedJournalBearing


@final
@dataclass(frozen=True)
class FrictionSweep:
    """Friction over speed at one load, in the order of the given Sommerfeld numbers."""

    sommerfeld_number: Array
    """Load parameter S = (eta N / P) (R / c)^2. [-]"""
    shaft_speed: Array
    """Rotation of the shaft. [rad/s]"""
    friction_coefficient: Array
    """Friction torque on the shaft over load and radius. [-]"""
    contact_share: Array
    """Part of the load that asperities carry. [-]"""
    eccentricity_ratio: Array
    """Eccentricity over clearance. [-]"""
    converged: bool
    """Whether every equilibrium was found."""


def sweep_friction(
    bearing: JournalBearing, *, load: float, sommerfeld_numbers: Sequence[float]
) -> FrictionSweep:
    """Equilibrium and friction at one load over a range of speeds.

    Parameters
    ----------
    bearing : JournalBearing
        Bearing, with rough surfaces for mixed lubrication.
    load : float
        Load on the shaft. [N]
    sommerfeld_numbers : sequence of float
        Load parameters; every equilibrium starts from its faster neighbour. [-]

    Returns
    -------
    FrictionSweep
        Friction coefficient and contact share at every speed.
    """
    numbers = np.asarray(sommerfeld_numbers, dtype=float)
    # rotation at which a loaded bearing has given Sommerfeld numbers. [rad/s]
    at_unit_speed = sommerfeld_number(
        1.0,
        load,
        bearing.dynamic_viscosity,
        0.5 * bearing.diameter,
        bearing.length,
        bearing.radial_clearance,
    )
    speeds = np.asarray(numbers / at_unit_speed)
    rows = np.zeros((numbers.size, 3))
    start: tuple[float, float] | None = None
    converged = True
    for k in np.argsort(-numbers):
        film = bearing.equilibrium(load=(load, 0.0), shaft_speed=float(speeds[k]), start=start)
        x, y = film.eccentricity
        start = (float(x), float(y))
        friction = -film.friction_torque / (0.5 * bearing.diameter * load)
        rows[k] = friction, float(np.hypot(*film.contact_force)) / load, film.eccentricity_ratio
        converged = converged and film.status.succeeded
    return FrictionSweep(numbers, speeds, rows[:, 0], rows[:, 1], rows[:, 2], converged)


def machine_bearing(
    journal: LumpedJournalBearing, dynamic_viscosity: float, grid: tuple[int, int] = (144, 15)
) -> JournalBearing:
    """Film of a machine's journal bearing with its roughness, hardness and boundary friction.

    Parameters
    ----------
    journal : LumpedJournalBearing
        Bearing; its combined roughness is shared by both walls.
    dynamic_viscosity : float
        Dynamic viscosity. [Pa s]
    grid : tuple of int
        Cells round the circumference and along the axis. [-]
    """
    each = journal.roughness / 2.0**0.5
    return JournalBearing(
        diameter=journal.diameter,
        length=journal.length,
        radial_clearance=journal.radial_clearance,
        dynamic_viscosity=dynamic_viscosity,
        grid=grid,
        surfaces=RoughSurfaces(
            moving_roughness=each,
            resting_roughness=each,
            correlation_length=journal.correlation_length,
            effective_modulus=journal.effective_modulus,
            hardness=journal.hardness,
            boundary_friction=journal.boundary_friction,
        ),
    )


def save_friction_table(sweep: FrictionSweep, path: Path) -> FrictionCurve:
    """Write a sweep as a table of numbers with its fitted curve in the head; return the curve.

    Columns: Sommerfeld number, friction coefficient, share of the load that asperities carry,
    eccentricity ratio. [-]
    """
    curve = fit_friction_curve(sweep.sommerfeld_number, sweep.friction_coefficient)
    terms = ", ".join(f"{name} = {value:.6g}" for name, value in asdict(curve).items())
    head = f"friction = boundary exp(-S/decay) + rise tanh(S/transition) + offset: {terms}\n"
    head += "sommerfeld_number,friction_coefficient,contact_share,eccentricity_ratio"
    columns = (
        sweep.sommerfeld_number,
        sweep.friction_coefficient,
        sweep.contact_share,
        sweep.eccentricity_ratio,
    )
    np.savetxt(path, np.column_stack(columns), "%.6g", ",", header=head)
    return curve


def fit_friction_curve(sommerfeld_number: Array, friction_coefficient: Array) -> FrictionCurve:
    """Fit the formula of :class:`FrictionCurve` by least squares of the logarithm.

    Parameters
    ----------
    sommerfeld_number : ndarray
        Load parameter S; at least six up to 0.5. [-]
    friction_coefficient : ndarray
        Friction coefficient there, positive. [-]

    Returns
    -------
    FrictionCurve
        Curve with positive coefficients. Points beyond S = 0.5 give the line of the full film;
        without them it goes through the fit at 0.5.
    """
    fitted = sommerfeld_number <= FULL_FILM_NUMBER
    numbers, target = sommerfeld_number[fitted], np.log(friction_coefficient[fitted])

    def mismatch(logarithms: Array) -> Array:
        boundary, decay, rise, transition, offset = np.exp(logarithms)
        fit = boundary_friction_term(numbers, boundary, decay)
        fit = fit + film_friction_fit(numbers, rise, transition, offset)
        return np.asarray(np.log(fit) - target)

    first = np.log([float(friction_coefficient[fitted].max()), 0.003, 0.02, 1.0, 5e-4])
    bounds = (np.log([1e-4, 1e-5, 1e-4, 0.05, 1e-7]), np.log([1.0, 0.1, 10.0, 100.0, 0.1]))
    found = least_squares(mismatch, first, bounds=bounds, x_scale=1.0, max_nfev=2000)
    boundary, decay, rise, transition, offset = (float(value) for value in np.exp(found.x))
    line = film_friction_fit(FULL_FILM_NUMBER, rise, transition, offset) / FULL_FILM_NUMBER
    if not fitted.all():
        line = (friction_coefficient[~fitted] / sommerfeld_number[~fitted]).mean()
    return FrictionCurve(boundary, decay, rise, transition, offset, float(line))
