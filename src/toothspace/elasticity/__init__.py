"""Linear elasticity of bodies and the influence matrices of their film surfaces.

================ =========================================================
module           responsibility
================ =========================================================
triangulation    plane regions to triangles
mesh             bodies swept along z, and their outer faces
solid_file       bodies of STEP files
elements         stiffness and mass of solid elements
dissection       order of elimination
condensation     large stiffness to flexibility of chosen loads
surfaces         film surfaces: coarse nodes and interpolation to cells
surface_loads    named loads and their nodal forces
body             :class:`ElasticBody`, the input
influence_matrix :class:`InfluenceMatrix`, the result
influence        :func:`influence_matrix`, which makes it
storage          results on disk
================ =========================================================
"""

from __future__ import annotations

from toothspace.elasticity.body import ElasticBody, Support, SweptShape
from toothspace.elasticity.influence import influence_matrix
from toothspace.elasticity.influence_matrix import InfluenceMatrix
from toothspace.elasticity.mesh import Prism, annulus, disc
from toothspace.elasticity.solid_file import SolidFile
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
