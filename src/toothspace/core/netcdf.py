"""Datasets as NetCDF files that are complete, and as they were written."""

from __future__ import annotations

import hashlib
import os
from io import FileIO
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, final

from toothspace.core.errors import CaseError
from toothspace.core.files import draft_of, write_whole
from toothspace.core.interrupts import interrupts_held

if TYPE_CHECKING:
    import xarray as xr

_SEAL = b"\ntoothspace BLAKE2b "
"""Stands behind the data, in front of their checksum."""
_CHECKSUM_BYTES = 32
_PART = 2**20
_NUMBERS = "fiub"


def write_dataset(dataset: xr.Dataset, path: str | Path) -> Path:
    """Write a dataset to one NetCDF file that is complete or not there.

    Parameters
    ----------
    dataset : xarray.Dataset
        What to write.
    path : str or Path
        File to create or replace; its folder is made if it is missing.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    OSError
        If the file cannot be written whole, as on a full disk.
    """
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    with interrupts_held(), draft_of(target) as draft, _Sink(draft) as sink:
        try:
            with h5netcdf.File(sink, "w") as file:
                store: Any = H5NetCDFStore(file)
                dataset.dump_to_store(store)
        except Exception:
            sink.raise_failure()
            raise
        sink.raise_failure()
        _seal(draft)
    return target


def read_dataset(path: str | Path) -> xr.Dataset:
    """Read a NetCDF file into memory, labels as text.

    Parameters
    ----------
    path : str or Path
        File to read.

    Raises
    ------
    CaseError
        If the file cannot be read as NetCDF, or is not as it was written.
    """
    import xarray as xr

    place = Path(path)
    if not place.is_file():
        found = "a folder" if place.is_dir() else "no file" if place.exists() else "nothing"
        raise CaseError(f"{path}: found {found}, allowed a NetCDF file")
    try:
        if _is_as_written(place):
            return _with_text(
                xr.load_dataset(
                    place, engine="h5netcdf", decode_times=False, decode_timedelta=False
                )
            )
    except Exception as error:  # a damaged file fails anywhere in the libraries below
        found = "a file that cannot be read as one"
        raise CaseError(f"{path}: found {found}, allowed a NetCDF file") from error
    found = "a damaged file, which differs from its checksum"
    raise CaseError(f"{path}: found {found}, allowed a NetCDF file as it was written")


def _seal(path: Path) -> None:
    """Append the checksum of a file to it; readers of the format pass over it."""
    with path.open("r+b") as file:
        checksum = _checksum(file, path.stat().st_size)
        file.seek(0, os.SEEK_END)
        file.write(_SEAL + checksum)


def _is_as_written(path: Path) -> bool:
    """Whether a file has the contents of its checksum; true for a file without one."""
    end = path.stat().st_size - len(_SEAL) - _CHECKSUM_BYTES
    with path.open("rb") as file:
        file.seek(max(end, 0))
        sealed, mark, kept = file.read().partition(_SEAL)
        if sealed or not mark:
            return True
        file.seek(0)
        return kept == _checksum(file, end)


def _checksum(file: IO[bytes], size: int) -> bytes:
    digest = hashlib.blake2b(digest_size=_CHECKSUM_BYTES)
    for begin in range(0, size, _PART):
        digest.update(file.read(min(_PART, size - begin)))
    return digest.digest()


def _with_text(dataset: xr.Dataset) -> xr.Dataset:
    for name in dataset.variables:
        if dataset[name].dtype.kind not in _NUMBERS:
            text = dataset[name].astype(str)
            dataset[name] = (text.dims, text.values.astype(str), dataset[name].attrs)
        dataset[name].encoding = {}
    dataset.encoding = {}
    return dataset


@final
class _Sink:
    """File for the HDF5 library that never fails to write.

    The library ends the process with a segmentation fault where a write fails; this keeps the
    failure, takes no more, and leaves it to the writer to raise.
    """

    def __init__(self, path: Path) -> None:
        self._file = FileIO(path, "r+")
        self._failure: OSError | None = None

    def write(self, content: memoryview) -> int:
        if self._failure is None:
            try:
                write_whole(self._file, content)
            except OSError as error:
                self._failure = error
        return len(content)

    def truncate(self, size: int | None = None) -> int:
        if self._failure is None:
            try:
                return self._file.truncate(size)
            except OSError as error:
                self._failure = error
        return size or 0

    def readinto(self, buffer: memoryview) -> int:
        return self._file.readinto(buffer) or 0

    def read(self, size: int = -1) -> bytes:
        return self._file.read(size) or b""

    def seek(self, offset: int, whence: int = 0) -> int:
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        return self._file.tell()

    def flush(self) -> None:
        """Nothing waits: every write goes to the file."""

    def raise_failure(self) -> None:
        if self._failure is not None:
            raise self._failure

    def __enter__(self) -> _Sink:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()
