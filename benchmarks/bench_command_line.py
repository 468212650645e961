"""Time of the command line until it answers."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CASE = Path(__file__).parents[1] / "cases" / "egm12_pump.toml"


def main(repeats: int = 5) -> None:
    """Print the best time of ``toothspace --help`` and of a run, from start to exit.

    The first of the runs is not counted: it may compile. Python keeps the bytecode of what it
    imports, as it does for who installs; without that a run takes nearly twice as long.
    """
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    print("Command line")
    with tempfile.TemporaryDirectory() as folder:
        run = ["run", str(CASE), "-o", str(Path(folder) / "result.nc"), "--force"]
        for name, words in (("--help", ["--help"]), ("run egm12_pump", run)):
            seconds = []
            for _ in range(repeats + 1):
                began = time.perf_counter()
                command = [sys.executable, "-m", "toothspace", *words]
                subprocess.run(command, check=True, capture_output=True, env=environment)
                seconds.append(time.perf_counter() - began)
            print(f"{'toothspace ' + name:26s}{min(seconds[1:]):9.3f} s")


if __name__ == "__main__":
    main()
