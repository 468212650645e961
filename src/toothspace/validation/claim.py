"""What a publication says, what this version finds, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, SupportsFloat, final

import numpy as np

import toothspace
from toothspace import api
from toothspace.case import Case
from toothspace.case.shipped import shipped_case
from toothspace.core.types import Array
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    import xarray as xr


Verdict = Literal["pass", "fail", "not judged", "cannot be had"]
Effort = Literal["short", "full"]


@final
@dataclass(frozen=True)
class ValidationSource:
    """A publication."""

    key: str
    """Short name, by custom author and year."""
    title: str
    """What it is about."""
    citation: str
    """Where to find it."""
    assumed: str = ""
    """What it leaves open and is assumed here; empty if nothing."""


@final
@dataclass(frozen=True)
class ComparedValue:
    """One number against a published number, bound or range."""

    name: str
    """What it is."""
    ours: float
    """Number of this version, in ``unit``."""
    unit: str
    """Unit of all numbers."""
    low: float = -math.inf
    high: float = math.inf
    """Allowed range; infinite where there is no bound."""
    published: float | None = None
    """Published number, None where only words, a bound or a range are given."""
    words: str = ""
    """What is published, where it is no number."""

    @property
    def verdict(self) -> Verdict:
        """Whether the number lies in its range; without one it is not judged."""
        if math.isinf(self.low) and math.isinf(self.high):
            return "fail" if math.isnan(self.ours) else "not judged"
        return "pass" if self.low <= self.ours <= self.high else "fail"

    @property
    def deviation(self) -> float:
        """Deviation over the published number, or nan. [-]."""
        if not self.published:
            return math.nan
        return self.ours / self.published - 1.0


def close(
    name: str,
    ours: SupportsFloat,
    published: float,
    unit: str,
    *,
    rel: float = 0.0,
    margin: float = 0.0,
) -> ComparedValue:
    """Value that may deviate by a part of the published one, or by a margin in its unit."""
    width = max(rel * abs(published), margin)
    low, high = published - width, published + width
    return ComparedValue(name, float(ours), unit, low, high, float(published))


def within(
    name: str,
    ours: SupportsFloat,
    unit: str,
    words: str,
    low: float = -math.inf,
    high: float = math.inf,
) -> ComparedValue:
    """Value against what is published in words, and the range that they are taken for."""
    return ComparedValue(name, float(ours), unit, low, high, words=words)


def holds(name: str, statement: bool, words: str) -> ComparedValue:
    """Statement in words that is true (1) or not (0)."""
    return within(name, statement, "1 = true", words, 1.0, 1.0)


@final
@dataclass(frozen=True)
class ComparedCurve:
    """A curve over a published one."""

    name: str
    """What is drawn."""
    x_label: str
    y_label: str
    """Axes with units."""
    x: Array
    y: Array
    """Curve of this version."""
    published: Array | None = None
    """Published values; None where there are no numbers and the figure is for the eye."""
    published_x: Array | None = None
    """Where they are published; None for the places of this version."""
    tolerance: float = math.inf
    """Largest distance in y at a published point; infinite if the curve itself is not judged."""
    logarithmic: bool = False
    """Whether both axes are."""

    @property
    def places(self) -> Array:
        """Where the published points lie."""
        return self.x if self.published_x is None else self.published_x

    @property
    def error(self) -> float:
        """Largest distance at the published points, or nan. [unit of y]."""
        if self.published is None:
            return math.nan
        order = np.argsort(self.x)
        found = np.interp(self.places, self.x[order], self.y[order])
        return float(np.max(np.abs(found - self.published)))

    @property
    def verdict(self) -> Verdict:
        """Whether all published points lie within the tolerance; without one it is not judged."""
        if self.published is None or math.isinf(self.tolerance):
            return "not judged"
        return "pass" if self.error <= self.tolerance else "fail"


@final
@dataclass(frozen=True)
class Evidence:
    """What one computation gives."""

    values: tuple[ComparedValue, ...] = ()
    """Numbers."""
    curves: tuple[ComparedCurve, ...] = ()
    """Figures."""
    films: xr.Dataset | None = None
    """Films at the points of a study, whose heights are drawn."""


@final
@dataclass(frozen=True)
class Claim:
    """A published number, statement or figure."""

    key: str
    """Unique short name."""
    source: ValidationSource
    """Publication."""
    statement: str
    """What it says."""
    tolerance: str
    """Why deviations of the allowed size are allowed; or why the claim cannot be examined."""
    measure: Callable[[Effort], Evidence] | None
    """Returns the finding at a given effort, ``short`` for coarse grids and few points; None if the
    numbers cannot be had.
    """
    minutes: float = 0.2
    """Rough duration of the full computation on one core. [min]"""
    reason: str = ""
    """Why this version does not meet it; empty where it does."""
    computed_with: str = ""
    """Key of the claim whose computation it judges, too; empty where it has its own."""


@final
@dataclass(frozen=True)
class Examined:
    """A claim with what was found."""

    claim: Claim
    """What is published."""
    finding: Evidence
    """Numbers and curves, empty where they cannot be had."""
    trouble: str = ""
    """Why the computation gave nothing, empty if it did."""
    duration: float = 0.0
    """Time that it took. [s]"""

    @property
    def verdict(self) -> Verdict:
        """``pass`` if every number and curve that is judged does, and one is at least."""
        if self.claim.measure is None:
            return "cannot be had"
        verdicts = [value.verdict for value in self.finding.values]
        verdicts += [curve.verdict for curve in self.finding.curves]
        passed = "pass" in verdicts and "fail" not in verdicts
        return "pass" if passed and not self.trouble else "fail"


_PACKAGE = Path(toothspace.__file__).resolve().parent


def data_file(source: str, name: str = "reference.csv") -> Path:
    """Return the file of published numbers of a source.

    Parameters
    ----------
    source : str
        Folder, by custom author and year.
    name : str
        File in that folder.
    """
    return _PACKAGE / "validation" / "data" / source / name


@cache
def shipped(case: str, *overrides: str) -> Case:
    """Load a shipped case with overrides, once for all claims."""
    return api.load_case(shipped_case(case), overrides)


@cache
def solved(case: str, *overrides: str) -> Solution:
    """Run a shipped case with overrides, once for all claims."""
    return api.simulate(shipped(case, *overrides))


def rows_of(source: str, name: str = "reference.csv") -> list[dict[str, str]]:
    """Read the rows of a file of published numbers as they are written, by their heading."""
    import csv

    return list(csv.DictReader(data_file(source, name).read_text(encoding="utf-8").splitlines()))


def columns(source: str, name: str = "reference.csv") -> dict[str, Array]:
    """Read the numeric columns of a file of published numbers, by their heading."""
    import numpy as np

    rows = rows_of(source, name)
    found = {}
    for heading in rows[0]:
        try:
            found[heading] = np.array([float(row[heading].replace(",", ".")) for row in rows])
        except ValueError:
            continue
    return found
