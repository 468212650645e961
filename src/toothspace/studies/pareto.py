"""Designs that no other one beats in all of several objectives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace import api
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    Choice,
    KeyTable,
    Named,
    choice,
    declare,
    flag,
    integer,
)
from toothspace.core.status import Status
from toothspace.core.types import Array, BoolArray
from toothspace.plotting.section import recess_outlines, turned_section
from toothspace.plotting.style import (
    BLUE,
    GREY,
    INK,
    LIGHT,
    METAL,
    ORANGE,
    StudyFigure,
    axis_title,
    new_figure,
    styled,
)
from toothspace.results.variables import STEADY, require_known
from toothspace.studies.points import (
    Point,
    evaluate_points,
    point,
    points_dataset,
    points_table,
    require_accepted,
    require_results,
)
from toothspace.studies.study import (
    NOT_RUN,
    Record,
    Row,
    Study,
    StudyContext,
    StudyResult,
    StudyTable,
    failed_count,
)
from toothspace.studies.variation import (
    ADDENDUM,
    DISPLACEMENT,
    LIMITS,
    VARY,
    Limit,
    axes_of,
    check_vary,
    unit_samples,
    values_at,
    written_values,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from toothspace.geometry.evaluated_designs import EvaluatedDesigns

_FAILED = 1e3
"""Violation of a point without results: more than that of any that has some."""
_WIDTH, _TIP = "machine.gears.face_width", "machine.gears.tip_diameter"
_DERIVED = {_WIDTH: "face_width_mm", _TIP: "tip_diameter_mm"}
_FREE_DESIGNS = 50
"""Designs that are looked at for one that is run."""
_SPREAD = 5.0
"""Index of the distributions of children round their parents; small spreads widely. [-]"""
_MM = 1e3
_DRAWN_ERROR = 1e-5
"""What drawn outlines may deviate. [m]"""


@final
@dataclass(frozen=True, kw_only=True)
class ParetoStudy(KeyTable):
    """``kind = "pareto"``: best compromises between several objectives."""

    vary: Mapping[str, Any] = declare(VARY)
    objectives: Mapping[str, str] = declare(
        Named(
            item=Choice(options=("minimise", "maximise"), doc="Direction."),
            doc="At least two summary numbers, or numbers of the geometry, with their directions.",
        )
    )
    constraints: Mapping[str, Limit] | None = declare(LIMITS, None)
    method: str = choice(
        "Search: NSGA-II, or a Sobol sequence over the whole range without any search.",
        "nsga2",
        "sobol",
        default="nsga2",
    )
    evaluation_count: int = integer("Most runs.", low=2, high=10**6, default=200)
    population_size: int = integer(
        "Designs of one generation, shared by the workers.", low=4, high=10**4, default=40
    )
    design_rules: bool = flag(
        "Whether a design must keep the design rules of the geometry report to be run.",
        default=True,
    )
    addendum: float | None = declare(ADDENDUM, None)
    displacement: float | None = declare(DISPLACEMENT, None)
    drawn_designs: int = integer(
        "Designs of the front whose sections are drawn.", low=0, high=24, default=6
    )
    seed: int = integer("Seed of the random numbers.", low=0, high=2**31 - 1, default=0)

    def __post_init__(self) -> None:
        check_vary(self.vary)
        if len(self.objectives) < 2:
            raise CaseError("objectives", f"{len(self.objectives)}", "at least two")


def run(case: Case, context: StudyContext) -> StudyResult:
    """Search for the designs that no other one beats in all objectives.

    Returns
    -------
    StudyResult
        All designs tried in their order, those on the front, and outlines of some of them.

    Raises
    ------
    CaseError
        If a result has an unknown name, pymoo is missing, or no design can be run.

    Notes
    -----
    Where the machine has kinematics in closed form, they are computed first: a design that
    cannot be made, or breaks a constraint of its geometry, is not run, does not count as one of
    the ``evaluation_count``, and is infeasible by how far it is off. A run that fails is
    infeasible too. The first generation is a third of the runs. NSGA-II prefers feasible designs,
    among infeasible ones the smaller violation, among feasible ones the better front and the
    emptier part of it.

    References
    ----------
    .. [1] K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, A fast and elitist multiobjective genetic
       algorithm: NSGA-II, IEEE Trans. Evol. Comput. 6 (2002) 182-197.
    """
    study = case.study
    assert isinstance(study, ParetoStudy)
    tried = _TriedDesigns(case, study, context)
    status = Status.DONE
    try:
        for shares, told in _generations(study, tried):
            told(*tried.evaluate(shares))
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
    require_accepted([r for r in tried.records if r.status != NOT_RUN])
    front = tried.front()
    if not front and status is Status.DONE:
        status = Status.NOT_CONVERGED
    data = points_dataset(tried.axes, tried.rows, tried.records)
    on_front = np.isin(np.arange(len(tried.records)), front)
    feasible = np.array([v == 0.0 for v in tried.violations], dtype=bool)
    data = data.assign(feasible=("point", feasible), front=("point", on_front))
    data = data.assign(_sections(tried, _spread(front, study.drawn_designs)))
    data.attrs["varied"] = " ".join(axis.path for axis in tried.axes)
    data.attrs["objectives"] = " ".join(study.objectives)
    data.attrs["goals"] = " ".join(study.objectives.values())
    return StudyResult(
        status=status,
        data=data,
        numbers=tried.numbers(front),
        tables=(
            *tried.front_table(front),
            points_table(tried.axes, tried.rows, tried.records),
        ),
    )


Answer = Any
"""Takes the objectives to be made small, shape (designs, objectives), and the violations."""


def _generations(study: ParetoStudy, tried: _TriedDesigns) -> Iterator[tuple[Array, Answer]]:
    """Yield designs as points of the unit cube, and what takes their objectives."""
    budget = study.evaluation_count
    if study.method == "sobol":
        yield tried.runnable(budget, study.seed), lambda *_: None
        return
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM
        from pymoo.problems.static import StaticProblem
        from pymoo.termination import get_termination
    except ImportError as error:
        found = "'nsga2', which needs the package pymoo"
        allowed = "'sobol', or 'nsga2' after pip install \"toothspace[design]\""
        raise CaseError("study.method", found, allowed) from error
    size = min(study.population_size, budget)
    first = tried.runnable(min(max(size, budget // 3), budget), study.seed)
    keys = first.shape[1]
    problem = Problem(n_var=keys, n_obj=len(study.objectives), n_ieq_constr=1, xl=0.0, xu=1.0)
    search = NSGA2(
        pop_size=size,
        sampling=first,
        crossover=SBX(eta=_SPREAD, prob=0.9),
        mutation=PM(eta=_SPREAD, prob=0.9),
    )
    # it ends by the number of runs: designs that are not run cost nothing
    generations = _FREE_DESIGNS * budget // size + 1
    search.setup(problem, termination=get_termination("n_gen", generations), seed=study.seed)
    while search.has_next() and tried.run_count < budget:
        asked = search.ask()

        def told(values: Array, violations: Array, asked: Any = asked) -> None:
            answer = StaticProblem(problem, F=values, G=violations[:, None])
            Evaluator().eval(answer, asked[: len(values)])
            search.tell(infills=asked[: len(values)])

        yield np.asarray(asked.get("X"), dtype=float), told


@final
class _TriedDesigns:
    """Designs tried so far, and how good they are."""

    def __init__(self, case: Case, study: ParetoStudy, context: StudyContext) -> None:
        self.case, self.study, self.context = case, study, context
        self.axes = axes_of(study.vary, case.label, case)
        self.rows: list[tuple[Any, ...]] = []
        self.points: list[Point] = []
        self.records: list[Record] = []
        self.violations: list[float] = []
        self.run_count = 0
        self.kinematic_keys = [axis.path for axis in self.axes if self._is_kinematic(axis.path)]
        wanted = {f"study.objectives.{name}": name for name in study.objectives}
        wanted |= {f"study.constraints.{name}": name for name in study.constraints or {}}
        middle = self._kinematics(values_at(self.axes, np.full((1, len(self.axes)), 0.5)))
        known = set(middle) - set(STEADY) if middle is not None else set()
        self.early = {n: x for n, x in (study.constraints or {}).items() if n in known}
        """Constraints that are known before a run."""
        later = {key: name for key, name in wanted.items() if name not in known}
        require_known(later, case.label, over_time=case.circuit is not None)

    def _is_kinematic(self, path: str) -> bool:
        """Whether a key acts on kinematics that are known in closed form."""
        if not path.startswith("machine.") or path.endswith(("face_width", "tip_diameter")):
            return path in _DERIVED and self._tried(path)
        return self._tried(path)

    def _tried(self, path: str) -> bool:
        try:
            api.evaluate_designs(self.case, {path: np.array([np.nan])})
        except CaseError:
            return False
        return True

    def _kinematics(self, rows: Sequence[tuple[Any, ...]]) -> EvaluatedDesigns | None:
        study = self.study
        if not self.kinematic_keys:
            if study.displacement is not None or study.addendum is not None:
                found = "addendum or displacement, but no varied key of gears in closed form"
                allowed = "keys of involute gears given by parameters in vary"
                raise CaseError("study", found, allowed).in_file(self.case.label)
            return None
        columns = {
            axis.path: axis.si(np.array([row[k] for row in rows], dtype=float))
            for k, axis in enumerate(self.axes)
            if axis.path in self.kinematic_keys
        }
        return api.evaluate_designs(
            self.case, columns, addendum=study.addendum, displacement=study.displacement
        )

    def runnable(self, count: int, seed: int) -> Array:
        """First points of a Sobol sequence whose geometry is possible and keeps its limits."""
        shares = unit_samples(len(self.axes), "sobol", count, seed)
        if not self.kinematic_keys:
            return shares
        shares = unit_samples(len(self.axes), "sobol", _FREE_DESIGNS * count, seed)
        designs = self._kinematics(values_at(self.axes, shares))
        assert designs is not None
        kept = designs.keeps_rules if self.study.design_rules else designs.valid
        for name, limit in self.early.items():
            kept = kept & limit.keeps(designs[name])
        if not kept.any():
            against = [f"{text}: {n}" for text, n in designs.counts().items()]
            against += [f"{name} out of its limits" for name in self.early]
            raise CaseError(
                "study.vary",
                f"no possible design among {len(kept)} ({'; '.join(against)})",
                "wider ranges or limits",
            ).in_file(self.case.label)
        return shares[kept][:count]

    def evaluate(self, shares: Array) -> tuple[Array, Array]:
        """Run designs; returns their objectives to be made small, and their violations."""
        rows = values_at(self.axes, shares)
        designs = self._kinematics(rows)
        points: list[Point] = []
        early: list[Record | None] = []
        known: list[dict[str, float]] = []
        for k, row in enumerate(rows):
            numbers = {} if designs is None else {n: float(designs[n][k]) for n in designs}
            values = written_values(self.axes, row)
            if self.study.displacement is not None:
                values[_WIDTH] = f"{numbers[_DERIVED[_WIDTH]]:.9g} mm"
            if self.study.addendum is not None:
                values[_TIP] = f"{numbers[_DERIVED[_TIP]]:.9g} mm"
            against = "" if designs is None else self._against(designs, k, numbers)
            known.append(numbers)
            early.append(Record("", NOT_RUN, numbers, against) if against else None)
            points.append(Point(values, None, against) if against else point(self.case, values))
        # the last generation is cut where the budget ends
        left = self.study.evaluation_count - self.run_count
        ends = np.flatnonzero(np.cumsum([record is None for record in early]) > left)
        size = int(ends[0]) if ends.size else len(rows)
        rows, points, early, known = rows[:size], points[:size], early[:size], known[:size]
        asked = [p for p, record in zip(points, early, strict=True) if record is None]
        self.run_count += len(asked)
        done = f"{self.run_count} run, {len(self.front())} on the front"
        context = self.context.counted(self.run_count, self.study.evaluation_count, done)
        found = iter(evaluate_points(asked, context))
        for item, row, record, numbers in zip(points, rows, early, known, strict=True):
            ran = record or next(found)
            merged = ran if record else replace(ran, numbers={**numbers, **ran.numbers})
            self.points.append(item)
            self.rows.append(row)
            self.records.append(merged)
            self.violations.append(self._violation(merged))
        start = len(self.records) - len(rows)
        wanted = (*self.study.objectives, *(self.study.constraints or {}))
        require_results(self.records[start:], wanted, self.case.label)
        merits = [self._merits(record) for record in self.records[start:]]
        return np.array(merits), np.array(self.violations[start:])

    def _against(self, designs: EvaluatedDesigns, k: int, numbers: Mapping[str, float]) -> str:
        """What is against a design before any run, in words; empty if nothing is."""
        if not (designs.keeps_rules if self.study.design_rules else designs.valid)[k]:
            return "; ".join(designs.why(k))
        broken = [n for n, limit in self.early.items() if limit.violation(numbers[n]) > 0.0]
        return "; ".join(f"not run: {n} = {numbers[n]:.4g} breaks its limit" for n in broken)

    def _violation(self, record: Record) -> float:
        """Sum of what breaks the constraints, each over the size of its limit. [-]."""
        limits = self.study.constraints or {}
        if record.status == NOT_RUN:
            off = sum(x.violation(record.number(name)) for name, x in self.early.items())
            # behind every design that was run, but still nearer or farther from the limits
            return 0.5 * _FAILED + off
        if not record.succeeded or not all(np.isfinite(self._merits(record))):
            return _FAILED
        return sum(limit.violation(record.number(name)) for name, limit in limits.items())

    def _merits(self, record: Record) -> list[float]:
        """Objectives with their signs, so that small is good; large where they are unknown."""
        signed = [
            (-1.0 if goal == "maximise" else 1.0) * record.number(name)
            for name, goal in self.study.objectives.items()
        ]
        return [1e12 if math.isnan(x) else x for x in signed]

    def front(self) -> list[int]:
        """Numbers of the feasible designs that no other one beats, by the first objective."""
        feasible = [k for k, violation in enumerate(self.violations) if violation == 0.0]
        if not feasible:
            return []
        merits = np.array([self._merits(self.records[k]) for k in feasible])
        best = [k for k, kept in zip(feasible, not_beaten(merits), strict=True) if kept]
        return sorted(best, key=lambda k: self._merits(self.records[k]))

    def compromise(self, front: Sequence[int]) -> int:
        """Number of the design nearest to the best of every objective, over their ranges."""
        merits = np.array([self._merits(self.records[k]) for k in front])
        span = np.ptp(merits, axis=0)
        far = (merits - merits.min(axis=0)) / np.where(span > 0.0, span, 1.0)
        return front[int(np.argmin(np.hypot.reduce(far, axis=1)))]

    def numbers(self, front: Sequence[int]) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        skipped = sum(record.status == NOT_RUN for record in self.records)
        found: dict[str, Any] = {
            "points": len(self.records),
            "points_not_run": skipped,
            "points_failed": failed_count([r for r in self.records if r.status != NOT_RUN]),
            "points_feasible": sum(v == 0.0 for v in self.violations),
            "front_count": len(front),
            "feasible": bool(front),
        }
        if not front:
            return found
        middle = self.compromise(front)
        return {
            **found,
            "front": list(front),
            "compromise": middle,
            "best": dict(self.points[middle].values),
            "best_point": {n: self.records[middle].number(n) for n in self._shown()},
        }

    def _shown(self) -> list[str]:
        return list(dict.fromkeys((*self.study.objectives, *(self.study.constraints or {}))))

    def front_table(self, front: Sequence[int]) -> tuple[StudyTable, ...]:
        """Return the table of the front: values as in a case file, objectives, constraints."""
        if not front:
            return ()
        names = self._shown()
        paths = list(self.points[front[0]].values)
        rows: list[Row] = [
            (
                float(k),
                *(str(self.points[k].values[path]) for path in paths),
                *(self.records[k].number(name) for name in names),
            )
            for k in front
        ]
        return (StudyTable("front", ("point", *paths, *names), tuple(rows)),)


def not_beaten(merits: Array) -> BoolArray:
    """Rows that no other row beats: as small in all columns, and smaller in one. [-].

    Parameters
    ----------
    merits : ndarray, shape (designs, objectives)
        Objectives, small is good. [any]
    """
    better = np.ones((len(merits), len(merits)), dtype=bool)
    smaller = np.zeros_like(better)
    for column in merits.T:
        better &= column[:, None] <= column[None, :]
        smaller |= column[:, None] < column[None, :]
    return np.asarray(~(better & smaller).any(axis=0))


def _spread(front: Sequence[int], count: int) -> list[int]:
    """Some designs of a front, its ends among them."""
    if count == 0 or not front:
        return []
    shown = np.unique(np.linspace(0, len(front) - 1, min(count, len(front))).round().astype(int))
    return [front[k] for k in shown]


def _sections(tried: _TriedDesigns, chosen: Sequence[int]) -> dict[str, Any]:
    """Outlines of designs as variables: bodies first, then casing and recesses. [mm]."""
    drawn: list[list[Array]] = []
    names: list[str] = []
    for k in chosen:
        case = tried.points[k].case
        assert case is not None
        description = api.describe(case)
        bodies = [turned_section(description, body, 0.0) for body in description.bodies]
        rings = [
            (body.name, s.exterior) for body, s in zip(description.bodies, bodies, strict=True)
        ]
        rings += [("hole", hole) for s in bodies for hole in s.interiors]
        fixed = {"casing": description.outlines["casing"], **recess_outlines(description)}
        names = [name for name, _ in rings] + list(fixed)
        lines = [np.asarray(r.simplify(_DRAWN_ERROR).coords) for _, r in rings]
        drawn.append([_MM * line for line in (*lines, *fixed.values())])
    if not drawn:
        return {}
    longest = max(len(line) for lines in drawn for line in lines)
    table = np.full((len(drawn), max(map(len, drawn)), longest, 2), np.nan)
    for d, lines in enumerate(drawn):
        for j, line in enumerate(lines):
            table[d, j, : len(line)] = line
    return {
        "section": (("drawn", "outline", "vertex", "axis"), table, {"units": "mm"}),
        "section_outline": (("outline",), np.array(names, dtype=str)),
        "section_point": (("drawn",), np.array(chosen)),
    }


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Front over its objectives, and sections of its designs."""
    if "front" not in data or not data["front"].any():
        return []
    caption = (
        "Designs over the objectives. Orange: the front, which no other design beats; blue: "
        "feasible; grey: a constraint is broken. Figures: numbers of the designs that are drawn."
    )
    found = [StudyFigure("front", caption, front_figure(data))]
    if "section" in data:
        found.append(
            StudyFigure(
                "designs",
                "Sections of designs on the front, in one scale, by the first objective.",
                design_sections(data),
            )
        )
    return found


@styled
def front_figure(data: xr.Dataset) -> Figure:
    """Objectives of all designs, one panel for each pair."""
    names = data.attrs["objectives"].split()
    pairs = list(combinations(names, 2))
    columns = min(len(pairs), 2)
    rows = -(-len(pairs) // columns)
    figure = new_figure(5.4 if columns == 1 else 7.2, 0.4 + (3.6 if rows == 1 else 3.0 * rows))
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    for axes in panels[len(pairs) :]:
        axes.set_visible(False)
    for axes, pair in zip(panels, pairs, strict=False):
        _front_panel(axes, data, *pair)
    return figure


def _front_panel(axes: Axes, data: xr.Dataset, first: str, second: str) -> None:
    x, y = data[first].values, data[second].values
    front = data["front"].values.astype(bool)
    kept = data["feasible"].values.astype(bool) & ~front
    broken = ~kept & ~front
    axes.plot(x[broken], y[broken], ".", color=GREY, ms=3, alpha=0.6, zorder=1)
    axes.plot(x[kept], y[kept], ".", color=BLUE, ms=5, zorder=2)
    axes.plot(x[front], y[front], "o", color=ORANGE, ms=5, zorder=3)
    goals = dict(zip(data.attrs["objectives"].split(), data.attrs["goals"].split(), strict=True))
    for limit, values, name in ((axes.set_xlim, x, first), (axes.set_ylim, y, second)):
        # the worst quarter would press the front into a corner
        share = 75.0 if goals[name] == "minimise" else 25.0
        ends = np.append(values[front], np.nanpercentile(values[kept | front], share))
        margin = 0.1 * float(np.ptp(ends)) or 1.0
        limit(float(ends.min()) - margin, float(ends.max()) + margin)
    for k in data["section_point"].values if "section_point" in data else ():
        axes.annotate(f"{k}", (x[k], y[k]), (4, 4), textcoords="offset points", fontsize=8)
    axes.set(xlabel=axis_title(first), ylabel=axis_title(second))


@styled
def design_sections(data: xr.Dataset) -> Figure:
    """Sections of designs on the front, in one scale."""
    table = data["section"].values
    names = [str(name) for name in data["section_outline"].values]
    objectives = data.attrs["objectives"].split()
    columns = min(len(table), 3)
    rows = -(-len(table) // columns)
    width, height = (float(np.nanmax(table[..., k]) - np.nanmin(table[..., k])) for k in (0, 1))
    panel = 7.2 / columns
    figure = new_figure(7.2, rows * (panel * height / width + 0.2 + 0.16 * len(objectives)))
    panels = list(figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).flat)
    for axes in panels:
        axes.set_axis_off()
        axes.set_aspect("equal")
    for axes, lines, k in zip(panels, table, data["section_point"].values, strict=False):
        for name, line in sorted(zip(names, lines, strict=True), key=lambda x: x[0] != "casing"):
            points = line[np.isfinite(line[:, 0])]
            if name.startswith(("groove_", "port_")):
                axes.plot(*points.T, color=INK, lw=0.8, ls=(0, (4, 2)))
                continue
            colour = LIGHT if name in {"casing", "hole"} else METAL
            axes.fill(*points.T, facecolor=colour, edgecolor=INK, lw=0.6)
        numbers = (f"{axis_title(n)}: {float(data[n][k]):.4g}" for n in objectives)
        axes.set_title("\n".join((f"Design {k}", *numbers)), fontsize=7, fontweight="normal")
    return figure


STUDY = Study(ParetoStudy, run, figures)
