"""A chamber over its own table angle: where it is open to ports and grooves, and its samples."""

from __future__ import annotations

import numpy as np
import xarray as xr

from toothspace.core.types import Array, IntArray
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.model.path_category import OPENINGS, PathCategory


def openings_of(description: MachineDescription) -> list[PathCategory]:
    """Categories of the paths that open chambers to ports and grooves: inlet, outlet, grooves."""
    found = [c for c in description.path_categories if c.role in OPENINGS]
    return sorted(found, key=lambda category: OPENINGS.index(category.role))


def opening_area(
    description: MachineDescription, family: ChamberFamily, category: PathCategory, angle: Array
) -> Array:
    """Open area between one chamber and all paths of a category.

    Parameters
    ----------
    angle : ndarray
        Table angle of the chamber. [rad]

    Returns
    -------
    ndarray
        Area; zero where nothing is open. [m2]
    """
    names = [other.name for other in description.families]
    first = sum(other.count for other in description.families[: names.index(family.name)])
    area = np.zeros_like(angle)
    for path in description.paths:
        if path.category != category or path.kind != "orifice":
            continue
        for member in np.flatnonzero((path.nodes_a == first) | (path.nodes_b == first)):
            scale = path.angle_ratio / family.angle_ratio
            offset = float(path.phases[member] - scale * family.phases[0])
            area = area + path.multiplicity * path.geometry(scale * angle + offset)[..., 0]
    return area


def opening_windows(
    description: MachineDescription, family: ChamberFamily, category: PathCategory
) -> list[tuple[float, float]]:
    """Intervals of the chamber's table angle in which a category is open. [rad]."""
    angle = np.linspace(0.0, family.volume.period, 721)
    area = opening_area(description, family, category, angle)
    opened = area > 1e-4 * max(float(area.max()), 1e-12)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], opened, [False]]).astype(int)))
    return [
        (float(angle[start]), float(angle[end - 1]))
        for start, end in zip(edges[::2], edges[1::2], strict=True)
    ]


def one_chamber(
    data: xr.Dataset, description: MachineDescription, family: ChamberFamily
) -> tuple[Array, IntArray, IntArray]:
    """Angles of a chamber over its turn with the sample and the chamber that show them.

    In one turn of the shaft a chamber may not come round; the ones behind it, which are alike,
    show the rest.

    Returns
    -------
    ndarray
        Table angle of the chamber, ascending. [rad]
    ndarray
        Samples along the shaft angle.
    ndarray
        Columns of the chambers.
    """
    shaft_angle = np.asarray(data["shaft_angle"])
    last = np.flatnonzero(shaft_angle >= shaft_angle[-1] - 2.0 * np.pi)
    first = description.chamber_labels.index(f"{family.name}_0")
    step = abs(family.angle_ratio) * float(np.median(np.diff(shaft_angle)))
    own = family.phases + family.angle_ratio * shaft_angle[last, None]
    own = np.mod(own, family.volume.period)
    found: list[tuple[float, int, int]] = []
    shown = np.zeros(round(family.volume.period / step) + 1, dtype=bool)
    for chamber in range(family.count):
        places = np.round(own[:, chamber] / step).astype(int)
        new = np.flatnonzero(~shown[places])
        found += [(own[k, chamber], int(last[k]), first + chamber) for k in new]
        shown[places] = True
    found.sort()
    angle, sample, column = zip(*found, strict=True)
    return np.array(angle), np.array(sample), np.array(column)
