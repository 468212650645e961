"""Small files that would fill memory or take hours are refused, or read in time."""

from __future__ import annotations

import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from toothspace.core import netcdf
from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset, write_dataset
from toothspace.geometry import body_section


@pytest.fixture
def bomb(tmp_path: Path) -> Path:
    """Zeros that need 800 MB and take 1 MB."""
    path = tmp_path / "bomb.nc"
    with h5py.File(path, "w") as file:
        file.create_dataset("x", (10**8,), "f8", chunks=(10**7,), compression="gzip")
    return path


def test_a_file_that_spreads_over_memory_is_refused(bomb: Path) -> None:
    assert not netcdf._is_readable(bomb)
    with pytest.raises(CaseError, match="cannot be read as one"):
        read_dataset(bomb)


def test_a_checksum_of_its_own_does_not_help_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    zeros = xr.Dataset({"x": ("n", np.zeros(2000))})
    path = write_dataset(zeros, tmp_path / "sealed.nc")
    assert read_dataset(path).sizes == {"n": 2000}
    monkeypatch.setattr(netcdf, "_most_bytes", lambda _: 10_000.0)
    with pytest.raises(CaseError, match="cannot be read as one"):
        read_dataset(path)


def test_a_section_of_many_corners_is_compared_in_time() -> None:
    """Two ends of 60 000 cut edges, on one curve: all pairs of them would take minutes."""
    turn = np.linspace(0.0, 2.0 * np.pi, 30_000, endpoint=False)
    wave = 1.0 + 0.1 * np.sin(12.0 * turn)
    ring = np.column_stack([wave * np.cos(turn), wave * np.sin(turn), np.zeros_like(turn)])
    local = np.vstack([ring, ring + np.array([0.0, 0.0, 1.0])])
    count = np.arange(len(turn))
    edges = np.column_stack([count, count + len(turn)])
    started = time.perf_counter()
    found = body_section._corner_chain(local, edges, local[:, 2] > 0.5)
    assert time.perf_counter() - started < 3.0
    assert found is not None
    assert len(found) == len(turn)
