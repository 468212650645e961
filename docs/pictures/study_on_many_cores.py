"""Picture of the time of a study over cores, for the tutorial on a study on many cores.

Run from the root of the repository: ``python docs/pictures/study_on_many_cores.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from toothspace.plotting.style import CYCLE, GREY, new_figure, save_figure, styled

FIRST, START, POINT = 0.1, 3.3, 2.1
"""First process, start of a worker, one point: the tutorial's measured times. [s]"""
SHARES = {1: 1.0, 2: 0.83, 4: 0.67, 8: 0.55}
"""Measured share of the processor time that went into 16 points, by workers."""


@styled
def draw() -> None:
    """Times by the model, and the share of the time that points take, measured."""
    figure = new_figure(7.2, 2.9)
    left, right = figure.subplots(1, 2)
    cores = np.unique(np.geomspace(1, 64, 49).round().astype(int))
    for count, color in zip((100, 1000, 10_000), CYCLE, strict=False):
        left.loglog(cores, FIRST + START + np.ceil(count / cores) * POINT, color=color)
        left.loglog(cores, count * POINT / cores, "--", color=color, lw=0.8)
        left.text(1.1, 1.15 * count * POINT, f"{count} points", color=color)
    left.set(xlabel="Cores", ylabel="Time (s)", ylim=(3.0, 6e4))
    many = np.linspace(1.0, 8.0, 57)
    right.plot(many, 16 * POINT / (FIRST + START * many + 16 * POINT), color=GREY, label="model")
    right.plot(list(SHARES), list(SHARES.values()), "o", color=CYCLE[0], label="measured")
    right.set(xlabel="Workers on two cores", ylabel="Share spent on 16 points (-)", ylim=(0.0, 1.1))
    right.legend()
    save_figure(figure, Path(__file__).resolve().parent / "study_on_many_cores.png")


if __name__ == "__main__":
    draw()
