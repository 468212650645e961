"""Gap of faces that deform locally under film and asperity pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined, kernel
from toothspace.core.types import Array, IntArray
from toothspace.films.reynolds.fluid import ReducedLaw, pressure_above
from toothspace.films.reynolds.rough_surfaces import ContactTable, contact_pressure
from toothspace.numerics.linear_system import TIGHT

_MOST_PASSES = 40
_SAME_GAP = 1e-15
"""Error of a gap between pressed faces. [m]"""
_MOST_HALVINGS = 80
"""Most steps to it."""


class Accuracy(NamedTuple):
    """When a film is done."""

    settled: float = 1e-7  # change of the gap by one pass over the gap [-]
    linear: float = TIGHT  # residual of one linear solution over its right-hand side [-]
    passes: int = _MOST_PASSES  # most passes; few where the force balance repeats them [-]


class LocalCompliance(NamedTuple):
    """How the faces deform."""

    compliance: float  # local approach over pressure [m/Pa]
    reference: float  # pressure without approach, above the cavitation pressure [Pa]
    contact: ContactTable
    roughness: float  # [m]
    frequency: float = 0.0  # inverse of the time in which the faces deform, 0 for steady [1/s]
    accuracy: Accuracy = Accuracy()


@inlined
def _contact_gap(base: float, start: float, how: LocalCompliance) -> tuple[float, float, float]:
    """Gap over which asperities hold faces apart, their pressure and its slope.

    Newton's method between bounds: asperities begin to carry so suddenly that its steps alone go
    back and forth over the edge of contact.
    """
    low, high, h = -np.inf, np.inf, max(base, start)
    p, slope = contact_pressure(h, how.roughness, how.contact)
    for _ in range(_MOST_HALVINGS):
        error = h - base - how.compliance * p
        if abs(error) < _SAME_GAP:
            break
        low, high = (h, high) if error < 0.0 else (low, h)
        h -= error / (1.0 - how.compliance * slope)
        if not low < h < high:
            h = 0.5 * (low + high)
        p, slope = contact_pressure(h, how.roughness, how.contact)
    return h, p, slope


@kernel
def settle_gap(
    kind: IntArray,
    values: Array,
    rigid: Array,
    walls: tuple[Array, Array],
    law: ReducedLaw,
    how: LocalCompliance,
    gap: Array,
    out: Array,
) -> None:
    """Gap of every cell under film and asperity pressure.

    Parameters
    ----------
    kind, values : ndarray
        Kinds of the cells, and their potential or saturation. [Pa or -]
    rigid : ndarray
        Undeformed gap. [m]
    walls : tuple of ndarray
        Pressure of prescribed cells above the lowest one, and an asperity pressure to begin with.
        [Pa, Pa]
    law : ReducedLaw
        Pressure over the potential.
    how : LocalCompliance
        How the faces deform.
    gap : ndarray
        Gap found. [m]
    out : ndarray, shape (4, rows, lanes)
        Asperity pressure, its slope, change of the gap over that of the undeformed one and over
        that of the potential. [Pa, Pa/m, -, m/Pa]
    """
    known, begun = walls
    rows, lanes = rigid.shape
    for i in range(rows):
        for j in range(lanes):
            if kind[i, j] == 2:
                gap[i, j] = rigid[i, j] + how.compliance * (known[i, j] - how.reference)
                out[0, i, j], out[1, i, j], out[2, i, j], out[3, i, j] = 0.0, 0.0, 1.0, 0.0
                continue
            potential = values[i * lanes + j] if kind[i, j] == 0 else 0.0
            pressure, stretch = pressure_above(potential, law)
            base = rigid[i, j] + how.compliance * (pressure - how.reference)
            start = base + how.compliance * begun[i, j]
            gap[i, j], out[0, i, j], out[1, i, j] = _contact_gap(base, start, how)
            out[2, i, j] = 1.0 / (1.0 - how.compliance * out[1, i, j])
            out[3, i, j] = how.compliance * out[2, i, j] * stretch
