"""What the page keeps on disk: designs with their changes and variants, runs, files."""

from __future__ import annotations

import json
import re
import secrets
import shutil
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, final

from toothspace.case.document import text_values
from toothspace.case.shipped import cases
from toothspace.core.errors import CaseError
from toothspace.core.files import write_text
from toothspace.library import shipped_folder

STORE = ".toothspace"
"""Folder beside the case files."""
FILE_ENDINGS = (".toml", ".txt", ".csv", ".dxf", ".stl", ".step", ".stp", ".mka")
"""Files that may be uploaded."""
LARGEST_UPLOAD = 100 * 2**20
MOST_UPLOADED = 2 * 2**30
"""Size of one file and of all. [byte]"""
_MOST_DESIGNS = 200
_MOST_CHANGES = 80
_ID = re.compile(r"[0-9a-f]{12}")
_FILE_NAME = re.compile(r"[^\W_][\w .()+-]{0,119}")


@final
class Workspace:
    """One folder with case files, and beside them what the page has made of them.

    Parameters
    ----------
    folder : Path
        Folder; file paths in cases are relative to it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._store = self.folder / STORE
        self._lock = threading.RLock()

    def cases(self) -> list[dict[str, str]]:
        """Case files of the folder, then those shipped, with title and origin."""
        own = sorted(path.name for path in self.folder.glob("*.toml") if path.is_file())
        return [
            *({"name": name, "title": name, "from": self.folder.name} for name in own),
            *({"name": name, "title": title, "from": ""} for name, title in cases().items()),
        ]

    def require_listed(self, name: str) -> None:
        """Refuse a case that is neither shipped nor a file of the folder."""
        if name not in {case["name"] for case in self.cases()}:
            raise CaseError("case", repr(name[:200]), "one that is listed")

    def guard(self, tables: Mapping[str, Any]) -> None:
        """Refuse tables that name a file outside the folder and the shipped cases.

        Texts are read as the reader of cases reads them, however long they are.
        """
        homes = self.folder, shipped_folder("cases").resolve()
        for key, text in text_values(tables):
            if "\0" in text:
                raise CaseError(f"case: {key}", "a NUL character", "a text without one")
            try:
                place = (self.folder / text).resolve()
                outside = not any(place.is_relative_to(home) for home in homes) and place.exists()
            except (OSError, RuntimeError):
                continue  # too long for a file, or a loop of links: no reader opens it either
            if outside:
                raise CaseError(f"case: {key}", repr(text[:200]), f"a file in {self.folder}")

    # designs ----------------------------------------------------------------

    def designs(self) -> list[dict[str, Any]]:
        """Kept designs, the last changed first."""
        found = []
        for path in (self._store / "designs").glob("*.json"):
            try:
                kept = json.loads(path.read_text(encoding="utf-8"))
                found.append(
                    {
                        "id": path.stem,
                        "title": kept["tables"].get("title", ""),
                        "machine": kept["tables"].get("machine", {}).get("type", ""),
                        "changed": path.stat().st_mtime,
                    }
                )
            except (OSError, ValueError, KeyError, AttributeError):
                continue
        return sorted(found, key=lambda one: -one["changed"])

    def new_design(self, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Keep a design of its own."""
        if len(self.designs()) >= _MOST_DESIGNS:
            raise CaseError("design", f"{_MOST_DESIGNS} kept ones", "fewer: delete some")
        design = {
            "id": secrets.token_hex(6),
            "version": 1,
            "tables": dict(tables),
            "past": [],
            "future": [],
            "variants": {},
        }
        self._save(design)
        return design

    def design(self, name: str) -> dict[str, Any]:
        """Return a kept design."""
        path = self._design_path(name)
        with self._lock:
            try:
                found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            except (OSError, ValueError) as error:
                raise CaseError("design", repr(name), "one that is kept here") from error
        return found

    def change(self, name: str, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Put other tables in place of those of a design, which can be undone."""
        with self._lock:
            design = self.design(name)
            if design["tables"] != tables:
                design["past"] = [*design["past"], design["tables"]][-_MOST_CHANGES:]
                design["future"], design["tables"] = [], dict(tables)
                self._bump(design)
        return design

    def undo(self, name: str, *, again: bool = False) -> dict[str, Any]:
        """Take back the last change of a design, or make it again."""
        source, target = ("future", "past") if again else ("past", "future")
        with self._lock:
            design = self.design(name)
            if design[source]:
                design[target].append(design["tables"])
                design["tables"] = design[source].pop()
                self._bump(design)
        return design

    def keep_variant(self, name: str, label: str, numbers: Mapping[str, Any]) -> dict[str, Any]:
        """Keep the present state of a design under a name, with the numbers of its answer."""
        label = label.strip()[:80]
        if not label:
            raise CaseError("variant", "no name", "a name of its own")
        with self._lock:
            design = self.design(name)
            design["variants"][label] = {"tables": design["tables"], "numbers": dict(numbers)}
            self._bump(design)
        return design

    def drop_variant(self, name: str, label: str) -> dict[str, Any]:
        """Forget a variant."""
        with self._lock:
            design = self.design(name)
            design["variants"].pop(label, None)
            self._bump(design)
        return design

    def delete(self, name: str) -> None:
        """Forget a design."""
        with self._lock:
            self._design_path(name).unlink(missing_ok=True)

    def _bump(self, design: dict[str, Any]) -> None:
        design["version"] += 1
        self._save(design)

    def _save(self, design: Mapping[str, Any]) -> None:
        path = self._design_path(design["id"])
        path.parent.mkdir(parents=True, exist_ok=True)
        (self._store / ".gitignore").write_text("*\n", encoding="utf-8")
        with self._lock:
            write_text(path, json.dumps(design))

    def _design_path(self, name: str) -> Path:
        if not _ID.fullmatch(name):
            raise CaseError("design", repr(name[:200]), "one that is kept here")
        return self._store / "designs" / f"{name}.json"

    # runs -------------------------------------------------------------------

    def runs(self) -> list[dict[str, Any]]:
        """Kept runs, the last one first."""
        found = []
        for path in (self._store / "runs").glob("*/run.json"):
            try:
                found.append(json.loads(path.read_text(encoding="utf-8")))
            except (OSError, ValueError):
                continue
        return sorted(found, key=lambda one: -one["begun"])

    def new_run(self, kind: str, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Make the folder of a run."""
        run: dict[str, Any] = {
            "id": secrets.token_hex(6),
            "kind": kind,
            "title": str(tables.get("title", "")),
            "tables": dict(tables),
            "state": "waiting",
            "begun": time.time(),
        }
        self.run_folder(run["id"]).mkdir(parents=True)
        self.save_run(run)
        return run

    def save_run(self, run: Mapping[str, Any]) -> None:
        """Keep what is known of a run."""
        folder = self.run_folder(run["id"])
        if folder.is_dir():
            write_text(folder / "run.json", json.dumps(run))

    def run_folder(self, name: str) -> Path:
        """Folder of a run."""
        if not _ID.fullmatch(name):
            raise CaseError("run", repr(name[:200]), "one that is kept here")
        return self._store / "runs" / name

    def run_file(self, name: str, file: str) -> Path:
        """File of a run, by the name that its folder lists."""
        for path in self.run_folder(name).iterdir() if self.run_folder(name).is_dir() else ():
            if path.name == file and path.is_file() and not path.is_symlink():
                return path
        raise CaseError("file", repr(file[:200]), "one of this run")

    def delete_run(self, name: str) -> None:
        """Forget a run and its files."""
        shutil.rmtree(self.run_folder(name), ignore_errors=True)

    # files ------------------------------------------------------------------

    def files(self) -> list[dict[str, Any]]:
        """Files of the folder that cases can name."""
        return [
            {"name": path.name, "size": path.stat().st_size}
            for path in sorted(self.folder.iterdir())
            if path.suffix.lower() in FILE_ENDINGS and path.is_file() and not path.is_symlink()
        ]

    def upload_path(self, name: str) -> Path:
        """Where an uploaded file goes: a plain name with a known ending that is free."""
        if not _FILE_NAME.fullmatch(name) or not name.lower().endswith(FILE_ENDINGS):
            allowed = f"a plain name with {', '.join(FILE_ENDINGS)}"
            raise CaseError("file", repr(name[:200]), allowed)
        if sum(one["size"] for one in self.files()) > MOST_UPLOADED:
            raise CaseError("folder", "2 GiB of files", "less: delete some")
        stem, dot, ending = name.rpartition(".")
        path, number = self.folder / name, 1
        while path.exists() or path.is_symlink():
            number += 1
            path = self.folder / f"{stem}_{number}{dot}{ending}"
        return path

    def require_file(self, name: str) -> str:
        """Refuse a name that is not listed in :meth:`files`."""
        if name not in {one["name"] for one in self.files()}:
            raise CaseError("file", repr(name[:200]), "one that was uploaded")
        return name
