"""One point of a floating bearing as a study keeps it, in memory and on disk."""

from __future__ import annotations

import base64
import hashlib
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.compilation.cache import digest_of_sources
from toothspace.core.files import plain
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.floating.coupling import CoupledPoint
from toothspace.floating.problem import LateralNumbers, film_fields, film_places
from toothspace.studies.records import Record

FIELDS = ("film_height", "film_pressure", "film_contact_pressure", "film_wear_power")
"""Fields of every film that a study keeps."""
_SCALARS = ("residual", "nose_pressure", "breakaway_force", "preload", "temperature_rise")


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class StoredPoint:
    """What a study keeps of one point."""

    status: Status
    """Outcome."""
    numbers: LateralNumbers
    """Mean numbers of the films."""
    residual: float
    """Largest force out of balance over the force behind the bearing. [-]"""
    nose_pressure: float
    """Absolute pressure on the nose. [Pa]"""
    breakaway_force: float
    """Friction of the housing at which the bearing breaks away. [N]"""
    preload: float
    """Force of springs and seal. [N]"""
    temperature_rise: float | None
    """Hottest film above the fluid; None where none warms up. [K]"""
    coordinates: Array
    """Positions and rotations of all bodies. [m, rad]"""
    films: tuple[str, ...]
    """Names of the films."""
    maps: Mapping[str, Array]
    """Fields of the films and the places of their cells, by the names of results."""


def stored_point(point: CoupledPoint) -> StoredPoint:
    """Take from a coupled solution what a study keeps."""
    stack, balance = point.problem.stack, point.equilibrium.balance
    drawn = film_fields(balance)
    return StoredPoint(
        status=point.status,
        numbers=point.numbers,
        residual=balance.residual,
        nose_pressure=point.problem.loads.back.nose,
        breakaway_force=point.problem.loads.friction.breakaway_force,
        preload=stack.balance.floating.preload.size,
        temperature_rise=point.temperature_rise,
        coordinates=balance.position,
        films=tuple(grid.interface.name for grid in stack.grids),
        maps={**{name: drawn[name].astype(np.float32) for name in FIELDS}, **film_places(stack)},
    )


def record_of(key: str, point: StoredPoint) -> Record:
    """Return the record from which :func:`recorded_point` makes the same point again."""
    numbers = {
        **{name: getattr(point, name) for name in _SCALARS},
        "films": point.films,
        "coordinates": point.coordinates,
        "lateral_numbers": asdict(point.numbers),
        "maps": {
            name: {
                "type": values.dtype.str,
                "shape": values.shape,
                "content": base64.b64encode(zlib.compress(values.tobytes())).decode("ascii"),
            }
            for name, values in point.maps.items()
        },
    }
    return Record(
        key,
        point.status.name.lower(),
        plain(numbers),
        "" if point.status is Status.DONE else point.status.value,
    )


def recorded_point(record: Record) -> StoredPoint:
    """Return the point of a record."""
    kept: Mapping[str, Any] = record.numbers
    values: dict[str, Any] = {
        f.name: kept["lateral_numbers"][f.name] for f in fields(LateralNumbers)
    }
    # JSON knows neither arrays nor numbers that are not
    for name, value in values.items():
        if value is None or isinstance(value, list):
            values[name] = float("nan") if value is None else np.array(value)
    return StoredPoint(
        status=Status[record.status.upper()],
        numbers=LateralNumbers(**values),
        **{name: kept[name] for name in _SCALARS},
        films=tuple(kept["films"]),
        coordinates=np.array(kept["coordinates"]),
        maps={
            name: np.frombuffer(
                zlib.decompress(base64.b64decode(packed["content"])), dtype=packed["type"]
            ).reshape(packed["shape"])
            for name, packed in kept["maps"].items()
        },
    )


def point_key(case: Case, *what: object) -> str:
    """Key of the record of a point: the case without its study, and what else decides.

    Parameters
    ----------
    *what : object
        Numbers and texts that the point depends on besides the case.
    """
    text = "\n".join((case.at_point({}).hash, repr(what), digest_of_sources()))
    return hashlib.sha256(text.encode()).hexdigest()[:32]
