"""A form for cases: what may be opened, checked and run, served to this computer alone."""

from __future__ import annotations

import json
import math
import secrets
import tempfile
import threading
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from typing import Any, final
from urllib.parse import parse_qs, urlsplit

from toothspace.api import simulate
from toothspace.case import Case, load_case
from toothspace.case.case import case_schema
from toothspace.case.document import text_values
from toothspace.case.shipped import cases, shipped_case
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.progress import UNKNOWN, reporting_to
from toothspace.library import shipped_folder
from toothspace.report.study import write_study_report
from toothspace.results.solution import Solution
from toothspace.studies import StudyResult, run_study

_LONGEST_PATH = 1000
HOST = "127.0.0.1"
_LARGEST_FORM = 2**20
_TYPES = {".html": "text/html; charset=utf-8", ".nc": "application/x-netcdf"}


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

        Raises CaseError if no case of that name is listed, or it cannot be read.
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

        Raises CaseError if a key cannot be taken, or a run is under way.
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

        Raises CaseError if there is none.
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


@final
class FormServer(ThreadingHTTPServer):
    """Server of the form on this computer; its address holds a secret that every request shows.

    Parameters
    ----------
    session : Session
        Cases and the run.
    port : int
        Port, 0 for a free one.
    """

    daemon_threads = True

    def __init__(self, session: Session, port: int = 0) -> None:
        super().__init__((HOST, port), _Handler)
        self.session = session
        self.token = secrets.token_urlsafe(16)

    @property
    def address(self) -> str:
        """Address to open in a browser."""
        return f"http://{HOST}:{self.server_address[1]}/?token={self.token}"


class _Handler(BaseHTTPRequestHandler):
    server: FormServer

    def do_GET(self) -> None:
        """Answer what changes nothing."""
        if not self._admitted():
            return
        asked, session = urlsplit(self.path), self.server.session
        page = files("toothspace.app").joinpath("page.html")
        answers: dict[str, Callable[[], object]] = {
            "/": lambda: self._send(200, page.read_bytes(), _TYPES[".html"]),
            "/schema": lambda: self._json(case_schema()),
            "/cases": lambda: self._json(session.cases()),
            "/case": lambda: self._json(session.tables(parse_qs(asked.query).get("name", [""])[0])),
            "/run": lambda: self._json(session.state()),
            "/report.html": lambda: self._result(".html"),
            "/result.nc": lambda: self._result(".nc"),
        }
        self._answer(answers.get(asked.path))

    def do_POST(self) -> None:
        """Check, run, stop, or write the case of the form."""
        size = self.headers.get("Content-Length") or "0"
        if not size.isdecimal() or int(size) > _LARGEST_FORM:
            self._send(413, b"")
            return
        body = self.rfile.read(int(size))
        if not self._admitted():
            return
        session = self.server.session
        answers: dict[str, Callable[[], object]] = {
            "/check": lambda: self._json(repr(session.case(_tables(body)))),
            "/run": lambda: self._json(session.start(_tables(body))),
            "/stop": lambda: self._json(session.stop()),
            "/case.toml": lambda: self._json(session.case(_tables(body)).to_toml()),
        }
        self._answer(answers.get(urlsplit(self.path).path))

    def log_message(self, *_: Any) -> None:
        """Say nothing about requests."""

    def _admitted(self) -> bool:
        # another page in the same browser knows no secret, and cannot come under another name
        given = parse_qs(urlsplit(self.path).query).get("token", [""])[0]
        port = self.server.server_address[1]
        known = self.headers.get("Host") in {f"{HOST}:{port}", f"localhost:{port}"}
        if known and secrets.compare_digest(given.encode(), self.server.token.encode()):
            return True
        self._send(403, b"Open the address that 'toothspace app' has printed.")
        return False

    def _answer(self, answer: Callable[[], object] | None) -> None:
        if answer is None:
            self._send(404, b"")
            return
        try:
            answer()
        except ToothspaceError as error:
            self._json({"problems": str(error).splitlines()}, 422)
        except BrokenPipeError:
            pass  # the page was closed

    def _result(self, ending: str) -> None:
        with tempfile.TemporaryDirectory() as folder:
            written = self.server.session.written(ending, Path(folder))
            self._send(200, written.read_bytes(), _TYPES[ending])

    def _json(self, value: Any, code: int = 200) -> None:
        self._send(code, json.dumps(value).encode(), "application/json")

    def _send(self, code: int, content: bytes, kind: str = "text/plain") -> None:
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("X-Frame-Options", "DENY")
        self.end_headers()
        self.wfile.write(content)


def _tables(body: bytes) -> Mapping[str, Any]:
    try:
        tables = json.loads(body)
    except ValueError as error:
        raise CaseError("form", "no JSON", "tables of keys") from error
    if not isinstance(tables, dict):
        raise CaseError("form", "no tables", "tables of keys")
    return tables
