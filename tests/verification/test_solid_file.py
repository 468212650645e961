"""Bodies of STEP files, meshed by Gmsh: volume, condensation, refusals; needs ``gmsh``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.core.errors import GeometryError
from toothspace.elasticity import (
    AreaPressure,
    ElasticBody,
    PlaneSurface,
    Prism,
    SolidFile,
    Support,
    SweptShape,
    annulus,
    influence_matrix,
)
from toothspace.elasticity import mesh as meshes
from toothspace.elasticity.elements import nodal_masses
from toothspace.elasticity.mesh import mesher

INNER, OUTER, HEIGHT = 10e-3, 25e-3, 12e-3
SECTION = annulus(INNER, OUTER)

needs_gmsh = pytest.mark.skipif(not mesher(), reason="gmsh is not installed")


@pytest.fixture
def ring(tmp_path: Path) -> Path:
    """Ring from z = 0 up, written as a STEP file."""
    pytest.importorskip("OCP")
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    outside = BRepPrimAPI_MakeCylinder(1e3 * OUTER, 1e3 * HEIGHT).Shape()
    bore = BRepPrimAPI_MakeCylinder(1e3 * INNER, 1e3 * HEIGHT).Shape()
    writer = STEPControl_Writer()
    writer.Transfer(BRepAlgoAPI_Cut(outside, bore).Shape(), STEPControl_AsIs)
    path = tmp_path / "ring.step"
    writer.Write(str(path))
    return path


def _body(shape: SolidFile | SweptShape) -> ElasticBody:
    film = PlaneSurface("face", "top", SECTION, 5e-3)
    push = AreaPressure("push", "top", SECTION & annulus(0.5 * INNER, 17e-3))
    return ElasticBody(shape, 100e9, 0.33, 8800.0, (film,), (push,), (Support("bottom", SECTION),))


@needs_gmsh
def test_mesh_has_the_volume_and_looks_outwards(ring: Path) -> None:
    mesh = SolidFile(ring, 4e-3).mesh()
    volume = np.pi * (OUTER**2 - INNER**2) * HEIGHT
    assert nodal_masses(mesh, 1.0).sum() == pytest.approx(volume, rel=0.02)
    centre, normal = mesh.face_frames()
    assert (centre * normal).sum() / 3.0 == pytest.approx(volume, rel=0.02)
    assert len(SolidFile(ring, 4e-3).mesh(1.6).elements) < 0.6 * len(mesh.elements)


@needs_gmsh
def test_solid_deforms_as_the_same_swept_body(ring: Path) -> None:
    """Bushing on its cover under pressure on a part of its face; tetrahedra against hexahedra.

    The step of the pressure is smeared over an element, which differ.
    """
    solid, swept = (
        influence_matrix(_body(shape), estimate_error=False, cache=False)
        for shape in (SolidFile(ring, 4e-3), SweptShape((Prism(SECTION, 0.0, HEIGHT),), 4e-3, 3e-3))
    )
    expected = swept.load_cases["push"]
    error = np.abs(solid.load_cases["push"] - expected) / expected.max()
    assert error.max() < 0.10
    assert error.mean() < 0.03
    assert np.trace(solid.compliance) == pytest.approx(np.trace(swept.compliance), rel=0.05)


def test_missing_program_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(meshes, "find_spec", lambda _: None)
    file = tmp_path / "body.step"
    file.write_text("ISO-10303-21;")
    with pytest.raises(GeometryError, match="found no program gmsh, allowed with it"):
        SolidFile(file, 1e-3).mesh()


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match="found no file, allowed is a STEP file"):
        SolidFile(tmp_path / "no.step", 1e-3).mesh()


@needs_gmsh
def test_broken_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "body.step"
    file.write_text("ISO-10303-21;\nnonsense")
    with pytest.raises(GeometryError, match=r"body\.step: found"):
        SolidFile(file, 1e-3).mesh()


def test_key_follows_the_content(tmp_path: Path) -> None:
    first, second = tmp_path / "a.step", tmp_path / "b.step"
    for file in (first, second):
        file.write_text("same")
    assert SolidFile(first, 1e-3).key() == SolidFile(second, 1e-3).key()
    second.write_text("other")
    assert SolidFile(first, 1e-3).key() != SolidFile(second, 1e-3).key()
