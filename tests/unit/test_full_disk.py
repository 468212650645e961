"""A disk that takes no more: a clean error, nothing half-written, no number lost.

The limit on the size of files stands for the full disk: the system refuses the write alike.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("resource")

REPOSITORY = Path(__file__).resolve().parents[2]

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
from tests.unit.test_results_stream import rows
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
sys.exit(main(["run", case, "--fidelity", "ideal", "-o", f"{sys.argv[2]}/result.nc", "--json"]))
"""


def limited(program: str, size: int, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a program that may write files of so many bytes only."""
    command = [sys.executable, "-c", _LIMITED + program, str(size), str(folder)]
    return subprocess.run(
        command, cwd=REPOSITORY, capture_output=True, text=True, timeout=120.0, check=False
    )


@pytest.mark.parametrize("size", [300, 4_000, 41_000, 100_000, 780_000])
def test_a_dataset_that_does_not_fit_is_refused_and_leaves_nothing(
    size: int, tmp_path: Path
) -> None:
    run = limited(_WRITE, size, tmp_path)
    assert (run.returncode, run.stdout) == (0, "refused: File too large\n"), run.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("size", "rows"), [(300, 550), (50_000, 550), (300_000, 1650)])
def test_samples_that_the_temporary_folder_refuses_stay_in_memory(
    size: int, rows: int, tmp_path: Path
) -> None:
    run = limited(_STREAM, size, tmp_path)
    assert (run.returncode, run.stdout) == (0, f"rows kept: {rows}\n"), run.stderr
