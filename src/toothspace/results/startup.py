r"""Start-up of a machine: breakaway, start-up pressure and its ratio to running pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array

if TYPE_CHECKING:
    import xarray as xr

_BAR = 1e5
_TURN = 2.0 * np.pi
_SETTLING = 1.0
_AT_PLATEAU = 1.0 - 1e-9


def startup_numbers(data: xr.Dataset, breakaway: float) -> dict[str, float]:
    """Numbers of a start from rest, NaN where the shaft never moved or did not start at rest.

    Parameters
    ----------
    data : Dataset
        Result over time.
    breakaway : float
        When the shaft begins to turn, NaN if it never does. [s]

    Returns
    -------
    dict
        ``startup_pressure_bar``: largest pressure difference until the shaft has turned one
        tooth pitch. ``max_running_pressure_bar``: largest moving mean over one pitch, from one
        second after breakaway until the supply slows down. ``startup_pressure_ratio``: one over
        the other. ``breakaway_time_s``.
    """
    angle = np.asarray(data["shaft_angle"])
    highest = np.asarray(data["pressure_difference_highest"])
    pitch = tooth_pitch(data)
    within_pitch = np.abs(angle - angle[0]) <= pitch
    startup = float(highest[within_pitch].max()) if np.isfinite(breakaway) else np.nan
    running = _running_pressure(data, breakaway, pitch)
    return {
        "startup_pressure_bar": startup / _BAR,
        "max_running_pressure_bar": running / _BAR,
        "startup_pressure_ratio": startup / running if running else np.nan,
        "breakaway_time_s": breakaway,
    }


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


def _running_pressure(data: xr.Dataset, breakaway: float, pitch: float) -> float:
    time, angle = (np.asarray(data[name]) for name in ("time", "shaft_angle"))
    supply = np.asarray(data["supply_speed"])
    plateau = np.flatnonzero(supply >= _AT_PLATEAU * supply.max())
    end = time[plateau[-1]] if supply.max() > 0.0 else time[-1]
    if not np.isfinite(breakaway):
        return float("nan")
    signal = np.asarray(data["pressure_difference"])
    running = (time >= breakaway) & (time <= end)
    if running.sum() < 2:
        return float("nan")
    at, mean = moving_mean(time[running], angle[running], signal[running], pitch)
    later = at >= breakaway + _SETTLING
    return float(mean[later].max()) if later.any() else float("nan")
