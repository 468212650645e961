"""From nothing but Python to a report: ``python -m benchmarks.first_contact``.

Builds the wheel, installs it in a fresh environment and prints how long each step took, how much
memory it needed and how large the environment is. The package index that pip is set up with
must answer.
"""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
import venv
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_MEBIBYTE = 2**20
_MEASURED = """
import resource, subprocess, sys
code = subprocess.call(sys.argv[2:])
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
open(sys.argv[1], "w").write(str(peak * (1 if sys.platform == "darwin" else 1024)))
sys.exit(code)
"""
"""Runs a program and writes its peak memory [byte] into a file."""


def build(kind: str, target: Path) -> Path:
    """Build the ``wheel`` or the ``sdist`` of this checkout into a folder."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(target)]
    subprocess.run(command, check=True, cwd=ROOT, capture_output=True)
    (built,) = target.glob("*.whl" if kind == "wheel" else "*.tar.gz")
    return built


class Environment:
    """A fresh environment, and an empty folder to work in that knows of no checkout.

    Parameters
    ----------
    folder : Path
        Where both are made.
    """

    def __init__(self, folder: Path) -> None:
        self.place = folder / "environment"
        self.work = folder / "work"
        self.work.mkdir()
        self.peak = folder / "peak"
        venv.create(self.place, with_pip=True)
        self.programs = self.place / ("Scripts" if os.name == "nt" else "bin")
        hidden = ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "VIRTUAL_ENV")
        self.variables = {name: v for name, v in os.environ.items() if name not in hidden}
        self.variables["TOOTHSPACE_CACHE"] = str(folder / "cache")

    def run(self, program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run a program of the environment in the empty folder."""
        path = shutil.which(program, path=str(self.programs)) or program
        measured = [] if os.name == "nt" else [sys.executable, "-c", _MEASURED, str(self.peak)]
        return subprocess.run(
            [*measured, path, *arguments],
            cwd=self.work,
            env=self.variables,
            capture_output=True,
            text=True,
        )

    def install(self, wheel: Path) -> subprocess.CompletedProcess[str]:
        """Install a wheel with all that it asks for."""
        return self.run("python", "-m", "pip", "install", "--quiet", str(wheel))

    def memory(self) -> float:
        """Peak memory of the last program, NaN where the system does not tell. [byte]."""
        return float(self.peak.read_text()) if self.peak.is_file() else math.nan

    def size(self) -> int:
        """Bytes of the whole environment."""
        return sum(f.lstat().st_size for f in self.place.rglob("*") if not f.is_dir())


def _processor() -> float:
    """Processor time of the programs that have ended; Windows does not tell. [s]."""
    spent = os.times()
    return spent.children_user + spent.children_system


def _timed(environment: Environment, name: str, step: Callable[[], object]) -> float:
    began, spent = time.perf_counter(), _processor()
    done = step()
    if isinstance(done, subprocess.CompletedProcess) and done.returncode:
        sys.exit(f"{name}: {done.stderr}")
    seconds = time.perf_counter() - began
    processor, memory = _processor() - spent, environment.memory() / _MEBIBYTE
    print(f"{name:52s}{seconds:8.1f} s{processor:8.1f} s{memory:8.0f} MiB", flush=True)
    return seconds


def main(commands: Sequence[str] = ()) -> None:
    """Print the table."""
    commands = commands or (
        "init egm12_pump",
        "run egm12_pump.toml",
        "report egm12_pump.nc",
        "run egm12_pump.toml --force",
        "run egm12_pump.toml --force --fidelity films",
        "run egm12_pump.toml --force --fidelity films",
        "bearing journal_bearing",
        "bearing journal_bearing --force",
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wheel = build("wheel", folder)
        print(f"{wheel.name}, {wheel.stat().st_size / _MEBIBYTE:.1f} MiB")
        environment = Environment(folder)
        print(f"{'':52s}{'wall':>10s}{'processor':>10s}{'memory':>11s}")
        total = _timed(environment, "pip install", lambda: environment.install(wheel))
        print(environment.run("toothspace", "--version", "-v").stdout, end="")
        for command in commands:
            arguments = command.split()
            total += _timed(
                environment,
                f"toothspace {command}",
                lambda given=arguments: environment.run("toothspace", *given),  # type: ignore[misc]
            )
        print(f"{'in all':52s}{total:8.1f} s")
        print(f"{'environment':52s}{environment.size() / _MEBIBYTE:8.0f} MiB")


if __name__ == "__main__":
    main()
