"""Closed-form films of the lumped preset as arrays: journal bearings and lateral films."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, final

import numpy as np

from toothspace.closures.bearing_map import JournalMap, build_journal_map
from toothspace.closures.contact_rough import asperity_pressure
from toothspace.closures.gap_flow import lateral_film_torque
from toothspace.core.compilation.library import way
from toothspace.core.compiled import cache_root, digest_of_sources, njit
from toothspace.core.files import keep_arrays, load_arrays
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.description import (
    FreeBlocks,
    LumpedJournalBearing,
    LumpedLateralFilm,
    MachineDescription,
)
from toothspace.numerics.periodic_table import cubic_coefficients

_INTERVALS = 240
_CIRCUMFERENCE_POINTS = 720
_MOST_MAPS = 40
"""Most film maps of bearings that are kept on disk."""
LONG = 1e4
"""Length over diameter that stands for walls at both ends. [-]"""


@final
@dataclass(frozen=True)
class JournalData:
    """Rows of the bearings that carry free bodies, their asperity tables and film map."""

    rows: Array
    asperity: Array
    asperity_range: float
    film: JournalMap
    curves: Array


def journal_data(
    description: MachineDescription,
    free: list[int],
    bush: Mapping[str, tuple[float, float]],
    blocks: FreeBlocks | None = None,
) -> JournalData:
    """Collect the data of the bearings whose bodies are free to move, then of moving blocks."""
    carried = [j for j in description.journals if j.body in bush]
    journals = [*carried, *((blocks.film,) if blocks else ())]
    # bearings with one key have one film map; walls at the ends make a bearing long
    shapes: dict[Any, JournalMap] = {}
    keys: list[Any] = []
    for journal in journals:
        open_ended = journal.end_condition != "no_flow"
        key: Any = round(journal.length / journal.diameter, 9) if open_ended else LONG
        shape = _journal_map(key)
        if journal.solved is not None:
            nodes = journal.solved.force_nodes
            key, shape = id(nodes), shape._replace(nodes=nodes)
        keys.append(key)
        shapes[key] = shape
    places = [list(shapes).index(key) for key in keys]
    maps = list(shapes.values()) or [_journal_map(1.0)]
    bodies = {body.name: body for body in description.bodies}
    turning = ((place, description.motions[k]) for place, k in enumerate(free))
    rotations = {motion.body: place for place, motion in turning if motion.axis == "rotation"}
    span = max((1.0 + 4.0 * j.roughness / j.radial_clearance for j in journals), default=1.0)
    on = (len(free), len(free) + 1) if blocks else (-1, -1)
    rows: list[tuple[float, ...]] = [
        (
            free.index(description.motion_index(j.body, "x")),
            free.index(description.motion_index(j.body, "y")),
            j.count,
            0.5 * j.diameter,
            j.length,
            j.radial_clearance,
            bodies[j.body].speed_ratio,
            *bush[j.body],
            j.boundary_friction,
            rotations.get(j.body, -1),
            place,
            0.0,
            0.0,
            0 if j.friction is None else len(j.friction.loads),
            np.sign(bodies[j.body].speed_ratio) if bodies[j.body].role == "driven" else 0.0,
            j.viscosity_ratio,
            *on,
        )
        for j, place in zip(carried, places, strict=False)
    ]
    if blocks:
        # the film between bearing blocks and housing: nothing turns, nothing carries it
        motion = len(free)
        size = (
            blocks.film.count,
            0.5 * blocks.film.diameter,
            blocks.film.length,
            blocks.film.radial_clearance,
        )
        at_rest = 0.0, 0.0, 0.0, blocks.film.boundary_friction, -1
        rows.append(
            (motion, motion + 1, *size, *at_rest, places[-1], 0.0, 0.0, 0, 0.0, 1.0, -1, -1)
        )
    friction = [
        np.empty((0, col.CURVE_COLUMNS)) if j.friction is None else j.friction.rows
        for j in journals
    ]
    longest = max((len(one) for one in friction), default=0)
    curves = np.zeros((len(journals), max(longest, 1), col.CURVE_COLUMNS))
    for block, one in zip(curves, friction, strict=True):
        block[: len(one)] = one
    return JournalData(
        rows=np.array(rows, dtype=float).reshape(len(journals), col.JOURNAL_COLUMNS),
        asperity=np.array([_asperity_tables(j, span) for j in journals]).reshape(
            len(journals), 3, _INTERVALS, 4
        ),
        asperity_range=span,
        film=maps[0]._replace(nodes=np.stack([one.nodes for one in maps])),
        curves=curves,
    )


@lru_cache(maxsize=8)
def _journal_map(slenderness: float) -> JournalMap:
    # a tenth of a second each; code of the library and of a compiler differ in the last digits
    name = f"{slenderness}-{way()}-{digest_of_sources()}.npz"
    path = cache_root() / "journal-maps" / name
    kept = load_arrays(path)
    if kept is not None:
        return JournalMap(kept["nodes"], float(kept["logarithm_step"]), slenderness)
    found = build_journal_map(slenderness)
    keep_arrays(path, found._asdict(), _MOST_MAPS)
    return found


def _asperity_tables(journal: LumpedJournalBearing, span: float) -> tuple[Array, Array, Array]:
    """Tables over the eccentricity ratio: radial force and load of asperities, viscous shear.

    The shear is that over the closed form. [N, N, -]
    """
    ratios = np.linspace(0.0, span, _INTERVALS + 1)
    force, load = np.zeros((2, ratios.size))
    _asperity_integrals(
        ratios,
        journal.radial_clearance,
        journal.roughness,
        journal.correlation_length,
        journal.effective_modulus,
        journal.hardness,
        force,
        load,
    )
    area = journal.count * 0.5 * journal.diameter * journal.length
    shear = np.ones_like(ratios)
    if journal.solved is not None:
        known = journal.solved
        places = np.linspace(0.0, known.shear_range, known.shear.size)
        shear = np.interp(ratios, places, known.shear)
    return _spline(area * force), _spline(area * load), _spline(shear)


@njit
def _asperity_integrals(
    ratios: Array,
    clearance: float,
    roughness: float,
    correlation_length: float,
    effective_modulus: float,
    hardness: float,
    force: Array,
    load: Array,
) -> None:
    step = 2.0 * np.pi / _CIRCUMFERENCE_POINTS
    for i in range(ratios.size):
        for k in range(_CIRCUMFERENCE_POINTS):
            cosine = np.cos(k * step)
            height = clearance * (1.0 - ratios[i] * cosine)
            if height > 4.0 * roughness:
                continue
            p = asperity_pressure(
                height, roughness, correlation_length, effective_modulus, hardness
            )
            force[i] += p * cosine * step
            load[i] += p * step


def _spline(values: Array) -> Array:
    """Coefficients of a monotone cubic through uniform nodes, one row per interval."""
    difference = np.diff(values)
    slope = np.zeros_like(values)
    product = difference[1:] * difference[:-1]
    total = np.where(product > 0.0, difference[1:] + difference[:-1], 1.0)
    slope[1:-1] = np.where(product > 0.0, 2.0 * product / total, 0.0)
    slope[-1] = difference[-1]
    return np.stack(cubic_coefficients(values[:-1], values[1:], slope[:-1], slope[1:]), axis=1)


def lateral_torque_coefficient(description: MachineDescription) -> float:
    """Lateral film torque at the shaft per viscosity and shaft speed. [m3]."""
    drag = lateral_drag(description)
    return sum(body.speed_ratio**2 * drag[body.name] for body in description.bodies)


def lateral_asperity_share(description: MachineDescription) -> float:
    """Part of the lateral film torque at the shaft that touching asperities cause. [-]."""
    ratio = {body.name: body.speed_ratio for body in description.bodies}
    films = description.laterals
    torques = [ratio[film.body] ** 2 * film.faces * lateral_face_torque(film) for film in films]
    touching = sum(t * film.asperity_share for t, film in zip(torques, films, strict=True))
    return touching / sum(torques) if sum(torques) > 0.0 else 0.0


def lateral_drag(description: MachineDescription) -> dict[str, float]:
    """Lateral film torque on each body per viscosity and speed of the body. [m3]."""
    drag = {body.name: 0.0 for body in description.bodies}
    for film in description.laterals:
        drag[film.body] += film.faces * lateral_face_torque(film)
    return drag


def lateral_face_torque(film: LumpedLateralFilm) -> float:
    """Torque of the film on one face per viscosity and speed of the body. [m3]."""
    if film.drag is not None:
        return film.viscosity_ratio * film.drag
    radii = film.inner_radius, film.root_radius, film.outer_radius
    full, ring = (
        lateral_film_torque(1.0, 1.0, low, high, film.height, film.tilt)
        for low, high in pairwise(radii)
    )
    return float(film.viscosity_ratio * (full + film.tooth_area_fraction * ring))
