"""Time of the command line until it answers."""

from __future__ import annotations

import subprocess
import sys
import time


def main(repeats: int = 5) -> None:
    """Print the best time of ``toothspace --help``."""
    command = [sys.executable, "-m", "toothspace", "--help"]
    seconds = []
    for _ in range(repeats):
        began = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        seconds.append(time.perf_counter() - began)
    print("Command line")
    print(f"{'toothspace --help':18s}{min(seconds):9.3f} s")
