"""Samples of a run over time on disk, so that memory does not grow with its length."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from io import FileIO
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.files import write_whole
from toothspace.core.types import Array
from toothspace.results.variables import SAMPLE, variable

if TYPE_CHECKING:
    import xarray as xr

_ROWS_IN_MEMORY = 512
_TIME = "time"


@final
class SampleStream:
    """Appends rows of result variables to files without a name, in the temporary folder.

    The files go with the last array that reads from them, also when the process is killed.
    Rows that the folder does not take stay in memory: none is lost.

    Attributes
    ----------
    failure : OSError or None
        Why rows could not be stored; nothing should be appended then.
    """

    def __init__(self) -> None:
        self._files: dict[str, FileIO] = {}
        self._waiting: list[Mapping[str, Array]] = []
        self._stored = 0
        self.rows = 0
        self.failure: OSError | None = None

    def append(self, values: Mapping[str, Array]) -> None:
        """Append rows.

        Parameters
        ----------
        values : mapping of name to ndarray, shape (rows, ...)
            The same variables in every call, in SI units.
        """
        self._waiting.append(values)
        self.rows += len(values[_TIME])
        if self.rows - self._stored >= _ROWS_IN_MEMORY:
            self._store()

    def finish(self) -> dict[str, xr.Variable]:
        """Return all rows as variables that are read from disk where they are used."""
        import xarray as xr

        if self.failure is None:
            self._store()
        rows = self._merged()
        found = {}
        for name, value in rows.items():
            dimensions = [_TIME if d == SAMPLE else d for d in variable(name).dimensions]
            column = value
            if self._stored:
                # rows on disk and in memory as one array
                shape = (self._stored, *value.shape[1:])
                stored = np.memmap(self._files[name], dtype=value.dtype, mode="r", shape=shape)
                column = stored if not len(value) else np.concatenate([stored, value])
            found[name] = xr.Variable(dimensions, column)
        for file in self._files.values():
            file.close()
        return found

    def _store(self) -> None:
        rows = self._merged()
        try:
            for name, value in rows.items():
                if name not in self._files:
                    self._files[name] = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115
                write_whole(self._files[name], np.ascontiguousarray(value).tobytes())
        except OSError as error:
            self.failure = error
            return
        self._stored = self.rows
        self._waiting = [{name: value[:0] for name, value in rows.items()}]

    def _merged(self) -> dict[str, Array]:
        names = self._waiting[0]
        return {name: np.concatenate([part[name] for part in self._waiting]) for name in names}
