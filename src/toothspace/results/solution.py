"""The solution of one run: data, ledger, findings, figures, tables and report."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, final, overload

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import path_of, write_text
from toothspace.core.finding import Finding, status_line
from toothspace.core.lazy import LazySequence
from toothspace.core.netcdf import read_dataset
from toothspace.core.registry import view
from toothspace.core.status import Event, Status
from toothspace.core.types import Array
from toothspace.results import performance
from toothspace.results.ledger import Ledger
from toothspace.results.tooth_contacts import ToothContacts, contact_numbers, tooth_contacts

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from toothspace.model.description import MachineDescription

STANDING = "Turning of a free shaft"
"""What a shaft that does not turn is about."""
_BAR = 1e5
_TURN = 2.0 * np.pi
_SETTLING = 1.0
_SETTLED_SHARE = 0.2
_AT_PLATEAU = 1.0 - 1e-9
DATA_ATTRIBUTES = ("title", "machine", "mode")
"""Attributes of the file that belong to the dataset."""


class Summary(dict[str, Any]):
    """Summary numbers by name; ``status`` alone is a text."""

    if TYPE_CHECKING:

        @overload
        def __getitem__(self, name: Literal["status"], /) -> str: ...  # type: ignore[overload-overlap]
        @overload
        def __getitem__(self, name: str, /) -> float: ...
        def __getitem__(self, name: str, /) -> float | str: ...


@final
@dataclass(frozen=True)
class Solution:
    """Result of one run, complete or not; what is drawn, listed or exported is made when asked.

    Parameters
    ----------
    status : Status
        Outcome; the data are kept if the run failed on its way.
    data : xarray.Dataset
        Samples over ``shaft_angle`` or ``time``, built by
        :func:`toothspace.results.variables.dataset_from`, with the attributes ``title``,
        ``machine`` and ``mode`` and the scalars ``displacement``, ``inlet_density``,
        ``outlet_density``, ``specific_heat_capacity`` and ``fluid_temperature``.
    ledger : Ledger
        Masses and energies over the evaluation window.
    statistics : mapping
        Counts and times of the solver: ``steps``, ``rhs``, ``jac``, ``lu``, ``revolutions``,
        ``wall_time`` without compilation [s], ``compile_time`` spent on compiling or loading
        compiled code [s], ...
    provenance : mapping of str to str
        ``package_version``, ``case_toml``, ``case_hash``, ``preset``, ``overrides`` (one
        ``key=value`` per line), ``python_version``, ``numba_version``, ...; a file holds
        ``warnings``, too, one per line.
    events : tuple of Event
        What happened, in the order of time.
    warnings : sequence of Finding
        What the run itself has to tell, without limits and design rules of the machine; what
        lies outside the range of the models is looked for when they are asked first.
    """

    status: Status
    data: xr.Dataset
    ledger: Ledger
    statistics: Mapping[str, float] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    warnings: Sequence[Finding] = ()

    def __repr__(self) -> str:
        axis = "time" if "time" in self.data.sizes else "shaft_angle"
        samples = f"{self.data.sizes.get(axis, 0)} samples over {axis}"
        title = self.provenance.get("title", "")
        return f"<Solution {title!r}: {status_line(self.status, self.findings)}; {samples}>"

    def _repr_html_(self) -> str:
        card: str = view("card")(self)
        return card

    def __getstate__(self) -> dict[str, object]:
        """State for another process, which cannot read what this one keeps on disk."""
        kept = {entry.name: getattr(self, entry.name) for entry in fields(self)}
        told = {"warnings": tuple(self.warnings), "provenance": dict(self.provenance)}
        return {**kept, "data": self.data.compute(), **told}

    def summary(self) -> Summary:
        """Return the summary numbers, with unit suffixes, status and wall time."""
        return Summary(self._numbers)

    @cached_property
    def _numbers(self) -> Summary:
        wall = float(self.statistics.get("wall_time", math.nan))
        if "time" in self.data.sizes:
            numbers = {
                **startup_numbers(self.data, self.breakaway_time),
                **performance.transient_numbers(self.data, self.ledger),
                "real_time_factor": self.ledger.duration / wall if wall else math.nan,
            }
        else:
            numbers = performance.summary_numbers(self.data, self.ledger)
            numbers |= performance.lateral_numbers(self.data, self.statistics)
            numbers |= contact_numbers(self.data)
            if "pressure_along_spaces" in self.statistics:
                along = self.statistics["pressure_along_spaces"]
                numbers["pressure_along_spaces_bar"] = along / 1e5
        return Summary(**numbers, status=self.status.name.lower(), wall_time_s=wall)

    def tooth_contacts(self) -> ToothContacts:
        """Contacts of the teeth of a gerotor: ``loaded`` at each sample, ``span`` in pitches.

        Raises
        ------
        ToothspaceError
            If the machine has no rotors, or the preset no contacts.
        """
        return tooth_contacts(self.data)

    @property
    def breakaway_time(self) -> float:
        """When the shaft begins to turn, NaN if it never does. [s]."""
        times = (event.time for event in self.events if event.kind == "shaft_released")
        return next(times, math.nan)

    def with_note(self, *warnings: Finding | str, **statistics: float) -> Solution:
        """Solution with more statistics and more warnings; texts that are empty are none."""
        told = tuple(Finding("warning", x) if isinstance(x, str) else x for x in warnings if x)
        found = tuple(dict.fromkeys((*self.warnings, *told))) if told else self.warnings
        return replace(self, statistics={**self.statistics, **statistics}, warnings=found)

    def with_later(self, look: Callable[[], Iterable[Finding | str]]) -> Solution:
        """Solution with warnings that are looked for when its warnings are asked first."""
        return replace(self, warnings=LazySequence(partial(_told, self, look)))

    def short_of(self, told: Finding | str) -> Solution:
        """Solution that misses what was asked, and says what; an empty text misses nothing."""
        if not told:
            return self
        finding = Finding("warning", told, severity="serious") if isinstance(told, str) else told
        status = Status.NOT_REACHED if self.status is Status.DONE else self.status
        return replace(self.with_note(finding), status=status)

    @property
    def case(self) -> Any:
        """The case in the result, with its files looked for beside the case file."""
        return view("case")(self)

    @cached_property
    def _machine(self) -> tuple[MachineDescription | None, str]:
        found: tuple[MachineDescription | None, str] = view("machine")(self)
        return found

    @property
    def description(self) -> MachineDescription | None:
        """The machine, rebuilt from the case in the result; None if a file of it is gone."""
        return self._machine[0]

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What to know before trusting the result or building the machine, serious things first.

        Warnings of the run, limits that it exceeds and design rules that the machine does not
        meet: the same list on the command line, in JSON, in the report and in comparisons.
        """
        found: tuple[Finding, ...] = view("findings")(self, *self._machine)
        return found

    @property
    def plot(self) -> Figures:
        """Figures of the result, such as ``solution.plot.pressures()``."""
        return Figures(self)

    def report(self, path: str | Path | None = None) -> Path:
        """Write the HTML report and return its path.

        Parameters
        ----------
        path : str or Path, optional
            File to write; by default named after the case, in the current folder.
        """
        stem = Path(self.provenance.get("case_file") or "case").stem
        written: Path = view("report")(self, f"{stem}.html" if path is None else path)
        return written

    def bench(self) -> Any:
        """Return the views of the bench as a page without a server, which a notebook shows.

        Curves with one cursor through them and the turning section, spectra, orbits, films in plane
        and space, losses. ``solution.bench().save("views.html")`` writes it.
        """
        return view("bench")(self)

    def to_dataframe(self) -> pd.DataFrame:
        """Return all samples as columns named ``variable`` or ``variable[label]``, SI units.

        The index is the shaft angle [rad] or the time [s]; ``attrs["units"]`` holds the units.
        """
        import pandas as pd

        axis = "time" if "time" in self.data.sizes else "shaft_angle"
        columns: dict[str, Any] = {}
        units: dict[str, str] = {}
        for name, variable in self.data.data_vars.items():
            if variable.dims[:1] != (axis,) or variable.ndim > 2:
                continue
            rest = variable.dims[1:]
            labels = [f"[{label}]" for label in self.data[rest[0]].values] if rest else [""]
            for k, label in enumerate(labels):
                columns[f"{name}{label}"] = variable.values[:, k] if rest else variable.values
                units[f"{name}{label}"] = str(variable.attrs.get("units", "1"))
        frame = pd.DataFrame(columns, index=pd.Index(self.data[axis].values, name=axis))
        frame.attrs["units"] = units
        return frame

    def to_csv(self, path: str | Path) -> Path:
        """Write all samples as CSV, one column for each value, with ``name [unit]`` on top.

        Parameters
        ----------
        path : str or Path
            File to write.
        """
        from toothspace.results.exchange import headed

        frame = self.to_dataframe()
        units = {"time": "s", "shaft_angle": "rad"}
        text = headed(frame, units).to_csv(index=False)
        target = path_of(path, "CSV", "a file to write")
        target.parent.mkdir(parents=True, exist_ok=True)
        return write_text(target, text)

    def save(self, path: str | Path) -> Path:
        """Write one NetCDF file; an interrupted write leaves no half file behind.

        Parameters
        ----------
        path : str or Path
            File to write, by custom ``*.nc``.

        Returns
        -------
        Path
            The file written.
        """
        from toothspace.results.file_layout import FINDINGS, write_result

        told = json.dumps([finding.to_dict() for finding in self.warnings])
        attributes = {"status": self.status.name, FINDINGS: told}
        sentences = "\n".join(finding.sentence for finding in self.warnings)
        provenance = {**self.provenance, **({"warnings": sentences} if sentences else {})}
        return write_result(
            path, self.data, self.ledger, self.events, attributes, self.statistics, provenance
        )


def _told(solution: Solution, look: Callable[[], Iterable[Finding | str]]) -> Sequence[Finding]:
    return solution.with_note(*look()).warnings


@final
@dataclass(frozen=True, eq=False)
class Figures:
    """Figures of a solution; each is an object of Matplotlib.

    Raises
    ------
    CaseError
        If the result cannot give the figure: the names of those it can are in the message.
    """

    solution: Solution

    def __repr__(self) -> str:
        return f"<Figures: {', '.join(self.names())}>"

    @property
    def _entries(self) -> dict[str, Any]:
        found = view("figures")(self.solution, self.solution.description)
        return {entry.name: entry for entry in found}

    def names(self) -> list[str]:
        """Return the names of the figures that the result can give."""
        return list(self._entries)

    def figure(self, name: str) -> Figure:
        """Return the figure of a name."""
        entries = self._entries
        if name not in entries:
            allowed = ", ".join(entries)
            raise CaseError("figure", f"{name!r}", f"for this result {allowed}")
        figure: Figure = entries[name].draw(self.solution, self.solution.description)
        return figure

    def section(self) -> Figure:
        """Section of the machine, coloured by pressure."""
        return self.figure("gear_section")

    def pressures(self) -> Figure:
        """Pressure of a chamber on its way round; over time where a run has a circuit."""
        transient = "time" in self.solution.data.sizes
        return self.figure("time_history" if transient else "chamber_pressure")

    def ripple(self) -> Figure:
        """Flow, pressure and torque over a turn, with their spectra."""
        return self.figure("ripple")

    def orbits(self) -> Figure:
        """Path of the bodies inside their clearances."""
        return self.figure("journal_orbits")

    def forces(self) -> Figure:
        """Pressure force on the bodies over a turn."""
        return self.figure("force_polar")

    def contacts(self) -> Figure:
        """Contact forces of the teeth."""
        rotors = "tooth_contact_forces" in self.names()
        return self.figure("tooth_contact_forces" if rotors else "contact_forces")

    def losses(self) -> Figure:
        """Every loss of power."""
        return self.figure("loss_bars")

    def torques(self) -> Figure:
        """Friction torque by mechanism."""
        return self.figure("torque_breakdown")

    def leakage(self) -> Figure:
        """Leakage by path."""
        return self.figure("leakage_by_path")

    def wear(self) -> Figure:
        """Depth that the gears cut into the casing."""
        return self.figure("casing_wear")

    def films(self) -> Figure:
        """Lateral films: height, pressure and contact."""
        return self.figure("lateral_films")

    def volumes(self) -> Figure:
        """Chamber volume and its derivative over the angle."""
        return self.figure("volumes")

    def openings(self) -> Figure:
        """Open areas of a chamber over the angle."""
        return self.figure("openings")


def startup_numbers(data: xr.Dataset, breakaway: float) -> dict[str, float]:
    """Numbers of a start from rest, NaN where the shaft never moved or did not start at rest.

    ``startup_pressure_bar``: largest pressure difference until the shaft has turned one tooth
    pitch. ``max_running_pressure_bar``: largest moving mean over one pitch, from one second after
    breakaway until the supply slows down. ``startup_pressure_ratio``: one over the other.
    ``breakaway_time_s`` and ``breakaway_pressure_bar``: when the shaft begins to turn.
    ``settled_pressure_bar``: mean over the last fifth of running, and ``startup_to_settled_ratio``
    with it, which swings after the start do not touch.

    Parameters
    ----------
    breakaway : float
        When the shaft begins to turn, NaN if it never does. [s]
    """
    angle = np.asarray(data["shaft_angle"])
    highest = np.asarray(data["pressure_difference_highest"])
    pitch = tooth_pitch(data)
    within_pitch = np.abs(angle - angle[0]) <= pitch
    startup = float(highest[within_pitch].max()) if np.isfinite(breakaway) else np.nan
    # largest and settled moving mean between start and end of running
    time, running, settled = np.asarray(data["time"]), float("nan"), float("nan")
    supply = np.asarray(data["supply_speed"])
    plateau = np.flatnonzero(supply >= _AT_PLATEAU * supply.max())
    end = time[plateau[-1]] if supply.max() > 0.0 else time[-1]
    signal = np.asarray(data["pressure_difference"])
    runs = (time >= breakaway) & (time <= end)
    if runs.sum() >= 2:
        at, mean = moving_mean(time[runs], angle[runs], signal[runs], pitch)
        later = at >= breakaway + _SETTLING
        if later.any():
            at_end = at >= at[-1] - _SETTLED_SHARE * (at[-1] - breakaway)
            running, settled = float(mean[later].max()), float(mean[at_end].mean())
    released = float(np.interp(breakaway, time, signal))
    return {
        "startup_pressure_bar": startup / _BAR,
        "max_running_pressure_bar": running / _BAR,
        "startup_pressure_ratio": startup / running if running else np.nan,
        "breakaway_time_s": breakaway,
        "breakaway_pressure_bar": released / _BAR,
        "settled_pressure_bar": settled / _BAR,
        "startup_to_settled_ratio": startup / settled if settled else np.nan,
    }


def standing(data: xr.Dataset) -> Iterator[Finding]:
    """Say that a shaft that is free never turned, or stands still although the supply runs.

    Parameters
    ----------
    data : xarray.Dataset
        Rows over time of a machine with a free shaft.
    """
    speed, time = np.asarray(data["shaft_speed"]), np.asarray(data["time"])
    if speed[-1] != 0.0:
        return
    pressure = np.asarray(data["pressure_difference"])
    if not speed.any():
        reached = f"{float(np.abs(pressure).max()) / _BAR:.4g} bar"
        text = f"The shaft never turns: friction and load hold it against {reached}."
    elif float(np.asarray(data["supply_speed"])[-1]) > 0.0:
        since = float(time[np.flatnonzero(speed)[-1]])
        reached = f"{float(pressure[-1]) / _BAR:.4g} bar"
        text = (
            f"The shaft stands still since {since:.3g} s although the supply runs: friction and "
            f"load hold it against {reached}."
        )
    else:
        return
    yield Finding(
        "warning",
        text,
        quantity=STANDING,
        found="0 rpm",
        allowed="a shaft that turns",
        advice="Raise the opening_pressure of the relief valve or the flow of the supply, let "
        "circuit.duration be longer, or lower the load or the breakaway torque.",
    )


def tooth_pitch(data: xr.Dataset) -> float:
    """Shaft angle from one tooth to the next, from the labels of the chambers. [rad]."""
    labels = [str(label) for label in data["chamber"].values]
    family = labels[0].rpartition("_")[0]
    return _TURN / sum(label.rpartition("_")[0] == family for label in labels)


def moving_mean(time: Array, angle: Array, signal: Array, window: float) -> tuple[Array, Array]:
    """Mean over time of a signal while the shaft turns by a window.

    End of each window that fits in [s], and the mean over it.

    Parameters
    ----------
    time, angle, signal : ndarray, shape (rows,)
        Time [s], growing shaft angle [rad] and signal.
    window : float
        Angle of the window. [rad]
    """
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (signal[1:] + signal[:-1]) * np.diff(time))])
    growing = np.maximum.accumulate(angle)
    ends = growing >= growing[0] + window
    begin = np.interp(growing[ends] - window, growing, time)
    duration = np.maximum(time[ends] - begin, 1e-12)
    return time[ends], (whole[ends] - np.interp(begin, time, whole)) / duration


def load_solution(path: str | Path) -> Solution:
    """Read a solution back.

    Parameters
    ----------
    path : str or Path
        File written by :meth:`Solution.save`.

    Raises
    ------
    CaseError
        If the file is missing, damaged or not a result of this package.
    """
    from toothspace.results.file_layout import (
        EXTRA_VARIABLES,
        PROVENANCE,
        STATISTICS,
        read_events,
        read_ledger,
        read_warnings,
    )

    dataset = read_dataset(path, "a NetCDF file of a run")
    if "study" in dataset.attrs:
        found = f"the result of a study ({dataset.attrs['study']})"
        raise CaseError(path, found, "that of a run; report.html beside it is the study's report")
    if "status" not in dataset.attrs or "ledger_energy" not in dataset:
        raise CaseError(f"{path}: not a result of toothspace; expected a file written by run -o")
    try:
        attributes = dataset.attrs
        statistics = {k: v for k, v in attributes.items() if k.startswith(STATISTICS)}
        provenance = {key: str(attributes[key]) for key in attributes.get(PROVENANCE, "").split()}
        data = dataset.drop_vars(EXTRA_VARIABLES, errors="ignore")
        data.attrs = {key: attributes[key] for key in DATA_ATTRIBUTES if key in attributes}
        return Solution(
            status=Status[attributes["status"]],
            data=data,
            ledger=read_ledger(dataset),
            statistics={k.removeprefix(STATISTICS): float(v) for k, v in statistics.items()},
            provenance=provenance,
            events=read_events(dataset),
            warnings=read_warnings(attributes),
        )
    except (KeyError, ValueError, TypeError, IndexError) as error:
        found = f"a result without a usable {error}"
        raise CaseError(path, found, "one that this version wrote") from error
