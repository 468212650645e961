r"""Conductances of the film on a toothed face between its chambers, recesses and the shaft.

Between parallel rigid faces the Reynolds equation is linear in the pressures round the film,

.. math:: \nabla\cdot\left(\frac{h^3}{12\mu}\nabla p\right) = 0,

so the flows into the film are :math:`Q = \frac{h^3}{12\mu} G p` with a symmetric matrix
:math:`G` of the shape alone. One factorisation gives all its columns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.sparse as sp
import shapely
from scipy.sparse.linalg import splu

from toothspace.core.types import Array, IntArray
from toothspace.films.plane.ring import LateralFilm
from toothspace.films.reynolds.equation import FluidField, film_balance
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.model.description import LumpedLateralFilm
from toothspace.model.film_shapes import FaceOutline
from toothspace.numerics.structured_grid import CellBalance

ROWS_PER_PITCH = 60
LANES = 48
ANGLES_PER_PITCH = 6


@final
@dataclass(frozen=True)
class FaceConductance:
    """Conductances of one face over the angle.

    Parameters
    ----------
    matrix : ndarray, shape (angles, k, k)
        Flow into the film per pressure, over h^3/(12 mu); nodes are the chambers, the recesses
        and the shaft. Rows sum to zero. [-]
    turn : ndarray, shape (angles,)
        Turn of the body from shaft angle zero, along the rotation. [rad]
    drag : float
        Torque on the face per viscosity and speed, times the gap height. [m4]
    """

    matrix: Array
    turn: Array
    drag: float


def face_conductance(
    film: LumpedLateralFilm,
    rows_per_pitch: int = ROWS_PER_PITCH,
    lanes: int = LANES,
    angles: int = ANGLES_PER_PITCH,
) -> FaceConductance:
    """Solve the film on one face of a body for a unit pressure at each of its edges.

    Parameters
    ----------
    film : LumpedLateralFilm
        Film with its outline.
    rows_per_pitch, lanes : int
        Cells on one pitch along the circumference, and along the radius. [-]
    angles : int
        Angles on one pitch, a divisor of ``rows_per_pitch``. [-]

    Returns
    -------
    FaceConductance
        Matrices over one pitch.

    Notes
    -----
    Polar grid; the tip circle is a wall, the shaft, the tooth spaces and recesses have given
    pressures. A relief groove counts as deep: no resistance, no shear.
    """
    assert film.face is not None
    count = film.face.nodes.size
    turns = 2.0 * np.pi / count * np.arange(angles) / angles
    grid = (rows_per_pitch * count, lanes)
    marks = [_marks(film, grid, turn) for turn in turns]
    ring = LateralFilm(
        inner_radius=film.inner_radius,
        outer_radius=film.outer_radius,
        side_gap=1.0,
        fluid=FilmFluid(1.0 / 12.0),
        grid=grid,
        inner_pressure=0.0,
    ).discretise()
    unit = FluidField(np.full(grid, 12.0), np.ones(grid))
    balance = film_balance(ring.grid, ring.gap, unit, 0.0)
    groups = count + len(film.face.recesses) + 1
    arm = np.asarray(ring.points.x**2 + ring.points.y**2) * ring.grid.area
    drag = np.mean([float(arm[mark < 0].sum()) for mark in marks])
    matrix = np.array([_reduced(balance, mark, groups) for mark in marks])
    return FaceConductance(matrix, turns, float(drag))


def _marks(film: LumpedLateralFilm, grid: tuple[int, int], turn: float) -> IntArray:
    """Number of the edge that a cell belongs to, -1 in the film."""
    step = 2.0 * np.pi / grid[0]
    angle = np.asarray((np.arange(grid[0]) + 0.5) * step, dtype=np.float64)
    rim = np.linspace(film.inner_radius, film.outer_radius, grid[1] + 1)
    assert film.face is not None
    return edge_marks(film.face, angle, np.asarray(0.5 * (rim[1:] + rim[:-1])), turn)


def edge_marks(face: FaceOutline, angle: Array, radius: Array, turn: float) -> IntArray:
    """Which edge of the film the points of a face belong to.

    Parameters
    ----------
    face : FaceOutline
        Outline of the body and recesses opposite.
    angle, radius : ndarray
        Table angles and radii of the points. [rad], [m]
    turn : float
        Turn of the body from shaft angle zero, along the rotation. [rad]

    Returns
    -------
    ndarray of int, shape (angles, radii)
        Number of the chamber; after the chambers those of the recesses; -1 in the film.
    """
    at_rest = _points(face.center, face.zero_angle + face.direction * (angle - turn), radius)
    solid = shapely.contains_xy(shapely.Polygon(face.polygon), *at_rest)
    mark = np.where(solid, -1, _nearest_space(face.phases + turn, angle)[:, None])
    here = _points(face.center, face.zero_angle + face.direction * angle, radius)
    for k, (_, outline) in enumerate(face.recesses):
        over = shapely.contains_xy(shapely.Polygon(outline), *here)
        mark[solid & over] = face.nodes.size + k
    return mark.astype(np.int64)


def _points(center: tuple[float, float], angle: Array, radius: Array) -> tuple[Array, Array]:
    x = center[0] + np.outer(np.cos(angle), radius)
    return x, center[1] + np.outer(np.sin(angle), radius)


def _nearest_space(phases: Array, angle: Array) -> IntArray:
    distance = np.abs(np.angle(np.exp(1j * (angle[:, None] - phases))))
    return np.asarray(np.argmin(distance, axis=1), dtype=np.int64)


def _reduced(balance: CellBalance, mark: IntArray, groups: int) -> Array:
    """Conductance matrix of the edges, the film eliminated."""
    free = mark < 0
    number = np.where(free, 0, int(free.sum()) + mark)
    number[free] = np.arange(int(free.sum()))
    inside, size = int(free.sum()), int(free.sum()) + groups
    shaft = np.full(mark.shape[0], size - 1)
    pairs = [
        (np.roll(number, 1, axis=0), number, balance.conductance_x[:-1]),
        (number[:, :-1], number[:, 1:], balance.conductance_y[:, 1:-1]),
        (shaft, number[:, 0], balance.conductance_y[:, 0]),
    ]
    a = np.concatenate([p[0].ravel() for p in pairs])
    b = np.concatenate([p[1].ravel() for p in pairs])
    g = np.concatenate([p[2].ravel() for p in pairs])
    # an edge runs between two cells: on the mean half a cell from the centre in the film
    edge = (
        (np.minimum(a, b) < inside) & (np.maximum(a, b) >= inside) & (np.maximum(a, b) < size - 1)
    )
    g = np.where(a == b, 0.0, np.where(edge, 2.0 * g, g))
    rows, columns = np.concatenate([a, b, a, b]), np.concatenate([a, b, b, a])
    whole = sp.csc_matrix((np.concatenate([g, g, -g, -g]), (rows, columns)), shape=(size, size))
    edges = whole[inside:, :inside]
    pressure = splu(whole[:inside, :inside]).solve(-edges.T.toarray())
    found = whole[inside:, inside:].toarray() + edges @ pressure
    return np.asarray(0.5 * (found + found.T))
