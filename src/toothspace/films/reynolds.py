r"""Thin-film flow on structured grids: from gap heights to cell balances and their variation.

The equation is the Reynolds equation

.. math::

    \nabla\cdot\left(-\frac{h^3}{12\mu}\nabla p + s\,\bar{\mathbf v}\,h\right)
        + s\,\frac{\partial h}{\partial t} = 0

with film fraction :math:`s` and mean surface velocity :math:`\bar{\mathbf v}`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array, IntArray
from toothspace.numerics.structured_grid import PRESCRIBED, CellBalance


class FilmGrid(NamedTuple):
    """Metric of a film grid and the motion of its surfaces.

    A face of the first index is crossed along x, of the second along y.
    """

    shape_x: Array  # (rows + 1, lanes) face length over distance of the centres [-]
    shape_y: Array  # (rows, lanes + 1)
    sweep_x: Array  # (rows + 1, lanes) mean normal surface velocity times face length [m2/s]
    sweep_y: Array  # (rows, lanes + 1)
    area: Array  # (rows, lanes) [m2]
    mark: IntArray  # (rows, lanes) FREE or PRESCRIBED
    prescribed: Array  # (rows, lanes) pressure of prescribed cells [Pa]
    west: Array  # (lanes,) pressure beyond the first row [Pa]
    east: Array
    south: Array  # (rows,)
    north: Array
    ring: bool


class GapField(NamedTuple):
    """Gap heights at centres and faces, or their variation with one motion."""

    centre: Array  # (rows, lanes), without step [m]
    face_x: Array  # (rows + 1, lanes) [m]
    face_y: Array  # (rows, lanes + 1) [m]
    rate: Array  # (rows, lanes) time derivative at the centres [m/s]
    step: Array  # (rows, lanes) extra depth of the whole cell, as of a pocket [m]


class FluidField(NamedTuple):
    """Fluid state of every cell."""

    fluidity: Array  # (rows, lanes) inverse of the dynamic viscosity [1/(Pa s)]
    density: Array  # (rows, lanes) over the density at cavitation pressure [-]


@inlined
def face_values(left: float, right: float) -> tuple[float, float]:
    """Cube and mean gap height of a face between half cells of gaps left and right.

    The half cells carry the same flow, so their resistances add. [m3, m]
    """
    resist_left = 1.0 / left**3
    resist_right = 1.0 / right**3
    total = resist_left + resist_right
    return 2.0 / total, (left * resist_left + right * resist_right) / total


@inlined
def face_variation(left: float, right: float, change: float) -> tuple[float, float]:
    """Variation of :func:`face_values` when both gaps grow by a small change. [m3, m]."""
    resist_left = 1.0 / left**3
    resist_right = 1.0 / right**3
    total = resist_left + resist_right
    slope_left = -3.0 * resist_left / left
    slope_right = -3.0 * resist_right / right
    slope_total = slope_left + slope_right
    carried = left * resist_left + right * resist_right
    slope_carried = resist_left + left * slope_left + resist_right + right * slope_right
    cube = -2.0 * slope_total / total**2
    mean = (slope_carried - carried * slope_total / total) / total
    return cube * change, mean * change


@njit(cache=True)
def _fill_faces(grid: FilmGrid, gap: GapField, fluid: FluidField, b: CellBalance) -> None:
    rows, lanes = gap.centre.shape
    for i in range(rows + 1):
        w, e = i - 1, i
        if grid.ring:
            w, e = (i + rows - 1) % rows, i % rows
        w, e = max(w, 0), min(e, rows - 1)
        for j in range(lanes):
            h = gap.face_x[i, j]
            cube, mean = face_values(h + gap.step[w, j], h + gap.step[e, j])
            density = 0.5 * (fluid.density[w, j] + fluid.density[e, j])
            fluidity = 0.5 * (fluid.fluidity[w, j] + fluid.fluidity[e, j])
            b.conductance_x[i, j] = density * fluidity * cube / 12.0 * grid.shape_x[i, j]
            b.advection_x[i, j] = density * mean * grid.sweep_x[i, j]
    for i in range(rows):
        for j in range(lanes + 1):
            s, n = max(j - 1, 0), min(j, lanes - 1)
            h = gap.face_y[i, j]
            cube, mean = face_values(h + gap.step[i, s], h + gap.step[i, n])
            density = 0.5 * (fluid.density[i, s] + fluid.density[i, n])
            fluidity = 0.5 * (fluid.fluidity[i, s] + fluid.fluidity[i, n])
            b.conductance_y[i, j] = density * fluidity * cube / 12.0 * grid.shape_y[i, j]
            b.advection_y[i, j] = density * mean * grid.sweep_y[i, j]


@njit(cache=True)
def _fill_cells(grid: FilmGrid, gap: GapField, fluid: FluidField, b: CellBalance) -> None:
    rows, lanes = gap.centre.shape
    for i in range(rows):
        for j in range(lanes):
            b.storage[i, j] = fluid.density[i, j] * gap.rate[i, j] * grid.area[i, j]


def film_balance(
    grid: FilmGrid, gap: GapField, fluid: FluidField, cavitation_pressure: float
) -> CellBalance:
    """Volume balance of every cell at the density of the cavitation pressure.

    Potentials are pressures above the cavitation pressure. [Pa, m3/s]
    """
    b = CellBalance(
        np.empty_like(gap.face_x),
        np.empty_like(gap.face_y),
        np.empty_like(gap.face_x),
        np.empty_like(gap.face_y),
        np.empty_like(gap.centre),
        np.zeros_like(gap.centre),
        grid.mark,
        np.where(grid.mark == PRESCRIBED, grid.prescribed - cavitation_pressure, 0.0),
        grid.west - cavitation_pressure,
        grid.east - cavitation_pressure,
        grid.south - cavitation_pressure,
        grid.north - cavitation_pressure,
        grid.ring,
    )
    _fill_faces(grid, gap, fluid, b)
    _fill_cells(grid, gap, fluid, b)
    return b


@njit(cache=True)
def _vary_x(
    grid: FilmGrid, gap: GapField, fluid: FluidField, change: GapField, b: CellBalance
) -> None:
    rows, lanes = gap.centre.shape
    for i in range(rows + 1):
        w, e = i - 1, i
        if grid.ring:
            w, e = (i + rows - 1) % rows, i % rows
        w, e = max(w, 0), min(e, rows - 1)
        for j in range(lanes):
            h = gap.face_x[i, j]
            cube, mean = face_variation(h + gap.step[w, j], h + gap.step[e, j], change.face_x[i, j])
            density = 0.5 * (fluid.density[w, j] + fluid.density[e, j])
            fluidity = 0.5 * (fluid.fluidity[w, j] + fluid.fluidity[e, j])
            b.conductance_x[i, j] = density * fluidity * cube / 12.0 * grid.shape_x[i, j]
            b.advection_x[i, j] = density * mean * grid.sweep_x[i, j]


@njit(cache=True)
def _vary_y(
    grid: FilmGrid, gap: GapField, fluid: FluidField, change: GapField, b: CellBalance
) -> None:
    rows, lanes = gap.centre.shape
    for i in range(rows):
        for j in range(lanes + 1):
            s, n = max(j - 1, 0), min(j, lanes - 1)
            h = gap.face_y[i, j]
            cube, mean = face_variation(h + gap.step[i, s], h + gap.step[i, n], change.face_y[i, j])
            density = 0.5 * (fluid.density[i, s] + fluid.density[i, n])
            fluidity = 0.5 * (fluid.fluidity[i, s] + fluid.fluidity[i, n])
            b.conductance_y[i, j] = density * fluidity * cube / 12.0 * grid.shape_y[i, j]
            b.advection_y[i, j] = density * mean * grid.sweep_y[i, j]


def balance_variation(
    grid: FilmGrid, gap: GapField, fluid: FluidField, change: GapField, balance: CellBalance
) -> CellBalance:
    """First variation of the coefficients of a film balance with the gap.

    ``change`` holds the variation of gap and rate per unit of a rigid motion; advection
    follows the given pressures and surfaces, which do not vary.
    """
    b = balance._replace(
        conductance_x=np.empty_like(gap.face_x),
        conductance_y=np.empty_like(gap.face_y),
        advection_x=np.empty_like(gap.face_x),
        advection_y=np.empty_like(gap.face_y),
        storage=fluid.density * change.rate * grid.area,
    )
    _vary_x(grid, gap, fluid, change, b)
    _vary_y(grid, gap, fluid, change, b)
    return b
