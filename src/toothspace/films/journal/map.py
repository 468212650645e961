"""Journal bearing films solved on a grid, as the maps that the machine model reads.

With cavitation at the pressure of the ends, the force depends on the motion of the journal in
the frame that turns at half the shaft speed only and is proportional to it. Reynolds solutions
over eccentricity and direction of that motion are therefore a complete impedance.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.interpolate import RectBivariateSpline

from toothspace.closures.bearing_map import build_journal_map
from toothspace.closures.journal_friction import journal_pressure_torque, journal_shear_torque
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.journal.bearing import JournalBearing
from toothspace.model.description import SolvedJournal

_GRID = (120, 17)
"""Cells of the solved films, round and along. [-]"""
_GAP_STEPS = np.linspace(0.0, 4.5, 16)
"""Sampled -ln(1 - eccentricity ratio); the last is a ratio of 0.989. [-]"""
_DIRECTIONS = np.linspace(0.0, math.pi, 19)
_SHEAR_RANGE = 0.98
_LEAST = 1e-3


@lru_cache(maxsize=16)
def solved_journal(length_over_diameter: float, clearance_over_roughness: float) -> SolvedJournal:
    r"""Force map and shear of a journal bearing from solutions of the Reynolds equation.

    Map and shear table. [-]

    Parameters
    ----------
    length_over_diameter : float
        Bearing length over diameter. [-]
    clearance_over_roughness : float
        Radial clearance over the combined roughness; infinite for smooth walls. [-]

    Notes
    -----
    Solved and closed-form force :math:`W` are compared at 16 eccentricity ratios up to 0.989 and
    19 directions; the fine map of the closed form is scaled by the interpolated ratio of their
    lengths and turned by their angle, with the last ratio beyond. Force: Reynolds boundary
    condition, pressure flow factors of both rough walls. Shear: mass-conserving film at steady
    rotation, which does not shear the whole of its cavity. What the shear flow factor of
    unequal walls adds to the force is left out; it is below 1 % above three times the roughness.

    References
    ----------
    .. [1] J. F. Booker, Dynamically loaded journal bearings: mobility method of solution,
       J. Basic Eng. 87 (1965) 537-546.
    """
    # bearing of radius 1000 clearances and viscosity 1; pressures above the cavity's
    surfaces = None
    if math.isfinite(clearance_over_roughness):
        each = 1.0 / (clearance_over_roughness * math.sqrt(2.0))
        surfaces = RoughSurfaces(moving_roughness=each, resting_roughness=each, contact_law="none")
    bearing = JournalBearing(
        diameter=2e3,
        length=2e3 * length_over_diameter,
        radial_clearance=1.0,
        dynamic_viscosity=1.0,
        grid=_GRID,
        end_pressure=0.0,
        cavitation_pressure=0.0,
        cavitation="reynolds",
        surfaces=surfaces,
    )
    closed = build_journal_map(length_over_diameter)
    samples = np.array([[_force(bearing, t, a) for a in _DIRECTIONS] for t in _GAP_STEPS])
    # force of the closed form at the samples
    half = closed.nodes.shape[1] // 2 + 1
    angle = _turns(closed.nodes.shape[1])[:half]
    height = closed.logarithm_step * np.arange(closed.nodes.shape[0])
    parts = [
        RectBivariateSpline(height, angle, closed.nodes[:, :half, m, 0])(_GAP_STEPS, _DIRECTIONS)
        for m in range(2)
    ]
    reference = np.asarray((parts[0] + 1j * parts[1]) * np.exp(1.5 * _GAP_STEPS)[:, None])
    ratio = samples / reference
    ratio[:, 0] = ratio[:, 0].real
    ratio[:, -1] = ratio[:, -1].real
    nodes = _scaled(closed.nodes, closed.logarithm_step, ratio)
    ratios = np.linspace(0.0, _SHEAR_RANGE, 29)
    shear = np.array([_shear(bearing, e) for e in np.maximum(ratios, _LEAST)])
    return SolvedJournal(nodes, shear, _SHEAR_RANGE)


def _force(bearing: JournalBearing, gap_step: float, direction: float) -> complex:
    """Force along and across the eccentricity at unit speed of the journal, as a map has it."""
    ratio = max(-math.expm1(-gap_step), _LEAST)
    velocity = (math.cos(direction), math.sin(direction))
    film = bearing.solve(eccentricity=(ratio, 0.0), shaft_speed=0.0, velocity=velocity)
    scale = bearing.length * (0.5 * bearing.diameter / bearing.radial_clearance) ** 3
    return complex(film.force[0], film.force[1]) / scale


def _turns(count: int) -> Array:
    """Directions of the map's columns, 0 to 2 pi."""
    turn = 4.0 * np.arange(count) / count
    x = np.abs(turn - 2.0) - 1.0
    y = np.where(turn <= 2.0, 1.0 - np.abs(x), np.abs(x) - 1.0)
    return np.asarray(np.mod(np.arctan2(y, x), 2.0 * np.pi))


def _scaled(nodes: Array, step: float, ratio: Array) -> Array:
    """Map whose values and slopes follow the closed form times a complex ratio."""
    rows, columns = nodes.shape[:2]
    height = np.minimum(step * np.arange(rows), _GAP_STEPS[-1])
    angle = _turns(columns)
    mirrored = angle > np.pi
    place = np.where(mirrored, 2.0 * np.pi - angle, angle)
    logarithm = np.log(ratio)
    parts = (logarithm.real, logarithm.imag)
    size, turn = (
        RectBivariateSpline(_GAP_STEPS, _DIRECTIONS, part)(height, np.sort(place))[
            :, np.argsort(np.argsort(place))
        ]
        for part in parts
    )
    turn = np.where(mirrored, -turn, turn)
    values = (nodes[..., 0, 0] + 1j * nodes[..., 1, 0]) * np.exp(size + 1j * turn)
    mapped = np.empty((*values.shape, 2, 4))
    by_turn = 0.5 * (np.roll(values, -1, axis=1) - np.roll(values, 1, axis=1))
    of_nodes = (values, np.gradient(values, axis=0), by_turn, np.gradient(by_turn, axis=0))
    for k, part in enumerate(of_nodes):
        mapped[..., 0, k], mapped[..., 1, k] = part.real, part.imag
    return np.ascontiguousarray(mapped)


def _shear(bearing: JournalBearing, ratio: float) -> float:
    """Viscous shear of the steadily turning journal over that of a full film."""
    conserving = replace(bearing, cavitation="jfo")
    film = conserving.solve(eccentricity=(float(ratio), 0.0), shaft_speed=1.0)
    pull = journal_pressure_torque(ratio * bearing.radial_clearance, 0.0, *film.force)
    full = journal_shear_torque(
        ratio, 1.0, 1.0, 0.5 * bearing.diameter, bearing.length, bearing.radial_clearance
    )
    return float((-film.friction_torque - pull) / full)
