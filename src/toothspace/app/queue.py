"""Runs that wait for their turn: each in a process of its own that can be stopped at once."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, final

from toothspace.app.workers import StoppedError, Worker
from toothspace.app.workspace import Workspace
from toothspace.core.errors import CaseError, ToothspaceError

MOST_WAITING = 20
KINDS = {"run": "run", "study": "run", "fmu": "unit", "animation": "animation", "film": "film"}
"""Kinds of runs and the method of the process that does each."""
_LEAST_BETWEEN = 0.1
"""Time between two reports of the same run. [s]"""


@final
class RunQueue:
    """Runs in the order in which they were asked for, one at a time.

    Parameters
    ----------
    workspace : Workspace
        Where they are kept.
    told : callable
        Called with what is known of a run whenever it changes.
    """

    def __init__(self, workspace: Workspace, told: Callable[[dict[str, Any]], None]) -> None:
        self._workspace, self._told = workspace, told
        self._changed = threading.Condition()
        self._waiting: list[tuple[dict[str, Any], bool]] = []
        self._present: tuple[dict[str, Any], Worker] | None = None
        self._ended = False
        for run in workspace.runs():
            if run["state"] in {"waiting", "running"}:
                workspace.save_run({**run, "state": "stopped"})
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def add(self, kind: str, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Let a case be run; what is known of the run."""
        if kind not in KINDS:
            raise CaseError("kind", repr(kind), ", ".join(KINDS))
        with self._changed:
            if len(self._waiting) >= MOST_WAITING:
                raise CaseError("queue", f"{MOST_WAITING} runs that wait", "fewer: stop some")
            run = self._workspace.new_run(kind, tables)
            self._put(run, resume=False)
        return _short(run)

    def resume(self, name: str) -> dict[str, Any]:
        """Run again what was stopped; a study goes on from its finished points."""
        found = next((run for run in self._workspace.runs() if run["id"] == name), None)
        if found is None or found["state"] in {"waiting", "running"}:
            raise CaseError("run", repr(name[:200]), "one that has ended")
        run = {**found, "state": "waiting"}
        with self._changed:
            self._put(run, resume=True)
        return _short(run)

    def stop(self, name: str) -> None:
        """Stop a run at once, or take it out of the queue."""
        with self._changed:
            for entry in [one for one in self._waiting if one[0]["id"] == name]:
                self._waiting.remove(entry)
                self._note(entry[0], state="stopped")
            present = self._present
        if present is not None and present[0]["id"] == name:
            present[1].end()

    def delete(self, name: str) -> None:
        """Stop a run and forget it."""
        self.stop(name)
        with self._changed:
            self._changed.wait_for(
                lambda: self._present is None or self._present[0]["id"] != name, timeout=10.0
            )
        self._workspace.delete_run(name)

    def runs(self) -> list[dict[str, Any]]:
        """What is known of all runs, the last one first."""
        return [_short(run) for run in self._workspace.runs()]

    def close(self) -> None:
        """End the present run and take no more."""
        with self._changed:
            self._ended = True
            self._waiting.clear()
            present = self._present
            self._changed.notify_all()
        if present is not None:
            present[1].end()
        self._thread.join(5.0)

    def _put(self, run: dict[str, Any], *, resume: bool) -> None:
        self._waiting.append((run, resume))
        self._note(run, state="waiting", share=None, text="")
        self._changed.notify_all()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._ended or bool(self._waiting))
                if self._ended:
                    return
                run, resume = self._waiting.pop(0)
                worker = Worker(self._workspace.folder)
                self._present = run, worker
            try:
                self._do(run, worker, resume=resume)
            finally:
                worker.end()
                with self._changed:
                    self._present = None
                    self._changed.notify_all()

    def _do(self, run: dict[str, Any], worker: Worker, *, resume: bool) -> None:
        self._note(run, state="running", share=None, text="", problem="")
        last = 0.0

        def told(share: float, text: str) -> None:
            nonlocal last
            if time.monotonic() - last > _LEAST_BETWEEN:
                last = time.monotonic()
                known = share if math.isfinite(share) else None
                run.update(share=known, text=text)
                self._told(_short(run))

        folder = str(self._workspace.run_folder(run["id"]))
        more = (resume,) if KINDS[run["kind"]] == "run" else ()
        try:
            found = worker.call(KINDS[run["kind"]], run["tables"], folder, *more, told=told)
        except StoppedError:
            self._note(run, state="stopped")
        except ToothspaceError as error:
            self._note(run, state="failed", problem=str(error))
        else:
            self._note(run, state="done", result=found)

    def _note(self, run: dict[str, Any], **values: Any) -> None:
        run.update(values)
        folder = self._workspace.run_folder(run["id"])
        if folder.is_dir():
            run["files"] = sorted(
                path.name
                for path in folder.iterdir()
                if path.is_file()
                and path.suffix in {".nc", ".csv", ".html", ".fmu", ".gif", ".mp4"}
            )
        self._workspace.save_run(run)
        self._told(_short(run))


def _short(run: Mapping[str, Any]) -> dict[str, Any]:
    """What a list of runs shows: without the case and the curves."""
    found = {name: value for name, value in run.items() if name not in {"tables", "result"}}
    result = run.get("result")
    if result:
        found |= {name: result.get(name) for name in ("status", "sentence", "numbers", "done")}
    return found
