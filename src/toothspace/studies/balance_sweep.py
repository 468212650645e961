"""Loops of pressure over the balanced area of a floating bearing and its housing friction.

Forces and losses of the films are tabulated over the lift of the bearing for every outlet pressure;
at every lift gears, tilts and deformation find their equilibrium. Any balanced area and any
friction then follow from the tables alone. Bodies bend under the balanced area of the case.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, final

import numpy as np
from scipy.interpolate import PchipInterpolator

from toothspace.case import Case
from toothspace.core.files import plain
from toothspace.core.keys import (
    KeyTable,
    Number,
    grid,
    items,
    quantity,
)
from toothspace.core.progress import tell
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.floating.heat import settle_bearing
from toothspace.floating.housing_friction import BREAKAWAY_RATIO
from toothspace.floating.motion import Balance
from toothspace.floating.problem import LateralProblem, lateral_problem
from toothspace.model.floating_bearing import HousingContact
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    StudyFigure,
    new_figure,
    styled,
)
from toothspace.results.variables import unit_of
from toothspace.studies.bearing_points import (
    LateralPoints,
    PointCondition,
    film_numbers,
    point_key,
    prepare,
)
from toothspace.studies.study import DONE, Record, Row, Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import PRESSURE

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NOT_SETTLED = Status.NOT_CONVERGED.name.lower()
GAPS = (
    np.array([0.4, 0.6, 0.8, 1, 1.2, 1.4, 1.6, 1.8, 2, 2.3, 2.7, 3.2, 4, 5, 7, 10, 14, 20]) * 1e-6
)
"""Gaps at which forces and losses are tabulated: half the lift between two bearings. [m]"""
CLAIMS = ("rises_on_the_way_up", "higher_on_the_way_down", "stays_on_its_film")
"""What the measurements of the source show, see ``claims``."""

_TABULATED = (
    "film_height_um",
    "smallest_film_um",
    "contact_force_N",
    "wear_power_W_per_mm2",
    "leakage_L_per_min",
    "torque_loss_N_m",
)
_EFFECTS = (
    ("smallest_film_um", "Smallest film (µm)"),
    ("contact_force_N", "Load on asperities (N)"),
    ("leakage_L_per_min", "Lateral leakage (L/min)"),
    ("torque_loss_N_m", "Lateral torque loss (N m)"),
)
_NAMES_WIDTH = 0.1
"""Room for the names of claims beside the lines, over the range of ratios. [-]"""
_CLAIM_TEXT = ("rises", "stays higher", "on its film")
_FINE = np.geomspace(GAPS[0], GAPS[-1], 6000)
_PLANE_GAP = 5e-6
_PLANE_ANGLES = 16
_TELL = 1e-9
"""Difference of gaps that counts as a difference. [m]"""


@final
@dataclass(frozen=True, kw_only=True)
class BalanceSweepStudy(KeyTable):
    """``kind = "balance_sweep"``: loops of pressure over balanced area and housing friction."""

    balance_ratio: tuple[float, ...] = grid(
        Number(above=0, high=2), "Balanced area over the reference area."
    )
    friction_coefficient: tuple[float, ...] = items(
        Number(low=0, high=1), "Friction in the housing."
    )
    outlet_pressures: tuple[float, ...] = items(
        PRESSURE, "Outlet pressures in their order, up and down."
    )
    reference_area: float | None = quantity(
        "mm^2",
        "Area of the ratio one; default what plane rigid films carry at the highest pressure.",
        above=0,
        high=1e6,
        default=None,
    )
    start_gap: float = quantity(
        "um", "Gap that the first point starts from.", above=0, high=10, default=1e-6
    )
    lifted_gap: float = quantity(
        "um", "Gap from which the bearing counts as lifted off.", above=1, high=20, default=10e-6
    )

    def port_pressures(self, inlet: float) -> list[tuple[str, float, float]]:
        """Return keys of pressures with the inlet and outlet pressure that they ask for. [Pa]."""
        asked = self.outlet_pressures
        return [(f"study.outlet_pressures[{k}]", inlet, outlet) for k, outlet in enumerate(asked)]


@final
@dataclass(frozen=True, eq=False)
class FilmTable:
    """Films at one outlet pressure over the gap that rigid faces would have."""

    outlet_pressure: float
    difference: float
    """Outlet pressure, and outlet less low pressure. [Pa]"""
    opening: Array
    """Force of films and low pressure away from the gears less the springs, without the balanced
    area, on a fine grid of gaps. [N]
    """
    normal: float
    """Force that presses the bearing against its housing. [N]"""
    numbers: Mapping[str, Array]
    """Numbers of the films over ``GAPS``, names with unit suffix."""
    plane_area: float
    """Area that plane rigid faces would carry. [m2]"""
    unsettled: tuple[str, ...] = ()
    """What did not come to its end, in words: the chambers, or the films at a gap."""

    def at(self, name: str, gaps: Array) -> Array:
        """Number of the films at gaps. [m to unit of the name]."""
        return np.interp(np.log(gaps), np.log(GAPS), self.numbers[name])


def run(case: Case, context: StudyContext) -> StudyResult:
    """Follow the outlet pressures of a case for every balanced area and friction coefficient."""
    assert isinstance(case.study, BalanceSweepStudy)
    return solve(case, case.study, context)


def solve(case: Case, study: BalanceSweepStudy, context: StudyContext) -> StudyResult:
    """Follow the outlet pressures for every balanced area and every friction coefficient.

    Gaps, films and claims over ``friction_coefficient``, ``balance_ratio`` and ``point``.

    Raises CaseError if the case has no operating point or no floating bearing.
    """
    tables = film_tables(case, study, context)
    loops = follow_all(tables, study)
    held, areas = _claimed(study, loops), _loop_areas(study, loops)
    plane = _reference(tables, study) * 1e6
    rows: list[Row] = []
    for (i, mu), (j, ratio) in product(
        enumerate(study.friction_coefficient), enumerate(study.balance_ratio)
    ):
        gaps = loops[i, j] * 1e6
        kept = ["yes" if claim else "no" for claim in held[:, i, j]]
        rows.append((mu, ratio, ratio * plane, float(areas[i, j]), *kept, *map(float, gaps)))
    points = [f"gap_{k + 1}_um" for k in range(loops.shape[-1])]
    head = ("friction_coefficient", "balance_ratio", "balanced_area_mm2", "loop_area_um_bar")
    every = _claimed(study, loops).all(axis=0)
    areas_ratio = np.asarray(study.balance_ratio)
    windows = [areas_ratio[held].tolist() for held in np.atleast_2d(every)]
    return StudyResult(
        status=Status.POINTS_FAILED if any(one.unsettled for one in tables) else Status.DONE,
        data=_dataset(study, tables, loops),
        numbers={
            "plane_area_mm2": tables[-1].plane_area * 1e6,
            "reference_area_mm2": _reference(tables, study) * 1e6,
            "friction_coefficient": list(study.friction_coefficient),
            "lowest_ratio_all_claims": [min(w) if w else None for w in windows],
            "highest_ratio_all_claims": [max(w) if w else None for w in windows],
            "ratios_with_all_claims": windows,
            "unsettled": {
                f"{one.outlet_pressure * 1e-5:.4g} bar": list(one.unsettled)
                for one in tables
                if one.unsettled
            },
        },
        tables=(StudyTable("ratios", (*head, *CLAIMS, *points), tuple(rows)),),
    )


def film_tables(
    case: Case, study: BalanceSweepStudy, context: StudyContext
) -> tuple[FilmTable, ...]:
    """Films of every outlet pressure of the study over the gap, rising pressures.

    Raises CaseError if the case has no operating point or no floating bearing.
    """
    # a coefficient of one leaves the force that presses the bearing against the wall
    points = prepare(case, HousingContact(friction_coefficient=1.0))
    levels = sorted(set(study.outlet_pressures))
    found = []
    for k, pressure in enumerate(levels):
        tell(context.progress, k / len(levels), f"films at {pressure * 1e-5:.4g} bar")
        key = point_key(case, "balance_sweep", pressure)
        kept = context.records.get(key)
        if kept is None:
            table = _film_table(points, pressure)
            told, status = "; ".join(table.unsettled), NOT_SETTLED if table.unsettled else DONE
            context.records.add(Record(key, status, plain(asdict(table)), told))
        else:
            own: dict[str, Any] = {**kept.numbers, "opening": np.array(kept.numbers["opening"])}
            own["numbers"] = {name: np.array(v) for name, v in own["numbers"].items()}
            table = FilmTable(**own)
        found.append(table)
    return tuple(found)


def _film_table(points: LateralPoints, pressure: float) -> FilmTable:
    condition = PointCondition.of(points.case, "", outlet_pressure=pressure)
    run = points.run
    lumped = points.lumped(condition)(run.machine)
    if lumped.status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    problem = lateral_problem(run.machine, run.fluid, lumped.data, points.settings)
    rigid = replace(points.settings, angles=_PLANE_ANGLES, deformation="none")
    plane = lateral_problem(run.machine, run.fluid, lumped.data, rigid)
    back, bearing = problem.loads.back, problem.stack.balance.floating
    difference = back.high - back.low
    settled = []
    for gap in GAPS:
        held = problem.held_at(float(problem.stack.opening @ problem.stack.start(gap)))
        found = settle_bearing(held, held.started(gap))
        own = film_numbers(found.numbers)
        opening = _opening(problem, found.balance)
        numbers = {"opening_N": opening, **{name: own[name] for name in _TABULATED}}
        settled.append((numbers, found.equilibrium.settled and found.warm))
    rows = [row for row, _ in settled]
    unsettled = [] if lumped.status.succeeded else [f"chambers are {lumped.status.name.lower()}"]
    unsettled += [
        f"films at {1e6 * gap:.3g} um do not settle"
        for gap, (_, found) in zip(GAPS, settled, strict=True)
        if not found
    ]
    net = np.array([row.pop("opening_N") for row in rows])
    carried = _opening(plane, plane.started(_PLANE_GAP)) + bearing.preload.size
    return FilmTable(
        pressure,
        difference,
        np.asarray(PchipInterpolator(GAPS, net)(_FINE)),
        problem.loads.friction.coulomb_force,
        {name: np.array([row[name] for row in rows]) for name in rows[0]},
        carried / difference,
        tuple(unsettled),
    )


def _opening(problem: LateralProblem, balance: Balance) -> float:
    """Force of films and low pressure that opens the bearing. [N]."""
    back = problem.loads.back
    parts = slice(0, problem.stack.first_body, 3)  # lifts of the bearing or its halves
    force = [float((s.film_force() + s.back_force(back))[parts].sum()) for s in balance.states]
    closing = problem.stack.balance.floating.high_pressure.area * (back.high - back.low)
    return float(np.mean(force)) + closing


def follow(
    tables: Sequence[FilmTable], order: Sequence[int], load: tuple[float, float], start: float
) -> Array:
    """Gaps of the points in their order, with the set-valued friction law.

    Gaps; the largest tabulated one stands for a bearing that lifted off. [m]

    Parameters
    ----------
    tables : sequence of FilmTable
        Films by rising pressure.
    order : sequence of int
        Table of every point.
    load : tuple of float
        Balanced area [m2] and friction coefficient [-].
    start : float
        Gap before the first point. [m]

    Notes
    -----
    The bearing sticks while the load is below the breakaway force; otherwise it slides until the
    load has fallen to the Coulomb force.
    """
    area, coefficient = load
    gap, gaps = start, []
    for k in order:
        one = tables[k]
        values, coulomb = one.opening - area * one.difference, coefficient * one.normal
        net = float(np.interp(gap, _FINE, values))
        if net > BREAKAWAY_RATIO * coulomb:
            hit = np.flatnonzero((gap <= _FINE) & (values <= coulomb))
            gap = _crossing(values, int(hit[0]), coulomb) if hit.size else float(_FINE[-1])
        elif net < -BREAKAWAY_RATIO * coulomb:
            hit = np.flatnonzero((gap >= _FINE) & (values >= -coulomb))
            gap = _crossing(values, int(hit[-1]) + 1, -coulomb) if hit.size else float(_FINE[0])
        gaps.append(gap)
    return np.array(gaps)


def _crossing(values: Array, after: int, level: float) -> float:
    """Gap at which a falling load passes a level, between two places of the fine grid. [m]."""
    first = after - 1
    drop = values[first] - values[after]
    share = (values[first] - level) / drop if drop != 0.0 else 0.0
    share = float(np.clip(share, 0.0, 1.0))
    return float(_FINE[first] + share * (_FINE[after] - _FINE[first]))


def follow_all(tables: Sequence[FilmTable], study: BalanceSweepStudy) -> Array:
    """Gaps over friction coefficients, balance ratios and points. [m]."""
    order = _order(tables, study)
    plane = _reference(tables, study)
    pairs = product(study.friction_coefficient, study.balance_ratio)
    loops = [follow(tables, order, (ratio * plane, mu), study.start_gap) for mu, ratio in pairs]
    shape = (len(study.friction_coefficient), len(study.balance_ratio), len(order))
    return np.array(loops).reshape(shape)


def claims(gaps: Array, lifted: float) -> tuple[bool, bool, bool]:
    """Whether a loop does what the measurements show.

    The position rises on the way up; it is nowhere lower and somewhere higher on the way down; the
    bearing stays on its film.

    Parameters
    ----------
    gaps : ndarray
        Gaps of one loop, the highest pressure in its middle. [m]
    lifted : float
        Gap from which the bearing counts as lifted off. [m]
    """
    top = len(gaps) // 2
    up, down = gaps[: top + 1], gaps[top:][::-1]
    rises = bool(np.all(np.diff(up) >= -_TELL) and up[-1] > up[0] + _TELL)
    both = min(len(up), len(down))
    up, down = up[-both:], down[-both:]
    higher = bool(np.all(down >= up - _TELL) and np.any(down > up + _TELL))
    return rises, higher, bool(gaps.max() < lifted)


def _order(tables: Sequence[FilmTable], study: BalanceSweepStudy) -> list[int]:
    levels = [table.outlet_pressure for table in tables]
    return [levels.index(pressure) for pressure in study.outlet_pressures]


def _reference(tables: Sequence[FilmTable], study: BalanceSweepStudy) -> float:
    """Balanced area of the ratio one. [m2]."""
    return study.reference_area or tables[-1].plane_area


def _claimed(study: BalanceSweepStudy, loops: Array) -> Array:
    """Claims over their names, friction coefficients and balance ratios."""
    held = [[claims(loop, study.lifted_gap) for loop in row] for row in loops]
    return np.moveaxis(np.array(held, dtype=bool), -1, 0)


def _loop_areas(study: BalanceSweepStudy, loops: Array) -> Array:
    """Area between the ways down and up of the position, that is of two gaps. [um bar].

    Not a number where the bearing leaves the tabulated gaps.
    """
    pressure = np.asarray(study.outlet_pressures)
    areas = -np.trapezoid(2.0 * loops, pressure, axis=-1) * 1e6 * 1e-5
    return np.where(loops.max(axis=-1) < GAPS[-1], areas, np.nan)


def _dataset(study: BalanceSweepStudy, tables: Sequence[FilmTable], loops: Array) -> xr.Dataset:
    import xarray as xr

    order = _order(tables, study)
    dims = ("friction_coefficient", "balance_ratio", "point")
    data: dict[str, Any] = {"gap_um": (dims, loops * 1e6, {"units": "um"})}
    for name in tables[0].numbers:
        values = [tables[k].at(name, loops[..., j]) for j, k in enumerate(order)]
        # beyond the table the bearing lifted off, and its films say nothing
        shown = np.where(loops < GAPS[-1], np.stack(values, axis=-1), np.nan)
        data[name] = (dims, shown, {"units": unit_of(name)})
    data["loop_area_um_bar"] = (dims[:2], _loop_areas(study, loops), {"units": "um bar"})
    data["claim_holds"] = (("claim", *dims[:2]), _claimed(study, loops).astype(np.int8))
    plane = _reference(tables, study) * 1e6
    ratio = np.asarray(study.balance_ratio)
    data["balanced_area_mm2"] = ("balance_ratio", ratio * plane, {"units": "mm2"})
    coords = {
        "friction_coefficient": np.asarray(study.friction_coefficient),
        "balance_ratio": ratio,
        "outlet_pressure_bar": ("point", np.asarray(study.outlet_pressures) * 1e-5),
        "claim": list(CLAIMS),
    }
    return xr.Dataset(data, coords=coords, attrs={"lifted_gap_um": study.lifted_gap * 1e6})


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return gaps with claims over the balance ratio, and sensitivities to area and friction."""
    found = []
    for k, mu in enumerate(data["friction_coefficient"].values):
        caption = (
            f"Gap at every point over the balance ratio with a housing friction of {mu:g}. Full "
            "lines: up; broken lines: down. Bars: ratios at which each claim of the source holds."
        )
        one = data.isel(friction_coefficient=k)
        found.append(StudyFigure(f"balance_window_{k + 1}", caption, balance_window(one)))
    caption = (
        "Films on the way up over the balanced area, one colour per outlet pressure: the more "
        "area, the closer the bearing runs, until asperities carry."
    )
    found.append(StudyFigure("area_sensitivity", caption, area_sensitivity(data)))
    if data.sizes["friction_coefficient"] > 1:
        caption = (
            "Loop area and gap at the highest pressure over the ratio, by housing friction, as far "
            "as the bearing does not lift off."
        )
        found.append(StudyFigure("friction_sensitivity", caption, friction_sensitivity(data)))
    return found


@styled
def balance_window(data: xr.Dataset) -> Figure:
    """Gaps over the balance ratio, and bars where each claim holds, of one friction."""
    figure = new_figure(7.2, 3.4)
    window_on(figure.subplots(), data)
    return figure


def window_on(axes: Axes, data: xr.Dataset) -> None:
    """Draw the window of one friction coefficient into given axes."""
    ratio, gaps = data["balance_ratio"].values, data["gap_um"].values
    count = gaps.shape[-1]
    top = count // 2
    lifted = float(data.attrs["lifted_gap_um"])
    for k, color in zip(range(top + 1), _cycle(top + 1), strict=True):
        back = count - 1 - k
        label = f"point {k + 1} and {back + 1}" if back != k else f"point {k + 1}"
        axes.plot(ratio, gaps[:, k], color=color, label=label)
        axes.plot(ratio, gaps[:, back], "--", color=color)
    axes.axhline(lifted, color=GREY, lw=0.8, ls=":")
    low = 0.9 * float(np.nanmin(gaps))
    for row, (held, text) in enumerate(zip(data["claim_holds"].values, _CLAIM_TEXT, strict=True)):
        height = low * 0.86 ** (row + 1)
        axes.plot(ratio, np.where(held, height, np.nan), lw=3, color=GREEN, solid_capstyle="butt")
        axes.text(ratio[0], height, f"{text} ", fontsize=6, ha="right", va="center")
    axes.set_xlim(ratio[0] - _NAMES_WIDTH * (ratio[-1] - ratio[0]), ratio[-1])
    axes.set_ylim(low * 0.6, None)
    _decades(axes)
    axes.set_xlabel("Balanced area over the area that plane films carry")
    axes.set_ylabel("Gap of rigid faces (µm)")
    axes.legend(fontsize=7)


def _decades(axes: Axes) -> None:
    """Logarithmic heights with a few plain numbers beside them."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    ticks = [t for t in (0.2, 0.5, 1, 2, 3, 5, 10, 20, 50) if low <= t <= high]
    axes.set_yticks(ticks, labels=[f"{t:g}" for t in ticks])
    axes.minorticks_off()


def _cycle(count: int) -> Sequence[str]:
    colours = (BLUE, ORANGE, GREY, INK, *CYCLE)
    return [colours[k % len(colours)] for k in range(count)]


@styled
def area_sensitivity(data: xr.Dataset) -> Figure:
    """Films on the way up over the balance ratio at the first friction coefficient."""
    figure = new_figure(7.2, 5.4)
    one = data.isel(friction_coefficient=0)
    pressure = one["outlet_pressure_bar"].values
    top = int(np.argmax(pressure))
    for axes, (name, label) in zip(figure.subplots(2, 2, sharex=True).flat, _EFFECTS, strict=True):
        for k, color in zip(range(top + 1), _cycle(top + 1), strict=True):
            values = one[name].values[:, k]
            axes.plot(one["balance_ratio"], values, color=color, label=f"{pressure[k]:.4g} bar")
        axes.set_ylabel(label)
    _decades(figure.axes[0])
    figure.axes[0].legend(fontsize=7)
    for axes in figure.axes[2:]:
        axes.set_xlabel("Balance ratio")
    return figure


@styled
def friction_sensitivity(data: xr.Dataset) -> Figure:
    """Loop area and gap at the highest pressure over the ratio, one line per friction."""
    figure = new_figure(7.2, 3.2)
    left, right = figure.subplots(1, 2)
    top = int(np.argmax(data["outlet_pressure_bar"].values))
    for k, mu in enumerate(data["friction_coefficient"].values):
        color = CYCLE[k % len(CYCLE)]
        one = data.isel(friction_coefficient=k)
        left.plot(one["balance_ratio"], one["loop_area_um_bar"], color=color, label=f"{mu:g}")
        on_film = np.isfinite(one["film_height_um"].values[:, top])
        gap = np.where(on_film, one["gap_um"].values[:, top], np.nan)
        right.plot(one["balance_ratio"], gap, color=color, label=f"{mu:g}")
    left.set_ylabel("Loop area (µm bar)")
    right.set_ylabel("Gap at the highest pressure (µm)")
    _decades(right)
    for axes in (left, right):
        axes.set_xlabel("Balance ratio")
    left.legend(title="Housing friction", fontsize=7)
    return figure


STUDY = Study(BalanceSweepStudy, run, figures)
