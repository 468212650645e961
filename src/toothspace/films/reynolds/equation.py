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

from toothspace.closures.flow_factors import PatternColumns
from toothspace.core.compiled import inlined, kernel, njit
from toothspace.core.types import Array, IntArray
from toothspace.films.reynolds.rough_surfaces import (
    SMOOTH,
    FlowLaw,
    carried_law,
    conductance_law,
    squeeze_law,
    tabulated,
    tabulates,
)
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
def face_values(
    left: float, right: float, law: FlowLaw, columns: PatternColumns, nodes: Array
) -> tuple[float, float]:
    """Conductance and carried height of a face between half cells of gaps left and right.

    The half cells carry the same flow, so their resistances add. [m3, m]
    """
    ratio = left / law.roughness
    if right == left and tabulates(law.table, ratio):
        value, _ = tabulated(law.table, nodes, ratio)
        height, _ = tabulated(law.table, law.table.carried, ratio)
        return value * law.roughness**3, height * law.roughness
    cube, _ = conductance_law(left, law, columns)
    carried, _ = carried_law(left, law)
    if right == left:
        return cube, carried
    other_cube, _ = conductance_law(right, law, columns)
    other_carried, _ = carried_law(right, law)
    total = 1.0 / cube + 1.0 / other_cube
    return 2.0 / total, (carried / cube + other_carried / other_cube) / total


@inlined
def face_variation(
    left: float, right: float, law: FlowLaw, columns: PatternColumns, nodes: Array
) -> tuple[float, float]:
    """Derivatives of :func:`face_values` when both gaps grow alike. [m2, -]."""
    ratio = left / law.roughness
    if right == left and tabulates(law.table, ratio):
        _, slope = tabulated(law.table, nodes, ratio)
        _, height_slope = tabulated(law.table, law.table.carried, ratio)
        return slope * law.roughness**2, height_slope
    cube, cube_slope = conductance_law(left, law, columns)
    carried, carried_slope = carried_law(left, law)
    if right == left:
        return cube_slope, carried_slope
    other_cube, other_cube_slope = conductance_law(right, law, columns)
    other_carried, other_carried_slope = carried_law(right, law)
    resist, other = 1.0 / cube, 1.0 / other_cube
    total = resist + other
    slope, other_slope = -cube_slope * resist**2, -other_cube_slope * other**2
    total_slope = slope + other_slope
    mean = (carried * resist + other_carried * other) / total
    mean_slope = carried_slope * resist + carried * slope
    mean_slope += other_carried_slope * other + other_carried * other_slope
    return -2.0 * total_slope / total**2, (mean_slope - mean * total_slope) / total


@inlined
def smooth_values(left: float, right: float) -> tuple[float, float]:
    """As :func:`face_values` for smooth walls; the tables of a law cost reference counts."""
    if right == left:
        return left * left * left, left
    cube, other = left * left * left, right * right * right
    # carried heights weigh with the resistances: (h1/h1^3 + h2/h2^3) over their sum
    total = 1.0 / cube + 1.0 / other
    return 2.0 / total, (left / cube + right / other) / total


@inlined
def smooth_variation(left: float, right: float) -> tuple[float, float]:
    """As :func:`face_variation` for smooth walls."""
    if right == left:
        return 3.0 * left * left, 1.0
    resist, other = 1.0 / (left * left * left), 1.0 / (right * right * right)
    total = resist + other
    slope, other_slope = -3.0 * resist / left, -3.0 * other / right
    mean = (left * resist + right * other) / total
    mean_slope = left * slope + resist + right * other_slope + other
    total_slope = slope + other_slope
    return -2.0 * total_slope / total**2, (mean_slope - mean * total_slope) / total


@kernel
def _fill_x(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, b: CellBalance, varied: bool
) -> None:
    """Faces of the first index: coefficients, or their derivatives with the gap."""
    rows, lanes = gap.centre.shape
    smooth = law.roughness == 0.0
    for i in range(rows + 1):
        w, e = i - 1, i
        if grid.ring:
            w, e = (i + rows - 1) % rows, i % rows
        w, e = max(w, 0), min(e, rows - 1)
        for j in range(lanes):
            left, right = gap.face_x[i, j] + gap.step[w, j], gap.face_x[i, j] + gap.step[e, j]
            if smooth and varied:
                cube, carried = smooth_variation(left, right)
            elif smooth:
                cube, carried = smooth_values(left, right)
            elif varied:
                cube, carried = face_variation(left, right, law, law.along, law.table.along)
            else:
                cube, carried = face_values(left, right, law, law.along, law.table.along)
            density = 0.5 * (fluid.density[w, j] + fluid.density[e, j])
            fluidity = 0.5 * (fluid.fluidity[w, j] + fluid.fluidity[e, j])
            b.conductance_x[i, j] = density * fluidity * cube / 12.0 * grid.shape_x[i, j]
            b.advection_x[i, j] = density * carried * grid.sweep_x[i, j]


@kernel
def _fill_y(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, b: CellBalance, varied: bool
) -> None:
    """Faces of the second index, as :func:`_fill_x`."""
    rows, lanes = gap.centre.shape
    smooth = law.roughness == 0.0
    for i in range(rows):
        for j in range(lanes + 1):
            s, n = max(j - 1, 0), min(j, lanes - 1)
            left, right = gap.face_y[i, j] + gap.step[i, s], gap.face_y[i, j] + gap.step[i, n]
            if smooth and varied:
                cube, carried = smooth_variation(left, right)
            elif smooth:
                cube, carried = smooth_values(left, right)
            elif varied:
                cube, carried = face_variation(left, right, law, law.across, law.table.across)
            else:
                cube, carried = face_values(left, right, law, law.across, law.table.across)
            density = 0.5 * (fluid.density[i, s] + fluid.density[i, n])
            fluidity = 0.5 * (fluid.fluidity[i, s] + fluid.fluidity[i, n])
            b.conductance_y[i, j] = density * fluidity * cube / 12.0 * grid.shape_y[i, j]
            b.advection_y[i, j] = density * carried * grid.sweep_y[i, j]


@kernel
def _fill_cells(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, b: CellBalance
) -> None:
    rows, lanes = gap.centre.shape
    smooth = law.roughness == 0.0
    for i in range(rows):
        for j in range(lanes):
            rate = gap.rate[i, j]
            if rate != 0.0 and not smooth:
                rate *= squeeze_law(gap.centre[i, j] + gap.step[i, j], law)[0]
            b.storage[i, j] = fluid.density[i, j] * rate * grid.area[i, j]


def ring_grid(rows: int, shape_x: Array, shape_y: Array, sweep_x: Array, area: Array) -> FilmGrid:
    """Grid of a ring of rows that are alike, of free cells with no pressure beyond the edges.

    Parameters
    ----------
    rows : int
        Cells round the ring. [-]
    shape_x, sweep_x, area : ndarray, shape (lanes,)
        As of :class:`FilmGrid`, over the second index. [-, m2/s, m2]
    shape_y : ndarray, shape (lanes + 1,)
        The same. [-]
    """
    lanes = area.size
    return FilmGrid(
        np.tile(shape_x, (rows + 1, 1)),
        np.tile(shape_y, (rows, 1)),
        np.tile(sweep_x, (rows + 1, 1)),
        np.zeros((rows, lanes + 1)),
        np.tile(area, (rows, 1)),
        np.zeros((rows, lanes), dtype=np.int64),
        np.zeros((rows, lanes)),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(rows),
        np.zeros(rows),
        True,
    )


def balance_on_grid(grid: FilmGrid, cavitation_pressure: float) -> CellBalance:
    """Balance of a grid with its given potentials, whose coefficients are still to be filled in.

    Potentials are pressures above the cavitation pressure [Pa], and not below zero.
    """
    given, west, east, south, north = (
        np.maximum(pressure - cavitation_pressure, 0.0)
        for pressure in (grid.prescribed, grid.west, grid.east, grid.south, grid.north)
    )
    x, y, cells = np.empty_like(grid.shape_x), np.empty_like(grid.shape_y), np.zeros_like(grid.area)
    return CellBalance(
        x,
        y,
        x.copy(),
        y.copy(),
        cells,
        cells.copy(),
        grid.mark,
        np.where(grid.mark == PRESCRIBED, given, 0.0),
        west,
        east,
        south,
        north,
        grid.ring,
    )


def film_balance(
    grid: FilmGrid,
    gap: GapField,
    fluid: FluidField,
    cavitation_pressure: float,
    law: FlowLaw = SMOOTH,
) -> CellBalance:
    """Volume balance of every cell at the density of the cavitation pressure.

    Potentials are pressures above the cavitation pressure, given ones not below it: a groove or
    edge of lower pressure holds a cavity. [Pa, m3/s]
    """
    b = balance_on_grid(grid, cavitation_pressure)
    _fill_x(grid, gap, fluid, law, b, False)
    _fill_y(grid, gap, fluid, law, b, False)
    _fill_cells(grid, gap, fluid, law, b)
    return b


@njit
def vary_storage(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, change: GapField, out: Array
) -> None:
    """Fill the change of the storage of every cell with one motion. [m3/s per unit]."""
    rows, lanes = gap.centre.shape
    for i in range(rows):
        for j in range(lanes):
            open_part, curve = squeeze_law(gap.centre[i, j] + gap.step[i, j], law)
            rate = open_part * change.rate[i, j] + curve * gap.rate[i, j] * change.centre[i, j]
            out[i, j] = fluid.density[i, j] * rate * grid.area[i, j]


def balance_derivative(
    grid: FilmGrid, gap: GapField, fluid: FluidField, balance: CellBalance, law: FlowLaw = SMOOTH
) -> CellBalance:
    """Derivatives of the face coefficients with the gap of each face; the same for every motion."""
    b = balance._replace(
        conductance_x=np.empty_like(gap.face_x),
        conductance_y=np.empty_like(gap.face_y),
        advection_x=np.empty_like(gap.face_x),
        advection_y=np.empty_like(gap.face_y),
    )
    _fill_x(grid, gap, fluid, law, b, True)
    _fill_y(grid, gap, fluid, law, b, True)
    return b


def balance_variation(
    grid: FilmGrid,
    gap: GapField,
    fluid: FluidField,
    change: GapField,
    slope: CellBalance,
    law: FlowLaw = SMOOTH,
) -> CellBalance:
    """First variation of the coefficients of a film balance with one rigid motion.

    ``change`` holds the variation of gap and rate per unit of the motion, ``slope`` is
    :func:`balance_derivative`; given pressures and surface speeds do not vary.
    """
    storage = np.empty_like(gap.centre)
    vary_storage(grid, gap, fluid, law, change, storage)
    return slope._replace(
        conductance_x=slope.conductance_x * change.face_x,
        conductance_y=slope.conductance_y * change.face_y,
        advection_x=slope.advection_x * change.face_x,
        advection_y=slope.advection_y * change.face_y,
        storage=storage,
    )
