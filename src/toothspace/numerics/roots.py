"""Root of a function of one variable between two places."""

from __future__ import annotations

from collections.abc import Callable

_ROUNDING = 4.0 * 2.0**-52
_MOST_STEPS = 200


def root_between(
    function: Callable[[float], float], low: float, high: float, tolerance: float = 2e-12
) -> float:
    """Find where a function changes its sign: inverse quadratic steps kept by bisection.

    Parameters
    ----------
    function : callable
        Continuous, of opposite sign at both ends.
    low, high : float
        Ends.
    tolerance : float
        Allowed distance to the root, beside rounding. [unit of the ends]

    Raises
    ------
    ValueError
        If both ends have the same sign.

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
