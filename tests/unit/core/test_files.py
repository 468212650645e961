"""Files are complete or not there, as they were written, and never replaced unasked."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import weakref
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from tests.conftest import posix
from tests.unit.results.test_results_stream import streamed
from toothspace.core import files as array_store
from toothspace.core import netcdf
from toothspace.core.errors import CaseError
from toothspace.core.files import draft_of, read_bytes, require_writable, write_text
from toothspace.core.interrupts import ending_interrupts, interrupts_held
from toothspace.core.netcdf import read_dataset, write_dataset
from toothspace.results.solution import load_solution


def test_a_draft_becomes_the_file_or_goes(tmp_path: Path) -> None:
    target = tmp_path / "kept.txt"
    write_text(target, "old")
    with pytest.raises(UnicodeEncodeError), draft_of(target) as draft:
        draft.write_text("half\udc80", encoding="utf-8")
    assert [path.name for path in tmp_path.iterdir()] == ["kept.txt"]
    assert target.read_text(encoding="utf-8") == "old"
    write_text(target, "new")
    assert target.read_text(encoding="utf-8") == "new"


def test_a_name_as_long_as_the_disk_allows_can_be_written(tmp_path: Path) -> None:
    target = tmp_path / f"{'n' * 252}.nc"
    assert require_writable(target, "-o", replace=False, endings=(".nc",)) == target
    write_dataset(xr.Dataset({"a": 1.0}), target)
    assert read_dataset(target)["a"] == 1.0


@posix
@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("", "found a directory"),
        ("absent/out.nc", "found no folder"),
        ("there.nc", "found a file that exists, allowed a new one, or --force"),
        (f"{'n' * 300}.nc", "found 'File name too long' on writing"),
        ("nul\0.nc", "null byte"),
        ("pipe", "found a device or pipe"),
        ("flow.csv", "found the ending '.csv', allowed .nc"),
        ("flow", "found a name without ending, allowed .nc"),
    ],
)
def test_a_place_that_cannot_be_written_is_found_before(
    name: str, part: str, tmp_path: Path
) -> None:
    (tmp_path / "there.nc").touch()
    os.mkfifo(tmp_path / "pipe")
    before = sorted(tmp_path.iterdir())
    with pytest.raises(CaseError, match="-o: found") as refused:
        require_writable(tmp_path / name, "-o", replace=False, endings=(".nc",))
    assert part in str(refused.value)
    assert sorted(tmp_path.iterdir()) == before
    assert require_writable(tmp_path / "there.nc", "-o", replace=True, endings=(".nc",))


@posix
@pytest.mark.parametrize("name", ["pipe", "zero", "folder", "absent", "n" * 300, "large"])
def test_only_ordinary_files_are_read(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    (tmp_path / "folder").mkdir()
    (tmp_path / "large").write_bytes(bytes(101))
    with pytest.raises(CaseError, match=r"^case: found .*, allowed"):
        read_bytes(tmp_path / name, "case", "a file", 100)


def test_a_signal_waits_for_the_end_of_the_body() -> None:
    done = []

    def body() -> None:
        with interrupts_held():
            signal.raise_signal(signal.SIGTERM)
            done.append("body")
        done.append("not reached")

    with ending_interrupts(), pytest.raises(KeyboardInterrupt):
        body()
    assert done == ["body"]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_a_held_signal_acts_sooner_where_the_body_lets_it_unless_it_is_held_twice() -> None:
    done = []

    def body() -> None:
        with interrupts_held() as outer:
            with interrupts_held() as inner:
                signal.raise_signal(signal.SIGTERM)
                inner()
                done.append("inner")
            outer()
            done.append("not reached")

    with ending_interrupts(), pytest.raises(KeyboardInterrupt):
        body()
    assert done == ["inner"]


def test_a_signal_while_a_place_is_tried_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not even for a moment is there an empty file under the final name."""
    tried: list[Path] = []

    def touch(path: Path) -> None:
        tried.append(path)
        path.write_bytes(b"")
        signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(Path, "touch", touch)
    target = tmp_path / "report.html"
    with ending_interrupts(), pytest.raises(KeyboardInterrupt):
        require_writable(target, "-o", replace=False, endings=(".html",))
    assert [path.name for path in tried] == [target.name]
    assert tried[0] != target
    assert not list(tmp_path.iterdir())


def test_a_signal_while_a_draft_is_made_leaves_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = os.open

    def make(*names: Any, **options: Any) -> int:
        found = opened(*names, **options)
        signal.raise_signal(signal.SIGTERM)
        return found

    monkeypatch.setattr(os, "open", make)
    with ending_interrupts(), pytest.raises(KeyboardInterrupt):
        write_text(tmp_path / "report.html", "text")
    assert not list(tmp_path.iterdir())


def test_a_signal_inside_an_import_waits_for_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Raised between the lock of imports and its release, it leaves a lock for ever."""
    text = (
        "import signal, time\nsignal.raise_signal(signal.SIGTERM)\ntime.sleep(0.1)\ndone = True\n"
    )
    (tmp_path / "slowly_imported.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)

    def body() -> None:
        import_module("slowly_imported")
        time.sleep(10.0)

    with ending_interrupts(), pytest.raises(KeyboardInterrupt):
        body()
    assert sys.modules.pop("slowly_imported").done


def test_a_signal_where_exceptions_are_ignored_is_not_lost(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def body() -> None:
        gone = threading.Event()
        watch = weakref.ref(gone, lambda _: signal.raise_signal(signal.SIGTERM))
        del gone
        time.sleep(10.0)
        assert watch() is None

    with ending_interrupts(), pytest.raises(KeyboardInterrupt):
        body()
    assert "Traceback" not in capsys.readouterr().err


def test_other_threads_are_left_alone() -> None:
    found = []

    def body() -> None:
        with ending_interrupts(), interrupts_held():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=body)
    thread.start()
    thread.join()
    assert found == [signal.SIG_DFL]


@pytest.fixture
def written(tmp_path: Path) -> Path:
    data = xr.Dataset(
        {
            "pressure": (("time", "body"), np.arange(600.0).reshape(200, 3), {"units": "Pa"}),
            "body": ["drive", "driven", "µ"],
            "closed": ("time", np.arange(200) % 2 == 0),
            "count": 3,
            "gap": ("time", np.where(np.arange(200) < 4, np.nan, 1e-6)),
        },
        attrs={"title": "Ä", "empty": "", "lines": "a\nb", "number": 3.5},
    )
    return write_dataset(data, tmp_path / "file.nc")


def test_a_file_comes_back_as_it_was_written(written: Path) -> None:
    data = read_dataset(written)
    assert data.attrs["title"] == "Ä"
    assert data["closed"].dtype == bool
    assert list(data["body"].values) == ["drive", "driven", "µ"]


def test_every_damage_is_found(written: Path) -> None:
    """One byte turned over, at places all through the file."""
    whole, good = written.read_bytes(), read_dataset(written)
    checked = whole.index(b"toothspace BLAKE2b") - 1
    for place in range(0, len(whole), 37):
        damaged = bytearray(whole)
        damaged[place] ^= 0xFF
        written.write_bytes(damaged)
        if place < checked or place >= len(whole) - 32:
            with pytest.raises(CaseError, match=r"found a damaged file, .* allowed a NetCDF file"):
                read_dataset(written)
        else:
            assert read_dataset(written).identical(good)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.99])
def test_a_file_cut_short_is_refused(share: float, written: Path) -> None:
    whole = written.read_bytes()
    written.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(CaseError, match="allowed a NetCDF file"):
        read_dataset(written)


def test_a_file_in_which_reading_never_ends_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With this byte turned over and no checksum, HDF5 goes round and round in an attribute."""
    monkeypatch.setattr(netcdf, "_LEAST_WAIT", 2.0)
    small = xr.Dataset({"a": ("x", np.arange(4.0))}, attrs={"title": "t", "machine": "m"})
    content = bytearray(bytes(small.to_netcdf(engine="h5netcdf")))
    content[355] ^= 0xFF
    path = tmp_path / "file.nc"
    path.write_bytes(content)
    with pytest.raises(CaseError, match="cannot be read as one, allowed a NetCDF file"):
        read_dataset(path)


def test_a_result_written_by_another_tool_is_read(tmp_path: Path) -> None:
    path = streamed(10, 10).save(tmp_path / "run.nc")
    with xr.open_dataset(path, engine="h5netcdf") as raw:
        changed = raw.load()
    changed["shaft_angle"][3] = 7.0
    changed.to_netcdf(path, engine="h5netcdf")
    assert load_solution(path).data["shaft_angle"][3] == 7.0


def test_a_result_without_its_parts_is_refused_in_words(tmp_path: Path) -> None:
    path = streamed(10, 10).save(tmp_path / "run.nc")
    partly = read_dataset(path).drop_vars("ledger_mass")
    write_dataset(partly, path)
    with pytest.raises(CaseError, match=r"without a usable .*ledger_mass"):
        load_solution(path)


def test_stored_arrays_are_as_they_were_or_none(tmp_path: Path) -> None:
    path = tmp_path / "store" / "a.npz"
    assert array_store.load_arrays(path) is None
    array_store.save_arrays(path, {"depth": np.arange(40.0), "size": np.asarray(3)})
    found = array_store.load_arrays(path)
    assert found is not None
    assert (found["depth"].tolist(), int(found["size"])) == (list(range(40)), 3)
    whole = path.read_bytes()
    for place in range(0, len(whole), 5):
        damaged = bytearray(whole)
        damaged[place] ^= 0x55
        path.write_bytes(damaged)
        read = array_store.load_arrays(path)
        assert read is None or read["depth"].tolist() == list(range(40))
    np.savez(path, other=np.ones(2))
    assert array_store.load_arrays(path) is None
