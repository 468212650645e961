"""What a notebook or a script calls: cases in, solutions with figures and exports out."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from html import escape
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace import api
from toothspace.advice.findings import findings_of, status_line
from toothspace.case import Case, load_case
from toothspace.core.errors import CaseError
from toothspace.core.files import path_of, write_text
from toothspace.core.finding import Finding
from toothspace.core.types import Array
from toothspace.core.units import Quantity, as_text, parse_quantity, split_quantity, to_si
from toothspace.model.description import MachineDescription
from toothspace.results import io
from toothspace.results import solution as results

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from toothspace.core.progress import Progress
    from toothspace.geometry.evaluated_designs import EvaluatedDesigns
    from toothspace.plotting.catalogue import FigureEntry
    from toothspace.report.comparison import Comparison
    from toothspace.studies.study import StudyResult

_KEY_NUMBERS = 12


@final
class Solution(results.Solution):
    """Result of one run with its figures, tables and report.

    ``status``, ``data``, ``ledger``, ``statistics``, ``provenance``, ``events``, ``warnings``,
    ``summary()`` and ``save()`` are those of :class:`toothspace.results.solution.Solution`.
    """

    @cached_property
    def _machine(self) -> tuple[MachineDescription | None, str]:
        """The machine, and why there is none."""
        from toothspace.report.machine import machine_of

        return machine_of(self)

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
        return findings_of(self, *self._machine)

    def __repr__(self) -> str:
        return self._shown(status_line(self.status, self.findings))

    @property
    def plot(self) -> Figures:
        """Figures of the result, such as ``solution.plot.pressures()``."""
        return Figures(self)

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
        frame = self.to_dataframe()
        index = "s" if frame.index.name == "time" else "rad"
        heads = [f"{name} [{unit}]" for name, unit in frame.attrs["units"].items()]
        text = frame.to_csv(index_label=f"{frame.index.name} [{index}]", header=heads)
        target = path_of(path, "CSV", "a file to write")
        target.parent.mkdir(parents=True, exist_ok=True)
        return write_text(target, text)

    def report(self, path: str | Path | None = None) -> Path:
        """Write the HTML report and return its path.

        Parameters
        ----------
        path : str or Path, optional
            File to write; by default named after the case, in the current folder.
        """
        from toothspace.report import write_report

        stem = Path(self.provenance.get("case_file") or "case").stem
        return write_report(self, f"{stem}.html" if path is None else path, self.description)

    def _repr_html_(self) -> str:
        from toothspace.plotting.style import figure_to_svg

        rows = [
            f"<tr><th style='text-align:left'>{escape(name)}</th>"
            f"<td>{f'{value:.5g}' if isinstance(value, float) else escape(str(value))}</td></tr>"
            for name, value in list(self.summary().items())[:_KEY_NUMBERS]
        ]
        section = figure_to_svg(self.plot.section()) if "gear_section" in self.plot.names() else ""
        head = escape(self.provenance.get("title", self.data.attrs.get("title", "")))
        status = escape(status_line(self.status, self.findings))
        found = "".join(f"<li>{escape(str(finding))}</li>" for finding in self.findings)
        table = f"<table>{''.join(rows)}</table>"
        return f"<h4>{head}</h4><p>{status}</p><ul>{found}</ul>{table}<div>{section}</div>"


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
    def _entries(self) -> dict[str, FigureEntry]:
        from toothspace.plotting.catalogue import available_figures

        return {e.name: e for e in available_figures(self.solution, self.solution.description)}

    def names(self) -> list[str]:
        """Return the names of the figures that the result can give."""
        return list(self._entries)

    def figure(self, name: str) -> Figure:
        """Return the figure of a name."""
        entries = self._entries
        if name not in entries:
            allowed = ", ".join(entries)
            raise CaseError(f"figure: found {name!r}, allowed for this result {allowed}")
        return entries[name].draw(self.solution, self.solution.description)

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


def _interactive(solution: results.Solution) -> Solution:
    return Solution(**{f.name: getattr(solution, f.name) for f in fields(results.Solution)})


def _as_case(case: Case | str | Path | Mapping[str, Any]) -> Case:
    return case if isinstance(case, Case) else load_case(case)


def describe(case: Case | str | Path) -> MachineDescription:
    """Turn the machine of a case into its tables over the shaft angle.

    Parameters
    ----------
    case : Case, str or Path
        Case, or its file.
    """
    return api.describe(_as_case(case))


def simulate(
    case: Case | str | Path | Mapping[str, Any], progress: Progress | None = None, **overrides: Any
) -> Solution:
    """Run a case; a numerical failure is a status of the solution.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case, its file or its tables.
    progress : callable, optional
        Called with the finished share and a short text.
    **overrides : object
        Values of key paths as for :meth:`toothspace.Case.replace`, two underscores for the dot:
        ``operating_point__shaft_speed="2000 rpm"``.

    Raises
    ------
    CaseError
        If the case asks for the impossible.

    Examples
    --------
    >>> import toothspace as ts
    >>> ts.simulate("cases/egm12_pump.toml", run__fidelity="ideal")  # doctest: +SKIP
    """
    given = _as_case(case)
    if overrides:
        values = {name.replace("__", "."): value for name, value in overrides.items()}
        given = given.replace(values)
    return _interactive(api.simulate(given, progress=progress))


def simulate_all(
    cases: Iterable[Case | str | Path], workers: int = 1
) -> list[Solution | Exception]:
    """Run several cases; a case that cannot run is returned as its exception.

    Parameters
    ----------
    cases : iterable of Case, str or Path
        Cases or their files.
    workers : int
        Processes.
    """
    if not isinstance(cases, Iterable) or isinstance(cases, (str, Mapping)):
        raise CaseError(f"cases: found {reprlib.repr(cases)}, allowed a list of cases")
    found = api.simulate_all([_as_case(case) for case in cases], _processes(workers))
    return [one if isinstance(one, Exception) else _interactive(one) for one in found]


def load_solution(path: str | Path) -> Solution:
    """Read a result file.

    Parameters
    ----------
    path : str or Path
        NetCDF file of ``Solution.save`` or ``toothspace run``.

    Raises
    ------
    CaseError
        If it is no such file.
    """
    return _interactive(io.load_solution(path))


def compare(
    first: results.Solution | str | Path, second: results.Solution | str | Path
) -> Comparison:
    """Put two results side by side.

    Parameters
    ----------
    first, second : Solution, str or Path
        Results, or their files.
    """

    def solution(given: results.Solution | str | Path) -> Solution:
        if isinstance(given, Solution):
            return given
        return _interactive(given) if isinstance(given, results.Solution) else load_solution(given)

    from toothspace.report.comparison import Comparison

    return Comparison(solution(first), solution(second))


def sweep(
    case: Case | str | Path,
    vary: Mapping[str, Any],
    *,
    workers: int = 1,
    folder: str | Path | None = None,
    progress: Progress | None = None,
) -> StudyResult:
    """Run a case at all combinations of values; the last key runs fastest.

    Parameters
    ----------
    case : Case, str or Path
        Case with an operating point or a circuit; its own study does not count.
    vary : mapping of key path to values
        Lists, or ``{"from": ..., "to": ..., "count": ...}``; values as in a case file.
    workers : int
        Processes.
    folder : str or Path, optional
        Folder of the results; finished points found there are not run again.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    StudyResult
        Summary numbers over ``point`` in ``data``.

    Raises
    ------
    CaseError
        If no point can be run.
    """
    from toothspace.studies.registry import run_study
    from toothspace.studies.sweep import SweepStudy

    study = replace(_as_case(case), study=SweepStudy(vary=vary))
    place = None if folder is None else path_of(folder, "folder", "a folder")
    resume = place is not None and place.is_dir()
    return run_study(study, place, progress=progress, workers=_processes(workers), resume=resume)


def export_fmu(
    case: Case | str | Path | Mapping[str, Any],
    path: str | Path,
    *,
    pressure_difference: Sequence[Quantity | str] = (),
    shaft_speed: Sequence[Quantity | str] = (),
    drive: str = "speed",
    binary: bool = True,
    workers: int = 1,
    progress: Progress | None = None,
) -> StudyResult:
    """Tabulate a machine by steady runs and write it as a unit for FMI 2.0 co-simulation.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case with an operating point; its ports are held at constant pressure.
    path : str or Path
        File to write. Finished runs are kept beside it until it is written, and taken again.
    pressure_difference, shaft_speed : sequence of Quantity or str, optional
        At least two values each, such as ``"50 bar"`` and ``"500 rpm"``; left out, those of an
        efficiency map of the case, or 10, 40, 70 and 100 % of its operating point.
    drive : str
        ``speed``: the shaft speed is an input; ``torque``: it follows from load torque and inertia.
    binary : bool
        Whether the C compiler of this computer, if there is one, adds a binary to the sources.
    workers : int
        Processes that share the runs.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    StudyResult
        The tables in ``data``; the unit is written only if its status is ``DONE``.

    Raises
    ------
    CaseError
        If the case has no operating point, an argument is not allowed, or the compiler fails.
    """
    from toothspace.fmi import export

    return export.export_fmu(
        _as_case(case),
        path_of(path, "path", "a file to write"),
        pressures=[parse_quantity(str(as_text(value)), "bar") for value in pressure_difference],
        speeds=[parse_quantity(str(as_text(value)), "rpm") for value in shaft_speed],
        drive=drive,
        binary=binary,
        workers=_processes(workers),
        progress=progress,
    )


def evaluate_designs(
    case: Case | str | Path,
    values: Mapping[str, Any],
    *,
    addendum: float | None = None,
    displacement: Quantity | str | None = None,
) -> EvaluatedDesigns:
    """Kinematics of many gear designs at once, without a run: closed forms over arrays.

    Parameters
    ----------
    case : Case, str or Path
        Machine with gears given by parameters; its keys count where none are given here.
    values : mapping of key path to array
        Numbers, in SI units where the key has a unit, or texts with units; arrays are broadcast
        together. Keys of the teeth, ``face_width``, ``normal_backlash`` and ``center_distance``.
    addendum : float, optional
        Height of the teeth above the shifted reference line, in modules: tip diameters follow
        module, tooth count and profile shift. Left out, they are those given.
    displacement : Quantity or str, optional
        Such as ``"4.95 cm^3/rev"``: the face width of each design is chosen for it.

    Returns
    -------
    EvaluatedDesigns
        Numbers as of ``toothspace geometry``, of the shape of the arrays, NaN of designs that
        cannot be made or do not turn; ``reasons``, ``valid``, ``keeps_rules`` and ``why(index)``
        say what is against a design.

    Raises
    ------
    CaseError
        If a key does not act on the kinematics, or the teeth come from a file.

    Examples
    --------
    >>> import toothspace as ts
    >>> designs = ts.evaluate_designs(
    ...     "egm12_pump", {"machine.gears.tooth_count": [10, 12, 14]}, addendum=1.0
    ... )
    >>> designs["flow_ripple_percent"].round(1).tolist()
    [19.6, 16.7, 14.5]
    """
    if not isinstance(values, Mapping):
        raise CaseError(f"values: found {reprlib.repr(values)}, allowed a table of keys and arrays")
    arrays = {path: _in_si(raw) for path, raw in values.items()}
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError as error:
        found = ", ".join(f"{path} {array.shape}" for path, array in arrays.items())
        allowed = "shapes that go together"
        raise CaseError(f"values: found arrays of shapes {found}, allowed {allowed}") from error
    rows = {path: np.broadcast_to(array, shape).ravel() for path, array in arrays.items()}
    volume = None
    if displacement is not None:
        volume = parse_quantity(str(displacement), "cm^3/rev")
    return api.evaluate_designs(_as_case(case), rows, addendum, volume).shaped(shape)


def _in_si(raw: Any) -> Array:
    given = np.asarray(raw)
    if given.dtype.kind in "OU":
        numbers = [to_si(*split_quantity(str(as_text(one)))) for one in given.flat]
        return np.asarray(numbers).reshape(given.shape)
    return given.astype(float)


def _processes(workers: object) -> int:
    if isinstance(workers, bool) or not isinstance(workers, Integral) or workers < 1:
        raise CaseError(f"workers: found {reprlib.repr(workers)}, allowed a whole number above 0")
    return int(workers)
