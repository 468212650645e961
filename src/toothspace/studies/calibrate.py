"""Parameters of a case fitted to measured data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    Free,
    Integer,
    KeyTable,
    Named,
    Row,
    declare,
    file_path,
    integer,
    items,
    number,
)
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import from_si
from toothspace.plotting.style import (
    BLUE,
    GREY,
    INK,
    ORANGE,
    StudyFigure,
    axis_title,
    panels_of,
    styled,
)
from toothspace.results.variables import label_of
from toothspace.studies.least_squares import Fit, fit
from toothspace.studies.measured import Measured, Signals, at_ports, read_measured
from toothspace.studies.points import Evaluate, evaluate_points, point, summary_numbers
from toothspace.studies.study import Record, Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import Axis, axes_of, check_span, values_at, written_values

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@final
@dataclass(frozen=True, kw_only=True)
class CalibrateStudy(KeyTable):
    """``kind = "calibrate"``: fit keys of the case to measured columns."""

    data: Path = file_path("Columns time and names of results.", ".csv", ".xlsx", default=MISSING)
    fit: Mapping[str, tuple[Any, Any]] = declare(
        Named(item=Row(items=(Free(), Free())), doc="Key paths with lower and upper bound.")
    )
    hold_out: float = number("Share of the data kept for the check.", low=0, high=0.9, default=0.3)
    fit_rows: tuple[int, ...] | None = items(
        Integer(low=1, high=10**6),
        "Rows of steady points that are fitted, counted from 1, all others held out; a share of "
        "the data if not given.",
        low=1,
        default=None,
    )
    evaluation_count: int = integer(
        "Most sets of values that are tried.", low=2, high=10**6, default=200
    )
    seed: int = integer("Seed of the choice of rows to hold out.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        if not self.fit:
            raise CaseError("fit", "nothing", "at least one key path with two bounds")
        for path, bounds in self.fit.items():
            check_span(dict(zip(("from", "to"), bounds, strict=True)), f"fit.{path}")


def run(case: Case, context: StudyContext) -> StudyResult:
    """Fit the keys of ``study.fit`` to the columns of ``study.data``.

    Returns
    -------
    StudyResult
        Fitted values with confidence intervals, and errors of the rows used and held out.

    Raises
    ------
    CaseError
        If the data or the keys do not fit the case.

    Notes
    -----
    Each channel counts with its deviations over the scatter of its measured values (over their
    mean, if they do not scatter). Intervals are those of linear regression at the minimum, for
    independent errors of equal size: correlated signals over time make them too narrow.

    References
    ----------
    .. [1] G. A. F. Seber, C. J. Wild, Nonlinear Regression, Wiley (1989), chapter 5.
    """
    study = case.study
    assert isinstance(study, CalibrateStudy)
    label = case.label
    spans = {path: {"from": low, "to": high} for path, (low, high) in study.fit.items()}
    axes = axes_of(spans, label)
    measured = read_measured(study.data)
    if measured.times is not None and case.circuit is not None:
        first, last, duration = measured.times[0], measured.times[-1], case.circuit.duration
        if first < 0.0 or last > duration * (1.0 + 1e-9):
            raise CaseError(
                f"{label}: study.data",
                f"times from {first:g} s to {last:g} s",
                f"0 s to {duration:g} s",
            )
    used = _used_rows(study, measured, len(axes), label)
    model = _Model(case, axes, measured, context, used, study.evaluation_count)
    status = Status.DONE
    try:
        # begins with the values of the case, where they lie within the bounds
        shares = np.full(len(axes), 0.5)
        for k, axis in enumerate(axes):
            value = case.value(axis.path)
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                own = from_si(value, axis.unit) if axis.unit else value
                share = (own - axis.low) / (axis.high - axis.low)
                shares[k] = share if 0.0 < share < 1.0 else 0.5
        found = fit(model.residuals, shares, study.evaluation_count)
        if not found.converged:
            status = Status.NOT_CONVERGED
        predicted = model.predicted(found.shares)
        if status is Status.DONE and not all(np.isfinite(row).all() for row in predicted.values()):
            status = Status.POINTS_FAILED
    except KeyboardInterrupt:
        status, found, predicted = Status.INTERRUPTED, None, None
    return _result(case, status, _Outcome(axes, measured, used, found, predicted))


@final
@dataclass(frozen=True)
class _Outcome:
    axes: tuple[Axis, ...]
    measured: Measured
    used: Array
    found: Fit | None
    predicted: Mapping[str, Array] | None


@final
@dataclass
class _Model:
    """The case as a function from the unit cube to the measured channels."""

    case: Case
    axes: tuple[Axis, ...]
    measured: Measured
    context: StudyContext
    used: Array
    budget: int
    tried: int = 0
    reason: str = ""

    def residuals(self, shares: Array) -> Array:
        """Return scaled residuals of the rows used, (points, rows times channels)."""
        found = self._channels(shares, self.used)
        scales = scales_of(self.measured)
        wanted = self.measured.channels
        return np.hstack(
            [(found[name] - wanted[name][self.used]) / scales[name] for name in wanted]
        )

    def predicted(self, shares: Array) -> dict[str, Array]:
        """Return the channels at all rows, those held out among them."""
        everywhere = np.ones(self.measured.rows, dtype=bool)
        return {name: rows[0] for name, rows in self._channels(shares[None], everywhere).items()}

    def _channels(self, shares: Array, rows: Array) -> dict[str, Array]:
        values = [written_values(self.axes, row) for row in values_at(self.axes, shares)]
        self.tried += len(values)
        if self.measured.times is not None:
            names = tuple(self.measured.channels)
            records = self._evaluate(values, Signals(tuple(self.measured.times.tolist()), names))
            nothing = [np.nan] * self.measured.rows
            found = {name: [r.numbers.get(name, nothing) for r in records] for name in names}
            return {name: np.array(signal, dtype=float)[:, rows] for name, signal in found.items()}
        measured = zip(self.measured.settings, rows, strict=True)
        settings = [at_ports(self.case, row) for row, wanted in measured if wanted]
        records = self._evaluate([{**s, **v} for v in values for s in settings], summary_numbers)
        return {
            name: np.array(
                [record.number(name) if record.succeeded else np.nan for record in records]
            ).reshape(len(values), -1)
            for name in self._known(records)
        }

    def _evaluate(self, values: Sequence[Mapping[str, Any]], evaluate: Evaluate) -> list[Record]:
        report = self.context.progress

        def progress(_share: float, text: str) -> None:
            if report is not None:
                report(min(self.tried / self.budget, 1.0), f"{text}, {self.tried} sets tried")

        context = StudyContext(progress, self.context.workers, self.context.records)
        points = [point(self.case, entry) for entry in values]
        for entry in points:
            if entry.case is None:
                raise CaseError(entry.message)
        return evaluate_points(points, context, evaluate)

    def _known(self, records: Sequence[Record]) -> list[str]:
        names = list(self.measured.channels)
        numbers = next((r.numbers for r in records if r.succeeded), None)
        unknown = [name for name in names if numbers is not None and name not in numbers]
        if unknown and numbers is not None:
            allowed = ", ".join(numbers)
            raise CaseError("study.data", f"the column {unknown[0]!r}", allowed)
        return names


def scales_of(measured: Measured) -> dict[str, float]:
    """Scatter of each channel, or its size if it does not scatter. [unit of the channel]."""
    found = {}
    for name, column in measured.channels.items():
        scatter, size = float(column.std()), float(np.abs(column).mean())
        found[name] = scatter if scatter > 1e-3 * size else size or 1.0
    return found


def _used_rows(study: CalibrateStudy, measured: Measured, keys: int, label: str) -> Array:
    """Rows of the fit: the first ones of signals, a random choice of steady points."""
    rows = measured.rows
    if study.fit_rows is not None:
        return _chosen_rows(study.fit_rows, measured, keys, label)
    kept_out = min(round(study.hold_out * rows), rows - 1)
    order = np.arange(rows)
    if measured.times is None:
        order = np.random.default_rng(study.seed).permutation(rows)
    used = np.ones(rows, dtype=bool)
    used[order[rows - kept_out :]] = False
    return _enough(used, measured, keys, label)


def _chosen_rows(chosen: Sequence[int], measured: Measured, keys: int, label: str) -> Array:
    """Steady points that the case names, counted from 1."""
    if measured.times is not None:
        allowed = "steady points, or hold_out for signals over time"
        raise CaseError(f"{label}: study.fit_rows", "signals over time", allowed)
    if max(chosen) > measured.rows:
        found = f"row {max(chosen)}"
        raise CaseError(f"{label}: study.fit_rows", found, f"1 to {measured.rows}")
    used = np.zeros(measured.rows, dtype=bool)
    used[np.array(chosen) - 1] = True
    return _enough(used, measured, keys, label)


def _enough(used: Array, measured: Measured, keys: int, label: str) -> Array:
    numbers = int(used.sum()) * len(measured.channels)
    if numbers < keys:
        found = f"{numbers} numbers for {keys} keys"
        raise CaseError(f"{label}: study.data", found, "at least as many as keys")
    return used


def _result(case: Case, status: Status, outcome: _Outcome) -> StudyResult:
    import xarray as xr

    measured = outcome.measured
    data = xr.Dataset(
        {name: ("row", column) for name, column in measured.channels.items()},
        coords={"row": np.arange(measured.rows)},
    )
    data["used"] = ("row", outcome.used)
    if measured.times is not None:
        data["time"] = ("row", measured.times, {"units": "s"})
    numbers: dict[str, Any] = {"rows": measured.rows, "rows_used": int(outcome.used.sum())}
    tables: tuple[StudyTable, ...] = ()
    if outcome.found is not None and outcome.predicted is not None:
        for name, column in outcome.predicted.items():
            data[f"fitted_{name}"] = ("row", column)
        values, errors = _values(outcome.axes, outcome.found), _errors(outcome)
        covariance = outcome.found.covariance
        size = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore", divide="ignore"):
            correlation = covariance / np.outer(size, size)
        numbers |= {
            "evaluations": outcome.found.evaluations,
            **values,
            **errors,
            "correlation": correlation.tolist(),
        }
        kinds = tuple(errors)
        rows = [(name, *(errors[kind][name] for kind in kinds)) for name in errors["fit_error"]]
        beside = StudyTable("errors", ("channel", *kinds), tuple(rows))
        fitted = tuple(
            (path, str(text), values["half_width_95"][path], values["unit"][path],
             "at a bound" if path in values["at_bounds"] else "")
            for path, text in values["fitted"].items()
        )  # fmt: skip
        head = ("key", "value", "half width at 95 %", "unit", "note")
        tables = (StudyTable("fitted", head, fitted), beside)
    return StudyResult(status=status, data=data, numbers=numbers, tables=tables)


def _values(axes: Sequence[Axis], found: Fit) -> dict[str, Any]:
    widths = found.half_widths()
    rows = list(zip(axes, found.shares.tolist(), widths.tolist(), strict=True))
    return {
        "fitted": {a.path: a.written(float(f"{a.quantile(share):.6g}")) for a, share, _ in rows},
        "half_width_95": {a.path: float(width * (a.high - a.low)) for a, _, width in rows},
        "unit": {a.path: a.unit or "1" for a in axes},
        "at_bounds": [a.path for a, share, _ in rows if min(share, 1.0 - share) < 2e-3],
    }


def _errors(outcome: _Outcome) -> dict[str, Any]:
    """Root mean square errors of rows used and held out, by channel."""
    assert outcome.predicted is not None
    found: dict[str, Any] = {"fit_error": {}, "hold_out_error": {}, "fit_error_percent": {}}
    found["hold_out_error_percent"] = {}
    for name, wanted in outcome.measured.channels.items():
        deviation = outcome.predicted[name] - wanted
        size = float(np.abs(wanted).mean()) or 1.0
        for kind, rows in (("fit", outcome.used), ("hold_out", np.logical_not(outcome.used))):
            error = float(np.sqrt(np.mean(deviation[rows] ** 2))) if rows.any() else float("nan")
            found[f"{kind}_error"][name] = error
            found[f"{kind}_error_percent"][name] = 100.0 * error / size
    return found


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Fitted against measured, over time or as deviations."""
    names = [str(n).removeprefix("fitted_") for n in data.data_vars if str(n).startswith("fitted_")]
    if not names:
        return []
    caption = "Fitted against measured; open or grey marks were held out of the fit."
    return [StudyFigure("fit", caption, fit_comparison(data, names))]


@styled
def fit_comparison(data: xr.Dataset, names: Sequence[str]) -> Figure:
    """Fitted against measured: over time, or as deviations."""
    figure, panels = panels_of(names, 1 if "time" in data else 2, 0.5, 2.6)
    used = data["used"].values.astype(bool)
    for axes, name in panels:
        (_over_time if "time" in data else _deviations)(axes, data, name, used)
    panels[0][0].legend()
    return figure


def _over_time(axes: Axes, data: xr.Dataset, name: str, used: Array) -> None:
    time = data["time"].values
    axes.plot(time[used], data[name].values[used], ".", color=INK, ms=3, label="measured")
    held = np.logical_not(used)
    axes.plot(time[held], data[name].values[held], ".", color=GREY, ms=3, label="held out")
    axes.plot(time, data[f"fitted_{name}"].values, color=ORANGE, lw=1.2, label="fitted")
    axes.set(xlabel="Time (s)", ylabel=axis_title(name))


def _deviations(axes: Axes, data: xr.Dataset, name: str, used: Array) -> None:
    x, held = data[name].values, np.logical_not(used)
    y = 100.0 * (data[f"fitted_{name}"].values - x) / (np.abs(x).mean() or 1.0)
    axes.axhline(0.0, color=GREY, lw=0.9)
    axes.plot(x[used], y[used], "o", color=BLUE, ms=4, label="used")
    axes.plot(x[held], y[held], "o", color=ORANGE, ms=4, mfc="white", label="held out")
    axes.set(xlabel=f"Measured {label_of(name)}", ylabel="Fitted minus measured (% of mean)")


STUDY = Study(CalibrateStudy, run, figures)
