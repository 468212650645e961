"""Faults by the hundred: commands are killed, interrupted and starved at random moments.

``python -m tests.faults --count 100`` starts every command that writes so many times, ends each at
a random moment by one of SIGKILL, SIGTERM and SIGINT, and then checks the folder: nothing
half-written under a final name, no draft of a finished command, every result, case and unit
readable, no process left, and ``study --resume`` completes with the numbers of a study that was not
ended. ``cluster`` is the study on the workers of a Dask scheduler, which outlive it, and ``page``
the server of ``toothspace app`` while a run is under way, which a later server calls stopped.
A signal to Python while it still reads the first files of the package is Python's to answer.
Then limits on the size of files, full disks and temporary folders, folders that cannot be
written, damaged caches, caches from the future, two processes on one cache, and too little
memory. The exit code is the number of faults that did harm.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import zipfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from http.client import HTTPConnection
from pathlib import Path

import psutil

from toothspace.app.queue import RunQueue
from toothspace.app.workspace import Workspace
from toothspace.core.compilation.sources import cache_root
from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset

REPOSITORY = Path(__file__).resolve().parent.parent
CASES = REPOSITORY / "cases"
ENDS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
_STARTUP = ["--set", "circuit.duration=0.2 s", "--set", "run.time_samples=4000"]
_SWEEP = ["--set", "run.fidelity=ideal", "--workers", "2"]
_MOTOR = "egm12_motor_profile"
_PROFILE = CASES / "profiles" / "egm12_drive.txt"
_COARSE = ["--set", "run.samples_per_revolution=36"]
_LONGEST = 20.0
"""Commands that take longer are ended within that time. [s]"""
_PAGE_TIME = 3.0
"""Time within which the server of the page is ended, once a run was asked for. [s]"""
_GRACE = 30.0
"""Time that a command gets to end after a signal. [s]"""


_SCHEDULER: list[str] = []
"""Address of the Dask scheduler of this campaign, once there is one."""


def commands(folder: Path) -> dict[str, list[str]]:
    """Arguments of the commands, by name; all write into a folder."""
    study = ["study", str(CASES / "sweep_clearance.toml"), "-o", f"{folder}/study"]
    return {
        "run": ["run", str(CASES / "startup_blocked.toml"), "-o", f"{folder}/run.nc", *_STARTUP],
        "study": [*study, *_SWEEP],
        "cluster": [*study, *_SWEEP[:2], "--scheduler", *_SCHEDULER],
        "report": ["report", f"{folder}/whole.nc", "-o", f"{folder}/report.html", "--force"],
        "compare": ["compare", *2 * [f"{folder}/whole.nc"], "-o", f"{folder}/compare.html"],
        "geometry": ["geometry", _MOTOR, "-o", f"{folder}/tables.nc", "--txt", f"{folder}/txt"],
        "gear": ["gear", str(_PROFILE), "--case", f"{folder}/drafted.toml"],
        "init": ["init", _MOTOR, f"{folder}/begun"],
        "fmu": ["fmu", _MOTOR, "-o", f"{folder}/motor.fmu", "--model", "full"],
        "reduce": ["reduce", _MOTOR, "-o", f"{folder}/films.nc", *_COARSE],
    }


def start(arguments: list[str], before: Callable[[], None] | None = None) -> psutil.Popen:
    def prepare() -> None:
        # a process in the background inherits that interrupts are ignored
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if before is not None:
            before()

    command = [sys.executable, "-B", "-m", "toothspace", *arguments]
    return psutil.Popen(
        command,
        cwd=REPOSITORY,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=prepare,
    )


def finish(process: psutil.Popen, longest: float = 20 * _GRACE) -> tuple[int, str]:
    """Exit code and messages; one that does not end in its time [s] counts as a crash."""
    try:
        _, messages = process.communicate(timeout=longest)
    except subprocess.TimeoutExpired:
        for one in (*process.children(recursive=True), process):
            one.kill()
        return 1, f"still there after {longest:g} s"
    return process.returncode, messages


def harm(folder: Path, *, killed: bool) -> Iterator[str]:
    """What a fault left behind that it should not have."""
    for path in folder.rglob("*"):
        if path.suffix == ".part" and not killed:
            yield f"{path.name}: a draft was left"
        if path.suffix == ".nc":
            try:
                read_dataset(path)
            except CaseError as error:
                yield str(error)
        if path.suffix == ".toml":
            try:
                tomllib.loads(path.read_text("utf-8"))
            except ValueError as error:
                yield f"{path.name}: half-written, {error}"
        if path.suffix == ".fmu" and not zipfile.is_zipfile(path):
            yield f"{path.name}: half-written"
        if path.suffix == ".html" and not path.read_text("utf-8").rstrip().endswith("</html>"):
            yield f"{path.name}: half-written"


STUDIES = ("study", "cluster")


def on_cluster(whole: Path, longest: float, draw: random.Random, count: int) -> Iterator[str]:
    """End studies whose points are computed by workers of a Dask scheduler."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0"
    ) as cluster:
        _SCHEDULER[:] = [cluster.scheduler_address]
        started = time.perf_counter()
        code, messages = finish(start([*commands(whole.parent / "first")["cluster"]]))
        if code != 0:
            yield f"cluster, left alone: code {code}: {messages[-300:]}"
        longest = time.perf_counter() - started
        for _ in range(count):
            yield from end_at_random("cluster", whole, longest, draw)
        if len(cluster.scheduler.workers) != 2:
            yield f"cluster: {len(cluster.scheduler.workers)} of 2 workers are left"


def end_page(draw: random.Random) -> list[str]:
    """End the server of the page at a random moment of a run; what harm that did."""
    end, found = draw.choice(ENDS), []
    with tempfile.TemporaryDirectory() as place:
        folder, passing = Path(place) / "bench", Path(place) / "passing"
        for made in (folder, passing):
            made.mkdir()
        process = start(
            ["app", str(folder), "--no-browser"], lambda: os.environ.update(TMPDIR=str(passing))
        )
        address = process.stderr.readline().split()[1]
        port, token = re.findall(r":(\d+)/\?token=(.+)", address)[0]
        asked = HTTPConnection("127.0.0.1", int(port), timeout=_GRACE)
        asked.request("GET", f"/?token={token}")
        answer = asked.getresponse()
        answer.read()
        headers = {
            "Cookie": str(answer.headers["set-cookie"]).partition(";")[0],
            "Origin": f"http://127.0.0.1:{port}",
        }

        def post(path: str, **given: object) -> dict[str, object]:
            asked.request("POST", path, json.dumps(given), headers)
            return dict(json.loads(asked.getresponse().read()))

        design = post("/api/designs", case="gerotor_trochoidal")["id"]
        run = post("/api/runs", design=design, values={"run.until": None, "run.revolutions": 2})
        asked.close()
        time.sleep(draw.uniform(0.0, _PAGE_TIME))
        family = process.children(recursive=True)
        process.send_signal(end)
        code, messages = finish(process, 4 * _GRACE)
        _, left = psutil.wait_procs(family, timeout=_GRACE)
        found += [f"process {one.pid} is left" for one in left]
        for one in left:
            one.kill()
        if end != signal.SIGKILL:
            found += [f"{path.name} is left" for path in passing.iterdir()]
            if "Traceback" in messages or code in (1, 70, -11):
                found.append(f"code {code}: {messages[-300:]}")
        found += harm(folder, killed=end == signal.SIGKILL)
        workspace = Workspace(folder)
        RunQueue(workspace, lambda _: None).close()
        states = {one["id"]: one["state"] for one in workspace.runs()}
        if states.get(run["id"]) not in {"stopped", "done"}:
            found.append(f"the run is {states.get(run['id'])}")
    return [f"page, {end.name}: {text}" for text in found]


def end_at_random(name: str, whole: Path, longest: float, draw: random.Random) -> list[str]:
    """End one command at a random moment; what harm that did."""
    end = draw.choice(ENDS)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "whole.nc").write_bytes(whole.read_bytes())
        process = start(commands(folder)[name])
        time.sleep(draw.uniform(0.0, longest))
        family = process.children(recursive=True) if process.is_running() else []
        process.send_signal(end)
        code, messages = finish(process, 4 * _GRACE)
        _, left = psutil.wait_procs(family, timeout=_GRACE)
        found = [f"process {one.pid} is left" for one in left]
        for one in left:
            one.kill()
        begun = ", in main\n" in messages or not messages.endswith("KeyboardInterrupt\n")
        if begun and end != signal.SIGKILL and ("Traceback" in messages or code in (1, 70, -11)):
            found.append(f"code {code}: {messages[-300:]}")
        found += harm(folder, killed=end == signal.SIGKILL)
        if name in STUDIES and (folder / "study").is_dir():
            code, messages = finish(start([*commands(folder)[name], "--resume"]))
            found += [] if code == 0 else [f"resume ends with {code}: {messages[-300:]}"]
            both = [place / "study" / "study.nc" for place in (folder, whole.parent)]
            if code == 0 and not read_dataset(both[0]).equals(read_dataset(both[1])):
                found.append("resumed, it has other numbers")
        return [f"{name}, {end.name}: {text}" for text in found]


def limited(name: str, whole: Path, kind: int, size: int) -> tuple[int, str, list[str]]:
    """Exit code, messages and harm of a command with so much of one resource only. [B]."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "whole.nc").write_bytes(whole.read_bytes())
        limit = (size, size)
        process = start(commands(folder)[name], lambda: resource.setrlimit(kind, limit))
        code, messages = finish(process)
        return code, messages, list(harm(folder, killed=False))


def starve(name: str, whole: Path, size: int) -> list[str]:
    """Run a command that may write files of so many bytes only; what harm that did."""
    code, messages, found = limited(name, whole, resource.RLIMIT_FSIZE, size)
    if "Traceback" in messages or code not in (0, 2, 3):
        found.append(f"code {code}: {messages[-300:]}")
    return [f"{name}, files of {size} bytes: {text}" for text in found]


def on_small_disks(whole: Path) -> Iterator[str]:
    """Commands on a full disk, in a read-only folder and with a full temporary folder."""
    mounts = {
        "full disk": "mount -t tmpfs -o size=200k tmpfs {0}/out && cp {0}/whole.nc {0}/out",
        "read-only folder": "mount --bind {0}/out {0}/out && mount -o remount,ro,bind {0}/out",
        "full temporary folder": "mount -t tmpfs -o size=100k tmpfs {0}/tmp",
    }
    for fault, mount in mounts.items():
        for name in ("run", "study", "report"):
            with tempfile.TemporaryDirectory() as place:
                folder = Path(place)
                for inner in ("out", "tmp"):
                    (folder / inner).mkdir()
                for copy in (folder / "whole.nc", folder / "out" / "whole.nc"):
                    copy.write_bytes(whole.read_bytes())
                words = [sys.executable, "-B", "-m", "toothspace", *commands(folder / "out")[name]]
                setting = (
                    f"export TMPDIR={place}/tmp; {mount.format(place)}; exec {shlex.join(words)}"
                )
                inside = ["unshare", "-rm", "sh", "-c", setting]
                done = subprocess.run(
                    inside, cwd=REPOSITORY, capture_output=True, text=True, timeout=600, check=False
                )
                found = [] if done.returncode in (0, 2, 3) else [f"code {done.returncode}"]
                if found or "Traceback" in done.stderr:
                    yield f"{name}, {fault}: {found} {done.stderr[-300:]}"


def with_cache(whole: Path, draw: random.Random) -> Iterator[str]:
    """A run on caches that are damaged, come from the future or are shared, gives its numbers."""
    expected = read_dataset(whole)
    with tempfile.TemporaryDirectory() as place:
        folder, cache = Path(place), Path(place) / "cache"
        setting = {**os.environ, "TOOTHSPACE_CACHE": str(cache)}
        shutil.copytree(
            cache_root(), cache / "toothspace", ignore=shutil.ignore_patterns("compiled-*")
        )
        stored = [path for path in cache.rglob("*") if path.is_file()]

        def run(number: int) -> subprocess.Popen[str]:
            arguments = commands(folder)["run"]
            arguments[3] = f"{folder}/{number}.nc"
            command = [sys.executable, "-B", "-m", "toothspace", *arguments]
            return subprocess.Popen(
                command, cwd=REPOSITORY, env=setting, text=True,
                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
            )  # fmt: skip

        def ends(fault: str, *numbers: int) -> Iterator[str]:
            for number, process in [(number, run(number)) for number in numbers]:
                _, messages = process.communicate(timeout=600)
                path = folder / f"{number}.nc"
                if process.returncode != 0 or not read_dataset(path).equals(expected):
                    same = "other numbers" if path.exists() else messages[-300:]
                    yield f"run, {fault}: code {process.returncode}, {same}"

        for path in draw.sample(stored, min(3, len(stored))):
            content = bytearray(path.read_bytes() or b"0")
            content[draw.randrange(len(content))] ^= 0xFF
            path.write_bytes(content)
        yield from ends("damaged cache", 1)
        for path in stored:
            os.utime(path, (2e9, 2e9))
        yield from ends("cache from the future", 2)
        yield from ends("two processes on one cache", 3, 4)


def without_memory(name: str, whole: Path, draw: random.Random) -> list[str]:
    """A command that may take little memory, its workers too; what harm that did."""
    size = draw.randrange(100, 500) * 2**20
    code, messages, found = limited(name, whole, resource.RLIMIT_DATA, size)
    if code in (1, 70, -11):
        found.append(f"code {code}: {messages[-300:]}")
    return [f"{name}, {size // 2**20} MiB of memory: {text}" for text in found]


def main() -> int:
    parser = argparse.ArgumentParser("python -m tests.faults", description=__doc__)
    parser.add_argument("--count", type=int, default=10, help="faults for each command")
    parser.add_argument("--only", choices=[*KINDS], nargs="+", default=[*KINDS])
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    draw, harms = random.Random(given.seed), 0
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        whole = folder / "run.nc"
        started = time.perf_counter()
        code, messages = finish(start(commands(folder)["run"]))
        assert code == 0, messages
        longest = time.perf_counter() - started
        if {*STUDIES} & {*given.only}:
            code, messages = finish(start(commands(folder)["study"]))
            assert code == 0, messages
        for kind in given.only:
            for text in KINDS[kind](whole, longest, draw, given.count):
                harms += 1
                sys.stdout.write(f"{text}\n")
                sys.stdout.flush()
            sys.stdout.write(f"{kind}: done, {harms} faults did harm so far\n")
            sys.stdout.flush()
    return harms


def ends(name: str, whole: Path, longest: float, draw: random.Random, count: int) -> Iterator[str]:
    if name == "reduce":
        longest = _LONGEST
    elif name not in ("run", "study"):
        started = time.perf_counter()
        with tempfile.TemporaryDirectory() as place:
            (Path(place) / "whole.nc").write_bytes(whole.read_bytes())
            process = start(commands(Path(place))[name])
            code, messages = finish(process)
        longest = min(time.perf_counter() - started, _LONGEST)
        if code != 0:
            yield f"{name}, left alone: code {code}: {messages[-300:]}"
    for _ in range(count):
        yield from end_at_random(name, whole, longest, draw)


def hunger(whole: Path, _longest: float, draw: random.Random, _count: int) -> Iterator[str]:
    for name in ("run", "study", "report"):
        for size in (0, 4096, 300_000):
            yield from starve(name, whole, size)
        yield from without_memory(name, whole, draw)


KINDS: Mapping[str, Callable[[Path, float, random.Random, int], Iterator[str]]] = {
    **{name: partial(ends, name) for name in commands(Path()) if name != "cluster"},
    "cluster": on_cluster,
    "page": lambda _whole, _longest, draw, count: (
        text for _ in range(count) for text in end_page(draw)
    ),
    "hunger": hunger,
    "disks": lambda whole, _longest, _draw, _count: on_small_disks(whole),
    "caches": lambda whole, _longest, draw, _count: with_cache(whole, draw),
}
"""Kinds of faults: commands that are ended, files and memory that are short, disks, caches."""


if __name__ == "__main__":
    sys.exit(main())
