"""What the form works with: cases to open, their check, and the one run of the moment."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any, final

from toothspace.api import simulate
from toothspace.case import Case, load_case
from toothspace.case.document import text_values
from toothspace.case.shipped import cases, shipped_case
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.progress import UNKNOWN, reporting_to
from toothspace.library import shipped_folder
from toothspace.report.study import write_study_report
from toothspace.results.solution import Solution
from toothspace.studies import StudyResult, run_study

_LONGEST_PATH = 1000


@final
class Session:
    """Cases of one folder and those shipped; one of them runs at a time.

    Parameters
    ----------
    folder : Path
        Folder whose case files are listed and that file paths in a case are relative to.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._thread: threading.Thread | None = None
        self._stopped = threading.Event()
        self._share, self._text = UNKNOWN, ""
        self._problem = ""
        self.solution: Solution | StudyResult | None = None

    def cases(self) -> dict[str, str]:
        """Titles by name: the files of the folder by their file name, then the shipped cases."""
        own = {path.name: f"file in {self.folder.name}" for path in self.folder.glob("*.toml")}
        return {**dict(sorted(own.items())), **cases()}

    def tables(self, name: str) -> dict[str, Any]:
        """Keys of a case that is listed, as tables with texts for quantities.

        Raises
        ------
        CaseError
            If no case of that name is listed, or it cannot be read.
        """
        if name not in self.cases():
            raise CaseError("case", f"{name!r}", "one that is listed")
        return load_case(self.folder / name if "." in name else shipped_case(name)).to_dict()

    def case(self, tables: Mapping[str, Any]) -> Case:
        """Check the keys of a form.

        Raises
        ------
        CaseError
            A line for every key that cannot be taken; a file outside the folder and the shipped
            cases is one of them.
        """
        homes = self.folder, shipped_folder("cases").resolve()
        for key, text in text_values(tables):
            if len(text) > _LONGEST_PATH or "\0" in text:
                continue
            place = (self.folder / text).resolve()
            if place.exists() and not any(place.is_relative_to(home) for home in homes):
                raise CaseError(f"case: {key}", f"{text!r}", f"a file in {self.folder}")
        return Case.from_dict(tables, self.folder).check()

    def start(self, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Run a case; returns the state.

        Raises
        ------
        CaseError
            If a key cannot be taken, or a run is under way.
        """
        case = self.case(tables)
        if self._thread is not None and self._thread.is_alive():
            raise CaseError("run", "one under way", "one at a time")
        self.solution, self._problem = None, ""
        self._share, self._text = UNKNOWN, "geometry"
        self._stopped.clear()
        self._thread = threading.Thread(target=self._run, args=(case,), daemon=True)
        self._thread.start()
        return self.state()

    def stop(self) -> dict[str, Any]:
        """End the run where it reports next, keeping what there is by then; returns the state."""
        self._stopped.set()
        return self.state()

    def state(self) -> dict[str, Any]:
        """How far the run is: running, share (null if unknown), text, problem, result."""
        running = self._thread is not None and self._thread.is_alive()
        return {
            "running": running,
            "share": self._share if math.isfinite(self._share) else None,
            "text": self._text,
            "problem": self._problem,
            "result": None if self.solution is None or running else self.solution._repr_html_(),
        }

    def written(self, ending: str, folder: Path) -> Path:
        """Write the result as a page (``.html``) or as data (``.nc``) into a folder; its file.

        Raises
        ------
        CaseError
            If there is none.
        """
        found, file = self.solution, folder / f"result{ending}"
        if found is None:
            raise CaseError("result", "none", "after a run")
        if isinstance(found, Solution):
            return found.report(file) if ending == ".html" else found.save(file)
        return write_study_report(found, file) if ending == ".html" else found.save(folder)[0]

    def _run(self, case: Case) -> None:
        try:
            with reporting_to(self._report):
                started = simulate if case.study is None else run_study
                self.solution = started(case, progress=self._report)
        except ToothspaceError as error:
            self._problem = str(error)
        except KeyboardInterrupt:
            self._problem = "Stopped before there was a result."
        except Exception as error:
            self._problem = f"Unexpected {type(error).__name__}: {error}"

    def _report(self, share: float, text: str) -> None:
        self._share, self._text = share, text
        if self._stopped.is_set():
            self._stopped.clear()
            raise KeyboardInterrupt
