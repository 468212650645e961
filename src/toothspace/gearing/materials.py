"""Elastic data of machine materials from the library."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from toothspace.library import load_material


@final
@dataclass(frozen=True, kw_only=True)
class Material:
    """Elastic data of a solid."""

    elastic_modulus: float
    """Young's modulus. [Pa]"""
    poisson_ratio: float
    """Poisson's ratio. [-]"""
    hardness: float
    """Indentation hardness. [Pa]"""
    density: float = 7850.0
    """Density. [kg/m3]"""


def library_material(name: str, key: str) -> Material:
    """Return a material of the library, or raise ``CaseError`` naming the key."""
    data = load_material(name, key)
    return Material(
        elastic_modulus=float(data["elastic_modulus"]),
        poisson_ratio=float(data["poisson_ratio"]),
        hardness=float(data["hardness"]),
        density=float(data["density"]),
    )


def reduced_modulus(first: Material, second: Material) -> float:
    """Effective modulus E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]."""
    return 2.0 / sum((1.0 - m.poisson_ratio**2) / m.elastic_modulus for m in (first, second))
