"""Processes of a study: none outlives the first one, whatever ends it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from tests.conftest import REPOSITORY, posix

_PROGRAM = """
import sys, time
from toothspace.core.interrupts import ending_interrupts
from toothspace.studies.workers import Workers

if __name__ == "__main__":
    with ending_interrupts(), Workers(2) as workers:
        for number, _ in workers.each(time.sleep, [0.01, 0.01, 600.0, 600.0]):
            print(number, flush=True)
"""

_POOL = """
import time
from toothspace.core.processes import outcomes

print(0, flush=True)
print(1, flush=True)
outcomes(time.sleep, [600.0, 600.0], 2)
"""


_THREADS = """
from toothspace.studies.workers import Workers

def counted(_):
    from toothspace.core.processes import threads
    return threads()

if __name__ == "__main__":
    with Workers(2) as workers:
        print(*(counts for _, counts in workers.each(counted, [0, 1])))
"""


def test_a_worker_computes_in_one_thread(tmp_path: Path) -> None:
    program = tmp_path / "study.py"
    program.write_text(_THREADS, encoding="utf-8")
    words = [sys.executable, str(program)]
    ended = subprocess.run(words, cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert ended.stdout.split("\n")[0] == "1 1", ended.stderr


KILL = getattr(signal, "SIGKILL", signal.SIGTERM)


@posix
@pytest.mark.parametrize(
    ("text", "end"),
    [
        (_PROGRAM, KILL),
        (_PROGRAM, signal.SIGTERM),
        (_PROGRAM, signal.SIGINT),
        (_POOL, KILL),
    ],
)
def test_no_worker_is_left(text: str, end: signal.Signals, tmp_path: Path) -> None:
    program = tmp_path / "study.py"
    program.write_text(text, encoding="utf-8")
    # a test run in the background inherits that interrupts are ignored
    first = subprocess.Popen(
        [sys.executable, str(program)],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert first.stdout is not None
    assert {first.stdout.readline(), first.stdout.readline()} == {b"0\n", b"1\n"}
    workers: list[psutil.Process] = []
    while len(workers) < 2:
        assert first.poll() is None
        time.sleep(0.5)
        workers = psutil.Process(first.pid).children(recursive=True)
    os.kill(first.pid, end)
    first.wait(timeout=20.0)
    first.stdout.close()
    until = time.monotonic() + 10.0
    while any(worker.is_running() for worker in workers) and time.monotonic() < until:
        time.sleep(0.05)
    left = [worker for worker in workers if worker.is_running()]
    for worker in left:
        worker.kill()
    assert not left
