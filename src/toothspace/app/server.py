"""The server of the bench: what the page asks for, on Starlette and uvicorn (extra ``app``)."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import socket
import tempfile
import threading
import tomllib
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, fields
from functools import partial
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.app.guard import Guard
from toothspace.app.queue import RunQueue
from toothspace.app.workers import StoppedError, Worker
from toothspace.app.workspace import LARGEST_UPLOAD, Workspace
from toothspace.case.conditions import InterfaceChoice
from toothspace.case.presets import INTERFACES, MODELS, PRESETS
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.registry import machine_type_names, optional_function
from toothspace.results.variables import BY_LABEL, WORDS

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

HOST = "127.0.0.1"
_LOOK_TIME = 60.0
"""In which a machine is drawn, or its case is read. [s]"""
_READ_TIME = 200.0
"""In which drawings are read, each of them in 180 s. [s]"""
_MOST_CONNECTIONS = 64
_COSTS = {
    "ideal": "at once",
    "lumped": "some seconds",
    "films": "some seconds more than lumped",
    "elastic": "a minute or more",
}
"""What a run costs by its preset, until the page has measured one."""
_VIEW_FILES = ("views.js", "views.css")
"""What draws views of a result, as in reports."""
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".nc": "application/x-netcdf",
    ".csv": "text/csv; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".gif": "image/gif",
    ".mp4": "video/mp4",
    ".fmu": "application/zip",
    ".toml": "application/toml; charset=utf-8",
}
_REPORT_POLICY = (
    "sandbox allow-scripts allow-popups; default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; img-src data:"
)
"""What a report may do: show itself, without asking this server as the page may."""


@final
@dataclass(frozen=True)
class FileAnswer:
    """A file as an answer."""

    content: bytes
    ending: str
    """Such as ``.nc``."""
    name: str = ""
    """Under which it is offered for saving; empty: it is shown."""
    report: bool = False
    """Whether it is a page of a result, which may ask this server for nothing."""


@final
class Bench:
    """Everything that stands behind the page: kept designs, warm processes, the queue of runs.

    Parameters
    ----------
    folder : Path
        Folder of case files and of files that they name.
    """

    def __init__(self, folder: Path) -> None:
        self.workspace = Workspace(folder)
        self._looking, self._solving = Worker(self.workspace.folder), Worker(self.workspace.folder)
        self._turn = threading.Lock()
        self._asked: dict[str, int] = {}
        self._solved = ""
        self._listeners: list[Callable[[dict[str, Any]], None]] = []
        self.queue = RunQueue(self.workspace, lambda run: self._tell("run", run))
        self._schema: Any = None

    def warm(self) -> None:
        """Start the processes before they are needed."""
        for worker in (self._looking, self._solving):
            threading.Thread(target=partial(_warmed, worker), daemon=True).start()

    def close(self) -> None:
        """End all processes."""
        self.queue.close()
        self._looking.end()
        self._solving.end()

    @contextmanager
    def listening(self, listener: Callable[[dict[str, Any]], None]) -> Iterator[None]:
        """Tell a listener of every change meanwhile."""
        self._listeners.append(listener)
        try:
            yield
        finally:
            self._listeners.remove(listener)

    def _tell(self, kind: str, value: Any) -> None:
        for listener in list(self._listeners):
            listener({"kind": kind, "value": value})

    def start(self) -> dict[str, Any]:
        """What the first page shows."""
        names = machine_type_names()
        return {
            "folder": self.workspace.folder.name,
            "cases": self.workspace.cases(),
            "designs": self.workspace.designs(),
            "files": self.workspace.files(),
            "runs": self.queue.runs(),
            "machines": names,
            "new": [name for name in names if optional_function(name, "new_case") is not None],
        }

    def schema(self) -> Any:
        """JSON Schema of a case."""
        if self._schema is None:
            self._schema = self._look("schema")
        return self._schema

    def words(self) -> dict[str, Any]:
        """Names of numbers for a reader, where those of the key would not tell."""
        return {"names": dict(WORDS), "beginnings": dict(BY_LABEL)}

    def fidelities(self) -> dict[str, Any]:
        """Presets, the models of every interface in each, and what a run costs with it."""
        return {
            "presets": [
                {"name": one.name, "content": one.content, "interfaces": dict(one.interfaces)}
                for one in PRESETS.values()
            ],
            "interfaces": dict(INTERFACES),
            "models": dict(MODELS),
            "free": [one.name for one in fields(InterfaceChoice)],
            "costs": _COSTS,
        }

    def new_design(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Keep a new design.

        From a listed ``case``, ``toml``, ``tables``, numbers (``new``), or a point (``values``) of
        a ``run``.
        """
        text = given.get("toml")
        if "new" in given:
            numbers = _table(given, "new")
            machine = str(numbers.pop("machine", ""))
            text = self._look("new", machine, {name: str(v) for name, v in numbers.items()})
        if text is not None:
            tables = self._look("read", str(text))
        elif "run" in given:
            run = str(given["run"])
            tables = next(
                (one["tables"] for one in self.workspace.runs() if one["id"] == run), None
            )
            if tables is None:
                raise CaseError("run", repr(run[:200]), "one that is kept here")
            tables.pop("study", None)
            tables = self._look("changed", tables, _table(given, "values"))
        elif "tables" in given:
            tables = self._look("changed", _table(given, "tables"), {})
        else:
            name = str(given.get("case", ""))
            self.workspace.require_listed(name)
            tables = self._look("opened", name)
        design = self.workspace.new_design(tables)
        self._tell("designs", self.workspace.designs())
        return _without_past(design)

    def design(self, name: str) -> dict[str, Any]:
        """Return a design as the page shows it."""
        return _without_past(self.workspace.design(name))

    def change(self, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Change keys (``values``), or all of them (``tables`` or ``toml``), of a design."""
        if "toml" in given:
            tables = self._look("read", str(given["toml"]))
        elif "tables" in given:
            tables = self._look("changed", _table(given, "tables"), {})
        else:
            before = self.workspace.design(name)["tables"]
            tables = self._look("changed", before, _table(given, "values"))
        return self._told(self.workspace.change(name, tables))

    def undo(self, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Take back the last change, or make it again."""
        return self._told(self.workspace.undo(name, again=bool(given.get("again"))))

    def variant(self, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Keep, restore or drop a named variant."""
        label, action = str(given.get("label", "")), given.get("action", "keep")
        if action == "drop":
            return self._told(self.workspace.drop_variant(name, label))
        if action == "restore":
            variants = self.workspace.design(name)["variants"]
            if label not in variants:
                raise CaseError("variant", repr(label[:200]), ", ".join(variants) or "none yet")
            return self._told(self.workspace.change(name, variants[label]["tables"]))
        numbers = _table(given, "numbers")
        return self._told(self.workspace.keep_variant(name, label, numbers))

    def delete(self, name: str) -> dict[str, Any]:
        """Forget a design."""
        self.workspace.delete(name)
        self._tell("designs", self.workspace.designs())
        return {}

    def toml(self, name: str) -> Any:
        """Case file of a design as text."""
        return self._look("toml", self.workspace.design(name)["tables"])

    def look(self, name: str, given: Mapping[str, Any]) -> Any:
        """Machine of a design with other values, which are not kept."""
        tables = self.workspace.design(name)["tables"]
        asked = {name: bool(given.get(name)) for name in ("drag", "numbers_only", "cells")}
        return self._look("look", tables, _table(given, "values"), **asked)

    def answer(self, name: str, given: Mapping[str, Any]) -> Any:
        """Solve a design; a newer question of the same tab takes the place of an older one."""
        asker = f"{name} {given.get('tab', '')}"
        number = self._asked[asker] = self._asked.get(asker, 0) + 1
        if self._solved == asker:
            self._solving.stop()
        with self._turn:
            if self._asked[asker] != number:
                return {"superseded": True}
            self._solved = asker
            design = self.workspace.design(name)
            told = partial(self._progress, name)
            try:
                found = self._solving.call(
                    "answer", name, design["tables"], bool(given.get("full")), told=told
                )
            except StoppedError:
                return {"superseded": True}
            finally:
                self._solved = ""
        return {**found, "version": design["version"]}

    def causes(self, name: str, given: Mapping[str, Any]) -> Any:
        """What each changed key does to the answer, from a variant to another one or the design.

        It is given up when the same tab asks for an answer or stops it.
        """
        design, asker = self.workspace.design(name), f"{name} {given.get('tab', '')}"
        states = {kept: one["tables"] for kept, one in design["variants"].items()}
        pair = []
        for end in ("from", "to"):
            label = given.get(end)
            if label is not None and label not in states:
                allowed = ", ".join(states) or "none yet"
                raise CaseError("variant", repr(label)[:200], allowed)
            pair.append(design["tables"] if label is None else states[label])
        with self._turn:
            self._solved = asker
            try:
                told = partial(self._progress, name)
                return self._solving.call("causes", *pair, told=told)
            except StoppedError:
                return {"superseded": True}
            finally:
                self._solved = ""

    def stop(self, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Stop the answer that a tab waits for at once."""
        asker = f"{name} {given.get('tab', '')}"
        self._asked[asker] = self._asked.get(asker, 0) + 1
        if self._solved == asker:
            self._solving.end()
        return {}

    def turning(self, name: str) -> Any:
        """Pictures of one pitch of the last answer of a design."""
        with self._turn:
            return self._solving.call("turning", name, self.workspace.design(name)["tables"])

    def findings(self, name: str) -> Any:
        """What there is to know of the last answer of a design."""
        with self._turn:
            return self._solving.call("findings", name)

    def views(self, name: str) -> Any:
        """Views of the last answer of a design."""
        with self._turn:
            return self._solving.call("views", name, self.workspace.design(name)["tables"])

    def download(self, name: str, ending: str) -> FileAnswer:
        """Last answer of a design as a file; ``toml`` is its case."""
        tables = self.workspace.design(name)["tables"]
        stem = "".join(c if c.isalnum() else "_" for c in str(tables.get("title", "")))[:60]
        stem = stem.strip("_") or "case"
        if ending == "toml":
            return FileAnswer(self._look("toml", tables).encode(), ".toml", f"{stem}.toml")
        if ending not in {"nc", "csv", "html", "png"}:
            raise CaseError("download", repr(ending[:20]), "toml, nc, csv, html or png")
        with tempfile.TemporaryDirectory() as folder, self._turn:
            path = Path(folder) / f"result.{ending}"
            self._solving.call("written", name, tables, ending, str(path))
            content = path.read_bytes()
        page = ending == "html"
        return FileAnswer(content, f".{ending}", "" if page else f"{stem}.{ending}", page)

    def run(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Put a design, or tables, into the queue of runs."""
        if "design" in given:
            tables = self.workspace.design(str(given["design"]))["tables"]
        else:
            tables = self._look("changed", _table(given, "tables"), {})
        values = given.get("values")
        if values:
            tables = self._look("changed", tables, values)
        return self.queue.add(str(given.get("kind", "run")), tables)

    def steer(self, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
        """Stop, resume or delete a run."""
        action = given.get("action")
        if action == "resume":
            return self.queue.resume(name)
        if action == "delete":
            self.queue.delete(name)
        else:
            self.queue.stop(name)
        return {}

    def run_file(self, name: str, file: str) -> FileAnswer:
        """File of a run."""
        path = self.workspace.run_file(name, file)
        page = path.suffix == ".html"
        return FileAnswer(path.read_bytes(), path.suffix, "" if page else file, page)

    def found_in(self, given: Mapping[str, Any]) -> Any:
        """What uploaded files hold."""
        names = given.get("names")
        if not isinstance(names, list) or not names:
            raise CaseError("names", repr(names)[:200], "a list of uploaded files")
        known = [self.workspace.require_file(str(name)) for name in names]
        unit = str(given.get("unit", "mm"))
        if unit not in {"mm", "m", "um", "in"}:
            raise CaseError("unit", repr(unit[:20]), "mm, m, um or in")
        left_out = given.get("left_out", [])
        if not isinstance(left_out, list) or not all(
            isinstance(one, list)
            and len(one) == 2
            and isinstance(one[0], str)
            and isinstance(one[1], int)
            for one in left_out
        ):
            raise CaseError("left_out", repr(left_out)[:200], "pairs of a file and a body's number")
        return self._looking.call("found_in", known, unit, left_out, longest=_READ_TIME)

    def _look(self, name: str, *arguments: Any, **named: Any) -> Any:
        return self._looking.call(name, *arguments, named=named, longest=_LOOK_TIME)

    def _told(self, design: Mapping[str, Any]) -> dict[str, Any]:
        self._tell("design", {"id": design["id"], "version": design["version"]})
        return _without_past(design)

    def _progress(self, name: str, share: float, text: str) -> None:
        self._tell("answer", {"design": name, "text": text})


def _warmed(worker: Worker) -> None:
    with suppress(ToothspaceError):
        worker.call("schema")


def _without_past(design: Mapping[str, Any]) -> dict[str, Any]:
    found = dict(design)
    found["undo"], found["redo"] = len(found.pop("past")), len(found.pop("future"))
    return found


def _table(given: Mapping[str, Any], name: str) -> dict[str, Any]:
    value = given.get(name, {})
    if not isinstance(value, dict):
        raise CaseError(name, repr(value)[:200], "a table")
    return value


def application(bench: Bench) -> Any:
    """Starlette application of a bench, without its guard."""
    from starlette.applications import Starlette
    from starlette.responses import JSONResponse, Response, StreamingResponse
    from starlette.routing import Route

    def answered(found: Any, code: int = 200) -> Response:
        if isinstance(found, FileAnswer):
            headers = {}
            if found.report:
                headers["Content-Security-Policy"] = _REPORT_POLICY
            if found.name:
                headers["Content-Disposition"] = f'attachment; filename="{found.name}"'
            kind = _TYPES.get(found.ending, "application/octet-stream")
            return Response(found.content, media_type=kind, headers=headers)
        return JSONResponse(found, code)

    async def computed(work: Callable[..., Any], *arguments: Any) -> Response:
        try:
            return answered(await asyncio.to_thread(work, *arguments))
        except CaseError as error:
            return answered({"problems": str(error).splitlines()}, 422)
        except ToothspaceError as error:
            return answered({"problems": [str(error)]}, 409)

    def route(path: str, work: Callable[..., Any], method: str = "GET") -> Route:
        """Route whose path parameters, and for others than GET the JSON body, go to a function."""

        async def handle(request: Request) -> Response:
            arguments = list(request.path_params.values())
            if method == "POST":
                body = await request.body()
                try:
                    arguments.append(_json(body))
                except CaseError as error:
                    return answered({"problems": str(error).splitlines()}, 422)
            return await computed(work, *arguments)

        return Route(path, handle, methods=[method])

    async def upload(request: Request) -> Response:
        name = request.path_params["name"]
        try:
            path = bench.workspace.upload_path(name)
        except CaseError as error:
            return answered({"problems": str(error).splitlines()}, 422)
        handle, draft = tempfile.mkstemp(dir=path.parent, prefix=".upload_")
        try:
            with os.fdopen(handle, "wb") as target:
                async for piece in request.stream():
                    target.write(piece)
            if path.suffix == ".toml":
                tomllib.loads(Path(draft).read_text(encoding="utf-8"))
            Path(draft).replace(path)
        except (ValueError, RecursionError) as error:
            return answered({"problems": [f"{name}: no case file: {error}"]}, 422)
        finally:
            Path(draft).unlink(missing_ok=True)
        return answered({"name": path.name})

    async def events(request: Request) -> Response:
        told: asyncio.Queue[dict[str, Any]] = asyncio.Queue(1000)
        loop = asyncio.get_running_loop()

        def put(event: dict[str, Any]) -> None:
            with suppress(asyncio.QueueFull):
                told.put_nowait(event)

        def listener(event: dict[str, Any]) -> None:
            with suppress(RuntimeError):  # the server has ended
                loop.call_soon_threadsafe(put, event)

        async def stream() -> AsyncIterator[bytes]:
            with bench.listening(listener):
                yield b": open\n\n"
                while not await request.is_disconnected():
                    try:
                        event = await asyncio.wait_for(told.get(), 15.0)
                    except TimeoutError:
                        yield b": still here\n\n"
                    else:
                        yield b"data: " + json.dumps(event).encode() + b"\n\n"

        return StreamingResponse(stream(), media_type="text/event-stream")

    async def page(request: Request) -> Response:
        name = request.path_params.get("name", "index.html")
        static = files("toothspace.app").joinpath("static")
        if name in _VIEW_FILES:
            static = files("toothspace").joinpath("report", "templates")
        elif name not in {entry.name for entry in static.iterdir()}:
            return Response(b"", 404)
        found = static.joinpath(name)
        return answered(FileAnswer(found.read_bytes(), Path(name).suffix))

    @contextlib.asynccontextmanager
    async def lifespan(_: Any) -> AsyncIterator[None]:
        bench.warm()
        try:
            yield
        finally:
            await asyncio.to_thread(bench.close)

    one = "/api/designs/{name}"
    return Starlette(
        lifespan=lifespan,
        routes=[
            Route("/", page),
            Route("/static/{name}", page),
            Route("/api/events", events),
            Route("/api/files/{name}", upload, methods=["PUT"]),
            route("/api/start", bench.start),
            route("/api/schema", bench.schema),
            route("/api/words", bench.words),
            route("/api/fidelities", bench.fidelities),
            route("/api/designs", bench.new_design, "POST"),
            route(one, bench.design),
            route(one, bench.delete, "DELETE"),
            route(f"{one}/change", bench.change, "POST"),
            route(f"{one}/undo", bench.undo, "POST"),
            route(f"{one}/variant", bench.variant, "POST"),
            route(f"{one}/look", bench.look, "POST"),
            route(f"{one}/answer", bench.answer, "POST"),
            route(f"{one}/causes", bench.causes, "POST"),
            route(f"{one}/stop", bench.stop, "POST"),
            route(f"{one}/turning", bench.turning),
            route(f"{one}/findings", bench.findings),
            route(f"{one}/views", bench.views),
            route(f"{one}/toml", bench.toml),
            route(f"{one}/download/{{ending}}", bench.download),
            route("/api/runs", bench.queue.runs),
            route("/api/runs", bench.run, "POST"),
            route("/api/runs/{name}", bench.steer, "POST"),
            route("/api/runs/{name}/{file}", bench.run_file),
            route("/api/found", bench.found_in, "POST"),
        ],
    )


def _json(body: bytes) -> dict[str, Any]:
    """Table that a body holds; CaseError if it is none, or a text in it cannot be kept."""
    try:
        found = json.loads(body or b"{}")
        json.dumps(found, ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, RecursionError) as error:
        raise CaseError("request", "no JSON of tables, texts and numbers", "a table") from error
    if not isinstance(found, dict):
        raise CaseError("request", "no table", "a table")
    return found


@final
class BenchServer:
    """Server of a bench on this computer.

    Parameters
    ----------
    folder : Path
        Folder of case files.
    port : int
        Port, 0 for a free one.
    host : str
        Address to listen on; the loopback address lets this computer alone in.
    """

    def __init__(self, folder: Path, port: int = 0, host: str = HOST) -> None:
        if find_spec("uvicorn") is None or find_spec("starlette") is None:
            raise CaseError("The page needs a web server: pip install 'toothspace[app]'.")
        import uvicorn

        self._socket = _listen(host, port)
        self.port = int(self._socket.getsockname()[1])
        self.bench = Bench(folder)
        names = {host, HOST, "localhost"}
        if host != HOST:
            names |= {socket.gethostname(), socket.getfqdn()}
        hosts = {f"{name}:{self.port}" for name in names}
        self._guard = Guard(application(self.bench), hosts, LARGEST_UPLOAD)
        self._shown = HOST if host in {"0.0.0.0", "::"} else host
        config = uvicorn.Config(
            self._guard,
            http="h11",
            ws="none",
            loop="asyncio",
            log_level="critical",
            access_log=False,
            server_header=False,
            date_header=False,
            proxy_headers=False,
            limit_concurrency=_MOST_CONNECTIONS,
            timeout_keep_alive=20,
            timeout_graceful_shutdown=1,
            h11_max_incomplete_event_size=2**15,
        )
        self._server = uvicorn.Server(config)

    @property
    def address(self) -> str:
        """Address to open first; it holds the token."""
        return f"http://{self._shown}:{self.port}/?token={self._guard.token}"

    def serve(self) -> None:
        """Answer until :meth:`stop`, Ctrl-C or the end of the program."""
        self._server.run(sockets=[self._socket])

    def stop(self) -> None:
        """Let :meth:`serve` end."""
        self._server.should_exit = True

    @contextmanager
    def door(self) -> Iterator[str]:
        """Address of a file that leads to the page, and that no other user can read.

        What a browser is started with is seen by all users of a computer; the token is not in it.
        """
        with tempfile.TemporaryDirectory(prefix="toothspace_") as folder:
            file = Path(folder) / "open.html"
            file.touch(mode=0o600)
            file.write_text(
                "<!doctype html><meta charset=utf-8><title>toothspace</title>"
                f'<meta http-equiv=refresh content="0;url={self.address}">'
                f'<p><a href="{self.address}">toothspace</a>',
                encoding="utf-8",
            )
            yield file.as_uri()


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except OSError as error:
        found = f"{host}:{port}, {error.strerror or error}"
        raise CaseError("--port", found, "a free port and an address of this computer") from error
