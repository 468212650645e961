"""How much each varied key moves a result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.core.types import Array

PERCENTILES = (5.0, 50.0, 95.0)


def rank_correlations(inputs: Array, output: Array) -> Array:
    """Rank correlation of each input with the output (Spearman 1904). [-].

    Parameters
    ----------
    inputs : ndarray, shape (points, keys)
        Values of the keys. [any]
    output : ndarray, shape (points,)
        Result; points without one (NaN) are left out. [any]

    Returns
    -------
    ndarray, shape (keys,)
        From -1 to 1, NaN where nothing changes. [-]
    """
    known = np.isfinite(output)
    found = np.full(inputs.shape[1], np.nan)
    if known.sum() < 3 or np.ptp(output[known]) == 0.0:
        return found
    ranks = _ranks(output[known])
    for k in range(inputs.shape[1]):
        if np.ptp(inputs[known, k]) > 0.0:
            found[k] = np.corrcoef(_ranks(inputs[known, k]), ranks)[0, 1]
    return found


def _ranks(values: Array) -> Array:
    from scipy.stats import rankdata

    return np.asarray(rankdata(values))


def index_samples(base: Array) -> Array:
    """Return the points of Sobol indices (Saltelli et al. 2010). [-].

    Parameters
    ----------
    base : ndarray, shape (count, 2 * keys)
        Two independent samples of the unit cube beside each other. [-]

    Returns
    -------
    ndarray, shape (count * (keys + 2), keys)
        Sample A, sample B, then A with one column from B for each key. [-]
    """
    keys = base.shape[1] // 2
    first, second = base[:, :keys], base[:, keys:]
    mixed = []
    for k in range(keys):
        exchanged = first.copy()
        exchanged[:, k] = second[:, k]
        mixed.append(exchanged)
    return np.vstack([first, second, *mixed])


def sobol_indices(output: Array, keys: int) -> tuple[Array, Array]:
    r"""Share of the variance that each key causes alone, and with its interactions. [-].

    Parameters
    ----------
    output : ndarray
        Results at the points of :func:`index_samples`; a row with a failed point (NaN) is left
        out. [any]
    keys : int
        Number of keys. [-]

    Returns
    -------
    tuple of ndarray, shape (keys,)
        First-order and total indices. [-]

    Notes
    -----
    .. math:: S_k = \frac{\overline{f_B (f_{AB,k} - f_A)}}{\sigma^2},\qquad
              S_{T,k} = \frac{\overline{(f_A - f_{AB,k})^2}}{2 \sigma^2}

    References
    ----------
    .. [1] A. Saltelli et al., Variance based sensitivity analysis of model output, Comput. Phys.
       Commun. 181 (2010) 259-270, table 2 (b) and (f).
    """
    blocks = np.asarray(output, dtype=float).reshape(keys + 2, -1)
    blocks = blocks[:, np.isfinite(blocks).all(axis=0)]
    nothing = np.full(keys, np.nan)
    if blocks.shape[1] < 2:
        return nothing, nothing
    first, second, mixed = blocks[0], blocks[1], blocks[2:]
    mean, variance = blocks[:2].mean(), blocks[:2].var()
    if variance <= 0.0:
        return nothing, nothing
    alone = np.mean((second - mean) * (mixed - first), axis=1) / variance
    total = np.mean((first - mixed) ** 2, axis=1) / (2.0 * variance)
    return alone, total


def statistics(values: Sequence[float]) -> dict[str, float]:
    """Mean, deviation, percentiles and extremes of the values that are known. [of the values]."""
    known = np.asarray(values, dtype=float)
    known = known[np.isfinite(known)]
    if known.size == 0:
        known = np.array([np.nan])
    deviation = float(known.std(ddof=1)) if known.size > 1 else 0.0
    low, middle, high = (float(x) for x in np.percentile(known, PERCENTILES))
    return {
        "mean": float(known.mean()),
        "deviation": deviation,
        "lowest": float(known.min()),
        "percentile_5": low,
        "percentile_50": middle,
        "percentile_95": high,
        "highest": float(known.max()),
    }
