"""Pad with a square pocket, mass-conserving cavitation, pressure-dependent liquid."""

from __future__ import annotations

import csv

import numpy as np

from toothspace.films.plane.pad import Pad, Pocket
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.validation.claim import data_file


def _reference() -> np.ndarray:
    lines = data_file("bertocchi_2013").read_text().splitlines()
    rows = list(csv.reader(lines))[1:]
    return np.array([[float(text.replace(",", ".")) for text in row] for row in rows])


def test_pressure_along_the_middle() -> None:
    reference = _reference()
    pad = Pad(
        length=20e-3,
        width=10e-3,
        inlet_height=1.1e-6,
        outlet_height=1.0e-6,
        fluid=FilmFluid(0.01, pressure_viscosity=1.2e-8, compressible=True),
        pocket=Pocket(0.4e-6, 4e-3, 6e-3, 7e-3),
        grid=(160, 80),
        ambient_pressure=1e5,
    )
    film = pad.solve(speed=1.0)
    along = np.interp(reference[:, 0] * pad.length, film.x, film.pressure_centerline) / 1e6
    peak = reference[:, 1].max()
    assert film.status.succeeded
    assert film.mass_balance_error < 1e-10
    assert abs(along.max() - peak) < 0.03 * peak
    assert np.sqrt(np.mean((along - reference[:, 1]) ** 2)) < 0.03 * peak
    assert 0.1 < film.cavitated_fraction < 0.25
