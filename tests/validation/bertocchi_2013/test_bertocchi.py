"""Pad with a square pocket, mass-conserving cavitation, pressure-dependent liquid."""

from __future__ import annotations

import numpy as np

from toothspace.validation.claim import columns
from toothspace.validation.published_films import bertocchi_pad


def test_pressure_along_the_middle() -> None:
    reference = columns("bertocchi_2013")
    place, published = reference["x"], reference["p_small_pocket"]
    pad = bertocchi_pad()
    film = pad.solve(speed=1.0)
    along = np.interp(place * pad.length, film.x, film.pressure_centerline) / 1e6
    peak = published.max()
    assert film.status.succeeded
    assert film.mass_balance_error < 1e-10
    assert abs(along.max() - peak) < 0.03 * peak
    assert np.sqrt(np.mean((along - published) ** 2)) < 0.03 * peak
    assert 0.1 < film.cavitated_fraction < 0.25
