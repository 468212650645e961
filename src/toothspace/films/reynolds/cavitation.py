"""Names of the cavitation models."""

from __future__ import annotations

from toothspace.numerics.complementarity import Constraint

CAVITATION = {
    "guembel": Constraint.NONE,
    "reynolds": Constraint.OBSTACLE,
    "jfo": Constraint.CONSERVING,
}
"""Cavitation models by name."""
