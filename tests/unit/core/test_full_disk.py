"""A disk that takes no more: a clean error, nothing half-written, no number lost.

The limit on the size of files stands for the full disk: the system refuses the write alike.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace.core import netcdf
from toothspace.results.solution import load_solution

pytest.importorskip("resource")

REPOSITORY = Path(__file__).resolve().parents[3]

_LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
from pathlib import Path
import numpy as np
"""

_WRITE = """
import xarray as xr
from toothspace.core.netcdf import write_dataset
values = {f"v{k}": (("a", "b"), np.ones((100, 50))) for k in range(20)}
try:
    write_dataset(xr.Dataset(values), Path(sys.argv[2]) / "result.nc")
except OSError as error:
    print("refused:", error.strerror)
"""

_STREAM = """
from tests.unit.results.test_results_stream import rows
from toothspace.results.stream import SampleStream
stream = SampleStream()
for begin in range(0, 5000, 50):
    stream.append(rows(begin, begin + 50))
    if stream.failure is not None:
        break
found = stream.finish()
for name, values in rows(0, stream.rows).items():
    np.testing.assert_array_equal(found[name].values, values)
print("rows kept:", stream.rows)
"""

_RUN = """
from toothspace.cli import main
case = "cases/egm12_motor.toml"
sys.exit(main(["run", case, "-o", f"{sys.argv[2]}/disk/result.nc", "--json"]))
"""


def limited(program: str, size: int, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a program that may write files of so many bytes only."""
    return started([sys.executable, "-B", "-c", _LIMITED + program, str(size), str(folder)])


def started(command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, cwd=REPOSITORY, capture_output=True, text=True, timeout=300.0, check=False
    )


def test_the_disk_sees_a_result_only_when_it_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[bytes] = []

    def take(path: Path, content: bytes) -> Path:
        taken.append(content)
        return path

    monkeypatch.setattr(netcdf, "write_bytes", take)
    netcdf.write_dataset(xr.Dataset({"depth": ("x", np.arange(9.0))}), tmp_path / "whole.nc")
    assert list(tmp_path.iterdir()) == []
    assert [content[:8] for content in taken] == [b"\x89HDF\r\n\x1a\n"]


@pytest.mark.parametrize("size", [300, 41_000, 780_000])
def test_a_dataset_that_does_not_fit_is_refused_and_leaves_nothing(
    size: int, tmp_path: Path
) -> None:
    run = limited(_WRITE, size, tmp_path)
    assert (run.returncode, run.stdout) == (0, "refused: File too large\n"), run.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("size", "rows"), [(300, 550), (300_000, 1650)])
def test_samples_that_the_temporary_folder_refuses_stay_in_memory(
    size: int, rows: int, tmp_path: Path
) -> None:
    run = limited(_STREAM, size, tmp_path)
    assert (run.returncode, run.stdout) == (0, f"rows kept: {rows}\n"), run.stderr


@pytest.mark.slow
def test_a_run_into_a_full_disk_keeps_its_numbers_elsewhere(tmp_path: Path) -> None:
    program = "import sys" + _RUN
    disk, spare = tmp_path / "disk", tmp_path / "spare"
    disk.mkdir()
    spare.mkdir()
    own_disk = f"mount -t tmpfs -o size=300k tmpfs {disk} && export TMPDIR={spare} && exec "
    inside = ["unshare", "-rm", "sh", "-c", own_disk + '"$@"', "sh"]
    if shutil.which("unshare") is None or started([*inside, "true"]).returncode:
        pytest.skip("no disk of its own can be made here")
    run = started([*inside, sys.executable, "-B", "-c", program, "0", str(tmp_path)])
    assert run.returncode == 2, run.stderr
    assert "No space left on device" in run.stderr
    (kept,) = spare.iterdir()
    assert load_solution(kept).status.name == "DONE"
