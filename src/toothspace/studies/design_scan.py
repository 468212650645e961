"""Best of very many gear designs by their kinematics, without a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace import api
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    choice,
    declare,
    flag,
    integer,
    suggestion,
    text,
)
from toothspace.core.status import Status
from toothspace.plotting.style import (
    BLUE,
    ORANGE,
    StudyFigure,
    axis_title,
    key_title,
    panels_of,
    styled,
)
from toothspace.results.variables import unit_of
from toothspace.studies.study import Row, Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import (
    ADDENDUM,
    DISPLACEMENT,
    LIMITS,
    VARY,
    Limit,
    axes_of,
    check_vary,
    unit_samples,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@final
@dataclass(frozen=True, kw_only=True)
class DesignScanStudy(KeyTable):
    """``kind = "design_scan"``: kinematics of very many gears, without runs."""

    vary: Mapping[str, Any] = declare(VARY)
    objective: str = text("Number of the geometry report to be made best.")
    goal: str = choice("Direction.", "maximise", "minimise", default="maximise")
    constraints: Mapping[str, Limit] | None = declare(LIMITS, None)
    design_rules: bool = flag(
        "Whether a best design must keep the design rules of the geometry report.", default=True
    )
    addendum: float | None = declare(ADDENDUM, None)
    displacement: float | None = declare(DISPLACEMENT, None)
    sample_count: int = integer("Number of designs.", low=2, high=10**7, default=100_000)
    method: str = choice("How points are placed.", "latin_hypercube", "sobol", default="sobol")
    best_count: int = integer("Designs in the table of the best.", low=1, high=1000, default=20)
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31, default=0)

    def __post_init__(self) -> None:
        check_vary(self.vary)


def run(case: Case, context: StudyContext) -> StudyResult:
    """Evaluate designs over ``study.vary`` and keep the best that hold the constraints.

    Returns
    -------
    StudyResult
        Kinematic numbers over ``point``, with the reasons against impossible designs, and the
        best designs in their order.

    Raises
    ------
    CaseError
        If a number has an unknown name, a key does not act on the kinematics, or no design is
        possible.
    """
    import xarray as xr

    study = case.study
    assert isinstance(study, DesignScanStudy)
    axes = axes_of(study.vary, case.label, case)
    shares = unit_samples(len(axes), study.method, study.sample_count, study.seed).T
    columns: list[Any] = []
    for axis, row in zip(axes, shares.tolist(), strict=True):
        if axis.path.endswith(".family"):
            columns.append(np.array([axis.quantile(share) for share in row], dtype=str))
            continue
        try:
            columns.append(np.array([axis.quantile(share) for share in row], dtype=float))
        except ValueError as error:
            allowed = "numbers, or texts with a unit"
            raise CaseError(f"study.vary.{axis.path}", "words", allowed) from error
    varied = {
        axis.path: column if column.dtype.kind == "U" else axis.si(column)
        for axis, column in zip(axes, columns, strict=True)
    }
    designs = api.evaluate_designs(
        case, varied, addendum=study.addendum, displacement=study.displacement
    )
    wanted = (study.objective, *(study.constraints or {}))
    for name in wanted:
        if name not in designs.numbers:
            found, allowed = f"{name!r}, which is no result", suggestion(name, designs)
            raise CaseError("study", found, allowed).in_file(case.label)
    if not designs.valid.any():
        against = "; ".join(f"{text}: {count}" for text, count in designs.counts().items())
        raise CaseError(f"{case.label}: study.vary: found no possible design ({against})")
    kept = designs.keeps_rules if study.design_rules else designs.valid
    for name, limit in (study.constraints or {}).items():
        kept = kept & limit.keeps(designs[name])
    sign = -1.0 if study.goal == "maximise" else 1.0
    merit = np.where(kept, sign * designs[study.objective], np.inf)
    best = np.argsort(merit, kind="stable")[: min(study.best_count, int(kept.sum()))].tolist()
    data: dict[str, Any] = {
        axis.path: ("point", column, {"units": axis.unit or "1"})
        for axis, column in zip(axes, columns, strict=True)
    }
    data |= {name: ("point", designs[name], {"units": unit_of(name)}) for name in designs}
    data |= {"reasons": ("point", designs.reasons), "feasible": ("point", kept)}
    attributes = {
        "varied": " ".join(axis.path for axis in axes),
        "objective": study.objective,
        "goal": study.goal,
    }
    head = [f"{axis.path} ({axis.unit})" if axis.unit else axis.path for axis in axes]
    rows: list[Row] = [
        (*(_value(column[k]) for column in columns), *(float(designs[name][k]) for name in designs))
        for k in best
    ]
    counts = designs.counts()
    numbers: dict[str, Any] = {
        "points": len(kept),
        "points_possible": int(designs.valid.sum()),
        "points_feasible": int(kept.sum()),
        "feasible": bool(best),
    }
    if best:
        first = best[0]
        numbers["best"] = {
            a.path: a.written(_value(c[first])) for a, c in zip(axes, columns, strict=True)
        }
        numbers["best_merit"] = float(designs[study.objective][first])
        numbers["best_point"] = {name: float(designs[name][first]) for name in designs}
    return StudyResult(
        status=Status.DONE if best else Status.NOT_CONVERGED,
        data=xr.Dataset(data, attrs=attributes),
        numbers=numbers,
        tables=(
            StudyTable("best", (*head, *designs), tuple(rows)),
            StudyTable("reasons", ("what is against designs", "designs"), tuple(counts.items())),
        ),
    )


def _value(given: Any) -> float | str:
    return str(given) if isinstance(given, str) else float(given)


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Designs that hold all constraints, over each varied key."""
    if not data["feasible"].any():
        return []
    caption = "Designs that hold all constraints, over each varied key; orange: the best."
    return [StudyFigure("designs", caption, feasible_designs(data))]


@styled
def feasible_designs(data: xr.Dataset) -> Figure:
    """Objective of the feasible designs over each varied key."""
    name, kept = data.attrs["objective"], data["feasible"].values
    sign = 1.0 if data.attrs["goal"] == "maximise" else -1.0
    merit = data[name].values
    best = int(np.argmax(np.where(kept, sign * merit, -np.inf)))
    figure, panels = panels_of(data.attrs["varied"].split(), 2, 0.4, 2.4)
    for axes, path in panels:
        axes.plot(data[path].values[kept], merit[kept], ".", color=BLUE, ms=2, rasterized=True)
        axes.plot(data[path].values[best], merit[best], "o", color=ORANGE, ms=6)
        axes.set_xlabel(key_title(data, path))
        axes.set_ylabel(axis_title(name))
    return figure


STUDY = Study(DesignScanStudy, run, figures)
