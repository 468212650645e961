r"""Start-up of a machine: breakaway, start-up pressure and its ratio to running pressure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.finding import Finding
from toothspace.core.types import Array

if TYPE_CHECKING:
    import xarray as xr

STANDING = "Turning of a free shaft"
"""What a shaft that does not turn is about."""

_BAR = 1e5
_TURN = 2.0 * np.pi
_SETTLING = 1.0
_SETTLED_SHARE = 0.2
_AT_PLATEAU = 1.0 - 1e-9


def startup_numbers(data: xr.Dataset, breakaway: float) -> dict[str, float]:
    """Numbers of a start from rest, NaN where the shaft never moved or did not start at rest.

    Parameters
    ----------
    breakaway : float
        When the shaft begins to turn, NaN if it never does. [s]

    Returns
    -------
    dict
        ``startup_pressure_bar``: largest pressure difference until the shaft has turned one
        tooth pitch. ``max_running_pressure_bar``: largest moving mean over one pitch, from one
        second after breakaway until the supply slows down. ``startup_pressure_ratio``: one over
        the other. ``breakaway_time_s`` and ``breakaway_pressure_bar``: when the shaft begins to
        turn. ``settled_pressure_bar``: mean over the last fifth of running, and
        ``startup_to_settled_ratio`` with it, which swings after the start do not touch.
    """
    angle = np.asarray(data["shaft_angle"])
    highest = np.asarray(data["pressure_difference_highest"])
    pitch = tooth_pitch(data)
    within_pitch = np.abs(angle - angle[0]) <= pitch
    startup = float(highest[within_pitch].max()) if np.isfinite(breakaway) else np.nan
    running, settled = _running_pressures(data, breakaway, pitch)
    pressure = np.asarray(data["pressure_difference"])
    released = float(np.interp(breakaway, np.asarray(data["time"]), pressure))
    return {
        "startup_pressure_bar": startup / _BAR,
        "max_running_pressure_bar": running / _BAR,
        "startup_pressure_ratio": startup / running if running else np.nan,
        "breakaway_time_s": breakaway,
        "breakaway_pressure_bar": released / _BAR,
        "settled_pressure_bar": settled / _BAR,
        "startup_to_settled_ratio": startup / settled if settled else np.nan,
    }


def standing(data: xr.Dataset) -> Iterator[Finding]:
    """Say that a shaft that is free never turned, or stands still although the supply runs.

    Parameters
    ----------
    data : xarray.Dataset
        Rows over time of a machine with a free shaft.
    """
    speed, time = np.asarray(data["shaft_speed"]), np.asarray(data["time"])
    if speed[-1] != 0.0:
        return
    pressure = np.asarray(data["pressure_difference"])
    if not speed.any():
        reached = f"{float(np.abs(pressure).max()) / _BAR:.4g} bar"
        text = f"The shaft never turns: friction and load hold it against {reached}."
    elif float(np.asarray(data["supply_speed"])[-1]) > 0.0:
        since = float(time[np.flatnonzero(speed)[-1]])
        reached = f"{float(pressure[-1]) / _BAR:.4g} bar"
        text = (
            f"The shaft stands still since {since:.3g} s although the supply runs: friction and "
            f"load hold it against {reached}."
        )
    else:
        return
    yield Finding(
        "warning",
        text,
        quantity=STANDING,
        found="0 rpm",
        allowed="a shaft that turns",
        advice="Raise the opening_pressure of the relief valve or the flow of the supply, let "
        "circuit.duration be longer, or lower the load or the breakaway torque.",
    )


def tooth_pitch(data: xr.Dataset) -> float:
    """Shaft angle from one tooth to the next, from the labels of the chambers. [rad]."""
    labels = [str(label) for label in data["chamber"].values]
    family = labels[0].rpartition("_")[0]
    return _TURN / sum(label.rpartition("_")[0] == family for label in labels)


def moving_mean(time: Array, angle: Array, signal: Array, window: float) -> tuple[Array, Array]:
    """Mean over time of a signal while the shaft turns by a window.

    Parameters
    ----------
    time, angle, signal : ndarray, shape (rows,)
        Time [s], growing shaft angle [rad] and signal.
    window : float
        Angle of the window. [rad]

    Returns
    -------
    time, mean : ndarray
        End of each window that fits in [s], and the mean over it.
    """
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (signal[1:] + signal[:-1]) * np.diff(time))])
    growing = np.maximum.accumulate(angle)
    ends = growing >= growing[0] + window
    begin = np.interp(growing[ends] - window, growing, time)
    duration = np.maximum(time[ends] - begin, 1e-12)
    return time[ends], (whole[ends] - np.interp(begin, time, whole)) / duration


def _running_pressures(data: xr.Dataset, breakaway: float, pitch: float) -> tuple[float, float]:
    """Largest and settled moving mean between start and end of running. [Pa]."""
    time, angle = (np.asarray(data[name]) for name in ("time", "shaft_angle"))
    supply = np.asarray(data["supply_speed"])
    plateau = np.flatnonzero(supply >= _AT_PLATEAU * supply.max())
    end = time[plateau[-1]] if supply.max() > 0.0 else time[-1]
    signal = np.asarray(data["pressure_difference"])
    running = (time >= breakaway) & (time <= end)
    if running.sum() < 2:
        return float("nan"), float("nan")
    at, mean = moving_mean(time[running], angle[running], signal[running], pitch)
    later = at >= breakaway + _SETTLING
    if not later.any():
        return float("nan"), float("nan")
    settled = at >= at[-1] - _SETTLED_SHARE * (at[-1] - breakaway)
    return float(mean[later].max()), float(mean[settled].mean())
