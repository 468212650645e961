"""Samples of a run over time on disk, so that memory does not grow with its length."""

from __future__ import annotations

import tempfile
import weakref
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.types import Array
from toothspace.results.variables import SAMPLE, variable

if TYPE_CHECKING:
    import xarray as xr

_ROWS_IN_MEMORY = 512
_TIME = "time"


@final
class SampleStream:
    """Appends rows of result variables to a file without a name, in the temporary folder.

    The file goes with the last dataset that reads from it, also when the process is killed.
    """

    def __init__(self) -> None:
        import h5netcdf

        self._file = tempfile.TemporaryFile()  # noqa: SIM115 (outlives this call)
        self._writer = h5netcdf.File(self._file, "w")
        self._waiting: list[Mapping[str, Array]] = []
        self.rows = 0

    def append(self, values: Mapping[str, Array]) -> None:
        """Append rows.

        Parameters
        ----------
        values : mapping of name to ndarray, shape (rows, ...)
            The same variables in every call, in SI units.
        """
        self._waiting.append(values)
        self.rows += len(values[_TIME])
        if sum(len(part[_TIME]) for part in self._waiting) >= _ROWS_IN_MEMORY:
            self._write()

    def finish(self) -> dict[str, xr.Variable]:
        """Return all rows as variables that are read from disk where they are used."""
        import h5netcdf
        import xarray as xr
        from xarray.backends import H5NetCDFStore

        if self._waiting:
            self._write()
        self._writer.close()
        reader = h5netcdf.File(self._file, "r")
        weakref.finalize(reader, self._file.close)
        store: Any = H5NetCDFStore(reader)
        data = xr.open_dataset(store, cache=False, decode_times=False)
        return {str(name): data.variables[name] for name in data.variables}

    def _write(self) -> None:
        names = self._waiting[0]
        rows = {name: np.concatenate([part[name] for part in self._waiting]) for name in names}
        self._waiting.clear()
        if not self._writer.variables:
            self._create(rows)
        begin = self.rows - len(rows[_TIME])
        self._writer.resize_dimension(_TIME, self.rows)
        for name, value in rows.items():
            self._writer.variables[name][begin:] = value

    def _create(self, rows: Mapping[str, Array]) -> None:
        self._writer.dimensions[_TIME] = None
        for name, value in rows.items():
            dimensions = [_TIME if d == SAMPLE else d for d in variable(name).dimensions]
            for dimension, length in zip(dimensions[1:], value.shape[1:], strict=True):
                if dimension not in self._writer.dimensions:
                    self._writer.dimensions[dimension] = length
            chunks = (_ROWS_IN_MEMORY, *value.shape[1:])
            self._writer.create_variable(name, tuple(dimensions), value.dtype, chunks=chunks)
