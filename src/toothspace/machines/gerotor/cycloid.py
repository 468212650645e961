"""Cycloidal sets: epicycloid teeth and hypocycloid roots of one generating circle."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array


def cycloid(tooth_count: int, rolling_radius: float, points_per_tooth: int) -> Array:
    r"""Closed curve of alternating epi- and hypocycloids.

    Parameters
    ----------
    tooth_count : int
        Teeth (epicycloids) of the curve.
    rolling_radius : float
        Radius of the generating circle, half of the eccentricity. [m]
    points_per_tooth : int
        Points on one epicycloid and one hypocycloid together.

    Returns
    -------
    ndarray, shape (n, 2)
        Closed counter-clockwise curve; the middle of an epicycloid is on the negative y
        axis. [m]

    Notes
    -----
    With the pitch radius :math:`r = 2 z q`:

    .. math::
        p_{epi}(t) = (r+q) e^{it} - q\, e^{i (r+q) t/q}, \qquad
        p_{hypo}(t) = (r-q) e^{it} + q\, e^{-i (r-q) t/q} .
    """
    q, r = rolling_radius, 2.0 * tooth_count * rolling_radius
    half_pitch = np.pi / tooth_count
    count = max(points_per_tooth // 2, 4)
    # points gather at the cusps, where the curvature grows without limit
    share = np.arange(count) / count
    t = half_pitch * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi))
    tip = (r + q) * np.exp(1j * t) - q * np.exp(1j * (r + q) * t / q)
    root = (r - q) * np.exp(1j * t) + q * np.exp(-1j * (r - q) * t / q)
    one = np.concatenate([tip, root * np.exp(1j * half_pitch)])
    places = -0.5 * np.pi + half_pitch * (2.0 * np.arange(tooth_count) - 0.5)
    points = (np.exp(1j * places)[:, None] * one[None, :]).ravel()
    return np.column_stack([points.real, points.imag])
