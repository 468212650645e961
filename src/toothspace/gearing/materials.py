"""Elastic data of gear materials from the library."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from toothspace.library import load_material


@final
@dataclass(frozen=True)
class Solid:
    """Elastic data of a material: modulus [Pa], Poisson ratio [-], hardness [Pa], density."""

    elastic_modulus: float
    poisson_ratio: float
    hardness: float
    density: float


def solid(name: str, key: str) -> Solid:
    """Return a material of the library, or raise ``CaseError`` naming the key."""
    data = load_material(name, key)
    return Solid(
        float(data["elastic_modulus"]),
        float(data["poisson_ratio"]),
        float(data["hardness"]),
        float(data["density"]),
    )


def reduced_modulus(first: Solid, second: Solid) -> float:
    """Effective modulus E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]."""
    return 2.0 / sum((1.0 - m.poisson_ratio**2) / m.elastic_modulus for m in (first, second))
