"""Condensed bodies against CalculiX on the same mesh and on a finer one; needs ``ccx``."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.interpolate import griddata
from scipy.sparse.linalg import spsolve

from toothspace.elasticity import (
    ElasticBody,
    PlaneSurface,
    Prism,
    Support,
    SweptShape,
    annulus,
    influence_matrix,
)
from toothspace.elasticity.elements import stiffness_matrix
from toothspace.elasticity.mesh import SolidMesh
from toothspace.elasticity.surface_loads import AreaPressure

MODULUS, POISSON, HEIGHT, PRESSURE = 100e9, 0.33, 12e-3, 10e6
SECTION = annulus(10e-3, 25e-3)
PRESSED = shapely.box(4e-3, -30e-3, 30e-3, 30e-3)

pytestmark = [
    pytest.mark.verification,
    pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed"),
]


def _body(edge: float) -> ElasticBody:
    """Bushing on its cover with pressure on a part of its face, as a seal line cuts it."""
    return ElasticBody(
        SweptShape((Prism(SECTION, 0.0, HEIGHT),), edge, edge),
        MODULUS,
        POISSON,
        8800.0,
        (PlaneSurface("face", "top", SECTION, 4e-3),),
        (AreaPressure("push", "top", PRESSED),),
        (Support("bottom", SECTION),),
    )


def _deck(mesh: SolidMesh, forces: np.ndarray) -> str:
    """Input file: elements with incompatible modes, held below, nodal forces above."""
    nodes = [f"{k + 1},{x:.12e},{y:.12e},{z:.12e}" for k, (x, y, z) in enumerate(mesh.nodes)]
    cells = [",".join(map(str, [k + 1, *(e + 1)])) for k, e in enumerate(mesh.elements)]
    below = [f"{k + 1},1,3" for k in np.flatnonzero(mesh.nodes[:, 2] < 1e-9)]
    push = [f"{k + 1},3,{f:.12e}" for k, f in enumerate(forces[2::3]) if f != 0.0]
    parts = [
        "*NODE,NSET=ALL", *nodes, "*ELEMENT,TYPE=C3D8I,ELSET=BODY", *cells,
        "*MATERIAL,NAME=BRONZE", "*ELASTIC", f"{MODULUS:.6e},{POISSON}",
        "*SOLID SECTION,ELSET=BODY,MATERIAL=BRONZE", "*STEP", "*STATIC",
        "*BOUNDARY", *below, "*CLOAD", *push, "*NODE PRINT,NSET=ALL", "U", "*END STEP",
    ]  # fmt: skip
    return "\n".join(parts) + "\n"


def _calculix(body: ElasticBody, folder: Path) -> np.ndarray:
    """Places of the upper nodes and what they sink under the load, one row each."""
    mesh = body.shape.mesh(1.0)
    forces = PRESSURE * np.asarray(body.loads[0].forces(mesh)).ravel()
    (folder / "body.inp").write_text(_deck(mesh, forces))
    subprocess.run(["ccx", "-i", "body"], cwd=folder, check=True, capture_output=True, timeout=300)
    lines = (folder / "body.dat").read_text().splitlines()
    rows = [line.split() for line in lines if len(line.split()) == 4 and line.split()[0].isdigit()]
    sunk = -np.array(rows, dtype=float)[:, 3]
    top = mesh.nodes[:, 2] > HEIGHT - 1e-9
    return np.column_stack([mesh.nodes[top, :2], sunk[top]])


def _difference(body: ElasticBody, reference: np.ndarray) -> float:
    """Largest difference on the inner nodes of the face over the largest deformation."""
    found = influence_matrix(body, estimate_error=False, cache=False)
    radius = np.hypot(*found.nodes.T)
    inner = (radius > 11e-3) & (radius < 24e-3)
    expected = griddata(reference[:, :2], reference[:, 2], found.nodes[inner])
    error = PRESSURE * found.load_cases["push"][inner] - expected
    return float(np.abs(error).max() / np.abs(expected).max())


def test_same_mesh_gives_the_same_displacement(tmp_path: Path) -> None:
    """All nodes of the face, edges included; the incompatible modes differ where cells are skew."""
    body = _body(5e-3)
    mesh = body.shape.mesh(1.0)
    forces = PRESSURE * np.asarray(body.loads[0].forces(mesh)).ravel()
    free = np.repeat(mesh.nodes[:, 2] > 1e-9, 3)
    matrix = stiffness_matrix(mesh, MODULUS, POISSON)[free][:, free].tocsc()
    own = np.zeros(mesh.unknowns)
    own[free] = spsolve(matrix, forces[free])
    sunk = -own[2::3][mesh.nodes[:, 2] > HEIGHT - 1e-9]
    expected = _calculix(body, tmp_path)[:, 2]
    assert np.abs(sunk - expected).max() < 0.02 * np.abs(expected).max()
    assert np.abs(sunk - expected).mean() < 0.003 * np.abs(expected).max()


@pytest.mark.slow
def test_condensed_body_against_a_finer_mesh(tmp_path: Path) -> None:
    """Hat functions of the face smooth the step of the pressure by some percent."""
    body = _body(5e-3)
    stated = influence_matrix(body, cache=False).error_estimate
    assert _difference(body, _calculix(_body(2e-3), tmp_path)) < max(2.0 * stated, 0.06)
