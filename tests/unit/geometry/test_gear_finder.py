"""Gears in solid files: any axis, hub and shaft, helical teeth, names, damaged files."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh

from toothspace.core.errors import GeometryError
from toothspace.geometry import cad_import, limited_reading
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.cad_export import Section, export_gear, export_section
from toothspace.geometry.cad_import import load_closed_curves
from toothspace.geometry.gear_data import file_report, flank_warnings, gear_data
from toothspace.geometry.gear_finder import find_gears
from toothspace.geometry.involute import InvoluteGear, generate_profile

MOTOR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3, tip_rounding=1e-4)
WIDTH = 7.5e-3


def gear_mesh(twist: float = 0.0, layers: int = 1, points: int = 200) -> trimesh.Trimesh:
    """Gear along z from 0 to its width, turned by an angle from end to end, in mm."""
    return outline_solid(generate_profile(MOTOR, points).closed_polygon() * 1e3, twist, layers)


def outline_solid(outline: np.ndarray, twist: float, layers: int) -> trimesh.Trimesh:
    count = len(outline)
    rings = []
    for layer in range(layers + 1):
        angle = twist * layer / layers
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        rings.append(np.column_stack([outline @ turn, np.full(count, 7.5 * layer / layers)]))
    vertices = np.vstack([*rings, [[0.0, 0.0, 0.0]], [[0.0, 0.0, 7.5]]])
    bottom, top = len(vertices) - 2, len(vertices) - 1
    here = np.arange(count)
    ahead = (here + 1) % count
    faces = [np.column_stack([np.full(count, bottom), ahead, here])]
    for layer in range(layers):
        a, b = layer * count + here, layer * count + ahead
        faces += [np.column_stack([a, b, b + count]), np.column_stack([a, b + count, a + count])]
    last = layers * count
    faces.append(np.column_stack([np.full(count, top), last + here, last + ahead]))
    return trimesh.Trimesh(vertices, np.vstack(faces), process=False)


def write_stl(path: Path, mesh: trimesh.Trimesh, *, text: bool = False) -> Path:
    path.write_bytes(
        mesh.export(file_type="stl_ascii").encode() if text else mesh.export(file_type="stl")
    )
    return path


def turned(mesh: trimesh.Trimesh, axis: tuple[float, float, float]) -> trimesh.Trimesh:
    """Turn z to an axis and move the gear away from the origin."""
    moved = mesh.copy()
    moved.apply_transform(trimesh.geometry.align_vectors((0.0, 0.0, 1.0), axis))
    moved.apply_translation((5.0, -3.0, 11.0))
    return moved


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (0, 1, 0), (0.3, -0.5, 0.8)])
def test_axis_is_found_by_symmetry(tmp_path: Path, axis: tuple[float, float, float]) -> None:
    path = write_stl(tmp_path / "gear.stl", turned(gear_mesh(), axis))
    (found,) = find_gears(path, 1e-3).gears
    unit = np.array(axis) / np.linalg.norm(axis)
    assert np.linalg.norm(np.cross(found.axis, unit)) < 1e-5
    assert found.face_width == pytest.approx(WIDTH, rel=1e-5)
    assert found.helix_angle == 0.0
    # the centre of the gear lies on its axis
    away = found.center - 1e-3 * np.array([5.0, -3.0, 11.0])
    assert np.linalg.norm(np.cross(away, unit)) < 1e-6
    data = gear_data(found.detected.profile)
    assert data.module == pytest.approx(2.75e-3, rel=1e-4)
    assert data.profile_shift == pytest.approx(0.3, abs=1e-3)
    assert data.tip_rounding == pytest.approx(1e-4, abs=3e-5)


def test_axis_can_be_given(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "gear.stl", turned(gear_mesh(), (1, 0, 0)))
    (found,) = find_gears(path, 1e-3, SectionRequest(axis="x")).gears
    assert found.detected.tooth_count == 12
    with pytest.raises(GeometryError, match=r"body 0 at .* along \(0, 0, 1\); profile_axis"):
        find_gears(path, 1e-3, SectionRequest(axis="z"))


def test_hub_shaft_and_housing_are_not_the_gear(tmp_path: Path) -> None:
    gear = gear_mesh()
    shaft = trimesh.creation.cylinder(radius=9.0, height=60.0, sections=128)
    shaft.apply_translation((0.0, 0.0, 35.0 + 7.5))
    casing = trimesh.creation.box((100.0, 60.0, 20.0))
    casing.apply_translation((90.0, 0.0, 0.0))
    path = write_stl(tmp_path / "pump.stl", trimesh.util.concatenate([casing, gear, shaft]))
    contents = find_gears(path, 1e-3)
    (found,) = contents.gears
    assert found.detected.tooth_count == 12
    assert len(contents.others) == 2
    assert found.face_width == pytest.approx(WIDTH, rel=1e-5)


@pytest.mark.slow
def test_gear_and_shaft_of_one_body(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Vec
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    from toothspace.geometry.cad_export import gear_section, step_face

    teeth = BRepPrimAPI_MakePrism(
        step_face(gear_section(generate_profile(MOTOR, 60))), gp_Vec(0, 0, 7.5)
    )
    place = gp_Ax2(gp_Pnt(0, 0, -40), gp_Dir(0, 0, 1))
    shaft = BRepPrimAPI_MakeCylinder(place, 9.0, 70.0)
    writer = STEPControl_Writer()
    writer.Transfer(BRepAlgoAPI_Fuse(teeth.Shape(), shaft.Shape()).Shape(), STEPControl_AsIs)
    writer.Write(str(tmp_path / "shaft.step"))
    (found,) = find_gears(tmp_path / "shaft.step", 1e-3).gears
    assert found.detected.tooth_count == 12
    assert found.center[2] == pytest.approx(0.5 * WIDTH, abs=1e-5)
    assert found.detected.profile.tip_radius == pytest.approx(MOTOR.tip_radius, abs=1e-6)


@pytest.mark.parametrize("angle", [15.0, -8.0])
def test_helix_angle_is_found(tmp_path: Path, angle: float) -> None:
    """The twist of a helix of radius r over a width b is b tan(beta) / r."""
    middle = 0.5 * (MOTOR.tip_radius + MOTOR.root_radius)
    twist = WIDTH * np.tan(np.deg2rad(angle)) / middle
    path = write_stl(tmp_path / "helical.stl", gear_mesh(twist, layers=16))
    (found,) = find_gears(path, 1e-3).gears
    assert np.rad2deg(found.helix_angle) == pytest.approx(angle, rel=0.01)


def test_text_stl_with_few_digits_is_closed_by_merging(tmp_path: Path) -> None:
    mesh = gear_mesh(points=80)
    noisy = mesh.triangles + 2e-6 * np.random.default_rng(3).uniform(-1, 1, mesh.triangles.shape)
    lines = ["solid gear"]
    for triangle in noisy:
        corners = "\n".join("vertex " + " ".join(f"{v:.9e}" for v in corner) for corner in triangle)
        lines.append(f"facet normal 0 0 1\nouter loop\n{corners}\nendloop\nendfacet")
    path = tmp_path / "gear.stl"
    path.write_text("\n".join([*lines, "endsolid gear"]))
    (found,) = find_gears(path, 1e-3).gears
    assert found.detected.profile.base_radius == pytest.approx(MOTOR.base_radius, abs=1.5e-6)


@pytest.mark.slow
def test_many_triangles_are_cut_in_seconds(tmp_path: Path) -> None:
    mesh = gear_mesh(layers=120, points=200)
    assert len(mesh.faces) > 550_000
    path = write_stl(tmp_path / "fine.stl", mesh)
    start = time.process_time()
    (found,) = find_gears(path, 1e-3).gears
    assert found.detected.tooth_count == 12
    assert time.process_time() - start < 20.0


def test_coordinates_that_are_no_numbers_are_refused_in_one_line(tmp_path: Path) -> None:
    """A signalling NaN, which warns when it is cast."""
    path = write_stl(tmp_path / "gear.stl", gear_mesh(points=40))
    content = bytearray(path.read_bytes())
    content[96:100] = b"\x01\x00\x80\x7f"
    path.write_bytes(bytes(content))
    with pytest.raises(GeometryError, match="found no finite triangles"):
        find_gears(path, 1e-3)


def step_gear(folder: Path) -> Path:
    path = folder / "gear.step"
    export_gear(generate_profile(InvoluteGear(9, 2.75e-3), 40), path, WIDTH)
    return path


@pytest.mark.slow
def test_damaged_step_file_is_refused_in_one_line(tmp_path: Path) -> None:
    path = step_gear(tmp_path)
    damaged, random = bytearray(path.read_bytes()), np.random.default_rng(0)
    for place in random.integers(300, len(damaged), 20):
        damaged[place] ^= 1 << int(random.integers(0, 8))
    path.write_bytes(bytes(damaged))
    with pytest.raises(GeometryError) as caught:
        load_closed_curves(path)
    assert str(caught.value).startswith(f"{path}: found")
    assert "\n" not in str(caught.value)


def test_reader_that_dies_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = step_gear(tmp_path)
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(GeometryError, match="damaged STEP file"):
        load_closed_curves(path)


def test_reading_ends_after_its_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = step_gear(tmp_path)
    monkeypatch.setattr(limited_reading, "TIME_LIMIT", 0.05)
    with pytest.raises(GeometryError, match=r"takes more than 0\.05 s to read"):
        load_closed_curves(path)


@pytest.mark.parametrize("suffix", ["txt", "dxf", "stl"])
def test_large_files_are_read_within_the_limits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    """As small ones, but in the process with limits; beyond them in one line."""
    path = tmp_path / f"gear.{suffix}"
    export_gear(generate_profile(MOTOR, 80), path, WIDTH)
    here = load_closed_curves(path)
    monkeypatch.setattr(cad_import, "_LARGE", 0)
    monkeypatch.setattr(cad_import, "READ_HERE", 0)
    elsewhere = load_closed_curves(path)
    assert [len(curve) for curve in elsewhere] == [len(curve) for curve in here]
    assert np.array_equal(elsewhere[0], here[0])
    monkeypatch.setattr(limited_reading, "TIME_LIMIT", 0.01)
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(GeometryError, match=f"found a {suffix.upper()} file that takes more than"):
        load_closed_curves(path)


@pytest.mark.parametrize("angle", [15.0, -25.0])
def test_helical_gears_have_the_module_of_their_tool(tmp_path: Path, angle: float) -> None:
    """Normal module 2.75 mm, 20 deg, a helix on the reference circle: transverse by ISO 21771."""
    helix = np.deg2rad(angle)
    transverse = InvoluteGear(
        12,
        2.75e-3 / np.cos(helix),
        np.arctan(np.tan(np.deg2rad(20.0)) / np.cos(helix)),
        0.3 * np.cos(helix),
        42e-3,
    )
    outline = generate_profile(transverse, 200).closed_polygon() * 1e3
    reference = 0.5 * 12 * transverse.module
    twist = WIDTH * np.tan(helix) / reference
    path = write_stl(tmp_path / "helical.stl", outline_solid(outline, twist, 24))
    (found,) = find_gears(path, 1e-3).gears
    data = gear_data(found.detected.profile, found.helix_angle)
    assert data.standard
    assert np.rad2deg(data.helix_angle) == pytest.approx(angle, rel=0.01)
    assert data.normal_module == pytest.approx(2.75e-3, rel=2e-3)
    assert np.rad2deg(data.normal_pressure_angle) == pytest.approx(20.0, abs=0.01)
    assert data.profile_shift / np.cos(data.helix_angle) == pytest.approx(0.3, abs=0.01)


@pytest.mark.parametrize("draft", [0.0, 0.5, 1.5, 30.0])
def test_teeth_that_taper_are_named(tmp_path: Path, draft: float) -> None:
    """Drafted, conical and bevel teeth: sections shrink along the axis by tan(draft)."""
    mesh = gear_mesh(points=120, layers=4)
    share = np.tan(np.deg2rad(draft)) * mesh.vertices[:, 2] / (1e3 * MOTOR.tip_radius)
    mesh.vertices[:, :2] *= 1.0 - share[:, None]
    contents = find_gears(write_stl(tmp_path / "gear.stl", mesh), 1e-3)
    assert np.rad2deg(contents.gears[0].taper) == pytest.approx(draft, rel=0.05, abs=1e-9)
    assert [line for line in flank_warnings(contents) if "taper" in line] == (
        [] if draft == 0.0 else flank_warnings(contents)[:1]
    )


def extruded(path: Path, outline: shapely.Polygon) -> trimesh.Trimesh:
    """Solid of a face with holes in mm, as an export writes it."""
    rings = [np.asarray(r.coords)[:-1] * 1e-3 for r in (outline.exterior, *outline.interiors)]
    export_section(Section(rings[0], tuple(rings[1:])), path, WIDTH)
    return trimesh.load(path)


def ring_outline(bore: np.ndarray, outside_diameter: float) -> shapely.Polygon:
    return shapely.Point(0.0, 0.0).buffer(0.5 * outside_diameter, 64) - shapely.Polygon(bore)


def test_ring_gear_and_pinion_of_a_crescent_set(tmp_path: Path) -> None:
    """The bore is that of an external gear of the same base circle; backlash by its own formula."""
    module, angle, counts, shifts = 2.5e-3, np.deg2rad(20.0), (13, 19), (0.3, 0.3)
    pinion, spaces = (
        InvoluteGear(z, module, angle, x, module * (z + 2.0))
        for z, x in zip(counts, shifts, strict=True)
    )
    teeth, bore = (generate_profile(g, 300).closed_polygon() * 1e3 for g in (pinion, spaces))
    distance = 8.0
    inner = outline_solid(teeth, 0.0, 1)
    inner.apply_translation((distance, 0.0, 0.0))
    ring = extruded(tmp_path / "ring.stl", ring_outline(bore, 70.0))
    path = write_stl(tmp_path / "set.stl", trimesh.util.concatenate([ring, inner]))
    contents = find_gears(path, 1e-3)
    (found,), (gear,) = contents.rings, contents.gears
    assert (found.detected.tooth_count, gear.detected.tooth_count) == (19, 13)
    assert contents.others == ()
    assert found.face_width == pytest.approx(WIDTH, rel=1e-5)
    report = file_report(contents)
    numbers = report["ring_gears"][0]
    assert numbers["module_mm"] == pytest.approx(2.5, rel=1e-4)
    assert numbers["tip_diameter_mm"] < numbers["root_diameter_mm"]
    assert numbers["root_diameter_mm"] == pytest.approx(2e3 * spaces.tip_radius, rel=1e-4)
    pair = report["pairs"][0]
    assert pair["center_distance_mm"] == pytest.approx(distance, abs=1e-3)
    working = np.arccos((spaces.base_radius - pinion.base_radius) / (1e-3 * distance))
    pitch = np.array([spaces.base_radius, pinion.base_radius]) / np.cos(working)
    # arc of the space of the ring less that of the tooth on their rolling circles
    space, tooth = (
        2.0 * r * (g.base_half_angle - np.tan(working) + working)
        for r, g in zip(pitch, (spaces, pinion), strict=True)
    )
    assert pair["normal_backlash_mm"] == pytest.approx(
        1e3 * (space - tooth) * np.cos(working), abs=2e-3
    )


def test_outer_rotor_of_a_gerotor_set(tmp_path: Path) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 700, endpoint=False)
    bore = (20.0 + 2.0 * np.cos(7 * turn))[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    extruded(tmp_path / "outer.stl", ring_outline(bore, 52.0))
    contents = find_gears(tmp_path / "outer.stl", 1e-3)
    assert contents.gears == ()
    (rotor,) = contents.rings
    assert rotor.detected.tooth_count == 7
    assert rotor.internal


def test_plain_bores_are_no_teeth(tmp_path: Path) -> None:
    bores = shapely.union_all([shapely.Point(x, 0.0).buffer(16.0, 64) for x in (-13.0, 13.0)])
    extruded(tmp_path / "casing.stl", shapely.box(-45, -30, 45, 30) - bores)
    with pytest.raises(GeometryError, match="repeating teeth"):
        find_gears(tmp_path / "casing.stl", 1e-3)
