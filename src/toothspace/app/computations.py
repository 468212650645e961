"""What the processes of the page compute, from tables of a case to what JSON holds."""

from __future__ import annotations

import json
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, final

from toothspace.app.answers import Answers, shown, told, turning_answer
from toothspace.app.causes import causes
from toothspace.app.drawing import DRAG_NODES, drawn_bodies, look
from toothspace.app.workspace import Workspace
from toothspace.case import Case, load_case
from toothspace.case.case import case_schema
from toothspace.case.shipped import shipped_case
from toothspace.core.errors import CaseError
from toothspace.core.files import plain, write_text
from toothspace.core.progress import Progress, reporting_to
from toothspace.core.status import Status

VIEWS = "views.json"
"""File of a run with its views."""
_KEPT_DESIGNS = 2


@final
class Computations:
    """Everything that needs more than moments or may fail, for one folder of cases.

    Parameters
    ----------
    folder : Path
        Folder that file paths in cases are relative to.
    told : callable
        Called with the finished share and a short text; raises KeyboardInterrupt to stop.
    """

    def __init__(self, folder: Path, told: Progress) -> None:
        self._folder, self._told = folder, told
        self._workspace = Workspace(folder)
        self._answers: OrderedDict[str, Answers] = OrderedDict()

    def case(self, tables: Mapping[str, Any]) -> Case:
        """Check the keys of a case; CaseError has a line for every key."""
        self._workspace.guard(tables)
        return Case.from_dict(tables, self._folder)

    def schema(self) -> Any:
        """JSON Schema of a case."""
        return case_schema()

    def opened(self, name: str) -> dict[str, Any]:
        """Tables of a case file of the folder or of a shipped case."""
        path = self._folder / name if name.endswith(".toml") else shipped_case(name)
        tables = load_case(path).to_dict()
        self._workspace.guard(tables)
        return tables

    def changed(self, tables: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
        """Tables of a case with other values behind key paths, checked and built."""
        self._workspace.guard(dict(values))
        case = self.case(tables)
        return (case.replace(values) if values else case).check().to_dict()

    def read(self, text: str) -> dict[str, Any]:
        """Tables of a case given as TOML, checked and built."""
        case = Case.from_toml(text, self._folder)
        self._workspace.guard(case.to_dict())
        return case.check().to_dict()

    def toml(self, tables: Mapping[str, Any]) -> str:
        """Case as TOML."""
        return self.case(tables).to_toml(self._folder)

    def look(self, tables: Mapping[str, Any], values: Mapping[str, Any], **asked: bool) -> Any:
        """Section, numbers, openings and rules of a machine with other values.

        While a handle is dragged (``drag``) of coarser tables; what the page draws itself
        (``numbers_only``) is left out, ``cells`` are what it cuts grooves from.
        """
        self._workspace.guard(dict(values))
        case = self.case(tables)
        if values:
            case = case.replace(values)
        if case.machine is None:
            return {}
        nodes = DRAG_NODES if asked.pop("drag", False) else None
        return look(case, nodes, **asked)

    def answer(self, design: str, tables: Mapping[str, Any], full: bool) -> dict[str, Any]:
        """Solve a machine, quickly from its last cyclic state or in full."""
        answers = self._answers.setdefault(design, Answers())
        self._answers.move_to_end(design)
        while len(self._answers) > _KEPT_DESIGNS:
            self._answers.popitem(last=False)
        case = self.case(tables).at_point({})
        if case.operating_point is None and case.circuit is None:
            return {**_stand_alone(case), "findings": [], "losses": []}
        with reporting_to(self._told):
            solve = answers.full if full else answers.quick
            found = solve(case, self._told)
        if found.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        return shown(found, answers.machine, findings=full or not found.status.succeeded)

    def findings(self, design: str) -> dict[str, Any]:
        """What there is to know of the last answer of a design."""
        answers = self._answers.get(design)
        if answers is None or answers.solution is None:
            raise CaseError("There is no answer yet: run the machine first.")
        return told(answers.solution)

    def causes(self, first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
        """What each key that differs between two cases changes in the answer."""
        with reporting_to(self._told):
            return causes(self.case(first), self.case(second), self._told)

    def turning(self, design: str, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Pictures of one pitch of the last answer."""
        answers = self._answers.get(design)
        if answers is None or answers.solution is None:
            raise CaseError("There is no answer yet: run the machine first.")
        if "shaft_angle" not in answers.solution.data.sizes:
            raise CaseError("A run over time does not repeat: it has no pictures of one pitch.")
        return turning_answer(self.case(tables), answers.solution, answers.march)

    def views(self, design: str, tables: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Views of the last answer."""
        from toothspace.report.views import views_of

        answers = self._answers.get(design)
        if answers is None or answers.solution is None:
            raise CaseError("There is no answer yet: run the machine first.")
        return views_of(answers.solution)

    def written(self, design: str, tables: Mapping[str, Any], ending: str, path: str) -> None:
        """Write the last answer of a design as ``nc``, ``csv``, ``html`` or ``png``."""
        answers = self._answers.get(design)
        if answers is None or answers.solution is None:
            raise CaseError("There is no answer yet: run the machine first.")
        _write(answers.solution, Path(path), ending)

    def run(self, tables: Mapping[str, Any], folder: str, resume: bool) -> dict[str, Any]:
        """Run a case or its study; results and report are written into a folder."""
        target, case = Path(folder), self.case(tables)
        with reporting_to(self._told):
            if case.study is not None:
                return self._study(case, target, resume=resume)
            if case.operating_point is None and case.circuit is None:
                found = _stand_alone(case)
                write_text(target / "result.json", json.dumps(found["numbers"], indent=2))
                return found
            from toothspace.api import simulate
            from toothspace.report.views import views_of

            solution = simulate(case, self._told)
        if solution.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        for ending in ("nc", "csv", "html"):
            _write(solution, target / f"result.{ending}", ending)
        write_text(target / VIEWS, json.dumps(views_of(solution)))
        return shown(solution)

    def _study(self, case: Case, target: Path, *, resume: bool) -> dict[str, Any]:
        from toothspace.report.study import write_study_report
        from toothspace.report.views import study_views
        from toothspace.studies import run_study

        result = run_study(case, target, progress=self._told, resume=resume)
        if result.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        result.save(target)
        write_study_report(result, target / "result.html")
        write_text(target / VIEWS, json.dumps(study_views(result, case)))
        return {
            "status": result.status.name.lower(),
            "done": result.status.succeeded,
            "sentence": result.status.value,
            "numbers": plain(
                {name: v for name, v in result.summary().items() if isinstance(v, int | float)}
            ),
        }

    def unit(self, tables: Mapping[str, Any], folder: str) -> dict[str, Any]:
        """Write the machine as a functional mock-up unit of its steady runs."""
        from toothspace.fmi.export import write_fmu

        result = write_fmu(self.case(tables), Path(folder) / "machine.fmu", progress=self._told)
        return {
            "status": result.status.name.lower(),
            "done": result.status.succeeded,
            "sentence": result.status.value,
            "numbers": {},
        }

    def animation(self, tables: Mapping[str, Any], folder: str) -> dict[str, Any]:
        """Run a case and write its turning machine as GIF."""
        return self._moving(tables, Path(folder) / "turning.gif")

    def film(self, tables: Mapping[str, Any], folder: str) -> dict[str, Any]:
        """Run a case and write its turning machine as MP4."""
        return self._moving(tables, Path(folder) / "turning.mp4")

    def _moving(self, tables: Mapping[str, Any], path: Path) -> dict[str, Any]:
        from toothspace.api import simulate
        from toothspace.plotting.animation import require_writer, write_animation

        require_writer(path)
        solution = simulate(self.case(tables), self._told)
        write_animation(solution, path, progress=self._told)
        return shown(solution)

    def found_in(
        self, names: Sequence[str], unit: str, left_out: Sequence[tuple[str, int]] = ()
    ) -> dict[str, Any]:
        """What CAD files of the folder hold, its bodies drawn, and a first case of it as TOML.

        Bodies that are left out, by file and number, are drawn but do not count.
        """
        from toothspace.api import draft_case
        from toothspace.core.units import to_si
        from toothspace.geometry.body_section import SectionRequest
        from toothspace.geometry.gear_data import file_report, flank_warnings
        from toothspace.geometry.gear_finder import find_in_files

        files, scale = [self._folder / name for name in names], to_si(1.0, unit)
        request = SectionRequest(left_out=tuple((file, body) for file, body in left_out))
        found: dict[str, Any] = {"report": {}, "warnings": [], "toml": "", "problem": ""}
        found["bodies"] = []
        try:
            contents = find_in_files(files, scale)
            found["bodies"] = drawn_bodies(contents, files, scale)
            if left_out:
                contents = find_in_files(files, scale, request)
            found["report"] = plain(file_report(contents, None))
            found["warnings"] = [str(warning) for warning in flank_warnings(contents)]
        except CaseError as error:
            found["problem"] = str(error)
        try:
            found["toml"] = draft_case(files, unit, request, self._folder)
        except CaseError as error:
            found["problem"] = found["problem"] or str(error)
        return found

    def new(self, machine: str, values: Mapping[str, str]) -> str:
        """First design of a machine for a displacement, a pressure and a speed, as TOML."""
        from toothspace.api import new_case

        return new_case(machine, **values)


def _stand_alone(case: Case) -> dict[str, Any]:
    """Numbers of a bearing or a film alone."""
    from toothspace.api import solve_bearing, solve_film

    solve = solve_bearing if case.bearing is not None else solve_film
    numbers = plain(solve(case))
    status = str(numbers["status"])
    return {
        "status": status,
        "done": Status[status.upper()].succeeded,
        "sentence": status,
        "numbers": {name: v for name, v in numbers.items() if isinstance(v, int | float)},
    }


def _write(solution: Any, path: Path, ending: str) -> None:
    if ending == "nc":
        solution.save(path)
    elif ending == "csv":
        solution.to_csv(path)
    elif ending == "html":
        solution.report(path)
    else:
        from toothspace.plotting.style import save_figure

        save_figure(solution.plot.section(), path)
