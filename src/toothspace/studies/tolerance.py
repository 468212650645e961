"""Scatter of results from scatter of dimensions and conditions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, choice, declare, integer, number, require
from toothspace.core.types import Array
from toothspace.plotting.style import (
    BLUE,
    GREY,
    INK,
    StudyFigure,
    axis_title,
    number_panels,
    panels_of,
    short_name,
    shown_numbers,
    styled,
)
from toothspace.results.variables import require_known
from toothspace.studies.points import (
    collected,
    columns,
    point,
    points_dataset,
    points_table,
    status_of,
)
from toothspace.studies.study import (
    Record,
    Study,
    StudyContext,
    StudyResult,
    StudyTable,
    failed_count,
)
from toothspace.studies.surrogate import fit_process
from toothspace.studies.variation import (
    LIMITS,
    VARY,
    Axis,
    Limit,
    axes_of,
    check_vary,
    unit_samples,
    values_at,
    written_values,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@final
@dataclass(frozen=True, kw_only=True)
class ToleranceStudy(KeyTable):
    """``kind = "tolerance"``: scatter of results from scatter of dimensions."""

    vary: Mapping[str, Any] = declare(VARY)
    sample_count: int = integer("Number of samples.", low=2, high=10**6, default=64)
    method: str = choice(
        "How points are placed.", "latin_hypercube", "sobol", default="latin_hypercube"
    )
    sensitivity: str = choice(
        "Rank correlation, or Sobol indices (sample_count times number of keys + 2 runs).",
        "rank_correlation",
        "sobol_indices",
        default="rank_correlation",
    )
    limits: Mapping[str, Limit] | None = declare(LIMITS, None)
    scrap_rate: float | None = number(
        "Wanted share of machines out of the limits: the factor on all tolerances that gives it is "
        "found with a surrogate through the samples.",
        above=0,
        high=0.5,
        default=None,
    )
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        check_vary(self.vary)
        if self.scrap_rate is not None:
            require(self, "with scrap_rate", "limits")


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run samples of ``study.vary`` and describe the scatter of every summary number.

    Returns
    -------
    StudyResult
        Samples over ``point``, percentiles, sensitivities, and the share within the limits.

    Raises
    ------
    CaseError
        If no point can be run.
    """
    import xarray as xr

    study = case.study
    assert isinstance(study, ToleranceStudy)
    wanted = {f"study.limits.{name}": name for name in study.limits or {}}
    require_known(wanted, case.label, over_time=case.circuit is not None)
    axes = axes_of(study.vary, case.label, case)
    endless = [axis for axis in axes if axis.values or not math.isfinite(axis.low + axis.high)]
    if study.scrap_rate is not None and endless:
        ranges = "{tolerance}, {from, to} or {mean, deviation, from, to} with scrap_rate"
        problem = CaseError(f"study.vary.{endless[0].path}", "a list, or no limits", ranges)
        raise problem.in_file(case.label)
    indices = study.sensitivity == "sobol_indices"
    keys = [axis.path for axis in axes]
    dimensions = 2 * len(keys) if indices else len(keys)
    shares = unit_samples(dimensions, study.method, study.sample_count, study.seed)
    shares = index_samples(shares) if indices else shares
    rows = values_at(axes, shares)
    records = collected([point(case, written_values(axes, row)) for row in rows], context)
    # with indices, the first two blocks are the plain sample; the rest repeats its values
    plain = records[: 2 * study.sample_count] if indices else records
    scatter = {name: statistics(values) for name, values in columns(plain).items()}
    results = {name: np.asarray(values) for name, values in columns(records).items()}
    effects: dict[str, dict[str, Array]]
    if indices:
        pairs = {name: sobol_indices(values, len(axes)) for name, values in results.items()}
        effects = {
            "first_order_index": {name: pair[0] for name, pair in pairs.items()},
            "total_index": {name: pair[1] for name, pair in pairs.items()},
        }
    else:
        effects = {
            "rank_correlation": {n: rank_correlations(shares, v) for n, v in results.items()}
        }
    data = points_dataset(axes, rows, records)
    data.attrs["varied"] = " ".join(keys)
    limits = study.limits
    wanted_scrap: dict[str, Any] = {}
    tolerances: tuple[StudyTable, ...] = ()
    if limits and study.scrap_rate is not None:
        found = allowed_tolerances(axes, rows[: len(plain)], plain, limits, study.scrap_rate)
        wanted_scrap, tolerances = found
    kinds = list(next(iter(scatter.values()), {}))
    return StudyResult(
        status=status_of(records),
        data=data.assign(
            {
                kind: xr.DataArray(
                    np.array(list(found.values())).reshape(len(found), len(keys)),
                    dims=("result", "key"),
                    coords={"result": list(found), "key": keys},
                )
                for kind, found in effects.items()
            }
        ),
        numbers={
            "points": len(records),
            "points_failed": failed_count(records),
            **(scrap(limits, plain) if limits else {}),
            **wanted_scrap,
            **{kind: {name: found[kind] for name, found in scatter.items()} for kind in kinds},
            **{
                kind: {
                    name: dict(zip(keys, row.tolist(), strict=True)) for name, row in found.items()
                }
                for kind, found in effects.items()
            },
        },
        tables=(
            *tolerances,
            StudyTable(
                "scatter",
                ("result", *next(iter(scatter.values()), {})),
                tuple((name, *found.values()) for name, found in scatter.items()),
            ),
            *(
                StudyTable(
                    kind,
                    ("result", *keys),
                    tuple((n, *row.tolist()) for n, row in found.items() if np.isfinite(row).any()),
                )
                for kind, found in effects.items()
            ),
            points_table(axes, rows, records),
        ),
    )


def share_within(limits: Mapping[str, Limit], records: Sequence[Record]) -> float:
    """Share of points that succeeded and keep all limits. [-]."""
    kept = [
        record.succeeded
        and all(limit.violation(record.number(name)) == 0.0 for name, limit in limits.items())
        for record in records
    ]
    return float(np.mean(kept))


def scrap(limits: Mapping[str, Limit], records: Sequence[Record]) -> dict[str, Any]:
    """Share of points out of limits, its interval of 95 %, and the share that breaks each.

    Notes
    -----
    A point that failed is scrap. The interval is that of a share counted in independent samples,
    which those of a Latin hypercube or of a Sobol sequence are not quite: it is rather too wide.

    References
    ----------
    .. [1] C. J. Clopper, E. S. Pearson, The use of confidence or fiducial limits illustrated in
       the case of the binomial, Biometrika 26 (1934) 404-413.
    """
    from scipy.stats import binomtest

    within = share_within(limits, records)
    out = round((1.0 - within) * len(records))
    interval = binomtest(out, len(records)).proportion_ci(0.95)
    return {
        "share_within_limits": within,
        "scrap_rate": 1.0 - within,
        "scrap_rate_low": float(interval.low),
        "scrap_rate_high": float(interval.high),
        "scrap_by_limit": {
            name: 1.0 - share_within({name: limit}, records) for name, limit in limits.items()
        },
    }


_DRAWN = 4096
"""Machines drawn from the surrogate for one scrap rate."""
_SMALLEST_FACTOR = 0.01


def allowed_tolerances(
    axes: Sequence[Axis],
    rows: Sequence[Sequence[float]],
    records: Sequence[Record],
    limits: Mapping[str, Limit],
    wanted: float,
) -> tuple[dict[str, Any], tuple[StudyTable, ...]]:
    """Tolerances that give a scrap rate, all of them reduced by one factor.

    Parameters
    ----------
    rows : sequence
        Values of the samples. [unit of the axis]
    records : sequence of Record
        What they gave.
    limits : mapping
        Limits of the numbers.
    wanted : float
        Scrap rate. [-]

    Returns
    -------
    numbers : dict
        ``tolerance_factor`` [-], 1 where the tolerances as given have no more scrap than that; the
        scrap rate of the surrogate with them; its hold-out errors. [unit of each number]
    tables : tuple of StudyTable
        Tolerance of each key as given and as allowed.

    Notes
    -----
    Machines are drawn with deviations from the middle times the factor. Each limited number is a
    Gaussian process through the samples, so each machine breaks a limit with a probability, and
    the scrap rate is the mean of these: an uncertain surrogate cannot promise little scrap. Numbers
    are taken as independent for one machine.
    """
    from scipy.optimize import brentq
    from scipy.stats import norm

    table = np.asarray(rows, dtype=float)
    low, high = table.min(axis=0), table.max(axis=0)
    processes = {}
    for name in limits:
        values = np.array([r.number(name) if r.succeeded else np.nan for r in records])
        known = np.isfinite(values)
        if known.sum() < 2 * (len(axes) + 1):
            found = f"{known.sum()} samples with {name}"
            raise CaseError("study.scrap_rate", found, f"at least {2 * (len(axes) + 1)}")
        processes[name] = fit_process((table[known] - low) / (high - low), values[known])
    drawn = np.asarray(values_at(axes, unit_samples(len(axes), "sobol", _DRAWN, 1)))
    middle = np.array([0.5 * (a.low + a.high) if math.isnan(a.mean) else a.mean for a in axes])

    def rate(factor: float) -> float:
        points = np.clip(middle + factor * (drawn - middle), low, high)
        within = np.ones(_DRAWN)
        for name, limit in limits.items():
            mean, spread = processes[name].predict((points - low) / (high - low))
            spread = (
                np.hypot(spread, processes[name].hold_out_error) + 1e-12 * np.abs(mean) + 1e-300
            )
            below = norm.cdf((np.inf if limit.high is None else limit.high) - mean, scale=spread)
            above = norm.cdf((-np.inf if limit.low is None else limit.low) - mean, scale=spread)
            within *= below - above
        return 1.0 - float(np.mean(within))

    as_given, best = rate(1.0), rate(_SMALLEST_FACTOR)
    if as_given <= wanted:
        factor = 1.0
    elif best >= wanted:
        factor = 0.0
    else:
        factor = float(brentq(lambda f: rate(f) - wanted, _SMALLEST_FACTOR, 1.0, xtol=1e-3))
    half = [0.5 * (axis.high - axis.low) for axis in axes]
    numbers = {
        "tolerance_factor": factor,
        "scrap_rate_of_surrogate": as_given,
        "hold_out_error": {name: process.hold_out_error for name, process in processes.items()},
    }
    lines = tuple(
        (axis.path, axis.unit or "1", float(mid), float(x), float(factor * x))
        for axis, mid, x in zip(axes, middle, half, strict=True)
    )
    head = ("key", "unit", "middle", "tolerance given", "tolerance allowed")
    return numbers, (StudyTable("tolerances", head, lines),)


PERCENTILES = (5.0, 50.0, 95.0)


def rank_correlations(inputs: Array, output: Array) -> Array:
    """Rank correlation of each input with the output (Spearman 1904). [-].

    From -1 to 1, NaN where nothing changes, shape (keys,). [-]

    Parameters
    ----------
    inputs : ndarray, shape (points, keys)
        Values of the keys. [any]
    output : ndarray, shape (points,)
        Result; points without one (NaN) are left out. [any]
    """
    from scipy.stats import spearmanr

    known = np.isfinite(output)
    found = np.full(inputs.shape[1], np.nan)
    if known.sum() < 3 or np.ptp(output[known]) == 0.0:
        return found
    for k, values in enumerate(inputs[known].T):
        if np.ptp(values) > 0.0:
            found[k] = spearmanr(values, output[known]).statistic
    return found


def index_samples(base: Array) -> Array:
    """Return the points of Sobol indices (Saltelli et al. 2010). [-].

    Sample A, sample B, then A with one column from B for each key, shape (count * (keys + 2). [-]

    Parameters
    ----------
    base : ndarray, shape (count, 2 * keys)
        Two independent samples of the unit cube beside each other. [-]
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

    First-order and total indices, shape (keys,). [-]

    Parameters
    ----------
    output : ndarray
        Results at the points of :func:`index_samples`; a row with a failed point (NaN) is left
        out. [any]
    keys : int
        Number of keys. [-]

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


_EFFECTS = {
    "rank_correlation": "Rank correlation",
    "first_order_index": "Share of the variance caused alone (first-order index)",
    "total_index": "Share of the variance with interactions (total index)",
}


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Scatter of the main numbers, and their sensitivity to each varied key."""
    if not shown_numbers(data):
        return []
    found = [
        StudyFigure("scatter", "Scatter of results; dashed: 5, 50 and 95 %.", histograms(data))
    ]
    for kind, words in _EFFECTS.items():
        if kind in data and np.isfinite(data[kind]).any():
            found.append(StudyFigure(kind, f"{words} of each varied key.", effect_bars(data, kind)))
    return found


@styled
def histograms(data: xr.Dataset) -> Figure:
    """Histograms of the main numbers with their percentiles."""
    figure, panels = number_panels(data)
    for axes, name in panels:
        values = data[name].values[np.isfinite(data[name].values)]
        axes.hist(values, bins=max(5, min(30, round(np.sqrt(values.size)))), color=BLUE)
        for mark in np.percentile(values, (5.0, 50.0, 95.0)) if values.size else ():
            axes.axvline(float(mark), color=INK, ls="--", lw=0.9)
        axes.set(xlabel=axes.get_ylabel(), ylabel="Number of points")
    return figure


@styled
def effect_bars(data: xr.Dataset, kind: str) -> Figure:
    """Sensitivity of the main numbers to each varied key."""
    table = data[kind]
    names = [n for n in shown_numbers(data) if n in table["result"].values]
    keys = [str(key) for key in table["key"].values]
    margin = 0.9 + 0.5 * len(names)
    figure, panels = panels_of(names, 2, margin, 0.32 * len(keys), sharex=True)
    for axes, name in panels:
        values = np.nan_to_num(table.sel(result=name).values)
        axes.barh([short_name(key) for key in keys], values, color=BLUE, height=0.6)
        axes.axvline(0.0, color=GREY, lw=0.8)
        axes.set_title(axis_title(name))
        axes.invert_yaxis()
    return figure


STUDY = Study(ToleranceStudy, run, figures)
