"""Two results side by side: their numbers, their losses, and whether they can be compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.core.files import write_text
from toothspace.core.finding import Finding
from toothspace.core.status import Status
from toothspace.report.card import machine_head
from toothspace.report.page import format_value, quantity, render
from toothspace.results.ledger import loss_causes
from toothspace.results.solution import Solution, load_solution

if TYPE_CHECKING:
    import pandas as pd

_TITLES = ("title", "base")
"""Keys that change no number."""

_LONGEST_LIST = 6
"""Keys that a warning names."""

_WITHOUT_SHARE = ("_degC", "_deg", "_error")
"""Ends of names whose zero is arbitrary, or that are all but zero: a share of them says nothing."""

_HEADLINES = (
    "overall_efficiency",
    "max_chamber_pressure_bar",
    "pressure_ripple_bar",
    "flow_ripple_percent",
    "mean_flow_L_per_min",
    "mean_torque_N_m",
)
"""Numbers that a page begins with where they differ."""
_NOTHING = 1e-3
"""Share of a number below which a change of it is not worth a word. [-]"""
_MANIFOLD = 10.0
"""Share from which a factor is easier to read. [-]"""


def compare(first: Solution | str | Path, second: Solution | str | Path) -> Comparison:
    """Put two results side by side.

    Parameters
    ----------
    first, second : Solution, str or Path
        Results, or their files.
    """
    both = (one if isinstance(one, Solution) else load_solution(one) for one in (first, second))
    return Comparison(*both)


@final
@dataclass(frozen=True, eq=False)
class Comparison:
    """Summary numbers of two results side by side."""

    first: Solution
    second: Solution
    """The results."""

    def numbers(self) -> dict[str, tuple[float, float]]:
        """Return what both summaries hold, but for the time that the runs took."""
        one, two = self.first.summary(), self.second.summary()
        return {
            name: (float(value), float(two[name]))
            for name, value in one.items()
            if isinstance(value, (int, float))
            and isinstance(two.get(name), (int, float))
            and name not in {"wall_time_s", "real_time_factor"}
        }

    def losses(self) -> dict[str, tuple[float, float]]:
        """Return the mean power that each cause dissipates in both runs, by its name. [W]."""
        one, two = (
            {f"{entry.cause}, {entry.label}": entry.power for entry in loss_causes(run.ledger)}
            for run in (self.first, self.second)
        )
        return {name: (one.get(name, 0.0), two.get(name, 0.0)) for name in {**one, **two}}

    @cached_property
    def _keys(self) -> dict[str, tuple[Any, Any]]:
        one, two = (_leaves(s.case.to_dict()) for s in (self.first, self.second))
        both = {name: (one.get(name), two.get(name)) for name in {**one, **two}}
        return {name: values for name, values in both.items() if values[0] != values[1]}

    def keys(self) -> dict[str, tuple[Any, Any]]:
        """Return the keys in which the cases differ, with both values."""
        return dict(self._keys)

    def warnings(self) -> list[str]:
        """Return why a difference may not come from one changed key, a line for each reason."""
        changed = [name for name in self._keys if name not in _TITLES]
        physical = [name for name in changed if name.partition(".")[0] != "run"]
        found = []
        if "machine.type" in changed:
            found.append("The machines are of different types.")
        if len(physical) > 1:
            more = len(physical) - _LONGEST_LIST
            named = ", ".join(physical[:_LONGEST_LIST]) + (f" and {more} more" * (more > 0))
            found.append(
                f"The cases differ in {len(physical)} keys, so that no difference belongs to one "
                f"of them: {named}."
            )
        if settings := [name for name in changed if name not in physical]:
            found.append(f"The runs have other settings: {', '.join(settings)}.")
        versions = [s.provenance.get("package_version", "") for s in (self.first, self.second)]
        if versions[0] != versions[1]:
            found.append(f"The results come from versions {versions[0]} and {versions[1]}.")
        for place, one in (("first", self.first), ("second", self.second)):
            if one.status is not Status.DONE:
                found.append(f"The {place} run is no result: {one.status.value}.")
        return found

    @cached_property
    def _findings(self) -> dict[str, list[Finding]]:
        one, two = (run.findings for run in (self.first, self.second))
        return {
            "both": [finding for finding in one if finding in two],
            "first": [finding for finding in one if finding not in two],
            "second": [finding for finding in two if finding not in one],
        }

    def findings(self) -> dict[str, list[Finding]]:
        """Return what is to be known of the results, by ``both``, ``first`` and ``second``."""
        return {place: list(found) for place, found in self._findings.items()}

    def finding_lines(self) -> list[str]:
        """Return the findings as text, a line for each, with the run that it is of."""
        names = {"both": "Both runs", "first": "First run", "second": "Second run"}
        return [
            f"{names[place]}, {str(x)[:1].lower()}{str(x)[1:]}"
            for place, found in self._findings.items()
            for x in found
        ]

    def answer(self) -> list[str]:
        """Return what was changed and what came of it, a sentence each."""
        numbers, said = self.numbers(), []
        changed = [name for name in self._keys if name not in _TITLES]
        if len(changed) == 1:
            first, second = (
                "not given" if value is None else value for value in self._keys[changed[0]]
            )
            name = changed[0].removeprefix("machine.").replace(".", ", ").replace("_", " ")
            said.append(f"Changed: {name}, from {first} to {second}.")
        came = []
        for name in _HEADLINES:
            first, second = numbers.get(name, (0.0, 0.0))
            if abs(second - first) <= _NOTHING * abs(first):
                continue
            label, _, unit = quantity(name, first)
            *_, difference, share = _shown_row(name, unit, first, second)
            unit = "points" if unit == "%" else unit
            part = f", {share}" if share.endswith("%") and unit != "points" else ""
            way = "more" if second > first else "less"
            came.append(f"{label.lower()} {difference.lstrip('-+')} {unit} {way}{part}")
        if came:
            text = "; ".join(came)
            said.append(f"The second one: {text}.")
        elif numbers:
            said.append("Efficiency, flow, torque, peak and ripple are the same within 0.1 %.")
        return said

    def to_dataframe(self) -> pd.DataFrame:
        """Return both values, their difference and its share of the first, by name.

        The share is NaN where it says nothing: for temperatures, angles and balance errors, and
        where the first value is zero or of the other sign.
        """
        import pandas as pd

        columns = ["first", "second", "difference", "relative"]
        rows = {name: _row(name, *both) for name, both in self.numbers().items()}
        return pd.DataFrame.from_dict(rows, orient="index", columns=columns)

    def to_dict(self) -> dict[str, Any]:
        """Return keys, numbers, losses, warnings and findings as one object for JSON."""
        return {
            "keys": {name: list(values) for name, values in self._keys.items()},
            "numbers": {name: _row(name, *both) for name, both in self.numbers().items()},
            "losses_W": {name: _row(name, *both) for name, both in self.losses().items()},
            "warnings": self.warnings(),
            "findings": {
                place: [finding.to_dict() for finding in found]
                for place, found in self._findings.items()
            },
        }

    def write(self, path: str | Path) -> Path:
        """Write the comparison as one HTML page that opens offline, and return its path."""
        page = render(
            "comparison.html.j2",
            machine=machine_head(self.second.provenance),
            answer=self.answer(),
            titles=[s.provenance.get("title", "") for s in (self.first, self.second)],
            warnings=self.warnings(),
            findings=self.finding_lines(),
            keys=self._keys,
            numbers=[
                (label.label, label.unit, *_shown_row(name, label.unit, *both))
                for name, both in self.numbers().items()
                for label in [quantity(name, both[0])]
            ],
            losses=[(n, "W", *_shown_row(n, "W", *both)) for n, both in self.losses().items()],
        )
        return write_text(Path(path), page)

    def __repr__(self) -> str:
        return f"<Comparison\n{self.to_dataframe().to_string(float_format='{:.5g}'.format)}>"

    def _repr_html_(self) -> str:
        keys = "".join(
            f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(str(a))}</td>"
            f"<td>{escape(str(b))}</td></tr>"
            for name, (a, b) in self._keys.items()
        )
        numbers = self.to_dataframe().to_html(float_format="{:.5g}".format)
        found = "".join(f"<li>{escape(line)}</li>" for line in self.finding_lines())
        return f"<table>{keys}</table><ul>{found}</ul>{numbers}"


def shown_change(name: str, first: float, second: float) -> str:
    """Difference of a number as share of the first, as factor, or the unit of the difference.

    Parameters
    ----------
    name : str
        Name with the suffix of its unit; differences of temperatures are in K, of percentages in
        points.
    """
    if name.endswith("_degC"):
        return "K"
    if name.endswith("_percent"):
        return "points"
    share = _row(name, first, second)[-1]
    if isnan(share):
        return "-"
    return f"{100.0 * share:+.2f} %" if share < _MANIFOLD else f"x {second / first:.3g}"


def _row(name: str, first: float, second: float) -> tuple[float, float, float, float]:
    comparable = first * second > 0.0 or (first != 0.0 and second == 0.0)
    share = float("nan")
    if comparable and not name.endswith(_WITHOUT_SHARE):
        share = (second - first) / abs(first)
    return first, second, second - first, share


def _shown_row(name: str, unit: str, first: float, second: float) -> tuple[str, str, str, str]:
    scale = 100.0 if unit == "%" and name.endswith("_efficiency") else 1.0
    values = (scale * first, scale * second, scale * (second - first))
    one, two, difference = (format_value(value) for value in values)
    change = shown_change(name if scale == 1.0 else f"{name}_percent", first, second)
    return one, two, difference, "" if change == "-" else change


def _leaves(tables: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in tables.items():
        if isinstance(value, Mapping):
            found |= _leaves(value, f"{path}{name}.")
        else:
            found[f"{path}{name}"] = value
    return found
