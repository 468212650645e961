r"""Balance of a film between compliant faces and its derivative with the gap, where there is film.

Pressure that steps from one cell to the next opens the gap in a step too, and a conductance taken
at one side or at the mean gap then lets the flow fall as the pressure rises: solutions multiply.
The mean of the conductances of both cells is the trapezoidal rule of

.. math::

    q \propto \int K(h(p))\,\mathrm dp,

which always grows with the pressure, so that the matrix of Newton's method is one of diffusion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.closures.flow_factors import PatternColumns
from toothspace.core.compiled import inlined, kernel, njit
from toothspace.core.types import Array, IntArray
from toothspace.films.reynolds.equation import FilmGrid, FluidField, GapField, balance_on_grid
from toothspace.films.reynolds.rough_surfaces import (
    FlowLaw,
    carried_law,
    conductance_law,
    squeeze_law,
    tabulated,
    tabulates,
)
from toothspace.numerics.structured_grid import CellBalance


class GapSlopes(NamedTuple):
    """Change of the coefficients with the gap of one of the two cells of a face. [m2, -]."""

    west: Array  # (rows + 1, lanes) conductance, gap of the cell before
    east: Array  # gap of the cell behind
    carried: Array  # advection, gap of the cell upstream
    south: Array  # (rows, lanes + 1)
    north: Array


class Linearised(NamedTuple):
    """Coefficients of a balance, and their derivatives."""

    balance: CellBalance
    slope: GapSlopes
    squeeze: Array  # (rows, lanes) storage over the rate of the gap [m2]
    squeeze_slope: Array  # change of the storage with the gap [m2/s]


class DeformedGap(NamedTuple):
    """Gap of a ring of cells between compliant faces."""

    rigid: GapField  # undeformed; its steps are not used
    opening: Array  # (rows, lanes) deformation [m]
    edge: Array  # (2, rows) deformation at the inner and at the outer rim [m]


class GapMotion(NamedTuple):
    """Motion of a face."""

    lift: GapField  # change of the undeformed gap and of its rate, per unit
    follows: Array  # change of the gap of a cell over that of its undeformed height [-]


class _Cells(NamedTuple):
    """Cube of the gap times flow factor along and across [m3], and their slopes. [m2]."""

    along: Array
    along_slope: Array
    across: Array
    across_slope: Array


@inlined
def _squeeze(gap: float, law: FlowLaw) -> tuple[float, float]:
    if law.roughness == 0.0:
        return 1.0, 0.0
    ratio = gap / law.roughness
    if tabulates(law.table, ratio):
        value, slope = tabulated(law.table, law.table.squeeze, ratio)
        return value, slope / law.roughness
    return squeeze_law(gap, law)


@inlined
def _conductance(
    gap: float, law: FlowLaw, columns: PatternColumns, nodes: Array
) -> tuple[float, float]:
    if law.roughness == 0.0:
        return gap * gap * gap, 3.0 * gap * gap
    ratio = gap / law.roughness
    if tabulates(law.table, ratio):
        value, slope = tabulated(law.table, nodes, ratio)
        return value * law.roughness**3, slope * law.roughness**2
    return conductance_law(gap, law, columns)


@inlined
def _carried(gap: float, law: FlowLaw) -> tuple[float, float]:
    if law.roughness == 0.0:
        return gap, 1.0
    ratio = gap / law.roughness
    if tabulates(law.table, ratio):
        value, slope = tabulated(law.table, law.table.carried, ratio)
        return value * law.roughness, slope
    return carried_law(gap, law)


@kernel
def _fill_cells(mark: IntArray, gap: DeformedGap, law: FlowLaw, alike: bool, cells: _Cells) -> None:
    """Conductances of the film and of the cells beside it; ``alike``: both ways the same."""
    rows, lanes = gap.opening.shape
    for i in range(rows):
        for j in range(lanes):
            bare = mark[i, j] == 2 and mark[(i + 1) % rows, j] == 2 and mark[i - 1, j] == 2
            bare = bare and mark[i, max(j - 1, 0)] == 2 and mark[i, min(j + 1, lanes - 1)] == 2
            if bare:
                continue
            h = gap.rigid.centre[i, j] + gap.opening[i, j]
            cube, slope = _conductance(h, law, law.along, law.table.along)
            cells.along[i, j], cells.along_slope[i, j] = cube, slope
            if not alike:
                cube, slope = _conductance(h, law, law.across, law.table.across)
            cells.across[i, j], cells.across_slope[i, j] = cube, slope


@kernel
def _fill_along(
    grid: FilmGrid,
    gap: DeformedGap,
    fluid: FluidField,
    law: FlowLaw,
    cells: _Cells,
    out: Linearised,
) -> None:
    """Faces of the first index between cells of which at least one holds film."""
    rows, lanes = gap.opening.shape
    b, slope = out.balance, out.slope
    for i in range(rows + 1):
        w, e = (i + rows - 1) % rows, i % rows
        for j in range(lanes):
            if grid.mark[w, j] == 2 and grid.mark[e, j] == 2:
                b.conductance_x[i, j], b.advection_x[i, j] = 0.0, 0.0
                slope.west[i, j], slope.east[i, j], slope.carried[i, j] = 0.0, 0.0, 0.0
                continue
            up = w if grid.sweep_x[i, j] >= 0.0 else e
            height, height_slope = _carried(gap.rigid.face_x[i, j] + gap.opening[up, j], law)
            density = 0.5 * (fluid.density[w, j] + fluid.density[e, j])
            fluidity = 0.5 * (fluid.fluidity[w, j] + fluid.fluidity[e, j])
            flow = density * fluidity / 24.0 * grid.shape_x[i, j]
            sweep = density * grid.sweep_x[i, j]
            b.conductance_x[i, j] = flow * (cells.along[w, j] + cells.along[e, j])
            b.advection_x[i, j] = sweep * height
            slope.west[i, j] = flow * cells.along_slope[w, j]
            slope.east[i, j] = flow * cells.along_slope[e, j]
            slope.carried[i, j] = sweep * height_slope


@kernel
def _fill_across(
    grid: FilmGrid,
    gap: DeformedGap,
    fluid: FluidField,
    law: FlowLaw,
    cells: _Cells,
    out: Linearised,
) -> None:
    """Faces of the second index, as :func:`_fill_along`; the rims have gaps of their own."""
    rows, lanes = gap.opening.shape
    b, slope = out.balance, out.slope
    for i in range(rows):
        for j in range(lanes + 1):
            s, n = max(j - 1, 0), min(j, lanes - 1)
            if grid.mark[i, s] == 2 and grid.mark[i, n] == 2:
                b.conductance_y[i, j], slope.south[i, j], slope.north[i, j] = 0.0, 0.0, 0.0
                continue
            density = 0.5 * (fluid.density[i, s] + fluid.density[i, n])
            fluidity = 0.5 * (fluid.fluidity[i, s] + fluid.fluidity[i, n])
            flow = density * fluidity / 24.0 * grid.shape_y[i, j]
            before, before_slope = cells.across[i, s], cells.across_slope[i, s]
            behind, behind_slope = cells.across[i, n], cells.across_slope[i, n]
            if j == 0:
                rim = gap.rigid.face_y[i, j] + gap.edge[0, i]
                before, before_slope = _conductance(rim, law, law.across, law.table.across)
            elif j == lanes:
                rim = gap.rigid.face_y[i, j] + gap.edge[1, i]
                behind, behind_slope = _conductance(rim, law, law.across, law.table.across)
            b.conductance_y[i, j] = flow * (before + behind)
            slope.south[i, j], slope.north[i, j] = flow * before_slope, flow * behind_slope


@kernel
def _fill_squeeze(
    grid: FilmGrid, gap: DeformedGap, fluid: FluidField, law: FlowLaw, out: Linearised
) -> None:
    rows, lanes = gap.opening.shape
    for i in range(rows):
        for j in range(lanes):
            if grid.mark[i, j] == 2:
                out.balance.storage[i, j] = out.squeeze[i, j] = out.squeeze_slope[i, j] = 0.0
                continue
            factor, slope = _squeeze(gap.rigid.centre[i, j] + gap.opening[i, j], law)
            rate, held = gap.rigid.rate[i, j], fluid.density[i, j] * grid.area[i, j]
            out.squeeze[i, j] = held * factor
            out.squeeze_slope[i, j] = held * rate * slope
            out.balance.storage[i, j] = held * rate * factor


def linearised_balance(
    grid: FilmGrid,
    gap: DeformedGap,
    fluid: FluidField,
    cavitation_pressure: float,
    law: FlowLaw,
    former: CellBalance | None = None,
) -> Linearised:
    """Balance of a ring of cells and how it follows the gaps.

    Faces between two prescribed cells conduct and carry nothing, and prescribed cells store
    nothing.

    Parameters
    ----------
    grid : FilmGrid
        Metric and given pressures.
    gap : DeformedGap
        Gap with its deformation. [m]
    fluid : FluidField
        Fluid of the cells.
    cavitation_pressure : float
        Absolute pressure at which the potential is zero. [Pa]
    law : FlowLaw
        Average flow between the walls.
    former : CellBalance, optional
        Balance with the same given pressures.
    """
    x, y, shape = gap.rigid.face_x.shape, gap.rigid.face_y.shape, gap.opening.shape
    if former is None:
        former = balance_on_grid(grid, cavitation_pressure)
        former.advection_y[:] = 0.0
    balance = former._replace(
        conductance_x=np.empty(x),
        conductance_y=np.empty(y),
        advection_x=np.empty(x),
        storage=np.empty(shape),
    )
    slope = GapSlopes(*map(np.empty, (x, x, x, y, y)))
    out = Linearised(balance, slope, np.empty(shape), np.empty(shape))
    cells = _Cells(*(np.empty(gap.opening.shape) for _ in range(4)))
    _fill_cells(grid.mark, gap, law, np.array_equal(law.table.along, law.table.across), cells)
    _fill_along(grid, gap, fluid, law, cells, out)
    _fill_across(grid, gap, fluid, law, cells, out)
    _fill_squeeze(grid, gap, fluid, law, out)
    return out


@njit(nogil=True, error_model="numpy")
def flow_change(
    found: Linearised,
    sweep_x: Array,
    motion: GapMotion,
    potential: Array,
    saturation: Array,
    own: Array,
    out: Array,
) -> None:
    """Net flow out of every cell that one motion of a face causes at given potentials. [m3/s].

    Parameters
    ----------
    found : Linearised
        Balance and its slopes.
    sweep_x : ndarray
        Motion of the face across the faces of the first index. [m2/s]
    motion : GapMotion
        What moves, per unit.
    potential, saturation : ndarray
        Fields that the balance was solved for. [Pa, -]
    own : ndarray
        Part of the motion that the gap follows. [m per unit]
    out : ndarray
        The flows, filled.
    """
    b, slope, lift = found.balance, found.slope, motion.lift
    rows, lanes = potential.shape
    for i in range(rows):
        for j in range(lanes):
            rate = found.squeeze[i, j] * lift.rate[i, j] + found.squeeze_slope[i, j] * own[i, j]
            out[i, j] = saturation[i, j] * rate
    for i in range(rows):
        w = (i + rows - 1) % rows
        for j in range(lanes):
            up = w if sweep_x[i, j] >= 0.0 else i
            carried = saturation[w, j] if b.advection_x[i, j] > 0.0 else saturation[i, j]
            height = lift.face_x[i, j] + own[up, j] - lift.centre[up, j]
            conducted = slope.west[i, j] * own[w, j] + slope.east[i, j] * own[i, j]
            flow = conducted * (potential[w, j] - potential[i, j])
            flow += slope.carried[i, j] * height * carried
            out[i, j] -= flow
            out[w, j] += flow
        for j in range(lanes + 1):
            before = own[i, j - 1] if j > 0 else lift.face_y[i, 0]
            behind = own[i, j] if j < lanes else lift.face_y[i, lanes]
            below = potential[i, j - 1] if j > 0 else b.south[i]
            above = potential[i, j] if j < lanes else b.north[i]
            flow = (slope.south[i, j] * before + slope.north[i, j] * behind) * (below - above)
            if j > 0:
                out[i, j - 1] += flow
            if j < lanes:
                out[i, j] -= flow
