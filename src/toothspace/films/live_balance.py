"""Balance of a film and its derivative with the gap in one pass, where there is film."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.closures.flow_factors import PatternColumns
from toothspace.core.compiled import inlined, kernel
from toothspace.core.types import Array
from toothspace.films.reynolds import (
    FilmGrid,
    FluidField,
    GapField,
    face_values,
    face_variation,
    gauge_pressure,
    smooth_values,
    smooth_variation,
)
from toothspace.films.rough_surfaces import FlowLaw, squeeze_law, tabulated, tabulates
from toothspace.numerics.structured_grid import PRESCRIBED, CellBalance


class Linearised(NamedTuple):
    """Coefficients of a balance, and the derivatives of its faces with their gaps."""

    balance: CellBalance
    slope: CellBalance


@inlined
def _face(
    left: float, right: float, law: FlowLaw, columns: PatternColumns, nodes: Array
) -> tuple[float, float, float, float]:
    """Conductance [m3] and carried height [m] of a face, and their derivatives. [m2, -]."""
    if law.roughness == 0.0:
        cube, carried = smooth_values(left, right)
        cube_slope, carried_slope = smooth_variation(left, right)
        return cube, carried, cube_slope, carried_slope
    ratio = left / law.roughness
    if right == left and tabulates(law.table, ratio):
        value, slope = tabulated(law.table, nodes, ratio)
        height, height_slope = tabulated(law.table, law.table.carried, ratio)
        size = law.roughness
        return value * size**3, height * size, slope * size**2, height_slope
    cube, carried = face_values(left, right, law, columns, nodes)
    cube_slope, carried_slope = face_variation(left, right, law, columns, nodes)
    return cube, carried, cube_slope, carried_slope


@kernel
def _fill_along(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, out: Linearised
) -> None:
    """Faces of the first index between cells of which at least one holds film."""
    rows, lanes = gap.centre.shape
    b, slope = out
    for i in range(rows + 1):
        w, e = i - 1, i
        if grid.ring:
            w, e = (i + rows - 1) % rows, i % rows
        w, e = max(w, 0), min(e, rows - 1)
        for j in range(lanes):
            if grid.mark[w, j] == 2 and grid.mark[e, j] == 2:
                b.conductance_x[i, j], b.advection_x[i, j] = 0.0, 0.0
                slope.conductance_x[i, j], slope.advection_x[i, j] = 0.0, 0.0
                continue
            left, right = gap.face_x[i, j] + gap.step[w, j], gap.face_x[i, j] + gap.step[e, j]
            cube, carried, cube_slope, carried_slope = _face(
                left, right, law, law.along, law.table.along
            )
            density = 0.5 * (fluid.density[w, j] + fluid.density[e, j])
            fluidity = 0.5 * (fluid.fluidity[w, j] + fluid.fluidity[e, j])
            flow = density * fluidity / 12.0 * grid.shape_x[i, j]
            sweep = density * grid.sweep_x[i, j]
            b.conductance_x[i, j], b.advection_x[i, j] = flow * cube, sweep * carried
            slope.conductance_x[i, j] = flow * cube_slope
            slope.advection_x[i, j] = sweep * carried_slope


@kernel
def _fill_across(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, out: Linearised
) -> None:
    """Faces of the second index, as :func:`_fill_along`."""
    rows, lanes = gap.centre.shape
    b, slope = out
    for i in range(rows):
        for j in range(lanes + 1):
            s, n = max(j - 1, 0), min(j, lanes - 1)
            if grid.mark[i, s] == 2 and grid.mark[i, n] == 2:
                b.conductance_y[i, j], b.advection_y[i, j] = 0.0, 0.0
                slope.conductance_y[i, j], slope.advection_y[i, j] = 0.0, 0.0
                continue
            left, right = gap.face_y[i, j] + gap.step[i, s], gap.face_y[i, j] + gap.step[i, n]
            cube, carried, cube_slope, carried_slope = _face(
                left, right, law, law.across, law.table.across
            )
            density = 0.5 * (fluid.density[i, s] + fluid.density[i, n])
            fluidity = 0.5 * (fluid.fluidity[i, s] + fluid.fluidity[i, n])
            flow = density * fluidity / 12.0 * grid.shape_y[i, j]
            sweep = density * grid.sweep_y[i, j]
            b.conductance_y[i, j], b.advection_y[i, j] = flow * cube, sweep * carried
            slope.conductance_y[i, j] = flow * cube_slope
            slope.advection_y[i, j] = sweep * carried_slope


@kernel
def _fill_squeeze(
    grid: FilmGrid, gap: GapField, fluid: FluidField, law: FlowLaw, storage: Array
) -> None:
    rows, lanes = gap.centre.shape
    for i in range(rows):
        for j in range(lanes):
            rate = gap.rate[i, j]
            if rate == 0.0 or grid.mark[i, j] == 2:
                storage[i, j] = 0.0
                continue
            if law.roughness > 0.0:
                rate *= squeeze_law(gap.centre[i, j] + gap.step[i, j], law)[0]
            storage[i, j] = fluid.density[i, j] * rate * grid.area[i, j]


def linearised_balance(
    grid: FilmGrid, gap: GapField, fluid: FluidField, cavitation_pressure: float, law: FlowLaw
) -> Linearised:
    """As film_balance and balance_derivative of the film, at about half of their cost.

    Faces between two prescribed cells conduct and carry nothing, and prescribed cells store
    nothing. [Pa, m3/s]
    """
    x, y = gap.face_x, gap.face_y
    balance = CellBalance(
        np.empty_like(x),
        np.empty_like(y),
        np.empty_like(x),
        np.empty_like(y),
        np.empty_like(gap.centre),
        np.zeros_like(gap.centre),
        grid.mark,
        np.where(grid.mark == PRESCRIBED, gauge_pressure(grid.prescribed, cavitation_pressure), 0),
        gauge_pressure(grid.west, cavitation_pressure),
        gauge_pressure(grid.east, cavitation_pressure),
        gauge_pressure(grid.south, cavitation_pressure),
        gauge_pressure(grid.north, cavitation_pressure),
        grid.ring,
    )
    slope = balance._replace(
        conductance_x=np.empty_like(x),
        conductance_y=np.empty_like(y),
        advection_x=np.empty_like(x),
        advection_y=np.empty_like(y),
    )
    out = Linearised(balance, slope)
    _fill_along(grid, gap, fluid, law, out)
    _fill_across(grid, gap, fluid, law, out)
    _fill_squeeze(grid, gap, fluid, law, balance.storage)
    return out
