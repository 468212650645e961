"""First case file of a pump from the CAD files of its parts."""

from __future__ import annotations

import re
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


def test_a_pump_of_four_files_is_drafted_with_what_they_hold(tmp_path: Path) -> None:
    """Far beside the origin: gears along z of the files and axes along x, so the outlet at +y."""
    far, half = np.array([60e-3, 3e-3]), np.pi / 12.0
    centers = [shapely.Point(far[0], far[1] + y) for y in (0.0, DISTANCE)]

    def bores(radius: float) -> shapely.Polygon:
        return shapely.union_all([center.buffer(radius, quad_segs=60) for center in centers])

    def gear(y: float, turn: float) -> shapely.Polygon:
        points = generate_profile(GEAR, 80).closed_polygon(turn, (far[0], far[1] + y))
        return shapely.Polygon(points)

    middle = far + np.array([0.0, 0.5 * DISTANCE])
    ports = shapely.box(far[0] - 30e-3, middle[1] - 8e-3, far[0] + 25e-3, middle[1] + 8e-3)
    casing = shapely.box(*(middle - 50e-3), *(middle + 50e-3)).difference(bores(BORE).union(ports))
    block = solid(tmp_path / "block.stl", bores(BORE - 1e-5).difference(bores(8e-3)), 10e-3)
    beside = trimesh.load(block)
    beside.apply_translation([1.5e3 * WIDTH, 0.0, 0.0])
    beside.export(block)
    parts = [
        solid(tmp_path / "upper.stl", gear(DISTANCE, half)),
        solid(tmp_path / "lower.stl", gear(0.0, 0.0), 1.5 * WIDTH),
        solid(tmp_path / "casing.stl", casing),
        block,
    ]
    text = api.draft_case(parts, "mm", SectionRequest(axis="x", plane=3e-3), tmp_path)
    told = dict(re.findall(r'^(\w+) = "?([^"#\n]*[^"# \n])"?', text, re.MULTILINE))
    for key, value in {
        "profile_axis": "x", "profile_plane": "3 mm", "face_width": "12 mm",
        "outlet_toward": "+y", "diameter": "16 mm", "radial_clearance": "8 um",
    }.items():  # fmt: skip
        assert told[key] == value
    clearance = float(text.split('radial_clearance = "')[1].split()[0])
    assert clearance == pytest.approx(1e6 * (BORE - GEAR.tip_radius), abs=0.1)
    # where both base circles and the distance without play leave it along the line of action
    base = 2.0 * GEAR.base_radius
    working, tight = (np.arccos(base / apart) for apart in (DISTANCE, 34.44166e-3))
    play = 2e3 * base * (np.tan(working) - working - np.tan(tight) + tight)
    assert float(text.split("normal backlash ")[1].split()[0]) == pytest.approx(play, rel=5e-3)

    # the casing as it stands, whose port on the outlet's side is 25 mm deep and the other 30 mm
    (tmp_path / "pump.toml").write_text(text)
    case = load_case(tmp_path / "pump.toml")
    for toward, ends in (("+y", (-30e-3, 25e-3)), ("-y", (-25e-3, 30e-3))):
        spec = case.replace({"machine.outlet_toward": toward}).machine_spec
        x = spec.casing_contour[:, 0]
        assert (x.min(), x.max()) == pytest.approx(ends, abs=1e-6)


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
    case = load_case(tmp_path / "pump.toml")
    assert case.machine_spec.drive.tooth.tooth_count == 12
    # a base pitch along the line of action, at the backlash of two radii over the teeth
    pitch, base = 2.0 * np.pi * GEAR.base_radius / 12.0, 2.0 * GEAR.base_radius
    grooves, bearings = case.machine.relief_grooves, case.machine.journal_bearings
    offset = 0.5 * pitch * base / 34.596e-3
    assert grooves.closing_side_offset == pytest.approx(offset, abs=6e-6)
    assert grooves.opening_side_offset == grooves.closing_side_offset
    assert grooves.depth == pytest.approx(0.15 * pitch, abs=0.06e-3)
    assert case.machine.gears.face_width == pytest.approx(10e-3)
    assert bearings.diameter == pytest.approx(0.6 * 2.0 * GEAR.root_radius, rel=1e-3)
    assert bearings.length == bearings.diameter
    assert bearings.radial_clearance == pytest.approx(0.5e-3 * bearings.diameter, abs=0.5e-6)


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
