"""Wear over hours of service: journals, faces and casing, and what the worn machine delivers."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.closures.contact_rough import asperity_pressure
from toothspace.closures.wear import cutting_time, wear_depth_rate, worn_time
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    QuantityKey,
    Table,
    choice,
    declare,
    grid,
    items,
    number,
    quantity,
    table,
)
from toothspace.core.progress import part
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREEN,
    ORANGE,
    StudyFigure,
    axis_title,
    has_numbers,
    new_figure,
    spread,
    styled,
)
from toothspace.results.solution import Solution
from toothspace.results.variables import unit_of
from toothspace.run.run import Run
from toothspace.run.running_in import Tracks
from toothspace.studies.points import (
    NOT_A_RESULT,
    collected,
    map_dataset,
    numbers_of,
    operating_point_of,
    operating_values,
    point,
    status_of,
)
from toothspace.studies.study import Record, Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import LIMITS, PRESSURE, SPEED, Limit

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_HOUR = 3600.0
_COEFFICIENT: dict[str, Any] = {"low": 0.0, "high": 1.0}
_SAID = "worn volume over load and sliding distance"
_NEW_TRACK = 1e-7
"""Deepening of the track above which a machine is run again at the same hours. [m]"""


@final
@dataclass(frozen=True, kw_only=True)
class WearingJournals(KeyTable):
    """``[study.journals]``: bushes of the journal bearings; the shafts are hard."""

    wear_coefficient: float = quantity("mm^3/(N m)", f"Of the bushes: {_SAID}.", **_COEFFICIENT)
    film_share: float = number(
        "Share of the load on the film that wears as if surfaces touched, by dirt that is larger "
        "than the film; the load on asperities counts whole.",
        low=0,
        high=1,
        default=0.0,
    )
    shape: str = choice(
        "Shape of a worn bush: a pocket in which the shaft sinks with the film of the new bearing, "
        "or a wider round bore, whose film is thinner.",
        "conforming",
        "round",
        default="conforming",
    )


@final
@dataclass(frozen=True, kw_only=True)
class WearingFaces(KeyTable):
    """``[study.faces]``: bushing faces or side plates along the gears."""

    wear_coefficient: float = quantity("mm^3/(N m)", f"Of the faces: {_SAID}.", **_COEFFICIENT)
    pressure: float = quantity(
        "bar",
        "Mean pressure of the faces on the gears, beside that on asperities of solved films.",
        low=0,
        high=1000,
        default=0.0,
    )
    opening: float = number(
        "Share of the worn depth that opens the side gap: 0 where a pressure-compensated part "
        "follows its wear, 1 between rigid covers.",
        low=0,
        high=1,
        default=0.0,
    )


@final
@dataclass(frozen=True, kw_only=True)
class WearingCasing(KeyTable):
    """``[study.casing]``: bores that the tips cut as the gears sink into worn bushes."""

    wear_coefficient: float = quantity("mm^3/(N m)", f"Of the casing: {_SAID}.", **_COEFFICIENT)


@final
@dataclass(frozen=True, kw_only=True)
class BreakIn(KeyTable):
    """``[study.break_in]``: faster wear of new surfaces."""

    factor: float = number("Rate of wear when new over the steady rate.", low=1, high=1000)
    time: float = quantity("h", "Hours after which the excess falls to 1/e.", above=0, high=1e5)


@final
@dataclass(frozen=True, kw_only=True)
class DutyPoint(KeyTable):
    """One point of the duty cycle."""

    share: float = number("Share of the hours.", above=0, high=1)
    shaft_speed: float = declare(replace(SPEED, doc="Shaft speed."))
    pressure_difference: float = declare(replace(PRESSURE, doc="High minus low pressure."))


@final
@dataclass(frozen=True, kw_only=True)
class WearStudy(KeyTable):
    """``kind = "wear"``: wear over hours, and the machine run again as it wears."""

    hours: tuple[float, ...] = grid(
        QuantityKey(unit="h", above=0, high=1e6),
        "Hours of service, rising, at which the machine is run again; it also runs new.",
    )
    duty: tuple[DutyPoint, ...] = items(
        Table(spec=DutyPoint),
        "Points of the duty cycle whose shares sum to 1; default the operating point.",
        default=(),
        high=20,
    )
    journals: WearingJournals | None = table(WearingJournals, "Journal bearings.", default=None)
    faces: WearingFaces | None = table(WearingFaces, "Faces beside the gears.", default=None)
    casing: WearingCasing | None = table(WearingCasing, "Casing round the gears.", default=None)
    break_in: BreakIn | None = table(BreakIn, "Break-in; leave out for none.", default=None)
    limits: Mapping[str, Limit] | None = declare(LIMITS, None)

    def __post_init__(self) -> None:
        if any(b <= a for a, b in zip(self.hours, self.hours[1:], strict=False)):
            found = ", ".join(f"{hour / _HOUR:g} h" for hour in self.hours)
            raise CaseError("hours", found, "hours that rise")
        if not any((self.journals, self.faces, self.casing)):
            raise CaseError("", "nothing that wears", "journals, faces or casing")
        total = sum(one.share for one in self.duty)
        if self.duty and abs(total - 1.0) > 1e-6:
            raise CaseError("duty", f"shares that sum to {total:g}", "shares that sum to 1")

    def worn_time(self, time: float) -> float:
        """Time at the steady rate that wears as much as a time since new. [s]."""
        early = self.break_in
        return time if early is None else worn_time(time, early.factor, early.time)


@final
@dataclass(frozen=True)
class Wear:
    """How far a machine is worn."""

    journals: float = 0.0
    """Depth in the most worn bush, in the direction of its load. [m]"""
    faces: float = 0.0
    """Depth of each face. [m]"""
    tracks: Mapping[str, Array] = field(default_factory=dict)
    """What was cut after running-in, by the body that cuts, at the nodes of its gap. [m]"""


@final
@dataclass(frozen=True)
class WornMachine:
    """Evaluates a worn machine at a point: its numbers, and what its parts rub with."""

    new: Case
    """The machine as new; running-in has cut its casing."""
    tracks: Mapping[str, Array]
    """What was cut after that. [m]"""

    @property
    def label(self) -> str:
        """What is evaluated, in one word."""
        content = b"".join(np.asarray(depth).tobytes() for depth in self.tracks.values())
        return f"worn {hashlib.sha256(content).hexdigest()[:32]} {self.new.hash}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Numbers of a case with worn clearances."""
        from toothspace import api

        run, new = api.prepare(case), api.prepare(self.new).worn()
        depths = {
            body: depth + self.tracks.get(body, 0.0) for body, depth in all_tracks(new).items()
        }
        machine = replace(run.machine.with_running_in(depths), running_in=None)
        worn = replace(run, machine=machine, tracks=Tracks(depths))
        solution = import_module(case.run.preset.module).simulate(worn)
        numbers = dict(numbers_of(solution))
        if solution.status is Status.DONE:
            numbers["rubbing"] = rubbing(solution, machine)
            numbers["track_depth_um"] = 1e6 * max((d.max() for d in depths.values()), default=0.0)
        return numbers


def all_tracks(run: Run) -> dict[str, Array]:
    """Tracks of running-in of every body that can cut its gap, of depth zero without. [m]."""
    return {
        path.worn_by: run.tracks.depths.get(path.worn_by, np.zeros(path.geometry.values.shape[0]))
        for path in run.machine.paths
        if path.worn_by is not None
    }


def rubbing(solution: Solution, machine: MachineDescription) -> dict[str, Any]:
    """With what the parts of a machine rub in a revolution: loads, speeds, overlaps.

    ``journals`` and ``tracks`` by body: mean force [N], that on asperities [N], speed [m/s];
    overlap at the nodes of the gap [m], stiffness of the bearings [N/m], radius, width [m] and
    speed [m/s] of the tips. ``faces``: mean asperity pressure times speed [W/m2], speed [m/s].
    """
    data, turning = solution.data, abs(float(solution.data["shaft_speed"].mean()))
    ratios = {body.name: abs(body.speed_ratio) for body in machine.bodies}
    bearings: dict[str, dict[str, float]] = {}
    stiffness: dict[str, float] = {}
    for journal in machine.journals:
        sides = data["journal_force"].sel(body=journal.body)
        force = float(np.hypot(sides.sel(axis="x"), sides.sel(axis="y")).mean())
        speed = 0.5 * journal.diameter * ratios[journal.body] * turning
        film = np.asarray(data["journal_film_height"].sel(journal=journal.body))
        surface = journal.roughness, journal.correlation_length
        solid = journal.effective_modulus, journal.hardness
        touching = np.mean([asperity_pressure(max(h, 0.0), *surface, *solid) for h in film])
        bearings[journal.body] = {
            "force": force,
            "speed": speed,
            "area": journal.count * journal.diameter * journal.length,
            "touching": float(touching),
        }
        stiffness[journal.body] = force / max(float(film.mean()), journal.roughness)
    # work of friction of all asperities, shared as they touch
    power = float(data["power_loss"].sel(mechanism="journal_asperity").mean()) if bearings else 0.0
    friction = {journal.body: journal.boundary_friction for journal in machine.journals}
    total = sum(friction[body] * one["touching"] * one["speed"] for body, one in bearings.items())
    for one in bearings.values():
        touching = one.pop("touching")
        one["asperity_force"] = max(power, 0.0) * touching / total if total > 0.0 else 0.0
    return {
        "journals": bearings,
        "faces": _faces(data, machine, turning),
        "tracks": _tracks(data, machine, stiffness, turning),
    }


def _faces(data: xr.Dataset, machine: MachineDescription, turning: float) -> dict[str, float]:
    found = {"power": 0.0, "speed": 0.0}
    radii = [(film.inner_radius, film.outer_radius) for film in machine.laterals]
    if radii:
        # mean of the speed over the faces
        means = [2.0 / 3.0 * (b**3 - a**3) / (b * b - a * a) for a, b in radii]
        found["speed"] = float(np.mean(means)) * turning
    if "film_wear_power" in data:
        weight = data["film_radius"] * np.isfinite(data["film_wear_power"])
        found["power"] = float((data["film_wear_power"] * weight).sum() / weight.sum())
    return found


def _tracks(
    data: xr.Dataset, machine: MachineDescription, stiffness: Mapping[str, float], turning: float
) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    ratios = {body.name: abs(body.speed_ratio) for body in machine.bodies}
    for path in machine.paths:
        if path.worn_by is None or path.shear_speed is None or path.worn_by not in stiffness:
            continue
        nodes = path.geometry.values.shape[0]
        angles = 2.0 * np.pi * np.arange(nodes) / nodes
        kept = data["tip_cut_depth"].sel(body=path.worn_by)
        overlap = np.interp(angles, data["casing_angle"], kept, period=2.0 * np.pi)
        speed = float(np.abs(path.shear_speed.values).max())
        found[path.worn_by] = {
            "overlap": overlap.tolist(),
            "stiffness": stiffness[path.worn_by],
            "radius": speed / ratios[path.worn_by],
            "width": float(path.geometry.values[:, 1].max()),
            "speed": speed * turning,
        }
    return found


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the machine new, and again at ``study.hours`` as it wears.

    Returns
    -------
    StudyResult
        Summary numbers, worn depths and clearances over ``hours`` and ``duty_point``; the life by
        ``study.limits``.

    Raises
    ------
    CaseError
        If the machine cannot wear so, or no point can be run.

    Notes
    -----
    Rates at the last two times are extrapolated over an interval (Adams, Bashforth), so that
    halving it takes a quarter of the error.
    """
    study = case.study
    assert isinstance(study, WearStudy)
    keys = _clearances(case, study)
    conditions = _conditions(case, study)
    shares = [one.share for one in study.duty] or [1.0]
    times = [0.0, *study.hours]
    wear, found = Wear(), list[WornState]()
    rates: tuple[float, float] | None = None
    before = 0.0
    for k, time in enumerate(times):
        shown = part(context.progress, f"{time / _HOUR:g} h", k / len(times), (k + 1) / len(times))
        here = replace(context, progress=shown)
        try:
            records = _records(case, conditions, keys, wear, here)
        except CaseError:
            if not found:
                raise
            break  # worn beyond what a case can hold
        span = study.worn_time(time) - study.worn_time(times[k - 1]) if k else 0.0
        deeper = _cut(study, records, shares, span)
        if k and max((d.max() for d in deeper.values()), default=0.0) > _NEW_TRACK:
            # tips cut much faster than bushes wear: the track of these hours is that of now
            tracks = {body: wear.tracks.get(body, 0.0) + depth for body, depth in deeper.items()}
            wear = replace(wear, tracks=tracks)
            records = _records(case, conditions, keys, wear, here)
        found.append(WornState(time / _HOUR, wear, records))
        if status_of(records) is not Status.DONE or k == len(times) - 1:
            break
        now, ahead = _rates(study, records, shares), study.worn_time(times[k + 1])
        step = ahead - study.worn_time(time)
        change = [0.0, 0.0] if rates is None else [
            (new - old) / before for new, old in zip(now, rates, strict=True)
        ]  # fmt: skip
        worn = [max(r * step + 0.5 * c * step**2, 0.0) for r, c in zip(now, change, strict=True)]
        wear = Wear(wear.journals + worn[0], wear.faces + worn[1], wear.tracks)
        rates, before = now, step
    return _result(case, study, keys, found, len(times))


@final
@dataclass(frozen=True)
class WornState:
    """The machine at one time."""

    hours: float
    wear: Wear
    records: Sequence[Record]


def _clearances(case: Case, study: WearStudy) -> dict[str, dict[str, float]]:
    """Clearances of the new machine that wear opens, by part and key path. [m]."""
    offered = getattr(case.machine, "clearance_keys", {})
    found: dict[str, dict[str, float]] = {}
    for name in ("journals", "faces"):
        if getattr(study, name) is None:
            continue
        shape = study.journals.shape if name == "journals" and study.journals else name
        paths = {f"machine.{key}": case.value(f"machine.{key}") for key in offered.get(shape, ())}
        found[name] = {path: value for path, value in paths.items() if value is not None}
        if not found[name] and shape == "conforming":
            found[name] = dict.fromkeys(paths, 0.0)  # blocks without play in the housing
        if not found[name]:
            allowed = "a machine with clearances that it opens, such as external_gear"
            raise CaseError(f"study.{name}", f"wear of {case.machine_type!r}", allowed).in_file(
                case.label
            )
    if not case.run.preset.has_losses:
        allowed = "a preset with losses, such as 'lumped'"
        raise CaseError("run.fidelity", f"{case.run.fidelity!r}", allowed).in_file(case.label)
    return found


def _conditions(case: Case, study: WearStudy) -> list[dict[str, str]]:
    """Keys of the operating point at each point of the duty cycle."""
    operating = operating_point_of(case)
    motor = getattr(case.machine, "mode", "pump") == "motor"
    low = operating.outlet_pressure if motor else operating.inlet_pressure
    high = "inlet_pressure" if motor else "outlet_pressure"
    return [
        operating_values(shaft_speed=one.shaft_speed, **{high: low + one.pressure_difference})
        for one in study.duty
    ] or [{}]


def _records(
    case: Case,
    conditions: Sequence[Mapping[str, str]],
    keys: Mapping[str, Mapping[str, float]],
    wear: Wear,
    context: StudyContext,
) -> list[Record]:
    worn = _opened(case, keys, wear)
    evaluate = WornMachine(replace(case, study=None), wear.tracks)
    points = [point(case, {**worn, **condition}) for condition in conditions]
    return collected(points, context, evaluate)


def _opened(case: Case, keys: Mapping[str, Mapping[str, float]], wear: Wear) -> dict[str, str]:
    """Clearances of the worn machine as they stand in a case file."""
    study = case.study
    assert isinstance(study, WearStudy)
    opening = 0.0 if study.faces is None else study.faces.opening
    deeper = {"journals": wear.journals, "faces": opening * wear.faces}
    return {
        path: f"{1e6 * (value + deeper[name]):.9g} um"
        for name, paths in keys.items()
        for path, value in paths.items()
    }


def _rates(
    study: WearStudy, records: Sequence[Record], shares: Sequence[float]
) -> tuple[float, float]:
    """Steady rates of depth of the most worn bush and of the faces over the duty cycle. [m/s]."""
    bushes: dict[str, float] = {}
    faces = 0.0
    for share, record in zip(shares, records, strict=True):
        rubs = record.numbers["rubbing"]
        if study.journals is not None:
            k, film = study.journals.wear_coefficient, study.journals.film_share
            for body, one in rubs["journals"].items():
                load = one["asperity_force"] + film * max(one["force"] - one["asperity_force"], 0.0)
                rate = float(wear_depth_rate(k, load / one["area"], one["speed"]))
                bushes[body] = bushes.get(body, 0.0) + share * rate
        if study.faces is not None:
            k, rub = study.faces.wear_coefficient, rubs["faces"]
            pressed = float(wear_depth_rate(k, study.faces.pressure, rub["speed"]))
            faces += share * (pressed + k * rub["power"])
    return max(bushes.values(), default=0.0), faces


def _cut(
    study: WearStudy, records: Sequence[Record], shares: Sequence[float], span: float
) -> dict[str, Array]:
    """What tips cut into the casing within a span of time at the steady rate. [m]."""
    if study.casing is None or status_of(records) is not Status.DONE:
        return {}
    found: dict[str, Array] = {}
    for share, record in zip(shares, records, strict=True):
        for body, one in record.numbers["rubbing"]["tracks"].items():
            size = one["stiffness"], one["radius"], one["width"], one["speed"]
            fades = cutting_time(study.casing.wear_coefficient, *size)
            cut = -math.expm1(-share * span / fades) * np.asarray(one["overlap"])
            found[body] = np.maximum(found.get(body, 0.0), cut)
    return found


def _result(
    case: Case,
    study: WearStudy,
    keys: Mapping[str, Mapping[str, float]],
    found: Sequence[WornState],
    wanted: int,
) -> StudyResult:
    records = [record for step in found for record in step.records]
    hours = [step.hours for step in found]
    duty = len(found[0].records)
    points = [float(k) for k in range(duty)]
    data = map_dataset({"hours": (hours, "h"), "duty_point": (points, "1")}, records)
    worn = _worn_numbers(case, keys, found)
    data = data.assign(
        {name: ("hours", np.asarray(v), {"units": unit_of(name)}) for name, v in worn.items()}
    )
    # over the hours, at the first point of the duty cycle
    series = {
        str(name): np.asarray(data[name]).reshape(len(hours), -1)[:, 0]
        for name in data.data_vars
        if data[name].dtype.kind == "f" and name not in NOT_A_RESULT
    }
    limits = study.limits or {}
    lives = {
        name: crossing(hours, values, limits[name])
        for name, values in series.items()
        if name in limits
    }
    unknown = set(limits) - set(lives)
    if unknown and status_of(records) is Status.DONE:
        allowed = "a number of the study, such as track_depth_um or volumetric_efficiency"
        raise CaseError(f"study.limits.{min(unknown)}", "no such number", allowed).in_file(
            case.label
        )
    reached = {name: life for name, life in lives.items() if math.isfinite(life)}
    first = min(reached, key=lambda name: reached[name], default="")
    numbers: dict[str, Any] = {
        "points": len(records),
        "hours_h": hours,
        **worn,
        **{name: v.tolist() for name, v in series.items() if name not in worn},
        "limits_reached_h": reached,
    }
    if first:
        numbers |= {"life_h": reached[first], "life_ended_by": first}
        at = {name: float(np.interp(reached[first], hours, v)) for name, v in series.items()}
        numbers["at_end_of_life"] = {name: at[name] for name in (*worn, *_SHOWN) if name in at}
    shown = [name for name in _SHOWN if name in series]
    columns = {"hours (h)": hours} | {axis_title(name): worn[name] for name in worn}
    columns |= {axis_title(name): series[name].tolist() for name in shown}
    state = status_of(records)
    if state is Status.DONE and len(found) < wanted:
        state = Status.POINTS_FAILED
    return StudyResult(state, data, numbers, (StudyTable.of("wear", columns),))


_JOURNAL_CLEARANCE = "machine.journal_bearings.radial_clearance"
_SHOWN = (
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "overall_efficiency",
    "mean_flow_L_per_min",
    "mean_torque_N_m",
)


def _worn_numbers(
    case: Case, keys: Mapping[str, Mapping[str, float]], found: Sequence[WornState]
) -> dict[str, list[float]]:
    """Depths and clearances over the hours."""
    numbers: dict[str, list[float]] = {}
    study = case.study
    assert isinstance(study, WearStudy)
    if study.journals is not None:
        new = case.value(_JOURNAL_CLEARANCE) or 0.0
        numbers["journal_wear_um"] = [1e6 * step.wear.journals for step in found]
        numbers["journal_clearance_um"] = [1e6 * (2.0 * new + s.wear.journals) for s in found]
    if study.faces is not None:
        gap = max(keys["faces"].values())
        numbers["face_wear_um"] = [1e6 * step.wear.faces for step in found]
        opened = [gap + study.faces.opening * step.wear.faces for step in found]
        numbers["side_gap_um"] = [1e6 * height for height in opened]
    numbers["track_depth_um"] = [
        max(record.number("track_depth_um") for record in step.records) for step in found
    ]
    return numbers


def crossing(hours: Sequence[float], values: Array, limit: Limit) -> float:
    """Hours at which values leave a limit for the first time, linear between; infinite if never."""
    before, last = math.inf, 0.0
    for hour, value in zip(hours, values.tolist(), strict=True):
        low = -math.inf if limit.low is None else limit.low - value
        beyond = max(low, -math.inf if limit.high is None else value - limit.high)
        if beyond > 0.0:
            if not before < 0.0:
                return hour
            return last + (hour - last) * before / (before - beyond)
        before, last = beyond, hour
    return math.inf


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Depths and efficiencies over the hours."""
    if data.sizes.get("hours", 0) < 2 or not has_numbers(data, "track_depth_um"):
        return []
    caption = (
        "Worn depths, and efficiencies at the points of the duty cycle, over the hours; "
        "dots: where the machine was run again."
    )
    return [StudyFigure("wear", caption, wear_over_hours(data))]


_DEPTHS = (
    ("journal_wear_um", "most worn bush", BLUE),
    ("track_depth_um", "track in the casing", ORANGE),
    ("face_wear_um", "faces", GREEN),
)


@styled
def wear_over_hours(data: xr.Dataset) -> Figure:
    """Worn depths above, volumetric and overall efficiency below."""
    figure = new_figure(7.2, 5.6)
    depths, shares = figure.subplots(2, 1, sharex=True)
    hours = data["hours"].values
    for name, label, colour in _DEPTHS:
        if name in data:
            depths.plot(hours, data[name], "o-", ms=3, color=colour, label=label)
    depths.set(ylabel="Depth (µm)")
    depths.legend()
    duty = data.sizes["duty_point"]
    for name, style in (("volumetric_efficiency", "o-"), ("overall_efficiency", "s--")):
        words = name.replace("_", " ")
        for k in spread(duty):
            label = f"{words}, point {k + 1}" if duty > 1 else words
            colour = CYCLE[k % len(CYCLE)]
            shares.plot(hours, data[name][:, k], style, ms=3, color=colour, label=label)
    shares.set(xlabel="Hours", ylabel="Efficiency (-)")
    shares.legend()
    return figure


STUDY = Study(WearStudy, run, figures)
