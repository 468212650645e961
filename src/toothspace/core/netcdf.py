"""Datasets as NetCDF files that are complete, and as they were written."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from threading import RLock
from typing import IO, TYPE_CHECKING, Any, final

from toothspace.core.errors import CaseError
from toothspace.core.files import path_of, write_bytes
from toothspace.core.interrupts import interrupts_held
from toothspace.core.processes import run_python

if TYPE_CHECKING:
    import xarray as xr

_SEAL = b"\ntoothspace BLAKE2b "
"""Stands behind the data, in front of their checksum."""
_CHECKSUM_BYTES = 32
_PART = 2**20
_TRIAL = """
import h5py, sys

sizes = []

def measure(name, item):
    if isinstance(item, h5py.Dataset):
        sizes.append(item.size * item.dtype.itemsize)

def read(name, item):
    dict(item.attrs)
    if isinstance(item, h5py.Dataset):
        item[()]

with h5py.File(sys.argv[1]) as file:
    file.visititems(measure)
    if sum(sizes) > float(sys.argv[2]):
        sys.exit(1)
    read("", file)
    file.visititems(read)
"""
"""Program that reads all of a file; h5py alone starts four times as fast as what is above it."""
_LEAST_WAIT, _LEAST_RATE = 10.0, 1e6
"""Time [s] for reading a file without checksum, and bytes that a second more is for. [B/s]"""
_MOST_SPREAD, _ALWAYS_READ = 50.0, 2**28
"""Largest ratio of arrays to their file, and arrays that are read from any file. [-], [B]"""
_NUMBERS = "fiub"
_CONVENTIONS = "CF-1.11"
_UDUNITS = {"deg": "degree", "cm3/rev": "cm3/revolution"}
"""Units that the library UDUNITS, and so the CF conventions, know by another name."""
_WRITE_LOCK = RLock()


@final
@dataclass(eq=False)
class _ArrayTypes:
    """Array types of a package as xarray asks for them: none as long as it is not loaded."""

    _package: str
    _module: str

    @cached_property
    def _loaded(self) -> Any:
        from xarray.namedarray.pycompat import DuckArrayModule

        package: Any = self._package
        return DuckArrayModule(package)

    def __getattr__(self, name: str) -> Any:
        if name == "type" and self._module not in sys.modules:
            return ()
        return getattr(self._loaded, name)


def spare_array_packages() -> None:
    """Keep xarray from loading Dask and Pint, where they are installed, to ask for their types.

    It does so when it meets its first array, which takes a second; no array can be one of theirs
    before they are loaded. Another version of xarray that looks elsewhere loads them as before.
    """
    with suppress(ImportError, AttributeError):
        from xarray.namedarray import pycompat

        known: dict[Any, Any] = pycompat._cached_duck_array_modules
        for package in ("dask", "pint", "cupy", "sparse"):
            module = "dask.array" if package == "dask" else package
            known.setdefault(package, _ArrayTypes(package, module))


def write_dataset(dataset: xr.Dataset, path: str | Path) -> Path:
    """Write a dataset to one NetCDF file that is complete or not there; returns its path.

    The file follows the CF conventions: units of UDUNITS, a long name for every variable, no fill
    values in coordinates. Labels along a dimension are text coordinates of its name.

    Raises OSError if the file cannot be written whole, as on a full disk.

    Parameters
    ----------
    path : str or Path
        File to create or replace; its folder is made if it is missing.
    """
    target = path_of(path, "result", "a file to write")
    target.parent.mkdir(parents=True, exist_ok=True)
    spare_array_packages()
    # content of a NetCDF file; its data are arrays in memory or on disk
    from xarray.backends import H5NetCDFStore

    # the HDF5 library ends the process where a disk refuses a write, so it writes into memory;
    # a lock that xarray chooses is one of a Dask scheduler where there is one
    buffer = BytesIO()
    store = H5NetCDFStore.open(buffer, mode="w", lock=_WRITE_LOCK)
    try:
        _conventional(dataset).dump_to_store(store)
    finally:
        store.close()
    content = buffer.getvalue()
    seal = _SEAL + _checksum(BytesIO(content), len(content))
    with interrupts_held():
        return write_bytes(target, content + seal)


def _conventional(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset with the attributes of the CF conventions that it lacks."""
    from toothspace import __version__

    written = f"toothspace {__version__}"
    given = {"Conventions": _CONVENTIONS, "source": written, "history": f"Written by {written}"}
    found = dataset.assign_attrs({**given, **dataset.attrs})
    for name, variable in found.variables.items():
        attributes = {"long_name": str(name).replace("_", " "), **variable.attrs}
        if "units" in attributes:
            attributes["units"] = _UDUNITS.get(str(attributes["units"]), attributes["units"])
        variable.attrs = attributes
        if name in found.coords and variable.dtype.kind == "f":
            variable.encoding = {**variable.encoding, "_FillValue": None}
    return found


def read_dataset(path: str | Path, allowed: str = "a NetCDF file") -> xr.Dataset:
    """Read a NetCDF file into memory, labels as text.

    Raises CaseError if the file cannot be read as NetCDF, or is not as it was written.

    Parameters
    ----------
    path : str or Path
        The file.
    allowed : str
        What the file should be, for messages.
    """
    import xarray as xr

    place = path_of(path, "result", allowed)
    if not place.is_file():
        found = "a folder" if place.is_dir() else "no file" if place.exists() else "nothing"
        raise CaseError(path, found, allowed)
    intact = _is_as_written(place)
    if intact is False:
        found = "a damaged file, which differs from its checksum"
        raise CaseError(path, found, f"{allowed} as it was written")
    unreadable = CaseError(path, "a file that cannot be read as one", allowed)
    spare_array_packages()
    try:
        if intact or _is_readable(place):
            with xr.open_dataset(
                place, engine="h5netcdf", decode_times=False, decode_timedelta=False
            ) as opened:
                if opened.nbytes > _most_bytes(place):
                    raise unreadable
                dataset = opened.load()
            for name in dataset.variables:
                if dataset[name].dtype.kind not in _NUMBERS:
                    text = dataset[name].astype(str)
                    dataset[name] = (text.dims, text.values.astype(str), dataset[name].attrs)
                dataset[name].encoding = {}
            dataset.encoding = {}
            return dataset
    except Exception as error:  # HDF5 without the layout of NetCDF fails anywhere in the libraries
        raise unreadable from error
    raise unreadable


def _is_as_written(path: Path) -> bool | None:
    """Whether a file has the contents of its checksum; None for a file without one."""
    end = path.stat().st_size - len(_SEAL) - _CHECKSUM_BYTES
    with path.open("rb") as file:
        file.seek(max(end, 0))
        sealed, mark, kept = file.read().partition(_SEAL)
        if sealed or not mark:
            return None
        file.seek(0)
        return kept == _checksum(file, end)


def _is_readable(path: Path) -> bool:
    """Whether a process of its own can read a file: HDF5 may go on for ever in a damaged one."""
    longest = _LEAST_WAIT + path.stat().st_size / _LEAST_RATE
    with suppress(subprocess.TimeoutExpired):
        order = [str(path.resolve()), str(_most_bytes(path))]
        return run_python(_TRIAL, order, longest=longest).returncode == 0
    return False


def _most_bytes(path: Path) -> float:
    """Most bytes of arrays: what compresses better than any result is made to fill memory."""
    return max(_MOST_SPREAD * path.stat().st_size, _ALWAYS_READ)


def _checksum(file: IO[bytes], size: int) -> bytes:
    digest = hashlib.blake2b(digest_size=_CHECKSUM_BYTES)
    for begin in range(0, size, _PART):
        digest.update(file.read(min(_PART, size - begin)))
    return digest.digest()
