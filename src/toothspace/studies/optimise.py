"""Best values of varied keys, within constraints."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from textwrap import fill
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    Free,
    KeyTable,
    Named,
    Number,
    choice,
    declare,
    forbid,
    integer,
    number,
    require,
    text,
)
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.plotting.style import (
    BLUE,
    GREY,
    INK,
    StudyFigure,
    axis_title,
    key_title,
    new_figure,
    styled,
)
from toothspace.results.variables import require_known
from toothspace.studies.least_squares import fit
from toothspace.studies.points import (
    evaluate_points,
    point,
    points_dataset,
    points_table,
    require_accepted,
    require_results,
)
from toothspace.studies.study import (
    Record,
    Study,
    StudyContext,
    StudyResult,
    StudyTable,
    failed_count,
)
from toothspace.studies.surrogate import GaussianProcess, fit_process
from toothspace.studies.variation import (
    LIMITS,
    VARY,
    Axis,
    Limit,
    axes_of,
    check_vary,
    number_in,
    unit_samples,
    values_at,
    written_values,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


_INFEASIBLE = 1e12
_FAILED = 1e15
_CANDIDATES = 2048
"""Points of a Sobol sequence among which a surrogate chooses, and half as many round the best."""
_EDGE_LENGTH = 1.0
"""Over which a run that failed speaks for others, over the range of a key: an assumption. [-]"""
_TINY = 1e-300
_WIDTHS = (0.1, 0.03, 0.01, 0.003)
"""Deviations round the best point, over the range of a key. [-]"""


@final
@dataclass(frozen=True, kw_only=True)
class OptimiseStudy(KeyTable):
    """``kind = "optimise"``: best values of varied keys."""

    vary: Mapping[str, Any] = declare(VARY)
    objective: str | None = text("Summary number to be made best.", default=None)
    goal: str = choice("Direction.", "maximise", "minimise", default="maximise")
    targets: Mapping[str, float] | None = declare(
        Named(item=Number(), doc="Summary numbers with wanted values, instead of objective."), None
    )
    constraints: Mapping[str, Limit] | None = declare(LIMITS, None)
    scatter: Mapping[str, Any] | None = declare(
        Named(
            item=Free(),
            doc="Key paths that scatter round each point, each as {tolerance}: normal, three "
            "deviations wide to each side. Each point is then run scatter_count times.",
        ),
        None,
    )
    scatter_count: int = integer(
        "Machines of each point that scatter, the middle one among them.",
        low=2,
        high=1000,
        default=16,
    )
    quantile: float = number(
        "With scatter: share of the machines that are at least as good as what counts.",
        low=0.5,
        high=1.0,
        default=0.9,
    )
    method: str = choice(
        "Search: over the whole range, from its middle towards targets, or where surrogates of "
        "the points so far expect the largest improvement.",
        "differential_evolution",
        "least_squares",
        "surrogate",
        default="differential_evolution",
    )
    evaluation_count: int = integer("Most evaluations.", low=2, high=10**6, default=200)
    batch_size: int = integer(
        'With method = "surrogate": points proposed at once, shared by the workers.',
        low=1,
        high=1000,
        default=4,
    )
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        check_vary(self.vary)
        for path, given in (self.scatter or {}).items():
            if not isinstance(given, Mapping) or set(given) != {"tolerance"}:
                raise CaseError(f"scatter.{path}", repr(given), "{tolerance = ...}")
        if self.targets is None:
            require(self, "unless targets are given", "objective")
        else:
            forbid(self, "because targets are given", "objective")
        if self.method == "least_squares":
            require(self, 'with method = "least_squares"', "targets")
            forbid(self, 'with method = "least_squares"', "scatter")
            forbid(self, 'with method = "least_squares"', "constraints")
        if self.method == "surrogate":
            require(self, 'with method = "surrogate"', "objective")


def run(case: Case, context: StudyContext) -> StudyResult:
    r"""Search for the best values of ``study.vary``.

    Returns
    -------
    StudyResult
        All points tried in their order, and the best one that keeps the constraints.

    Raises
    ------
    CaseError
        If a result has an unknown name, no point can be run, or scikit-learn is missing for
        ``method = "surrogate"``.

    Notes
    -----
    ``differential_evolution`` computes one generation after another. A point that breaks a
    constraint counts less than any that keeps them, and among those the smaller violation wins.
    ``least_squares`` needs few points, but finds the nearest minimum only. With ``scatter``, all
    points get the same deviations from their values; the objective and the violation of a point
    are those that the share ``quantile`` of its machines reach or beat.

    ``surrogate`` begins with a Sobol sequence: a quarter of the points, at least two more than
    twice the keys. Objective :math:`f` and each side of a limit, :math:`g \le 0`, are then
    Gaussian processes with mean :math:`m` and deviation :math:`s`. What runs next is where

    .. math:: \left[(f_\mathrm{best} - m)\,\Phi(z) + s\,\varphi(z)\right] \prod \Phi(-m_g/s_g),
              \qquad z = (f_\mathrm{best} - m)/s

    is largest: expected improvement times the probability that limits are kept, or that
    probability alone while no point keeps them. Each point of a batch is taken to be as predicted
    when the next one is chosen. Where runs fail, a process through +1 for these and -1 for the
    others is one more limit.

    References
    ----------
    .. [1] R. Storn, K. Price, Differential evolution, J. Global Optim. 11 (1997) 341-359.
    .. [2] K. Deb, An efficient constraint handling method for genetic algorithms, Comput. Methods
       Appl. Mech. Eng. 186 (2000) 311-338.
    .. [3] D. R. Jones, M. Schonlau, W. J. Welch, Efficient global optimization of expensive
       black-box functions, J. Global Optim. 13 (1998) 455-492.
    .. [4] M. Schonlau, W. J. Welch, D. R. Jones, Global versus local search in constrained
       optimization of computer models, IMS Lecture Notes 34 (1998) 11-25.
    """
    study = case.study
    assert isinstance(study, OptimiseStudy)
    if study.method == "surrogate" and find_spec("sklearn") is None:
        found = "'surrogate', which needs the package scikit-learn"
        allowed = "'differential_evolution', or after pip install \"toothspace[design]\""
        raise CaseError("study.method", found, allowed).in_file(case.label)
    wanted = {"study.objective": study.objective} if study.objective else {}
    wanted |= {f"study.targets.{name}": name for name in study.targets or {}}
    wanted |= {f"study.constraints.{name}": name for name in study.constraints or {}}
    require_known(wanted, case.label, over_time=case.circuit is not None)
    search = _TriedPoints(case, study, context)
    status = Status.DONE
    try:
        if not search.run():
            status = Status.NOT_CONVERGED
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    require_accepted(search.records)
    best = search.best()
    if best is None and status is Status.DONE:
        status = Status.NOT_CONVERGED
    data = points_dataset(search.axes, search.rows, search.records)
    merits = [search.merit(record) for record in search.records]
    kept = [r.succeeded and search.violation(r) == 0.0 for r in search.records]
    data = data.assign(
        merit=("point", np.asarray(merits)), feasible=("point", np.asarray(kept, dtype=bool))
    )
    data.attrs["varied"] = " ".join(axis.path for axis in search.axes)
    data.attrs["objective"] = study.objective or "targets"
    data.attrs["goal"] = study.goal
    errors = search.hold_out_errors()
    for name, error in errors.items():
        data["merit" if name == study.objective else name].attrs["hold_out_error"] = error
    return StudyResult(
        status=status,
        data=data,
        numbers={**search.numbers(best), **({"hold_out_error": errors} if errors else {})},
        tables=(*search.best_table(best), points_table(search.axes, search.rows, search.records)),
    )


@final
class _TriedPoints:
    """Points tried so far, and how good they are."""

    def __init__(self, case: Case, study: OptimiseStudy, context: StudyContext) -> None:
        self.case, self.study, self.context = case, study, context
        self.axes = axes_of(study.vary, case.label, case)
        self.rows: list[tuple[Any, ...]] = []
        self.shares = np.empty((0, len(self.axes)))
        """The same in the unit cube."""
        self.records: list[Record] = []
        self.groups: dict[str, list[Record]] = {}
        """Machines that scatter round a point, by the key of the point."""
        scatter = axes_of(study.scatter or {}, case.label, case, "study.scatter")
        shares = np.empty((0, len(scatter)))
        if scatter:
            shares = unit_samples(
                len(scatter), "latin_hypercube", study.scatter_count - 1, study.seed + 1
            )
        self.scattered = scatter
        self.deviations = [
            {axis.path: value - axis.mean for axis, value in zip(scatter, row, strict=True)}
            for row in values_at(scatter, shares)
        ]

    def run(self) -> bool:
        """Search; returns whether it ended by itself."""
        if self.study.method == "least_squares":
            found = fit(
                lambda shares: np.array([self._deviations(r) for r in self._evaluate(shares)]),
                np.full(len(self.axes), 0.5),
                self.study.evaluation_count,
            )
            return found.converged
        if self.study.method == "surrogate":
            self._follow_surrogate()
            return True
        from scipy.optimize import differential_evolution

        keys, budget = len(self.axes), self.study.evaluation_count
        size = max(5, min(max(10, 5 * keys), budget // 3))
        first = unit_samples(keys, "latin_hypercube", size, self.study.seed)
        best = differential_evolution(
            lambda shares: np.array([self._cost(record) for record in self._evaluate(shares.T)]),
            [(0.0, 1.0)] * keys,
            init=first,
            maxiter=max(budget // size - 1, 1),
            polish=False,
            vectorized=True,
            updating="deferred",
            seed=self.study.seed,
            tol=1e-3,
        )
        # the budget is what the user gave: using it up is no failure
        return bool(best.success) or "iterations" in str(best.message)

    def _evaluate(self, shares: Array) -> list[Record]:
        rows = values_at(self.axes, shares)
        given = [written_values(self.axes, row) for row in rows]
        points = [point(self.case, one) for one in given]
        round_each = len(self.deviations)
        points += [
            point(self.case, self._moved(one, off)) for one in given for off in self.deviations
        ]
        best, tried = self.best(), len(self.records)
        shown = "" if best is None else f", best {self.merit(self.records[best]):.6g}"
        context = self.context.counted(tried, self.study.evaluation_count, f"{tried} tried{shown}")
        evaluated = evaluate_points(points, context)
        records, others = evaluated[: len(rows)], evaluated[len(rows) :]
        for k, record in enumerate(records):
            self.groups[record.key] = [record, *others[k * round_each : (k + 1) * round_each]]
        self.rows += rows
        self.shares = np.vstack([self.shares, shares])
        self.records += records
        study = self.study
        wanted = [*(study.targets or {}), *(study.constraints or {})]
        wanted += [study.objective] if study.objective else []
        require_results(records, wanted, self.case.label)
        return records

    def _follow_surrogate(self) -> None:
        """Run a first sample, and then batches that surrogates propose."""
        keys, budget = len(self.axes), self.study.evaluation_count
        first = min(max(2 * keys + 2, budget // 4), budget)
        shares = centred(self.axes, unit_samples(keys, "sobol", first, self.study.seed))
        self._evaluate(np.array(list(dict.fromkeys(map(tuple, shares.tolist())))))
        while (left := budget - len(self.records)) > 0:
            proposed = self._proposed(min(self.study.batch_size, left))
            if not len(proposed):
                return
            self._evaluate(proposed)

    def _proposed(self, count: int) -> Array:
        """Points that surrogates expect most of, shape (points, keys); fewer if all are tried."""
        keys, seed = len(self.axes), self.study.seed + len(self.records)
        candidates = unit_samples(keys, "sobol", _CANDIDATES, seed)
        best = self.best()
        if best is not None:
            widths = np.resize(_WIDTHS, (_CANDIDATES // 2, 1))
            off = widths * np.random.default_rng(seed).normal(size=(_CANDIDATES // 2, keys))
            candidates = np.vstack([candidates, np.clip(self.shares[best] + off, 0.0, 1.0)])
        candidates = centred(self.axes, candidates)
        rows, tried = values_at(self.axes, candidates), set(self.rows)
        objective, limits = self._processes()
        cost = None if best is None else self._cost(self.records[best])
        chosen: list[int] = []
        for _ in range(count):
            promise = log_promise(objective, limits, cost, candidates)
            promise[[row in tried for row in rows]] = -np.inf
            most = int(np.argmax(promise))
            if promise[most] == -np.inf:
                break
            chosen.append(most)
            tried.add(rows[most])
            objective, *limits = (believed(p, candidates[most]) for p in (objective, *limits))
        return candidates[chosen]

    def _processes(self) -> tuple[GaussianProcess, list[GaussianProcess]]:
        """Surrogates of the objective to be made small, and of what must be negative."""
        study = self.study
        assert study.objective is not None
        objective = self._process(study.objective, -1.0 if study.goal == "maximise" else 1.0)
        limits = []
        for name, limit in (study.constraints or {}).items():
            if limit.low is not None:
                limits.append(self._process(name, -1.0, -limit.low))
            if limit.high is not None:
                limits.append(self._process(name, 1.0, limit.high))
        failed = np.array([1.0 - 2.0 * record.succeeded for record in self.records])
        if failed.max() > 0.0:
            lengths = np.full(len(self.axes), _EDGE_LENGTH)
            limits.append(
                GaussianProcess(self.shares, failed, 0.0, 1.0, 1.0, lengths, 1e-6, math.nan)
            )
        return objective, limits

    def _process(self, name: str, factor: float, edge: float = 0.0) -> GaussianProcess:
        """Surrogate of a number times a factor, less an edge, through the points that have it."""
        values = np.array([self._reached(record, name, factor) for record in self.records]) - edge
        known = np.isfinite(values)
        if not known.any():
            return fit_process(self.shares[:1], np.zeros(1), self.study.seed)
        return fit_process(self.shares[known], values[known], self.study.seed)

    def _reached(self, record: Record, name: str, factor: float) -> float:
        """Number times a factor that the wanted share of the machines of a point stays below."""
        machines = self.groups.get(record.key, [record])
        numbers = np.array([factor * r.number(name) if r.succeeded else np.nan for r in machines])
        numbers = np.where(np.isnan(numbers), np.inf, numbers)
        return float(np.quantile(numbers, self.study.quantile, method="higher"))

    def hold_out_errors(self) -> dict[str, float]:
        """Errors of the surrogates of objective and limited numbers. [unit of each number]."""
        study = self.study
        if study.method != "surrogate" or not any(record.succeeded for record in self.records):
            return {}
        signs = {
            name: 1.0 if x.low is None else -1.0 for name, x in (study.constraints or {}).items()
        }
        signs[study.objective or ""] = -1.0 if study.goal == "maximise" else 1.0
        return {name: self._process(name, sign).hold_out_error for name, sign in signs.items()}

    def _moved(self, values: Mapping[str, Any], off: Mapping[str, float]) -> dict[str, Any]:
        """Values of a point with deviations from them, or from the case where they do not vary."""
        moved = dict(values)
        for axis in self.scattered:
            own = values.get(axis.path)
            middle = axis.mean if own is None else number_in(own, axis.unit)
            moved[axis.path] = axis.written(middle + off[axis.path])
        return moved

    def _cost(self, record: Record) -> float:
        if not record.succeeded:
            return _FAILED
        violation, merit = self.violation(record), self.merit(record)
        if violation > 0.0:
            return _INFEASIBLE * (1.0 + min(violation, 100.0))
        upwards = self.study.targets is None and self.study.goal == "maximise"
        return _FAILED if math.isnan(merit) else -merit if upwards else merit

    def violation(self, record: Record) -> float:
        """Sum of what breaks the constraints, each over the size of its limit. [-].

        With scatter, what the wanted share of the machines does not exceed.
        """
        limits = self.study.constraints or {}
        broken = [
            sum(limit.violation(one.number(name)) for name, limit in limits.items())
            for one in self.groups.get(record.key, [record])
        ]
        return float(np.quantile(broken, self.study.quantile, method="higher"))

    def merit(self, record: Record) -> float:
        """Return the objective, or the root mean square of the deviations from targets.

        With scatter, what the wanted share of the machines reaches or beats.
        """
        merits = np.array([self._merit(one) for one in self.groups.get(record.key, [record])])
        upwards = self.study.targets is None and self.study.goal == "maximise"
        merits = np.where(np.isnan(merits), -np.inf if upwards else np.inf, merits)
        if upwards:
            found = float(np.quantile(merits, 1.0 - self.study.quantile, method="lower"))
        else:
            found = float(np.quantile(merits, self.study.quantile, method="higher"))
        return found if math.isfinite(found) else math.nan

    def _merit(self, record: Record) -> float:
        if self.study.objective is not None:
            return record.number(self.study.objective)
        deviations = np.array(self._deviations(record))
        return float(np.sqrt(np.mean(deviations**2)))

    def _deviations(self, record: Record) -> list[float]:
        targets = self.study.targets or {}
        if not record.succeeded:
            return [math.nan] * len(targets)
        return [(record.number(name) - x) / (abs(x) or 1.0) for name, x in targets.items()]

    def best(self) -> int | None:
        """Return the number of the best point that keeps the constraints, or None."""
        costs = [self._cost(record) for record in self.records]
        if not costs or min(costs) >= _INFEASIBLE:
            return None
        return int(np.argmin(costs))

    def numbers(self, best: int | None) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        found: dict[str, Any] = {
            "points": len(self.records),
            "points_failed": failed_count(self.records),
            "feasible": best is not None,
        }
        if best is None:
            return found
        record = self.records[best]
        return {
            **found,
            "best": written_values(self.axes, self.rows[best]),
            "best_merit": self.merit(record),
            "best_point": dict(record.numbers),
            "at_bounds": [
                axis.path
                for axis, x in zip(self.axes, self.rows[best], strict=True)
                if not (axis.values or axis.whole)
                and min(x - axis.low, axis.high - x) < 0.01 * (axis.high - axis.low)
            ],
        }

    def best_table(self, best: int | None) -> tuple[StudyTable, ...]:
        """Return the table of the best values and of the results there."""
        if best is None:
            return ()
        pairs = zip(self.axes, self.rows[best], strict=True)
        values = [(axis.path, str(axis.written(value))) for axis, value in pairs]
        names = [self.study.objective, *(self.study.targets or {}), *(self.study.constraints or {})]
        results = [(n, self.records[best].number(n)) for n in dict.fromkeys(names) if n]
        return (StudyTable("best", ("name", "value"), (*values, *results)),)


def centred(axes: Sequence[Axis], shares: Array) -> Array:
    """Points of the unit cube, in the middle of what stands for the same value of a list. [-]."""
    moved = shares.copy()
    for k, axis in enumerate(axes):
        steps = len(axis.values)
        if axis.whole and not steps and math.isnan(axis.mean):
            steps = round(axis.high - axis.low) + 1
        if steps:
            moved[:, k] = (np.minimum(np.floor(steps * shares[:, k]), steps - 1) + 0.5) / steps
    return moved


def log_promise(
    objective: GaussianProcess,
    limits: Sequence[GaussianProcess],
    best: float | None,
    shares: Array,
) -> Array:
    """Logarithm of expected improvement times the probability that limits are kept. [-].

    Parameters
    ----------
    objective : GaussianProcess
        Of a number to be made small.
    limits : sequence of GaussianProcess
        Of numbers that are to be negative.
    best : float or None
        Smallest objective that keeps the limits; None leaves the probability alone.
    shares : ndarray, shape (points, keys)
        Points of the unit cube. [-]
    """
    from scipy.special import log_ndtr, ndtr

    promise = np.zeros(len(shares))
    for limit in limits:
        mean, spread = limit.predict(shares)
        promise += log_ndtr(-mean / _floored(spread, limit))
    if best is None:
        return promise
    mean, spread = objective.predict(shares)
    spread = _floored(spread, objective)
    z = (best - mean) / spread
    density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
    # far below, the difference of two small numbers: its series
    far = np.minimum(z, -10.0)
    series = -0.5 * far**2 - 0.5 * math.log(2.0 * math.pi) - 2.0 * np.log(-far)
    near = np.log(np.maximum(z * ndtr(z) + density, _TINY))
    return np.asarray(promise + np.log(spread) + np.where(z < -10.0, series, near))


def _floored(spread: Array, process: GaussianProcess) -> Array:
    return np.maximum(spread, 1e-9 * process.deviation + _TINY)


def believed(process: GaussianProcess, share: Array) -> GaussianProcess:
    """Return the process as if its prediction at a point, shape (keys,), had been computed."""
    mean, _ = process.predict(share[None])
    scaled = (mean - process.mean) / (process.deviation or 1.0)
    return replace(
        process,
        points=np.vstack([process.points, share]),
        values=np.append(process.values, scaled),
    )


_LABEL_WIDTH = 22


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Points tried in their order."""
    if data.sizes["point"] == 0:
        return []
    caption = (
        "Every point tried, in its order; grey: a constraint is broken; line: the best so far."
    )
    return [StudyFigure("search", caption, search_history(data))]


@styled
def search_history(data: xr.Dataset) -> Figure:
    """Objective of all points tried, and the varied keys."""
    paths = [p for p in data.attrs["varied"].split() if data[p].dtype.kind in "fiu"]
    figure = new_figure(7.2, 2.2 + 1.5 * len(paths))
    panels = figure.subplots(1 + len(paths), 1, sharex=True, squeeze=False)[:, 0]
    order, kept = data["point"].values, data["feasible"].values.astype(bool)
    upwards = data.attrs["goal"] == "maximise" and data.attrs["objective"] != "targets"
    merit = np.where(kept, data["merit"].values, np.nan)
    panels[0].plot(order, (np.fmax if upwards else np.fmin).accumulate(merit), color=INK, lw=1.0)
    shown = [("merit", axis_title(data.attrs["objective"]))]
    shown += [(path, key_title(data, path)) for path in paths]
    for axes, (name, label) in zip(panels, shown, strict=True):
        broken = np.logical_not(kept)
        axes.plot(order[broken], data[name].values[broken], ".", color=GREY, ms=3)
        axes.plot(order[kept], data[name].values[kept], ".", color=BLUE, ms=5)
        axes.set_ylabel(fill(label, _LABEL_WIDTH), fontsize=8)
    panels[-1].set_xlabel("Point")
    return figure


STUDY = Study(OptimiseStudy, run, figures)
