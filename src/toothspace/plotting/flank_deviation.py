"""Deviation of flanks from the involute that fits them, as on the sheet of a gear tester."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from toothspace.geometry.involute_fit import InvoluteFit, ProfileDeviation
from toothspace.plotting.style import BLUE, GREY, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEAST_RANGE = 1.0
"""Of the axis, so that a perfect flank looks like one. [um]"""


@styled
def flank_deviation(fits: Mapping[str, InvoluteFit]) -> Figure:
    """Deviation of both flanks of every gear over the roll length, excess material to the right.

    Parameters
    ----------
    fits : mapping
        Fit of each gear by its name.

    Returns
    -------
    Figure
        One row for each gear, root below, tip above.
    """
    figure = new_figure(7.2, 0.8 + 3.2 * len(fits))
    rows = np.reshape(figure.subplots(len(fits), 2, sharey="row", sharex="row"), (-1, 2))
    for (name, fit), row in zip(fits.items(), rows, strict=True):
        _flank(row[0], f"{name}\nleft flank", fit.left)
        _flank(row[1], "right flank", fit.right)
        row[0].set_ylabel("Roll length (mm)")
    return figure


def _flank(axes: Axes, title: str, deviation: ProfileDeviation) -> None:
    axes.axvline(0.0, color=GREY, linewidth=0.8)
    axes.plot(deviation.deviation * 1e6, deviation.roll_length * 1e3, color=BLUE)
    axes.set_title(title)
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, -_LEAST_RANGE), max(high, _LEAST_RANGE))
    axes.locator_params(axis="x", nbins=5)
    axes.set_xlabel(
        f"Deviation (µm)   Fα {1e6 * deviation.total:.2f}, ffα {1e6 * deviation.form:.2f}, "
        f"fHα {1e6 * deviation.slope:.2f}",
        fontsize=8.0,
    )
