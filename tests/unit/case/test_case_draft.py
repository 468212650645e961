"""First case file of a pump from the CAD files of its parts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from toothspace import api
from toothspace.case import load_case
from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.cad_export import Section, export_section
from toothspace.geometry.involute import InvoluteGear, generate_profile

trimesh = pytest.importorskip("trimesh")

GEAR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3)
DISTANCE, BORE, WIDTH = 34.567e-3, 20.211e-3, 8e-3


def outline(y: float, turn: float = 0.0) -> np.ndarray:
    return generate_profile(GEAR, 200).closed_polygon(turn, (5e-3, 3e-3 + y))


def solid(path: Path, section: shapely.Polygon, height: float = WIDTH) -> Path:
    """STL in millimetres whose z axis becomes the x axis of the file."""
    rings = [shapely.get_coordinates(ring)[:-1] for ring in (section.exterior, *section.interiors)]
    export_section(Section(rings[0], tuple(rings[1:])), path, height)
    mesh = trimesh.load(path)
    mesh.vertices = mesh.vertices[:, [2, 0, 1]]
    mesh.export(path)
    return path


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two gears, the one below on the longer shaft, and a casing with a port on each side."""
    folder = tmp_path_factory.mktemp("parts")
    half = np.pi / 12.0
    centers = [shapely.Point(5e-3, 3e-3 + y) for y in (0.0, DISTANCE)]
    bores = shapely.union_all([center.buffer(BORE, quad_segs=180) for center in centers])
    middle = 3e-3 + 0.5 * DISTANCE
    ports = shapely.box(-0.02, middle - 8e-3, 0.03, middle + 8e-3)
    block = shapely.box(-0.05, -0.05, 0.06, 0.09).difference(bores.union(ports))
    gears = [
        solid(folder / "upper.stl", shapely.Polygon(outline(DISTANCE, half))),
        solid(folder / "lower.stl", shapely.Polygon(outline(0.0)), 1.5 * WIDTH),
    ]
    return [*gears, solid(folder / "casing.stl", block)]


@pytest.mark.slow
def test_pump_of_several_files_becomes_a_case(
    parts: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    target = parts[0].parent / "pump.toml"
    given = ["gear", *map(str, parts), "--case", str(target)]
    assert main(given) == 0
    assert "center_distance_mm" in capsys.readouterr().out
    case = load_case(target)
    spec = case.machine_spec
    assert spec.center_distance == pytest.approx(DISTANCE, abs=1e-8)
    assert spec.drive.face_width == pytest.approx(1.5 * WIDTH, abs=1e-8)
    assert case.machine.gears.profile.name == "lower.stl"
    assert case.machine.casing.radial_clearance == pytest.approx(BORE - GEAR.tip_radius, abs=2e-6)
    # without the number, the distance follows from the frame that the files share
    alone = case.replace({"machine.gears.center_distance": None})
    assert alone.machine_spec.center_distance == pytest.approx(DISTANCE, abs=1e-8)
    before = target.read_text()
    assert main(given) == 2
    assert "--case: found" in capsys.readouterr().err
    assert target.read_text() == before


def test_bore_of_a_mesh_seals_as_the_circle_that_was_meshed() -> None:
    """Chords of 13 um in a bore with 25 um of clearance: its circle counts, ports stay straight."""
    from toothspace.geometry.curve import with_arcs

    angle = np.arange(90) * 2.0 * np.pi / 90
    circle = BORE * np.column_stack([np.cos(angle), np.sin(angle)])
    for curve in (circle, circle[::-1]):
        assert np.hypot(*with_arcs(curve).T) == pytest.approx(BORE, abs=1e-8)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert np.array_equal(with_arcs(square), square)


def test_single_gear_meshes_with_its_equal(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "gear.txt", 1e3 * outline(0.0), fmt="%.9f")
    text = api.draft_case([tmp_path / "gear.txt"], "mm", SectionRequest(), tmp_path)
    assert 'normal_backlash = "0.11 mm"      # assumed' in text
    assert "module 2.75 mm, pressure angle 20 deg, profile shift 0.3" in text
    (tmp_path / "pump.toml").write_text(text)
    assert load_case(tmp_path / "pump.toml").machine_spec.drive.tooth.tooth_count == 12


def test_files_without_a_machine_are_named(tmp_path: Path) -> None:
    plate = solid(tmp_path / "plate.stl", shapely.box(0.0, 0.0, 0.02, 0.01))
    with pytest.raises(CaseError, match=r"plate\.stl: --case: found no machine"):
        api.draft_case([plate], "mm", SectionRequest(), tmp_path)
    assert main(["gear", str(plate), str(tmp_path / "absent.stl")]) == 2


def test_surface_that_touches_itself_is_closed(tmp_path: Path) -> None:
    """Two boxes with one common edge, as CAD programs leave them: four triangles at it."""
    from toothspace.geometry.cad_import import load_body_sections

    boxes = trimesh.util.concatenate(
        [
            trimesh.creation.box(bounds=[[0, 0, 0], [10, 10, 10]]),
            trimesh.creation.box(bounds=[[10, 10, 0], [20, 20, 10]]),
        ]
    )
    boxes.export(tmp_path / "boxes.stl")
    (cut,) = load_body_sections(tmp_path / "boxes.stl", 1e-3, SectionRequest("z", 4e-3))
    area = sum(shapely.Polygon(curve).area for curve in cut.curves)
    assert area == pytest.approx(200e-6)
