"""Finished points of a study, kept one by one so that an interrupt loses nothing."""

from __future__ import annotations

import errno
import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, final

from toothspace.core.files import write_text
from toothspace.core.interrupts import interrupts_held

DONE = "done"
BAD_INPUT = "bad_input"
FAILED = "failed"
INTERRUPTED = "interrupted"

FILE_NAME = "points.jsonl"
"""Name of the file in the folder of a study: one finished point per line."""

PREVIOUS_FILE_NAME = "points_previous.jsonl"
"""What a study that starts anew makes of the points of the one before."""


@final
@dataclass(frozen=True)
class Record:
    """What one point of a study gave."""

    key: str
    """Hash of what was computed."""
    status: str
    """Status of the run in lower case, ``bad_input``, or ``failed`` after an unexpected error."""
    numbers: Mapping[str, Any] = field(default_factory=dict)
    """Summary numbers, or what else the study evaluates; empty if there are none."""
    message: str = ""
    """Why the point failed, in one line; empty if it did not."""
    wall_time: float = math.nan
    """Time that it took. [s]"""

    @property
    def succeeded(self) -> bool:
        """Whether the point did what was asked."""
        return self.status == DONE

    def number(self, name: str) -> float:
        """Return a number of the point, NaN if it has none of that name. [unit of the name]."""
        value = self.numbers.get(name)
        return float(value) if isinstance(value, (int, float)) else math.nan


@final
class Records:
    """Records by key, in memory and, with a file, on disk from the first one that is added.

    Parameters
    ----------
    path : Path or None
        File of one record per line; None keeps them in memory only.
    resume : bool
        Whether successful records that the file holds already count; otherwise it starts anew.
    """

    def __init__(self, path: Path | None = None, *, resume: bool = False) -> None:
        self.path = path
        self._resume = resume
        self._begun = path is None
        self._own_folder = path is not None and not path.parent.exists()
        self._found: dict[str, Record] = {}
        if path is None:
            return
        if resume and path.is_file():
            self._found = _read(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        if not os.access(path.parent, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path.parent))

    def withdraw(self) -> None:
        """Remove the folder again if it was made for these records and nothing is in it."""
        if self.path is not None and self._own_folder and not any(self.path.parent.iterdir()):
            self.path.parent.rmdir()

    def get(self, key: str) -> Record | None:
        """Return the record of a key, or None."""
        return self._found.get(key)

    def add(self, record: Record) -> None:
        """Keep a record; a reader never sees half of it as a whole line."""
        if not self._begun and self.path is not None:
            if self.path.is_file() and self.path.stat().st_size and not self._resume:
                # a forgotten --resume must not cost hours of computing
                self.path.replace(self.path.with_name(PREVIOUS_FILE_NAME))
            write_text(self.path, "".join(_line(record) for record in self._found.values()))
            self._begun = True
        self._found[record.key] = record
        if self.path is not None:
            with interrupts_held(), self.path.open("a", encoding="utf-8") as file:
                file.write(_line(record))

    def __len__(self) -> int:
        """Return the number of records."""
        return len(self._found)


def failed_count(records: Sequence[Record]) -> int:
    """Return the number of points that were tried and failed. [-]."""
    return sum(not record.succeeded and record.status != INTERRUPTED for record in records)


def _line(record: Record) -> str:
    return json.dumps(asdict(record)) + "\n"


def _read(path: Path) -> dict[str, Record]:
    found = {}
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            record = Record(**json.loads(line))
        except (ValueError, TypeError):
            continue  # a line that a crash cut short
        if record.succeeded:
            found[record.key] = record
    return found
