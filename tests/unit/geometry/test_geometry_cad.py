import struct
import sys
from dataclasses import replace

import numpy as np
import pytest

from tests.reference_formulas.involute_deviation import deviations
from toothspace.core.errors import GeometryError
from toothspace.core.files import write_bytes
from toothspace.geometry import cad_import
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.cad_export import export_gear
from toothspace.geometry.cad_import import load_body_sections, load_closed_curves
from toothspace.geometry.curve import signed_area
from toothspace.geometry.gear_pair import pair_from_backlash
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.geometry.profile_detection import gear_profile_from_curve

MOTOR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3, tip_rounding=1e-4)
UNDERCUT = InvoluteGear(9, 2.75e-3)
SQUARE = "0,0\n2,0\n2,2\n0,2\n"


def cut(path, **request):
    sections = load_body_sections(path, 1e-3, SectionRequest(**request))
    return [curve for section in sections for curve in section.curves]


def write(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "gear", "count"),
    [
        (".txt", MOTOR, 200),
        (".txt", UNDERCUT, 200),
        (".dxf", MOTOR, 200),
        (".stl", UNDERCUT, 200),
        (".stl", MOTOR, 200),
        (".step", MOTOR, 80),
    ],
    ids=lambda value: str(getattr(value, "tooth_count", value)),
)
def test_round_trip_reproduces_area_tooth_and_displacement(tmp_path, suffix, gear, count):
    profile = generate_profile(gear, count)
    path = tmp_path / f"gear{suffix}"
    export_gear(profile, path, 7.5e-3)
    assert [item.name for item in tmp_path.iterdir()] == [path.name]
    (curve,) = load_closed_curves(path)
    # the chords of the exported polygon take 4e-5 of the area; solids in STEP have splines
    fine = generate_profile(gear, 2000)
    assert abs(signed_area(curve)) == pytest.approx(fine.area, rel=1e-4)
    found = gear_profile_from_curve(curve)
    assert found.tooth_count == gear.tooth_count
    assert found.center == pytest.approx((0.0, 0.0), abs=1e-7)
    assert found.profile.tip_radius == pytest.approx(gear.tip_radius, abs=1e-7)
    assert found.profile.root_radius == pytest.approx(gear.root_radius, abs=1e-6)
    assert found.profile.tooth_space_area == pytest.approx(fine.tooth_space_area, rel=5e-4)
    assert np.abs(deviations(found.profile, gear)).max() < 1e-6
    # displacement from what the file holds: tip radius and base pitch
    pair = pair_from_backlash(gear, gear, 2e-5)
    pitch = 2.0 * np.pi * found.profile.base_radius / gear.tooth_count
    inner = (0.5 * pair.center_distance) ** 2 + pitch**2 / 12.0
    volume = 7.5e-3 * (found.profile.tip_radius**2 - inner)
    assert volume == pytest.approx(pair.displacement_per_radian(7.5e-3), rel=1e-3)


def test_units_of_files(tmp_path):
    export_gear(generate_profile(MOTOR), tmp_path / "gear.dxf", 7.5e-3, unit=25.4e-3)
    (curve,) = load_closed_curves(tmp_path / "gear.dxf", unit=25.4e-3)
    assert np.hypot(*curve.T).max() == pytest.approx(MOTOR.tip_radius)


@pytest.mark.parametrize(
    "content",
    [
        SQUARE,
        "x;y\n0,0;0,0\n2,0;0,0\n2,0;2,0\n0,0;2,0\n",
        "0;0\n2;0\n2;2\n0;2\n",
        "# remark\nx y z\n0 0 5\n2 0 5\n2 2 5\n0 2 5\n0 0 5\n",
        "0,0\t0,0\n2,0\t0,0\n2,0\t2,0\n0,0\t2,0\n",
        "  0.0   0.0\n 2e0 0.0\n2.0 2.0\n0.0 2.0",
        "\ufeff0,0\n2,0\n2,2\n0,2\n",
        "Maße in mm\n0 0\n2 0\n2 2\n0 2\n".encode("latin-1"),
    ],
    ids=["csv", "decimal comma", "semicolon", "xyz", "tab, decimal comma", "blanks", "BOM",
         "Latin-1"],
)  # fmt: skip
def test_point_files(tmp_path, content):
    (curve,) = load_closed_curves(write(tmp_path, "points.txt", content))
    assert signed_area(curve) == pytest.approx(4e-6)
    assert len(curve) == 4


def drawing(tmp_path, draw, name="drawing.dxf"):
    import ezdxf

    document = ezdxf.new()
    draw(document.modelspace())
    document.saveas(tmp_path / name)
    return tmp_path / name


def test_dxf_bulges_are_true_arcs(tmp_path):
    def draw(space):
        # slot: two lines and two half circles of radius 5, one with negative direction
        space.add_lwpolyline(
            [(0, 0, 0), (10, 0, 1), (10, 10, 0), (0, 10, 1)], format="xyb", close=True
        )

    (curve,) = load_closed_curves(drawing(tmp_path, draw))
    assert abs(signed_area(curve)) == pytest.approx((100.0 + np.pi * 25.0) * 1e-6, rel=1e-5)
    right = curve[curve[:, 0] > 10.001e-3]
    assert np.hypot(*(right - (10e-3, 5e-3)).T) == pytest.approx(5e-3, abs=1e-9)


def test_dxf_negative_bulges_cut_inwards(tmp_path):
    def draw(space):
        space.add_lwpolyline(
            [(0, 0, 0), (20, 0, -1), (20, 10, 0), (0, 10, -1)], format="xyb", close=True
        )

    (curve,) = load_closed_curves(drawing(tmp_path, draw))
    assert abs(signed_area(curve)) == pytest.approx((200.0 - np.pi * 25.0) * 1e-6, rel=1e-5)


def test_dxf_lines_and_arcs_are_chained_in_any_order(tmp_path):
    def draw(space):
        space.add_line((0, 0), (10, 0))
        space.add_line((0, 10), (10, 10))
        space.add_arc((0, 5), 5, 90, 270)
        space.add_arc((10, 5), 5, 270, 90)

    (curve,) = load_closed_curves(drawing(tmp_path, draw))
    assert abs(signed_area(curve)) == pytest.approx((100.0 + np.pi * 25.0) * 1e-6, rel=1e-5)


def test_dxf_circles_splines_polylines_and_layers(tmp_path):
    def draw(space):
        space.add_circle((50, 0), 10, dxfattribs={"layer": "PORT"})
        space.add_polyline2d([(0, 0), (30, 0), (30, 30)], close=True)
        points = [(2 * np.cos(a), 2 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 41)[:-1]]
        from ezdxf.math import fit_points_to_cad_cv

        loop = [(x - 20.0, y, 0.0) for x, y in [*points, points[0]]]
        space.add_spline(dxfattribs={"layer": "SPLINE"}).apply_construction_tool(
            fit_points_to_cad_cv(loop)
        )

    path = drawing(tmp_path, draw)
    areas = [abs(signed_area(curve)) * 1e6 for curve in load_closed_curves(path)]
    assert areas == pytest.approx([450.0, np.pi * 100.0, np.pi * 4.0], rel=1e-3)
    (port,) = load_closed_curves(path, layer="PORT")
    assert abs(signed_area(port)) == pytest.approx(np.pi * 1e-4, rel=1e-5)
    with pytest.raises(GeometryError, match=r"layer 'GROOVE' .*PORT"):
        load_closed_curves(path, layer="GROOVE")


def test_dxf_blocks_stand_where_they_are_inserted(tmp_path):
    """A circle in a block on layer 0, in a block, twice: once scaled, on layers of the inserts."""
    import ezdxf

    document = ezdxf.new()
    inner, outer = document.blocks.new("inner"), document.blocks.new("outer")
    inner.add_circle((0, 0), 2)
    outer.add_blockref("inner", (10, 0), dxfattribs={"layer": "0"})
    outer.add_line((0, -50), (0, 50), dxfattribs={"layer": "CENTRE"})
    space = document.modelspace()
    space.add_blockref("outer", (0, 0), dxfattribs={"layer": "GEAR"})
    space.add_blockref("inner", (50, 0), {"xscale": 3, "yscale": 3, "layer": "HOLE"})
    path = tmp_path / "blocks.dxf"
    document.saveas(path)
    (gear,) = load_closed_curves(path, layer="GEAR")
    assert gear.mean(axis=0) == pytest.approx([10e-3, 0.0], abs=1e-6)
    (hole,) = load_closed_curves(path, layer="HOLE")
    assert abs(signed_area(hole)) == pytest.approx(np.pi * 36e-6, rel=1e-4)
    with pytest.raises(GeometryError, match="CENTRE, GEAR, HOLE"):
        load_closed_curves(path, layer="NONE")


def test_dxf_blocks_of_blocks_without_end_are_refused(tmp_path, monkeypatch):
    """Ten inserts of the block below, nine times: a billion circles in a small file."""
    monkeypatch.setattr(cad_import, "_MOST_ENTITIES", 2_000)
    import ezdxf

    document = ezdxf.new()
    document.blocks.new("b0").add_circle((0, 0), 1)
    for level in range(1, 10):
        block = document.blocks.new(f"b{level}")
        for k in range(10):
            block.add_blockref(f"b{level - 1}", (k, 0))
    document.modelspace().add_blockref("b9", (0, 0))
    path = tmp_path / "laughs.dxf"
    document.saveas(path)
    with pytest.raises(GeometryError, match="more than 2000 entities"):
        load_closed_curves(path)


def two_body_stl(path, drop_facet=False):
    import trimesh

    large = trimesh.creation.box((20.0, 20.0, 10.0))
    small = trimesh.creation.cylinder(radius=3.0, height=10.0, sections=64)
    small.apply_translation((40.0, 0.0, 0.0))
    mesh = trimesh.util.concatenate([large, small])
    if drop_facet:
        mesh.update_faces(np.arange(len(mesh.faces)) > 0)
    path.write_bytes(mesh.export(file_type="stl"))
    return path


def test_bodies_and_plane_of_stl(tmp_path):
    path = two_body_stl(tmp_path / "two.stl")
    both = load_closed_curves(path)
    assert [len(curve) for curve in both] == [4, 64]
    (small,) = cut(path, body=1, plane=4e-3)
    assert small[:, 0].mean() == pytest.approx(40e-3, abs=1e-6)
    with pytest.raises(GeometryError, match="plane_z = 6 mm, allowed -5 to 5 mm"):
        cut(path, plane=6e-3)
    with pytest.raises(GeometryError, match="body = 2, allowed 0 to 1"):
        cut(path, body=2)


@pytest.mark.slow
def test_bodies_beside_the_plane_are_cut_at_their_middle_where_asked(tmp_path):
    import trimesh

    low, high = (trimesh.creation.box((size, size, 10.0)) for size in (20.0, 10.0))
    high.apply_translation((0.0, 0.0, 30.0))
    path = tmp_path / "two.stl"
    trimesh.util.concatenate([low, high]).export(path)
    request = SectionRequest("z", 1e-3)
    assert [cut.height for cut in load_body_sections(path, 1e-3, request)] == [1e-3]
    both = load_body_sections(path, 1e-3, replace(request, missed=True))
    assert [cut.height for cut in both] == pytest.approx([1e-3, 30e-3])


def test_plane_of_step(tmp_path):
    export_gear(generate_profile(UNDERCUT, 60), tmp_path / "gear.step", 7.5e-3)
    text = (tmp_path / "gear.step").read_text()
    assert "PRODUCT('gear" in text
    assert "translator" not in text
    with pytest.raises(GeometryError, match="plane_z = 9 mm, allowed"):
        cut(tmp_path / "gear.step", plane=9e-3)


@pytest.mark.slow
def test_step_solid_that_is_no_prism_is_cut(tmp_path):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(
        BRepPrimAPI_MakeCone(10.0, 5.0, 20.0).Shape(), STEPControl_StepModelType.STEPControl_AsIs
    )
    writer.Write(str(tmp_path / "cone.step"))
    (middle,) = load_closed_curves(tmp_path / "cone.step")
    assert np.hypot(*middle.T) == pytest.approx(7.5e-3, rel=1e-6)
    (upper,) = cut(tmp_path / "cone.step", plane=15e-3)
    assert np.hypot(*upper.T) == pytest.approx(6.25e-3, rel=1e-6)


def test_step_library_keeps_quiet(tmp_path, capfd):
    path = tmp_path / "gear.step"
    export_gear(generate_profile(UNDERCUT, 40), path, 7.5e-3)
    path.write_bytes(path.read_bytes()[:100_000])
    with pytest.raises(GeometryError, match="damaged STEP file"):
        load_closed_curves(path)
    assert capfd.readouterr().out == ""


ENDLESS_LINE = (
    "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n1e999\n21\n0\n0\nENDSEC\n0\nEOF\n"
)
WRONG_FILES = {
    "empty.txt": ("", "empty file"),
    "words.txt": ("alpha beta\ngamma delta\n", "no line with 2 or 3 numbers"),
    "broken.csv": (SQUARE + "1,two\n", "'1,two' in line 5"),
    "columns.txt": (SQUARE + "1,2,3,4\n", "'1,2,3,4' in line 5"),
    "nan.txt": ("0,0\n1,nan\n1,1\n", "not finite in point 2"),
    "short.txt": ("0,0\n1,1\n", "curve of 2 points"),
    "utf16.txt": (SQUARE.encode("utf-16"), "UTF-16"),
    "binary.txt": (bytes(range(256)), "binary file"),
    "no.dxf": ("this is no drawing", "no readable DXF"),
    "inf.dxf": (ENDLESS_LINE, "a LINE that is not finite"),
    "short.stl": (b"\0" * 60, "60 bytes"),
    "truncated.stl": (b"\0" * 80 + struct.pack("<I", 12) + b"\0" * 300, "truncated STL"),
    "ascii.stl": ("solid gear\nfacet normal 0 0 1\nouter loop\n", "truncated ASCII STL"),
    "no.step": ("ISO? no", "no STEP header"),
    "cut.step": ("ISO-10303-21;\nHEADER;\n", "STEP"),
    "gear.igs": ("0", "suffix '.igs', allowed .txt"),
}


@pytest.mark.parametrize("name", WRONG_FILES)
def test_wrong_files_give_one_line_with_the_file(tmp_path, name):
    content, message = WRONG_FILES[name]
    path = write(tmp_path, name, content)
    with pytest.raises(GeometryError) as caught:
        load_closed_curves(path)
    text = str(caught.value)
    assert message in text
    assert text.startswith(f"{path}: found")
    assert "allowed" in text
    assert "\n" not in text


def test_missing_file():
    with pytest.raises(GeometryError, match=r"nowhere\.txt: found no such file"):
        load_closed_curves("nowhere.txt")


def test_open_polyline_is_refused(tmp_path):
    def draw(space):
        space.add_lwpolyline([(0, 0), (10, 0), (10, 10)], close=False)

    with pytest.raises(GeometryError, match="open curve ending at x = 10 mm, y = 10 mm"):
        load_closed_curves(drawing(tmp_path, draw))


def test_chain_with_a_gap_is_refused(tmp_path):
    def draw(space):
        space.add_line((0, 0), (10, 0))
        space.add_line((10, 0.1), (0, 0))

    with pytest.raises(GeometryError, match=r"next end: 0.1 mm\), allowed closed curves"):
        load_closed_curves(drawing(tmp_path, draw))


def test_drawing_without_curves_is_refused(tmp_path):
    path = drawing(tmp_path, lambda space: space.add_text("gear"))
    with pytest.raises(GeometryError, match="found TEXT on all layers"):
        load_closed_curves(path)


def test_leaking_stl_is_refused(tmp_path):
    with pytest.raises(GeometryError, match="not watertight"):
        load_closed_curves(two_body_stl(tmp_path / "leak.stl", drop_facet=True))


def test_missing_step_package_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OCP.STEPControl", None)
    path = write(tmp_path, "gear.step", "ISO-10303-21;")
    with pytest.raises(GeometryError, match=r'pip install "toothspace\[cad\]"'):
        load_closed_curves(path)
    with pytest.raises(GeometryError, match=r'pip install "toothspace\[cad\]"'):
        export_gear(generate_profile(MOTOR), path, 7.5e-3)
    assert path.read_text() == "ISO-10303-21;"


def test_export_refuses_other_formats_and_widths(tmp_path):
    profile = generate_profile(MOTOR)
    with pytest.raises(GeometryError, match=r"'\.iges', allowed \.txt, \.dxf, \.stl, \.step"):
        export_gear(profile, tmp_path / "gear.iges", 7.5e-3)
    with pytest.raises(GeometryError, match=r"face_width: found -0\.01 m"):
        export_gear(profile, tmp_path / "gear.stl", -1e-2)


def test_failed_write_leaves_the_old_file(tmp_path):
    path = write(tmp_path, "kept.txt", "old")
    with pytest.raises(TypeError):
        write_bytes(path, "text, not bytes")
    assert [item.name for item in tmp_path.iterdir()] == ["kept.txt"]
    assert path.read_text() == "old"
