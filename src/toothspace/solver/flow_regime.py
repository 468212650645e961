"""Films and gaps whose flow is no longer laminar, as their formulas take it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.finding import Finding, beyond_too
from toothspace.core.types import Array
from toothspace.model.description import FlowPath
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.model.paths import by_kind
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.cyclic import History

LAMINAR_GAP = 2000.0
"""Reynolds number of a gap, with twice its height, up to which the flow is laminar. [-]"""

LAMINAR_BEARING = 41.2
"""Taylor number of a bearing from which vortices stand between the walls. [-]"""

_LOOKS = 180
_OPEN = 1e-6
"""Smallest width of a gap that is open. [m]"""


def gap_reynolds_number(mass_flow: Array, width: Array, viscosity: Array) -> Array:
    r"""Reynolds number of the flow in a gap.

    Parameters
    ----------
    mass_flow : ndarray
        Mass flow through the gap. [kg/s]
    width : ndarray
        Width across the flow. [m]
    viscosity : ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    ndarray
        With the hydraulic diameter, twice the height. [-]

    Notes
    -----
    .. math:: Re = \frac{\rho v\, 2 h}{\mu} = \frac{2 \dot m}{b \mu}

    Validity of the gap formulas: laminar, up to about 2000.

    References
    ----------
    .. [1] F. M. White, *Viscous Fluid Flow*, 3rd ed., McGraw-Hill, 2006, section 3-3.
    """
    return np.asarray(2.0 * np.abs(mass_flow) / (width * viscosity))


def taylor_number(
    density: float, speed: float, clearance: float, radius: float, viscosity: float
) -> float:
    r"""Taylor number of the flow between a journal and its bearing.

    Parameters
    ----------
    density : float
        Density. [kg/m3]
    speed : float
        Speed of the surface. [m/s]
    clearance : float
        Radial clearance. [m]
    radius : float
        Radius of the journal. [m]
    viscosity : float
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float
        Taylor number. [-]

    Notes
    -----
    .. math:: Ta = \frac{\rho U c}{\mu} \sqrt{\frac{c}{R}}

    Vortices stand between concentric walls from 41.2 on.

    References
    ----------
    .. [1] DIN 31652-1, Hydrodynamic plain journal bearings under steady-state conditions (limit
       of laminar flow); G. I. Taylor, Phil. Trans. R. Soc. A 223 (1923) 289-343.
    """
    return float(density * abs(speed) * clearance / viscosity * np.sqrt(clearance / radius))


@final
@dataclass(frozen=True)
class _Place:
    label: str
    number: float


def flow_regimes(history: History) -> Iterator[Finding]:
    """Say in which gaps and bearings of a revolution the flow is not laminar."""
    gaps = [place for place in _gaps(history) if place.number > LAMINAR_GAP]
    if gaps:
        yield _finding(gaps, "Reynolds number", LAMINAR_GAP, "the gaps")
    bearings = [place for place in _bearings(history) if place.number > LAMINAR_BEARING]
    if bearings:
        yield _finding(bearings, "Taylor number", LAMINAR_BEARING, "the journal bearings")


def _finding(places: list[_Place], number: str, limit: float, where: str) -> Finding:
    highest: dict[str, float] = {}
    for place in places:
        highest[place.label] = max(place.number, highest.get(place.label, 0.0))
    worst = max(highest, key=lambda label: highest[label])
    found = f"{highest[worst]:.3g} ({worst})"
    beside = beyond_too(highest, worst)
    return Finding(
        "warning",
        f"{number} reaches {found}{beside}; the formulas of {where} are those of laminar flow, "
        f"up to {limit:g}.",
        quantity=f"{number} of {where}",
        found=found,
        allowed=f"up to {limit:g}",
        advice="Turbulent films leak less and drag more: narrow the clearance, lower "
        "operating_point.shaft_speed or the pressure, or take thicker oil.",
    )


def _gaps(history: History) -> Iterator[_Place]:
    """Largest Reynolds number of every gap whose geometry is its own."""
    system = history.system
    states = np.ascontiguousarray(history.states[:: max(len(history.states) // _LOOKS, 1)])
    seen, first = observe(system.arrays, states), 0
    viscosity = np.sqrt(dynamic_viscosity(seen.pressure, system.arrays.fluid))
    # solved faces have conductances for widths
    solved = any(film.drag is not None for film in system.description.laterals)
    for path in by_kind(system.description.paths):
        members = slice(first, first + path.count)
        first += path.count
        # throats between flanks count the kinetic energy of their flow
        throat = path.kind == "orifice" or path.category.role == "mesh"
        if throat or (solved and path.category in LATERAL_PATHS):
            continue
        yield _Place(path.category.label, _of_path(path, states[:, 0], seen, viscosity, members))


def _of_path(
    path: FlowPath, angles: Array, seen: Observation, root: Array, members: slice
) -> float:
    at = path.phases + path.angle_ratio * angles[:, None]
    tables = path.own or (path.geometry,)
    if len(tables) == 1:
        width = tables[0](at)[..., 1]
    else:
        width = np.stack([table(at[:, k])[:, 1] for k, table in enumerate(tables)], axis=1)
    ends = np.take_along_axis(root, seen.path_partner[:, members], axis=1)
    viscosity = root[:, path.nodes_a] * ends * path.viscosity_ratio
    flow = np.where(width > _OPEN, seen.path_flow[:, members], 0.0)
    width = np.maximum(width, _OPEN) * path.multiplicity
    return float(gap_reynolds_number(flow, width, viscosity).max(initial=0.0))


def _bearings(history: History) -> Iterator[_Place]:
    """Taylor number of every journal bearing."""
    system = history.system
    fluid, speed = system.arrays.fluid, system.condition.shaft_speed
    drain = system.condition.drain_pressure
    viscosity = float(dynamic_viscosity(drain, fluid))
    ratios = {body.name: body.speed_ratio for body in system.description.bodies}
    for journal in system.description.journals:
        radius = 0.5 * journal.diameter
        number = taylor_number(
            fluid.reference_density,
            ratios[journal.body] * speed * radius,
            journal.radial_clearance,
            radius,
            viscosity * journal.viscosity_ratio,
        )
        yield _Place(journal.body.replace("_", " "), number)
