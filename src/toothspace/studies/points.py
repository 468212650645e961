"""Points of a study: cases with other values, evaluated once each, as lists and tables."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case, OperatingPoint
from toothspace.core.compilation.sources import digest_of_sources
from toothspace.core.errors import CaseError
from toothspace.core.files import plain
from toothspace.core.interrupts import is_interrupt
from toothspace.core.keys import suggestion
from toothspace.core.progress import tell
from toothspace.core.status import Status
from toothspace.core.units import from_si
from toothspace.results.variables import unit_of
from toothspace.studies.study import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    Record,
    StudyContext,
    StudyTable,
    failed_count,
)
from toothspace.studies.variation import Axis
from toothspace.studies.workers import WorkerLostError

if TYPE_CHECKING:
    import xarray as xr

    from toothspace.results.solution import Solution

Evaluate = Callable[[Case], Mapping[str, Any]]
"""Numbers of one case, with its ``status`` among them, and ``told`` where there is more to say.

A function of a module, or an object with a text ``label`` that says what it evaluates.
"""
NOT_A_RESULT = ("wall_time_s",)
"""Summary numbers that say nothing about the machine."""


@final
@dataclass(frozen=True)
class Point:
    """One point of a study."""

    values: Mapping[str, Any]
    """What differs from the case of the study, as it would stand in a case file. By key path."""
    case: Case | None
    """The case of the point; None if the values are refused."""
    message: str = ""
    """Why they are refused."""


def operating_point_of(case: Case) -> OperatingPoint:
    """Return the operating point of the case of a steady study.

    Raises CaseError if it has none.
    """
    if case.operating_point is None:
        found = "no [operating_point]"
        raise CaseError("study.kind", found, "a steady case").in_file(str(case.source))
    return case.operating_point


def operating_values(**given: float) -> dict[str, str]:
    """Return keys of the operating point as they stand in a case file, from SI units."""
    units = {name: "rpm" if name == "shaft_speed" else "bar" for name in given}
    return {
        f"operating_point.{name}": f"{from_si(value, units[name]):.12g} {units[name]}"
        for name, value in given.items()
    }


def summary_numbers(case: Case) -> Mapping[str, Any]:
    """Run a case and return its summary numbers."""
    from toothspace import api

    return numbers_of(api.simulate(case))


def numbers_of(solution: Solution) -> Mapping[str, Any]:
    """Summary numbers, with ``told`` where a run says what it did not reach."""
    said = next((x.sentence for x in solution.warnings if x.severity == "serious"), "")
    reached = solution.status is not Status.NOT_REACHED
    return solution.summary() if reached else {**solution.summary(), "told": said}


def point(case: Case, values: Mapping[str, Any]) -> Point:
    """Make one point; values that the case refuses are kept with the reason."""
    try:
        return Point(values, case.at_point(values))
    except CaseError as error:
        return Point(values, None, str(error))


def evaluate_points(
    points: Sequence[Point], context: StudyContext, evaluate: Evaluate = summary_numbers
) -> list[Record]:
    """Evaluate points that have no record yet; every finished one is recorded at once.

    In the order of the points.

    Parameters
    ----------
    evaluate : callable
        Function of a module that turns a case into numbers.

    Raises
    ------
    KeyboardInterrupt
        After an interrupt by the user; finished points are recorded.
    """
    keys = [_key(item, evaluate) for item in points]
    open_cases: dict[str, Case] = {}
    for key, item in zip(keys, points, strict=True):
        if context.records.get(key) is None:
            if item.case is None:
                context.records.add(Record(key, BAD_INPUT, message=item.message))
            else:
                open_cases[key] = item.case
    done = len(points) - len(open_cases)
    tell(context.progress, done / max(len(points), 1), f"point {done} of {len(points)}")
    compute, tasks = partial(_evaluated, evaluate), list(open_cases.items())
    try:
        for k, record in context.workers.each(compute, tasks):
            if isinstance(record, WorkerLostError):
                record = Record(tasks[k][0], FAILED, message=str(record))
            if record.status == INTERRUPTED:
                raise KeyboardInterrupt
            context.records.add(record)
            done += 1
            tell(context.progress, done / len(points), f"point {done} of {len(points)}")
    except KeyboardInterrupt:
        context.workers.stop()
        raise
    return recorded(points, context, evaluate)


def recorded(
    points: Sequence[Point], context: StudyContext, evaluate: Evaluate = summary_numbers
) -> list[Record]:
    """Return the records of points; those not evaluated have the status ``interrupted``."""
    keys = [_key(item, evaluate) for item in points]
    return [context.records.get(key) or Record(key, INTERRUPTED) for key in keys]


def collected(
    points: Sequence[Point], context: StudyContext, evaluate: Evaluate = summary_numbers
) -> list[Record]:
    """Return the records of evaluated points; after an interrupt, of those that are finished.

    Raises CaseError if every point is refused.
    """
    if points and all(item.case is None for item in points):
        raise CaseError(points[0].message)
    try:
        records = evaluate_points(points, context, evaluate)
    except KeyboardInterrupt:
        records = recorded(points, context, evaluate)
    require_accepted(records)
    return records


def status_of(records: Sequence[Record]) -> Status:
    """Return the status of a study from those of its points."""
    if any(record.status == INTERRUPTED for record in records):
        return Status.INTERRUPTED
    if all(record.succeeded for record in records):
        return Status.DONE
    return Status.POINTS_FAILED


def require_accepted(records: Sequence[Record]) -> None:
    """Refuse a study of which every point is refused.

    Raises
    ------
    CaseError
        With the reason of the first point.
    """
    if records and all(record.status == BAD_INPUT for record in records):
        raise CaseError(records[0].message)


def require_results(records: Sequence[Record], wanted: Sequence[str], label: str) -> None:
    """Refuse a study that asks for a number that its points do not have.

    Raises
    ------
    CaseError
        With the name, and with one like it if there is any.
    """
    for record in records:
        missing = [name for name in wanted if name not in record.numbers]
        if record.succeeded and missing:
            allowed = suggestion(missing[0], record.numbers)
            found = f"{missing[0]!r}, which is no result"
            raise CaseError(f"{label}: study", found, allowed)


def _key(item: Point, evaluate: Evaluate) -> str:
    content = repr(sorted(item.values.items())) if item.case is None else item.case.hash
    name = getattr(evaluate, "label", None) or f"{evaluate.__module__}.{evaluate.__qualname__}"
    text = "\n".join((content, str(name), digest_of_sources()))
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _evaluated(evaluate: Evaluate, task: tuple[str, Case]) -> Record:
    started, (key, case) = time.perf_counter(), task
    try:
        numbers = dict(evaluate(case))
        status, message = str(numbers.pop("status")), ""
        told = str(numbers.pop("told", ""))
        if status in {s.name.lower() for s in Status} - {"done"}:
            message = told or Status[status.upper()].value
    except CaseError as error:
        numbers, status, message = {}, BAD_INPUT, str(error)
    except Exception as error:  # one point that fails must not end a long study
        if is_interrupt(error):
            raise KeyboardInterrupt from error
        numbers, status = {}, FAILED
        message = f"{type(error).__name__}: {' '.join(str(error).split())}"
    return Record(key, status, plain(numbers), message, time.perf_counter() - started)


def number_names(records: Sequence[Record]) -> list[str]:
    """Return the names of the numbers that any record holds, in their order."""
    found: dict[str, None] = {}
    for record in records:
        for name, value in record.numbers.items():
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                found[name] = None
    return [name for name in found if name not in NOT_A_RESULT]


def columns(records: Sequence[Record]) -> dict[str, list[float]]:
    """Return the numbers of records by name; NaN where a point has none."""
    return {name: [r.number(name) for r in records] for name in number_names(records)}


def numbers_table(
    name: str,
    values: Mapping[str, Sequence[float | str]],
    shown: Iterable[tuple[str, str]],
    records: Sequence[Record],
) -> StudyTable:
    """Build the table of the numbers that a study shows.

    Parameters
    ----------
    values : mapping
        Varied values of the points, by the heads of their columns.
    shown : iterable of (str, str)
        Names of numbers and heads of their columns.
    records : sequence of Record
        The points.
    """
    numbers = {head: [r.number(number) for r in records] for number, head in shown}
    return StudyTable.of(name, {**values, **numbers, "status": [r.status for r in records]})


def record_arrays(
    records: Sequence[Record], dimensions: Sequence[str] = ("point",), shape: Sequence[int] = (-1,)
) -> dict[str, Any]:
    """Return numbers with their units, and statuses, as variables of a dataset."""
    arrays = {
        name: (dimensions, np.asarray(values).reshape(shape), {"units": unit_of(name)})
        for name, values in columns(records).items()
    }
    statuses = np.asarray([r.status for r in records], dtype=str)
    return {**arrays, "point_status": (dimensions, statuses.reshape(shape))}


def points_dataset(
    axes: Sequence[Axis], rows: Sequence[Sequence[Any]], records: Sequence[Record]
) -> xr.Dataset:
    """Build the dataset over ``point``: varied keys, numbers and statuses."""
    import xarray as xr

    data: dict[str, Any] = {
        axis.path: ("point", np.asarray([row[k] for row in rows]), {"units": axis.unit or "1"})
        for k, axis in enumerate(axes)
    }
    data |= record_arrays(records)
    data["point_message"] = ("point", np.asarray([r.message for r in records], dtype=str))
    return xr.Dataset(data, coords={"point": np.arange(len(records))})


def map_dataset(
    axes: Mapping[str, tuple[Sequence[float], str]], records: Sequence[Record]
) -> xr.Dataset:
    """Build the dataset over the axes of a map: numbers and statuses.

    Parameters
    ----------
    axes : mapping
        Values and unit of every axis, the last one running fastest.
    records : sequence of Record
        Points of the map in that order.
    """
    import xarray as xr

    data = record_arrays(records, tuple(axes), [len(values) for values, _ in axes.values()])
    coords = {
        name: (name, np.asarray(values), {"units": unit}) for name, (values, unit) in axes.items()
    }
    return xr.Dataset(data, coords=coords)


def points_table(
    axes: Sequence[Axis], rows: Sequence[Sequence[Any]], records: Sequence[Record]
) -> StudyTable:
    """Build the table of all points."""
    names = number_names(records)
    head = [f"{axis.path} ({axis.unit})" if axis.unit else axis.path for axis in axes]
    lines = [
        (
            *(x if isinstance(x, str) else float(x) for x in row),
            *(r.number(name) for name in names),
            r.status,
            r.message,
        )
        for row, r in zip(rows, records, strict=True)
    ]
    return StudyTable("points", (*head, *names, "status", "message"), tuple(lines))


def point_lists(values: Mapping[str, Sequence[Any]], records: Sequence[Record]) -> dict[str, Any]:
    """Return what ``--json`` prints of points: their values and numbers, in their order."""
    return {
        "points": len(records),
        "points_failed": failed_count(records),
        **values,
        **{name: found for name, found in columns(records).items() if name not in values},
        "point_status": [r.status for r in records],
    }
