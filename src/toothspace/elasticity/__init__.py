"""Linear elasticity of bodies and the influence matrices of their film surfaces.

================ =========================================================
module           responsibility
================ =========================================================
mesh             triangulated regions swept along z, bodies of STEP files, outer faces
elements         stiffness and mass of solid elements
condensation     order of elimination; large stiffness to flexibility of chosen loads
surfaces         film surfaces: coarse nodes and interpolation to cells
surface_loads    named loads and their nodal forces
body             :class:`ElasticBody`, the input
influence        :class:`InfluenceMatrix`, the result, how it is made and kept on disk
================ =========================================================
"""

from __future__ import annotations

from toothspace.elasticity.body import ElasticBody, Support, SweptShape
from toothspace.elasticity.influence import InfluenceMatrix, influence_matrix
from toothspace.elasticity.mesh import Prism, SolidFile, annulus, disc
from toothspace.elasticity.surface_loads import (
    AreaPressure,
    LateralFaces,
    LateralPressure,
    journal_load,
)
from toothspace.elasticity.surfaces import CylinderSurface, PlaneSurface

__all__ = [
    "AreaPressure",
    "CylinderSurface",
    "ElasticBody",
    "InfluenceMatrix",
    "LateralFaces",
    "LateralPressure",
    "PlaneSurface",
    "Prism",
    "SolidFile",
    "Support",
    "SweptShape",
    "annulus",
    "disc",
    "influence_matrix",
    "journal_load",
]
