"""Gap of faces that deform locally under film and asperity pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined, kernel
from toothspace.core.types import Array
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
    rigid: Array, pressure: Array, film: Array, how: LocalCompliance, gap: Array, out: Array
) -> None:
    """Gap of every cell under film and asperity pressure; ``out`` holds contact, slope, share."""
    rows, lanes = rigid.shape
    for i in range(rows):
        for j in range(lanes):
            base = rigid[i, j] + how.compliance * (pressure[i, j] - how.reference)
            out[0, i, j], out[1, i, j], out[2, i, j] = 0.0, 0.0, 1.0
            if not film[i, j] or how.contact.value.size == 0:
                gap[i, j] = base
                continue
            gap[i, j], out[0, i, j], out[1, i, j] = _contact_gap(base, gap[i, j], how)
            out[2, i, j] = 1.0 / (1.0 - how.compliance * out[1, i, j])
