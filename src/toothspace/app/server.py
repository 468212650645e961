"""What the browser asks for: the page, cases, checks and runs; nothing of it from elsewhere."""

from __future__ import annotations

import json
import secrets
import tempfile
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from typing import Any, final
from urllib.parse import parse_qs, urlsplit

from toothspace.app.session import Session
from toothspace.case.case import case_schema
from toothspace.core.errors import CaseError, ToothspaceError

HOST = "127.0.0.1"
_LARGEST_FORM = 2**20
_TYPES = {".html": "text/html; charset=utf-8", ".nc": "application/x-netcdf"}


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
