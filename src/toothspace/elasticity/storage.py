"""Influence matrices on disk, keyed by a hash of the body and of the sources that made them."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import numpy as np

from toothspace.core.compiled import cache_root
from toothspace.core.files import load_arrays, save_arrays
from toothspace.core.types import Array
from toothspace.elasticity.body import ElasticBody
from toothspace.elasticity.influence_matrix import InfluenceMatrix

_ARRAYS = ("nodes", "surface", "compliance", "rigid_modes", "center_of_mass")


@cache
def _sources() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).resolve().parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def folder() -> Path:
    """Folder of the stored matrices, beside that of the compiled code."""
    return cache_root() / "elasticity"


def _path(name: str) -> Path:
    return folder() / f"{name}-{_sources()}.npz"


def load(name: str, body: ElasticBody) -> InfluenceMatrix | None:
    """Stored matrix of a body, or None."""
    stored = load_arrays(_path(name))
    if stored is None:
        return None
    names = [entry.name for entry in body.loads]
    return InfluenceMatrix(
        body=body,
        **{key: stored[key] for key in _ARRAYS},
        load_cases=dict(zip(names, stored["load_cases"], strict=True)),
        resultants=dict(zip(names, stored["resultants"], strict=True)),
        mass=float(stored["mass"]),
        element_count=int(stored["element_count"]),
        error_estimate=float(stored["error_estimate"]),
    )


def save(name: str, matrix: InfluenceMatrix) -> None:
    """Store a matrix."""
    content: dict[str, Array] = {key: getattr(matrix, key) for key in _ARRAYS}
    for key in ("load_cases", "resultants"):
        content[key] = np.array(list(getattr(matrix, key).values()))
    for key in ("mass", "element_count", "error_estimate"):
        content[key] = np.asarray(getattr(matrix, key))
    save_arrays(_path(name), content)
