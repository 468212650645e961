"""Studies on the workers of a Dask scheduler."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import pytest
import xarray as xr
from distributed import Client, LocalCluster

from tests.conftest import posix
from tests.study_cases import case_with_study
from toothspace import api
from toothspace.case import Case
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.netcdf import read_dataset
from toothspace.core.status import Status
from toothspace.studies import StudyResult, run_study, workers
from toothspace.studies.study import FILE_NAME
from toothspace.studies.workers import WorkerLostError, Workers

SWEEP = """
kind = "sweep"
[study.vary]
"machine.casing.radial_clearance" = {from = "10 um", to = "30 um", count = 3}
"operating_point.shaft_speed" = ["1000 rpm", "1500 rpm"]
"""
TIMES = ("wall_time", "point_time")


@pytest.fixture
def threads() -> Iterator[LocalCluster]:
    """A cluster within this process."""
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0"
    ) as cluster:
        yield cluster


def sweep() -> Case:
    return case_with_study(SWEEP, "egm12_pump").replace({"run.fidelity": "ideal"})


def without_times(result: StudyResult) -> xr.Dataset:
    return result.data.drop_vars([n for n in result.data.variables if str(n).startswith(TIMES)])


@posix
@pytest.mark.slow
def test_a_worker_that_is_killed_changes_nothing(tmp_path: Path) -> None:
    local = run_study(sweep())
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as own,
    ):
        processes = own.run(os.getpid)

        def kill_one(_share: float, text: str) -> None:
            if text.startswith("point 1 ") and processes:
                os.kill(processes.popitem()[1], signal.SIGKILL)

        address = cluster.scheduler_address
        found = run_study(sweep(), tmp_path, scheduler=address, progress=kill_one)
        assert len(processes) == 1
        assert found.status is local.status is Status.DONE
        xr.testing.assert_identical(without_times(found), without_times(local))
        # a client of the user stands by while results are written and read
        assert read_dataset(tmp_path / "study.nc").sizes == found.data.sizes
        kept = (tmp_path / FILE_NAME).read_text()
        again = run_study(sweep(), tmp_path, scheduler=address, resume=True)
    xr.testing.assert_identical(again.data, found.data)
    assert (tmp_path / FILE_NAME).read_text() == kept


def test_resume_computes_again_what_other_sources_gave(
    calls: list[Case], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = case_with_study(SWEEP)
    run_study(case, tmp_path)
    run_study(case, tmp_path, resume=True)
    assert len(calls) == 6
    monkeypatch.setattr("toothspace.studies.points.digest_of_sources", lambda: "other")
    run_study(case, tmp_path, resume=True)
    assert len(calls) == 12


def test_a_worker_with_other_sources_is_refused(
    threads: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    digests = iter(("mine", "of the worker"))
    monkeypatch.setattr(workers, "digest_of_sources", lambda: next(digests))
    with (
        Workers(1, threads.scheduler_address) as pool,
        pytest.raises(ToothspaceError, match="found other sources of toothspace on the worker"),
    ):
        list(pool.each(abs, [-1]))


def test_a_scheduler_may_be_lost_between_two_generations(threads: LocalCluster) -> None:
    with Workers(1, threads.scheduler_address) as pool:
        assert list(pool.each(abs, [-1])) == [(0, 1)]
        pool._client.close()
        with pytest.raises(ToothspaceError, match="does not answer any more"):
            list(pool.each(abs, [-1]))


def test_a_scheduler_may_be_lost_while_it_is_given_points(
    threads: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Workers(1, threads.scheduler_address) as pool:
        assert list(pool.each(abs, [-1])) == [(0, 1)]
        assert pool._executor is not None
        submit = pool._executor.submit

        def submit_and_lose(call: Any, item: int) -> Any:
            if item == 2:
                pool._client.close()
            return submit(call, item)

        monkeypatch.setattr(pool._executor, "submit", submit_and_lose)
        with pytest.raises(ToothspaceError, match="does not answer any more"):
            list(pool.each(abs, [1, 2, 3]))


def test_what_the_cluster_cannot_do_is_one_sentence(threads: LocalCluster) -> None:
    with (
        Workers(1, threads.scheduler_address) as pool,
        pytest.raises(
            ToothspaceError, match=r"the cluster failed \(TypeError: .*need this version"
        ),
    ):
        list(pool.each(abs, ["text"]))


def test_a_lost_scheduler_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, calls: list[Case]
) -> None:
    """Killed while the study waits for workers; points that it had before are kept."""
    some = case_with_study(SWEEP.replace('"1000 rpm", ', ""))
    run_study(some, tmp_path / "study")
    kept = (tmp_path / "study" / FILE_NAME).read_text()
    told = tmp_path / "scheduler.json"
    words = ["--no-dashboard", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(told)]
    scheduler = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    connect = workers._client

    def connect_and_lose(address: str) -> Any:
        client = connect(address)
        client._timeout = 1.0  # for which it looks for the scheduler again
        scheduler.kill()
        return client

    monkeypatch.setattr(workers, "_client", connect_and_lose)
    monkeypatch.setattr(workers, "_ANSWER_TIME", 60.0)
    try:
        # the file is there before the address is in it
        while not told.exists() or not told.read_text():
            assert scheduler.poll() is None
            time.sleep(0.05)
        address = json.loads(told.read_text())["address"]
        lost = r"scheduler .* does not answer any more; .*--resume"
        with pytest.raises(ToothspaceError, match=lost):
            run_study(case_with_study(SWEEP), tmp_path / "study", scheduler=address, resume=True)
    finally:
        scheduler.kill()
        scheduler.wait()
    assert (tmp_path / "study" / FILE_NAME).read_text() == kept
    done = run_study(case_with_study(SWEEP), tmp_path / "study", resume=True)
    assert done.status is Status.DONE
    assert len(calls) == 6


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nothing://here", "here"])
def test_an_address_without_scheduler_is_refused(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "_ANSWER_TIME", 1.0)
    with pytest.raises(CaseError, match=f"--scheduler: found '{address}', where no scheduler"):
        list(Workers(1, address).each(abs, [1.0]))


def test_a_point_whose_workers_die_is_a_failed_point(monkeypatch: pytest.MonkeyPatch) -> None:
    def each(_self: Workers, function: Any, arguments: Any) -> Iterator[tuple[int, Any]]:
        yield 0, WorkerLostError("its workers died")
        yield from ((k, function(item)) for k, item in enumerate(arguments) if k)

    monkeypatch.setattr(Workers, "each", each)
    result = run_study(sweep())
    assert result.status is Status.POINTS_FAILED
    assert result.numbers["point_status"] == ["failed", *["done"] * 5]
    assert result.data["point_message"].values[0] == "its workers died"


def test_results_are_written_beside_a_client(threads: LocalCluster, tmp_path: Path) -> None:
    with Client(threads):
        solution = api.simulate(sweep().at_point({}))
        again = read_dataset(solution.save(tmp_path / "run.nc"))
    assert again["shaft_torque"].equals(solution.data["shaft_torque"])


@posix
@pytest.mark.slow
def test_a_point_that_exhausts_its_worker_fails_alone() -> None:
    """The nanny ends a worker beyond its memory; the other points are done by another one."""

    def hungry(item: int) -> int:
        import time

        held = b"x" * (900 << 20) if item == 1 else b""
        time.sleep(20.0 if held else 0.0)
        return len(held) + item

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(
            n_workers=1,
            threads_per_worker=1,
            memory_limit="600MiB",
            dashboard_address="127.0.0.1:0",
        ) as cluster,
        Workers(1, cluster.scheduler_address) as pool,
    ):
        found = dict(pool.each(hungry, [0, 1, 2]))
    assert found[0] == 0
    assert found[2] == 2
    assert isinstance(found[1], WorkerLostError)
    assert "lack of memory" in str(found[1])
