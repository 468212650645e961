"""A machine that turns, in space and over time, for ParaView and VTK (VTKHDF)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import write_bytes
from toothspace.core.progress import Progress, part, tell
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.section import (
    fixed_parts,
    fluid_cells,
    housing_region,
    port_region,
    section_at,
    turned_section,
)
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    import xarray as xr

FRAMES = 121
"""States of a series: one revolution in steps of three degrees."""
_WEDGE, _QUAD = 13, 9
"""Cell types of VTK."""
_DRAWN_ERROR = 4e-6
"""What drawn outlines may deviate. [m]"""
_WOUND_LAYERS = 8
"""Layers along the axis of teeth that wind about it."""
_UPPER_SIDES = ("floating", "b")
"""First words of films at the end of the axis; others are at its origin."""
_FILM_FIELDS = (
    "film_height",
    "film_pressure",
    "film_contact_pressure",
    "film_deformation",
    "film_wear_power",
    "film_fraction",
)


@final
@dataclass(frozen=True)
class _SpaceGrid:
    """Cells of one kind with values; arrays that a later state shares are written once."""

    points: Array
    """Corners, shape (points, 3). [m]"""
    cells: Array
    """Corners of each cell by number."""
    kind: int
    """Cell type of VTK."""
    cell_values: Mapping[str, Array] = field(default_factory=dict)
    point_values: Mapping[str, Array] = field(default_factory=dict)


def write_space_series(
    solution: Solution, path: Path, frames: int = FRAMES, progress: Progress | None = None
) -> Path:
    """Write bodies, chambers, ports and films of a run in space, over time, as one VTKHDF file.

    Values are in SI units under the names of the result without their first word: ``pressure``,
    ``volume`` and ``gas_fraction`` of chambers, ``height``, ``pressure``, ``contact_pressure`` and
    ``deformation`` of films. Bodies stand where the section of the machine has them;
    ``displacement`` is by how much the run moved them from there.

    Parameters
    ----------
    solution : Solution
        Result over the shaft angle or over time.
    path : Path
        File to write, by custom ``*.vtkhdf``.
    frames : int
        States, spread evenly over the samples of the result.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CaseError
        If the machine of the result cannot be rebuilt, or its outlines or width are not known.

    Notes
    -----
    Cells lie between sections of the machine: one layer over the face width, eight where teeth wind
    about their axes. Films do not change over a series; those of the result are at its last sample.

    References
    ----------
    .. [1] Kitware, *VTKHDF format specification*, version 2, docs.vtk.org.
    """
    description, data = solution.description, solution.data
    if description is None or "casing" not in description.outlines:
        raise CaseError("result", "a machine that cannot be drawn", "one whose files are there")
    if "face_width_mm" not in description.geometry_summary:
        raise CaseError("result", "a machine of unknown face width", "one that tells face_width_mm")
    samples = data["shaft_speed"].sizes[data["shaft_speed"].dims[0]]
    chosen = np.unique(np.linspace(0, samples - 1, min(frames, samples)).round().astype(int))
    states = _SpaceStates(description, data, chosen)
    drawing = part(progress, "drawing")
    blocks: dict[str, dict[str, list[_SpaceGrid]]] = {
        "bodies": {body.name: states.body(k) for k, body in enumerate(description.bodies)},
        "fluid": {port: states.port(port) for port in ("inlet", "outlet")},
        "films": {name: [film] * chosen.size for name, film in _films(data, states.levels)},
        "casing": {"casing": [states.casing()] * chosen.size},
    }
    if section_at(description, 0.0, 0.0).drawn.chamber_outlines is not None:
        chambers = []
        for k, grid in enumerate(states.chambers()):
            chambers.append(grid)
            tell(drawing, (k + 1) / chosen.size, f"state {k + 1} of {chosen.size}")
        blocks["fluid"]["chambers"] = chambers
    write_bytes(path, _vtkhdf(blocks, np.asarray(data["time"])[chosen]))
    return path


@final
class _SpaceStates:
    """A machine at chosen samples of its result."""

    def __init__(self, description: MachineDescription, data: xr.Dataset, chosen: Array) -> None:
        self.description = description
        self.data = data.isel({data["shaft_speed"].dims[0]: chosen})
        self.angles = np.asarray(self.data["shaft_angle"])
        width: Any = description.geometry_summary["face_width_mm"]
        self.width = 1e-3 * float(width)
        winding = description.winding
        layers = 1 if winding is None else _WOUND_LAYERS
        self.levels = np.linspace(0.0, self.width, layers + 1)
        self.lead = 0.0 if winding is None else winding.turn_per_length

    def leads(self, levels: Array) -> Array:
        """Shaft angles by which sections lead that of the middle. [rad]."""
        return np.asarray(self.lead * (levels - 0.5 * self.width))

    def body(self, number: int) -> list[_SpaceGrid]:
        """Solid of a body in all states."""
        body = self.description.bodies[number]
        corners, triangles = _triangles(turned_section(self.description, body, 0.0))
        cells = _wedges(triangles, len(corners), self.levels.size - 1)
        grids = []
        for k, angle in enumerate(self.angles):
            turn = body.speed_ratio * (angle + self.leads(self.levels))[:, None]
            x, y = (corners - np.asarray(body.center)).T
            x, y = np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y
            points = np.stack([x.ravel(), y.ravel()], axis=1) + np.asarray(body.center)
            points = np.concatenate([points, np.repeat(self.levels, len(corners))[:, None]], axis=1)
            shift = np.zeros(3)
            if "body_position" in self.data:
                given = np.asarray(self.data["body_position"])[k, number]
                shift[: given.size] = given
            moved = np.broadcast_to(shift, points.shape)
            grids.append(_SpaceGrid(points, cells, _WEDGE, {}, {"displacement": moved}))
        return grids

    def chambers(self) -> Iterator[_SpaceGrid]:
        """Fluid of the chambers, state by state."""
        import shapely

        names = [
            str(name)
            for name, values in self.data.data_vars.items()
            if str(name).startswith("chamber_") and values.dims[1:] == ("chamber",)
        ]
        middles = 0.5 * (self.levels[1:] + self.levels[:-1])
        for k, angle in enumerate(self.angles):
            parts, owners, shift = [], [], 0
            for layer in range(middles.size):
                height = float(middles[layer] / self.width - 0.5)
                cut = section_at(self.description, float(angle), height)
                shapes = shapely.simplify(fluid_cells(cut.drawn, cut.shaft_angle), _DRAWN_ERROR)
                for chamber, shape in zip(cut.chambers, shapes, strict=True):
                    corners, triangles = _triangles(shape)
                    if not len(triangles):
                        continue
                    prisms = _prisms(corners, self.levels[layer : layer + 2])
                    parts.append((prisms, shift + _wedges(triangles, len(corners), 1)))
                    owners.append(np.full(len(triangles), chamber))
                    shift += len(prisms)
            owner = np.concatenate(owners)
            values = {
                name.removeprefix("chamber_"): np.asarray(self.data[name])[k, owner]
                for name in names
            }
            points, cells = map(np.concatenate, zip(*parts, strict=True))
            yield _SpaceGrid(points, cells, _WEDGE, {"chamber": owner, **values})

    def port(self, port: str) -> list[_SpaceGrid]:
        """Fluid of a port in all states."""
        grid = self._prism(port_region(self.description, port))
        pressures = np.asarray(self.data[f"{port}_pressure"])
        count = len(grid.cells)
        return [
            _SpaceGrid(grid.points, grid.cells, _WEDGE, {"pressure": np.full(count, pressure)})
            for pressure in pressures
        ]

    def casing(self) -> _SpaceGrid:
        """Wall round the machine and what stands in it."""
        return self._prism(housing_region(self.description).union(fixed_parts(self.description)))

    def _prism(self, region: Any) -> _SpaceGrid:
        corners, triangles = _triangles(region.simplify(_DRAWN_ERROR))
        points = _prisms(corners, self.levels[[0, -1]])
        return _SpaceGrid(points, _wedges(triangles, len(corners), 1), _WEDGE)


def _prisms(corners: Array, levels: Array) -> Array:
    """Corners of a section at levels along the axis. [m]."""
    heights = np.repeat(levels, len(corners))
    return np.column_stack([np.tile(corners, (levels.size, 1)), heights])


def _triangles(region: Any) -> tuple[Array, Any]:
    """Corners and triangles of a plane region, anticlockwise."""
    import shapely

    shapes = shapely.get_parts(
        shapely.constrained_delaunay_triangles(region.simplify(_DRAWN_ERROR))
    )
    shapes = shapely.orient_polygons(shapes)
    points = shapely.get_coordinates(shapes).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
    corners, number = np.unique(points, axis=0, return_inverse=True)
    return np.asarray(corners), np.asarray(number.reshape(-1, 3), dtype=np.int64)


def _wedges(triangles: Array, count: int, layers: int) -> Array:
    """Wedges between layers of the same triangles."""
    shifts = count * np.arange(layers)[:, None, None]
    low = triangles[None] + shifts
    return np.asarray(np.concatenate([low, low + count], axis=2).reshape(-1, 6))


def _films(data: xr.Dataset, levels: Array) -> Iterator[tuple[str, _SpaceGrid]]:
    """Films beside the bodies on the face that they lubricate; cells without a film left out."""
    if "film_height" not in data or "film_radius" not in data:
        return
    angle, rims = np.asarray(data["film_angle"]), np.asarray(data["film_radius"])
    turn = angle[1] - angle[0]
    for k, name in enumerate(map(str, data["film"].values)):
        reach = rims[k, 1] - rims[k, 0]
        radius = np.append(rims[k] - 0.5 * reach, rims[k, -1] + 0.5 * reach)
        around = angle - 0.5 * turn
        x = float(data["film_center_x"][k]) + np.cos(around)[:, None] * radius
        y = float(data["film_center_y"][k]) + np.sin(around)[:, None] * radius
        level = levels[-1] if name.partition("_")[0] in _UPPER_SIDES else levels[0]
        points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, level)])
        here = np.arange(x.size).reshape(x.shape)
        ahead = np.roll(here, -1, axis=0)
        cells = np.stack([here[:, :-1], here[:, 1:], ahead[:, 1:], ahead[:, :-1]], axis=-1)
        wet = np.isfinite(np.asarray(data["film_height"])[k]).ravel()
        values = {
            field.removeprefix("film_"): np.asarray(data[field])[k].ravel()[wet]
            for field in _FILM_FIELDS
            if field in data
        }
        yield f"film_{name}", _SpaceGrid(points, cells.reshape(-1, 4)[wet], _QUAD, values)


def _vtkhdf(blocks: Mapping[str, Mapping[str, list[_SpaceGrid]]], times: Array) -> bytes:
    """File of a collection of grids over time."""
    import h5py

    # a disk that refuses a write ends the process in the HDF5 library, so it writes into memory
    buffer = BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        root = file.create_group("VTKHDF", track_order=True)
        _mark(root, "PartitionedDataSetCollection")
        assembly = root.create_group("Assembly", track_order=True)
        index = 0
        for part_name, grids in blocks.items():
            node = assembly.create_group(part_name, track_order=True) if grids else None
            for name, states in grids.items():
                block = root.create_group(name, track_order=True)
                _mark(block, "UnstructuredGrid")
                block.attrs["Index"] = index
                index += 1
                _write_block(block, states, times)
                assert node is not None
                node[name] = h5py.SoftLink(f"/VTKHDF/{name}")
    return buffer.getvalue()


def _mark(group: Any, kind: str) -> None:
    group.attrs["Version"] = (2, 1)
    group.attrs.create("Type", np.bytes_(kind))


def _write_block(group: Any, states: list[_SpaceGrid], times: Array) -> None:
    """One grid over time: arrays one after the other, and where those of each state begin."""
    fixed = all(state.cells is states[0].cells for state in states)
    shapes = states[:1] if fixed else states
    group["NumberOfPoints"] = [len(state.points) for state in shapes]
    group["NumberOfCells"] = [len(state.cells) for state in shapes]
    group["NumberOfConnectivityIds"] = [state.cells.size for state in shapes]
    corners = [state.cells.shape[1] for state in shapes]
    group["Connectivity"] = np.concatenate([state.cells.ravel() for state in shapes])
    group["Offsets"] = np.concatenate(
        [n * np.arange(len(state.cells) + 1) for n, state in zip(corners, shapes, strict=True)]
    )
    group["Types"] = np.concatenate(
        [np.full(len(state.cells), state.kind, dtype=np.uint8) for state in shapes]
    )
    steps = group.create_group("Steps")
    steps.attrs["NSteps"] = len(states)
    steps["Values"] = times
    parts = np.zeros(len(states), int) if fixed else np.arange(len(states))
    steps["PartOffsets"], steps["NumberOfParts"] = parts, np.ones(len(states), int)
    cells = _beginnings([state.cells for state in states])
    steps["CellOffsets"] = cells[:, None]
    steps["ConnectivityIdOffsets"] = states[0].cells.shape[1] * cells[:, None]
    steps["PointOffsets"] = _pooled(group, "Points", [state.points for state in states])
    for kind, values in (
        ("CellData", [state.cell_values for state in states]),
        ("PointData", [state.point_values for state in states]),
    ):
        target, offsets = group.create_group(kind), steps.create_group(f"{kind}Offsets")
        for name in values[0]:
            offsets[name] = _pooled(target, name, [given[name] for given in values])


def _pooled(group: Any, name: str, arrays: list[Array]) -> Array:
    """Write arrays one after the other, shared ones once; returns where each begins."""
    shared = all(array is arrays[0] for array in arrays)
    content = arrays[0] if shared else np.concatenate(arrays)
    kind = np.float32 if content.dtype.kind == "f" else content.dtype
    group.create_dataset(name, data=content.astype(kind), compression="gzip", compression_opts=1)
    return _beginnings(arrays)


def _beginnings(arrays: list[Array]) -> Array:
    if all(array is arrays[0] for array in arrays):
        return np.zeros(len(arrays), dtype=int)
    return np.cumsum([0, *(len(array) for array in arrays[:-1])])
