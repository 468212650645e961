"""Roots of functions of one variable between two places."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from toothspace.core.types import Array

_ROUNDING = 4.0 * 2.0**-52
_MOST_STEPS = 200


def root_between(
    function: Callable[[float], float], low: float, high: float, tolerance: float = 2e-12
) -> float:
    """Find where a function changes its sign: inverse quadratic steps kept by bisection.

    Raises ValueError if both ends have the same sign.

    Parameters
    ----------
    function : callable
        Continuous, of opposite sign at both ends.
    low, high : float
        Ends.
    tolerance : float
        Allowed distance to the root, beside rounding. [unit of the ends]

    Notes
    -----
    Validity: one change of sign; of several any may be found.

    References
    ----------
    Chandrupatla, Advances in Engineering Software 28 (1997) 145-149.
    """
    before, place = float(high), float(low)
    value_before, value = function(before), function(place)
    if value == 0.0 or value_before == 0.0:
        return place if value == 0.0 else before
    if value * value_before > 0.0:
        raise ValueError(f"the function has one sign at {low:g} and {high:g}")
    share = 0.5
    for _ in range(_MOST_STEPS):
        trial = place + share * (before - place)
        found = function(trial)
        if (found > 0.0) == (value > 0.0):
            last, value_last = place, value
        else:
            last, value_last = before, value_before
            before, value_before = place, value
        place, value = trial, found
        best = place if abs(value) < abs(value_before) else before
        smallest = (0.5 * tolerance + _ROUNDING * abs(best)) / abs(before - place)
        if smallest > 0.5 or value == 0.0:
            return best
        # inverse quadratic interpolation only where it is monotone
        along = (place - before) / (last - before)
        rise = (value - value_before) / (value_last - value_before)
        share = 0.5
        if rise**2 < along and (1.0 - rise) ** 2 < 1.0 - along:
            share = value / (value_before - value) * value_last / (value_before - value_last)
            share += (
                (last - place)
                / (before - place)
                * (value / (value_last - value))
                * (value_before / (value_last - value_before))
            )
        share = min(max(share, smallest), 1.0 - smallest)
    return best


def roots_between(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Find where many functions change their sign: secants that keep a bracket.

    Roots, to rounding. [unit of the ends]

    Parameters
    ----------
    function : callable
        Values at one place of each function.
    low, high : ndarray
        Ends. Without a change of sign between them the result means nothing.

    References
    ----------
    M. Dowell, P. Jarratt, BIT 11 (1971) 168-174 (Illinois method).
    """
    behind, place = low, high
    value_behind, value = function(behind), function(place)
    bracketed = value_behind * value < 0.0
    for _ in range(_MOST_STEPS):
        rise = np.where(bracketed, value - value_behind, np.inf)
        step = value * (place - behind) / rise
        trial = place - step
        found = function(trial)
        crossed = found * value < 0.0
        behind = np.where(crossed, place, behind)
        value_behind = np.where(crossed, value, 0.5 * value_behind)
        place, value = trial, found
        if not np.any(np.abs(step) > _ROUNDING * np.abs(place)):
            break
    return place


def next_change(known: list[tuple[float, float]], longest: float) -> float:
    """Change of a place towards that at which what it leads to agrees with it.

    Change of the last place: by all that it misses, and as soon as another misses in the other
    sense by the secant, which leaves at least a fifth of the way to either. [as the places]

    Parameters
    ----------
    known : list of tuple
        Places that were tried, and by how much what each leads to lies beyond it. [any]
    longest : float
        Largest change. [as the places]
    """
    place, error = known[-1]
    opposite = [(s, e) for s, e in known if e * error < 0.0]
    if opposite:
        other, before = min(opposite, key=lambda pair: abs(pair[0] - place))
        return min(max(error / (error - before), 0.2), 0.8) * (other - place)
    return min(max(error, -longest), longest)
