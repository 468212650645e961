"""Running-in: how deep the gears cut into the casing at a break-in condition."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import FlowPath
from toothspace.model.paths import by_kind
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import History


def running_in_depths(history: History) -> dict[str, Array]:
    """Depths at the table nodes of every wearing gap, from one revolution at break-in. [m].

    The casing is cut until no gap of the revolution is smaller than its residual height.
    """
    system = history.system
    heights = observe(system.arrays, history.states).raw_height
    angles = history.states[:, 0]
    depths = {}
    first = 0
    for path in by_kind(system.description.paths):
        members = slice(first, first + path.count)
        if path.wears:
            depths[path.name] = _depth(path, angles, heights[:, members])
        first += path.count
    return depths


def _depth(path: FlowPath, shaft_angles: Array, heights: Array) -> Array:
    period, nodes = path.geometry.period, path.geometry.values.shape[0]
    step = period / nodes
    depth = np.zeros(nodes)
    closed = path.geometry.values[:, 1] <= 0.0
    for k in range(path.count):
        angle = np.mod(path.phases[k] + path.angle_ratio * shaft_angles, period)
        index = np.round(angle / step).astype(int) % nodes
        np.maximum.at(depth, index, path.minimum_height - heights[:, k])
    depth[closed] = 0.0
    return _smoothed(depth)


def _smoothed(depth: Array) -> Array:
    """Widen and round the track by a few nodes: a tip land has a width."""
    widened = np.max([np.roll(depth, k) for k in range(-3, 4)], axis=0)
    return np.mean([np.roll(widened, k) for k in range(-3, 4)], axis=0)
