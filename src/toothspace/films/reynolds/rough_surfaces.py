"""Rough walls of a film: average flow, shear stress, asperity contact, boundary friction."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from toothspace.closures.contact_rough import (
    asperity_pressure,
    greenwood_tripp_pressure,
    kogut_etsion_pressure,
    mean_gap_ratio,
)
from toothspace.closures.flow_factors import (
    PatternColumns,
    contact_factor,
    contact_factor_slope,
    pattern_columns,
    pressure_flow_factor,
    pressure_stress_factor,
    shear_flow_factor,
    shear_stress_correction,
    shear_stress_factor,
)
from toothspace.core.compiled import inlined, njit
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces

SMALLEST_FLOW_GAP = 0.1
"""Gap over roughness below which the conductance is not reduced further (percolation). [-]"""


class FlowTable(NamedTuple):
    """Average flow over the gap ratio, uniform nodes: values and slopes with the gap ratio."""

    first: float
    step: float
    along: Array  # (nodes, 2) cube of the gap ratio times the pressure flow factor
    across: Array
    carried: Array  # (nodes, 2) carried height over the roughness
    squeeze: Array  # (nodes, 2) derivative of the mean gap by the nominal one


class FlowLaw(NamedTuple):
    """Average flow of a film; zero roughness means smooth walls."""

    roughness: float  # combined [m]
    along: PatternColumns  # pressure flow along the first index
    across: PatternColumns  # pressure flow along the second index
    moving: PatternColumns  # shear flow of the moving wall
    resting: PatternColumns
    moving_share: float  # variance of the moving wall over that of both [-]
    slide_ratio: float  # sliding over sum speed, 1 if one wall rests [-]
    table: FlowTable  # of the same law, no nodes for none


class ContactTable(NamedTuple):
    """Logarithm of the asperity pressure over the gap ratio, uniform nodes, and its slope."""

    first: float
    step: float
    value: Array
    slope: Array


_PLAIN = pattern_columns(1.0)
_NO_TABLE = FlowTable(SMALLEST_FLOW_GAP, 0.02, *(np.zeros((0, 2)) for _ in range(4)))
_TABLE_NODES = 500
DEEPEST = 3.0
"""Overlap of the mean planes over the roughness beyond which no law of contact holds. [-]"""
SMOOTH = FlowLaw(0.0, _PLAIN, _PLAIN, _PLAIN, _PLAIN, 0.5, 0.0, _NO_TABLE)
"""Smooth walls."""
NO_CONTACT = ContactTable(0.0, 1.0, np.zeros(0), np.zeros(0))
"""Walls that carry nothing by contact."""


@inlined
def conductance_law(gap: float, law: FlowLaw, columns: PatternColumns) -> tuple[float, float]:
    """Cube of the gap times the pressure flow factor, and its derivative. [m3, m2]."""
    if law.roughness == 0.0:
        return gap * gap * gap, 3.0 * gap * gap
    ratio = gap / law.roughness
    factor, slope = pressure_flow_factor(ratio, columns.pressure, columns.weight)
    if ratio < SMALLEST_FLOW_GAP:
        return factor * (SMALLEST_FLOW_GAP * law.roughness) ** 3, 0.0
    return factor * gap**3, slope / law.roughness * gap**3 + 3.0 * factor * gap * gap


@inlined
def carried_law(gap: float, law: FlowLaw) -> tuple[float, float]:
    """Mean gap that the moving walls carry along, and its derivative. [m, -]."""
    if law.roughness == 0.0:
        return gap, 1.0
    ratio = gap / law.roughness
    moving, moving_slope = shear_flow_factor(ratio, law.moving.shear, law.moving.weight)
    resting, resting_slope = shear_flow_factor(ratio, law.resting.shear, law.resting.weight)
    share = law.moving_share
    shear = law.slide_ratio * (share * moving - (1.0 - share) * resting)
    slope = law.slide_ratio * (share * moving_slope - (1.0 - share) * resting_slope)
    return law.roughness * (mean_gap_ratio(ratio) + shear), contact_factor(ratio) + slope


def mean_gap(gap: Array, law: FlowLaw) -> Array:
    """Mean gap of rough walls, the gap itself of smooth ones, of every cell. [m]."""
    out = np.empty_like(gap)
    fill_mean_gap(gap, law, out)
    return out


@njit
def fill_mean_gap(gap: Array, law: FlowLaw, out: Array) -> None:
    """Fill what :func:`mean_gap` gives."""
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            h = gap[i, j]
            out[i, j] = h
            if law.roughness > 0.0:
                out[i, j] = law.roughness * mean_gap_ratio(h / law.roughness)


@inlined
def tabulated(table: FlowTable, column: Array, ratio: float) -> tuple[float, float]:
    """Value and slope of a column at a gap ratio inside the table. [-]."""
    place = (ratio - table.first) / table.step
    k = int(place)
    t = place - k
    v0, v1 = column[k, 0], column[k + 1, 0]
    s0, s1 = column[k, 1] * table.step, column[k + 1, 1] * table.step
    c2, c3 = 3.0 * (v1 - v0) - 2.0 * s0 - s1, s0 + s1 - 2.0 * (v1 - v0)
    return v0 + t * (s0 + t * (c2 + t * c3)), (s0 + t * (2.0 * c2 + 3.0 * t * c3)) / table.step


@inlined
def tabulates(table: FlowTable, ratio: float) -> bool:
    """Whether a gap ratio lies inside the table."""
    return table.first <= ratio < table.first + table.step * (table.carried.shape[0] - 1)


@inlined
def squeeze_law(gap: float, law: FlowLaw) -> tuple[float, float]:
    """Derivative of the mean gap by the nominal gap, and the next derivative. [-, 1/m]."""
    if law.roughness == 0.0:
        return 1.0, 0.0
    ratio = gap / law.roughness
    return contact_factor(ratio), contact_factor_slope(ratio) / law.roughness


@inlined
def stress_factors(gap: float, law: FlowLaw) -> tuple[float, float]:
    """Sliding stress over viscosity and speed: mean, and difference of the two walls. [1/m]."""
    if law.roughness == 0.0:
        return 1.0 / gap, 0.0
    ratio = gap / law.roughness
    moving, resting = law.moving, law.resting
    share = law.moving_share
    pattern = share * shear_stress_correction(ratio, moving.stress_correction, moving.weight)
    pattern -= (1.0 - share) * shear_stress_correction(
        ratio, resting.stress_correction, resting.weight
    )
    return shear_stress_factor(ratio) / law.roughness, pattern / max(gap, 1e-3 * law.roughness)


@inlined
def pressure_stress(gap: float, law: FlowLaw) -> float:
    """Half the gap times the pressure stress factor. [m]."""
    if law.roughness == 0.0:
        return 0.5 * gap
    columns = law.along
    factor = pressure_stress_factor(gap / law.roughness, columns.pressure_stress, columns.weight)
    return 0.5 * max(gap, 0.0) * factor


def wall_stress(gap: Array, law: FlowLaw) -> tuple[Array, Array, Array]:
    """Parts of the shear stress on both walls of every cell: sliding, pattern, pressure.

    The moving wall is braked by viscosity times speed times the first less the second [1/m] plus
    the third times the pressure gradient along the motion [m]; the resting one is dragged along by
    the sum of the first two less the third.
    """
    mean, difference, half = np.empty_like(gap), np.empty_like(gap), np.empty_like(gap)
    fill_wall_stress(gap, law, mean, difference, half)
    return mean, difference, half


@njit
def fill_wall_stress(gap: Array, law: FlowLaw, mean: Array, difference: Array, half: Array) -> None:
    """Fill what :func:`wall_stress` gives."""
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            mean[i, j], difference[i, j] = stress_factors(gap[i, j], law)
            half[i, j] = pressure_stress(gap[i, j], law)


@inlined
def contact_pressure(gap: float, roughness: float, table: ContactTable) -> tuple[float, float]:
    """Asperity pressure at a nominal gap, and its derivative. [Pa, Pa/m]."""
    count = table.value.size
    if count == 0:
        return 0.0, 0.0
    inverse = 1.0 / (roughness * table.step)  # the same for all cells: divisions would take longest
    place = gap * inverse - table.first / table.step
    if place >= count - 1:
        return 0.0, 0.0
    k = max(int(place), 0) if place > 0.0 else 0
    t = place - k
    v0, v1 = table.value[k], table.value[k + 1]
    s0, s1 = table.slope[k] * table.step, table.slope[k + 1] * table.step
    if t < 0.0:
        logarithm, rise = v0 + s0 * t, s0
    else:
        c2, c3 = 3.0 * (v1 - v0) - 2.0 * s0 - s1, s0 + s1 - 2.0 * (v1 - v0)
        logarithm = v0 + t * (s0 + t * (c2 + t * c3))
        rise = s0 + t * (2.0 * c2 + 3.0 * t * c3)
    pressure = math.exp(logarithm)
    return pressure, pressure * rise * inverse


def contact_field(gap: Array, roughness: float, table: ContactTable) -> tuple[Array, Array]:
    """Asperity pressure of every cell, and its derivative with the gap. [Pa, Pa/m]."""
    pressure, slope = np.empty_like(gap), np.empty_like(gap)
    fill_contact(gap, roughness, table, pressure, slope)
    return pressure, slope


@njit
def fill_contact(
    gap: Array, roughness: float, table: ContactTable, pressure: Array, slope: Array
) -> None:
    """Fill what :func:`contact_field` gives."""
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            pressure[i, j], slope[i, j] = contact_pressure(gap[i, j], roughness, table)


def refuse_deep_contact(gap: Array, surfaces: RoughSurfaces | None, place: str) -> None:
    """Refuse walls that a given position presses into each other beyond any law of contact."""
    if surfaces is None:
        return
    lowest, allowed = float(gap.min()), -DEEPEST * surfaces.roughness
    if lowest < allowed:
        raise CaseError(
            place,
            f"a smallest gap of {1e6 * lowest:.3g} um",
            f"between these rough walls are gaps from {1e6 * allowed:.3g} um",
        )


@lru_cache(maxsize=64)
def flow_law(surfaces: RoughSurfaces, slide_ratio: float) -> FlowLaw:
    """Average flow for a ratio of sliding over sum speed.

    The pattern of the pressure flow is that of the walls weighted with their variances.
    """
    share = (surfaces.moving_roughness / surfaces.roughness) ** 2
    logarithm = share * math.log(surfaces.moving_pattern)
    logarithm += (1.0 - share) * math.log(surfaces.resting_pattern)
    law = FlowLaw(
        surfaces.roughness,
        pattern_columns(math.exp(logarithm)),
        pattern_columns(math.exp(-logarithm)),
        pattern_columns(surfaces.moving_pattern),
        pattern_columns(surfaces.resting_pattern),
        share,
        slide_ratio,
        _NO_TABLE,
    )
    # table that replaces powers and exponentials of the law where films are thin
    ratios = _NO_TABLE.first + _NO_TABLE.step * np.arange(_TABLE_NODES)
    # just above its first node the law no longer holds the gap
    gaps = np.maximum(ratios, _NO_TABLE.first * (1.0 + 1e-12)) * law.roughness
    unit = np.array([1.0 / law.roughness**3, 1.0 / law.roughness**2])
    cubes = [
        np.array([conductance_law(float(h), law, columns) for h in gaps]) * unit
        for columns in (law.along, law.across)
    ]
    carried = np.array([carried_law(float(h), law) for h in gaps])
    carried[:, 0] /= law.roughness
    squeeze = np.array([squeeze_law(float(h), law) for h in gaps])
    squeeze[:, 1] *= law.roughness
    return law._replace(
        table=_NO_TABLE._replace(along=cubes[0], across=cubes[1], carried=carried, squeeze=squeeze)
    )


def _elastic_plastic(s: RoughSurfaces, ratio: float) -> float:
    gap, modulus = ratio * s.roughness, s.effective_modulus
    return float(asperity_pressure(gap, s.roughness, s.correlation_length, modulus, s.hardness))


def _greenwood_tripp(s: RoughSurfaces, ratio: float) -> float:
    return greenwood_tripp_pressure(
        ratio, s.asperity_product, s.roughness_over_radius, s.effective_modulus
    )


def _kogut_etsion(s: RoughSurfaces, ratio: float) -> float:
    return kogut_etsion_pressure(
        ratio, s.roughness, s.correlation_length, s.effective_modulus, s.hardness
    )


def _user_table(s: RoughSurfaces, ratio: float) -> float:
    points = np.array(s.contact_points)
    gap, logarithm = points[:, 0], np.log(points[:, 1])
    if ratio > gap[-1]:
        return 0.0
    if ratio < gap[0]:
        slope = (logarithm[1] - logarithm[0]) / (gap[1] - gap[0])
        return float(np.exp(logarithm[0] + slope * (ratio - gap[0])))
    return float(np.exp(np.interp(ratio, gap, logarithm)))


_LAWS: dict[str, Callable[[RoughSurfaces, float], float] | None] = {
    "elastic_plastic": _elastic_plastic,
    "greenwood_tripp": _greenwood_tripp,
    "kogut_etsion": _kogut_etsion,
    "table": _user_table,
    "none": None,
}


@lru_cache(maxsize=32)
def contact_table(surfaces: RoughSurfaces) -> ContactTable:
    """Table of the asperity pressure."""
    law = _LAWS[surfaces.contact_law]
    if law is None:
        return NO_CONTACT
    nodes = np.linspace(-1.0, 5.0, 241)
    smallest = 1e-12 * surfaces.hardness
    value = np.log([max(law(surfaces, float(ratio)), smallest) for ratio in nodes])
    step = float(nodes[1] - nodes[0])
    return ContactTable(float(nodes[0]), step, value, np.gradient(value, step))
