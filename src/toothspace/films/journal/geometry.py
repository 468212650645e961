r"""Definition of a journal bearing, the gap between shaft and bush, and the integrals over it.

Angle :math:`\varphi` runs from x towards y about the bush axis, :math:`z` along it from the
middle of the bush. With the displacement :math:`(x, y)` and the rotation
:math:`(\alpha, \beta)` of the shaft about the x and y axis the gap height is

.. math::

    h = c - (x + \beta z)\cos\varphi - (y - \alpha z)\sin\varphi .
"""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import NamedTuple, final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.films.definitions import Groove, Lobes, RoughSurfaces
from toothspace.films.reynolds.equation import FilmGrid, GapField, ring_grid
from toothspace.films.reynolds.fluid import CAVITATION, FilmFluid
from toothspace.films.reynolds.rough_surfaces import FlowLaw, pressure_stress, stress_factors
from toothspace.numerics.banded import check_grid

_CHOICES = {
    "cavitation": set(CAVITATION),
    "end_condition": {"pressure", "no_flow"},
    "supply": {"auto", "none", "widest_gap"},
}


@dataclass(frozen=True, kw_only=True)
class JournalDefinition:
    """What is known of a journal bearing before its film is solved.

    The fields are the parameters of :class:`~toothspace.films.journal.bearing.JournalBearing`.
    """

    diameter: float
    length: float
    radial_clearance: float
    dynamic_viscosity: float
    grid: tuple[int, int] = (200, 53)
    cavitation: str = "jfo"
    grooves: tuple[Groove, ...] = ()
    end_pressure: float = ATMOSPHERIC_PRESSURE
    cavitation_pressure: float = ATMOSPHERIC_PRESSURE
    end_condition: str = "pressure"
    surfaces: RoughSurfaces | None = None
    lobes: Lobes | None = None
    supply: str = "auto"
    pressure_viscosity: float = 0.0
    compressible: bool = False

    def __post_init__(self) -> None:
        for key in ("diameter", "length", "radial_clearance", "dynamic_viscosity"):
            value = getattr(self, key)
            if not (isinstance(value, Real) and float(value) > 0.0):
                raise CaseError(f"bearing.{key}", f"{value!r}", "are positive SI numbers")
        for key, allowed in _CHOICES.items():
            value = getattr(self, key)
            if value not in allowed:
                raise CaseError(f"bearing.{key}", f"{value!r}", f"are {sorted(allowed)}")
        for groove in self.grooves:
            if abs(groove.position) >= 0.5 * (self.length + groove.length):
                raise CaseError(
                    "bearing.grooves.position",
                    f"{1000.0 * groove.position:g} mm",
                    f"are grooves on the bearing of {1000.0 * self.length:g} mm",
                )
        if np.shape(self.grid) != (2,) or min(self.grid) < 4:
            raise CaseError("bearing.grid", f"{self.grid!r}", "are 4 cells or more")
        check_grid("bearing.grid", self.grid)
        object.__setattr__(self, "grooves", tuple(self.grooves))

    @property
    def fluid(self) -> FilmFluid:
        """Liquid of the film."""
        return FilmFluid(self.dynamic_viscosity, self.pressure_viscosity, self.compressible)


class JournalMesh(NamedTuple):
    """Cells of the developed film; half of it if the middle plane is a mirror."""

    angle: Array  # (rows,) centres [rad]
    angle_step: float  # [rad]
    axial: Array  # (lanes,) centres [m]
    axial_face: Array  # (lanes + 1,) [m]
    weight: float  # 2 for half a film, else 1


@final
@dataclass(frozen=True)
class SurfaceSpeed:
    """Rotation of shaft and bush. [rad/s]."""

    shaft: float
    bush: float = 0.0


class MotionState(NamedTuple):
    """Rigid motion of the shaft against the bush: x, y [m], rotations about x and y [rad]."""

    place: Array  # (4,)
    speed: Array  # (4,) their time derivatives


def journal_mesh(
    length: float, grid: tuple[int, int], first_angle: float, *, half: bool
) -> JournalMesh:
    """Return uniform cells from a first angle; half a film keeps the cells with z >= 0.

    With an odd number of lanes the middle cell is cut in half, its centre stays in the
    mirror plane; results on half and whole grids are then identical.
    """
    rows, lanes = grid
    step = 2.0 * np.pi / rows
    faces = np.asarray(length * (np.arange(lanes + 1) / lanes - 0.5), dtype=np.float64)
    centres = 0.5 * (faces[1:] + faces[:-1])
    if half:
        first = lanes // 2
        centres = centres[first:]
        faces = faces[first:].copy()
        centres[0] = max(centres[0], 0.0) if lanes % 2 == 0 else 0.0
        faces[0] = 0.0
    angle = np.asarray(first_angle + step * np.arange(rows), dtype=np.float64)
    axial = np.asarray(centres, dtype=np.float64)
    return JournalMesh(angle, step, axial, faces, 2.0 if half else 1.0)


class EndConditions(NamedTuple):
    """Pressures beyond the two ends of the bush, or walls."""

    south: float  # at z = -length/2 [Pa]
    north: float  # at z = +length/2 [Pa]
    wall: bool  # no flow through the ends


def journal_grid(
    mesh: JournalMesh, radius: float, grooves: tuple[Groove, ...], ends: EndConditions
) -> FilmGrid:
    """Metric of the film; unit mean surface speed, to be scaled by half the surface speed."""
    lanes = mesh.axial.size
    widths = np.diff(mesh.axial_face)
    along = radius * mesh.angle_step
    distance = np.empty(lanes + 1)
    distance[1:-1] = np.diff(mesh.axial)
    distance[0] = mesh.axial[0] - mesh.axial_face[0]
    distance[-1] = mesh.axial_face[-1] - mesh.axial[-1]
    closed = np.zeros(lanes + 1, dtype=bool)
    closed[[0, -1]] = ends.wall
    closed[0] |= mesh.weight > 1.0
    across = np.where(closed, 0.0, along / np.where(closed, 1.0, distance))
    grid = ring_grid(mesh.angle.size, widths / along, across, widths, widths * along)
    grid.south[:], grid.north[:] = ends.south, ends.north
    for groove in grooves:
        _cut_groove(grid, mesh, groove)
    return grid


def _cut_groove(grid: FilmGrid, mesh: JournalMesh, groove: Groove) -> None:
    """Prescribe the cells of a groove and shorten the paths from its edges."""
    offset = np.angle(np.exp(1j * (mesh.angle - groove.angle)))
    along = _inside(offset, 0.5 * groove.width, mesh.angle_step)
    reach = mesh.axial - groove.position
    across = _inside(reach, 0.5 * groove.length, float(np.diff(mesh.axial_face).max()))
    cells = np.ix_(along, across)
    grid.mark[cells] = 2
    grid.prescribed[cells] = groove.pressure
    rows, lanes = grid.mark.shape
    for i in range(rows):
        west = (i - 1) % rows
        if along[i] != along[west]:
            free = offset[i] if along[west] else offset[west]
            edge = max(abs(free) - 0.5 * groove.width, 0.1 * mesh.angle_step)
            grid.shape_x[i, across] *= mesh.angle_step / edge
    grid.shape_x[rows] = grid.shape_x[0]
    for j in range(1, lanes):
        if across[j] != across[j - 1]:
            free, step = (
                reach[j] if across[j - 1] else reach[j - 1],
                mesh.axial[j] - mesh.axial[j - 1],
            )
            edge = max(abs(free) - 0.5 * groove.length, 0.1 * step)
            grid.shape_y[along, j] *= step / edge


def _inside(distance: Array, half_extent: float, step: float) -> np.ndarray:
    """Cells with their centre in the groove, at least the nearest one."""
    inside = np.abs(distance) <= half_extent + 1e-9 * step
    if not inside.any() and np.abs(distance).min() <= step:
        inside[np.argmin(np.abs(distance))] = True
    return inside


def _heights(place: Array, base: float, angle: Array, axial: Array) -> Array:
    """Height of the gap, or its rate, on lines of constant angle. Shape (angles, lanes)."""
    c, s = np.cos(angle), np.sin(angle)
    level = base - place[0] * c - place[1] * s
    slope = place[2] * s - place[3] * c
    return np.asarray(level[:, None] + slope[:, None] * axial)


def journal_gap(mesh: JournalMesh, clearance: float, motion: MotionState) -> GapField:
    """Gap height of a rigid shaft in a rigid cylindrical bush. [m]."""
    faces = mesh.angle - 0.5 * mesh.angle_step
    centre = _heights(motion.place, clearance, mesh.angle, mesh.axial)
    along = _heights(motion.place, clearance, np.append(faces, faces[0]), mesh.axial)
    across = _heights(motion.place, clearance, mesh.angle, mesh.axial_face)
    rate = _heights(motion.speed, 0.0, mesh.angle, mesh.axial)
    return GapField(centre, along, across, rate, np.zeros(centre.shape))


def lobed(gap: GapField, mesh: JournalMesh, lobes: Lobes, clearance: float) -> GapField:
    """Gap height in a bore of lobes instead of a cylinder. [m]."""
    face = np.append(mesh.angle - 0.5 * mesh.angle_step, mesh.angle[-1] + 0.5 * mesh.angle_step)
    centre = clearance * lobes.narrowing(mesh.angle)[:, None]
    return gap._replace(
        centre=gap.centre - centre,
        face_x=gap.face_x - clearance * lobes.narrowing(face)[:, None],
        face_y=gap.face_y - centre,
    )


@njit
def journal_load(
    mesh: JournalMesh, pressure: Array, area: Array
) -> tuple[float, float, float, float]:
    """Force x, y [N] and moment about x, y [N m] on the shaft by the film pressure."""
    rows, lanes = pressure.shape
    along, across, about_x, about_y = 0.0, 0.0, 0.0, 0.0
    for i in range(rows):
        total, lever = 0.0, 0.0
        for j in range(lanes):
            f = pressure[i, j] * area[i, j]
            total += f
            lever += f * mesh.axial[j]
        c, s = np.cos(mesh.angle[i]), np.sin(mesh.angle[i])
        along -= total * c
        across -= total * s
        about_x += lever * s
        about_y -= lever * c
    # both halves of a bearing that is solved by half hold each other's moments
    both = mesh.weight if mesh.weight <= 1.0 else 0.0
    return along * mesh.weight, across * mesh.weight, about_x * both, about_y * both


@njit
def journal_shear(
    gap: GapField, pressure: Array, sheared: Array, mesh: JournalMesh, law: FlowLaw
) -> tuple[float, float, float]:
    """Integrals of the wall shear: sliding over speed and viscosity, pattern, pressure part.

    Returns the sums over angle and axis of ``sheared / h`` [rad], of its difference between
    the walls by their patterns [rad], and of ``(h/2) dp`` [N].
    """
    rows, lanes = pressure.shape
    sliding, pattern, poiseuille = 0.0, 0.0, 0.0
    smooth = law.roughness == 0.0
    for i in range(rows):
        west = (i + rows - 1) % rows
        for j in range(lanes):
            width = mesh.axial_face[j + 1] - mesh.axial_face[j]
            if smooth:
                mean, difference, half = 1.0 / gap.centre[i, j], 0.0, 0.5 * gap.face_x[i, j]
            else:
                mean, difference = stress_factors(gap.centre[i, j], law)
                half = pressure_stress(gap.face_x[i, j], law)
            sliding += sheared[i, j] * mesh.angle_step * width * mean
            pattern += sheared[i, j] * mesh.angle_step * width * difference
            drop = pressure[i, j] - pressure[west, j]
            poiseuille += half * drop * width
    return sliding, pattern, poiseuille
