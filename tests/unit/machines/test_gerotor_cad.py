"""Gerotor rotors through CAD and text files and back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.gerotor_designs import CYCLOIDAL, TROCHOIDAL, machine
from toothspace import api
from toothspace.case import load_case
from toothspace.cli import main
from toothspace.core.errors import CaseError, GeometryError
from toothspace.geometry.body_section import SectionRequest
from toothspace.geometry.cad_export import Section, export_section, smooth_pieces
from toothspace.geometry.cad_import import load_closed_curves
from toothspace.geometry.curve import signed_area
from toothspace.machines.gerotor.cad import export_profiles
from toothspace.machines.gerotor.pockets import lobe_path, pockets
from toothspace.machines.gerotor.profiles import rotors_from
from toothspace.machines.gerotor.rotor_files import DrawnRotor, drawn_eccentricity, size_beside

PLACES = np.radians(np.arange(0.0, 360.0, 2.5))


@pytest.mark.parametrize(
    "suffix", ["txt", "dxf", "stl", pytest.param("step", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("design", [TROCHOIDAL, CYCLOIDAL], ids=["trochoidal", "cycloidal"])
def test_rotors_survive_a_round_trip(design, suffix, tmp_path):
    """Written with bore and rim, read back: outlines, displacement and throats as they were.

    Near the smallest pocket the edges of cycloids have smaller radii than files resolve.
    """
    if suffix == "step":
        pytest.importorskip("OCP")
    spec = machine(replace(design, shaft_diameter=10e-3))
    paths = export_profiles(spec, tmp_path / "pump", suffix)
    assert [p.name for p in paths[:2]] == [f"pump_inner.{suffix}", f"pump_outer.{suffix}"]
    assert [p.name for p in paths[2:]] == ["pump_contacts.txt"] * (suffix == "txt")
    read = replace(
        design,
        kind=None,
        generating_radius=None,
        lobe_radius=None,
        inner_profile=paths[0],
        outer_profile=paths[1],
        tip_clearance=0.0,
    )
    written, found = rotors_from(design), rotors_from(read)
    for name in ("inner", "outer"):
        first, second = (shapely.Polygon(getattr(r, name)) for r in (written, found))
        assert second.area == pytest.approx(first.area, rel=1e-4)
        assert first.symmetric_difference(second).area < 2e-4 * first.area
    exact, again = pockets(design, written, 140), pockets(read, found, 140)
    assert again.displaced_area == pytest.approx(exact.displaced_area, rel=5e-4)
    assert again.area == pytest.approx(exact.area, abs=2e-4 * float(np.ptp(exact.area)))
    path = lobe_path(read, found, PLACES)
    assert path.gap == pytest.approx(design.tip_clearance, abs=0.1e-6)
    away = np.cos(PLACES) < np.cos(np.radians(45.0))
    exact_radius = lobe_path(design, written, PLACES).relative_radius
    assert path.relative_radius[away] == pytest.approx(exact_radius[away], rel=0.04)


def test_bore_and_rim_are_in_the_solid(tmp_path):
    """Circles of a section file: the bore within the toothed curve, the rim round the other."""
    spec = machine(replace(TROCHOIDAL, shaft_diameter=10e-3))
    inner, outer = (load_closed_curves(p) for p in export_profiles(spec, tmp_path / "pump", "dxf"))
    assert len(inner) == len(outer) == 2
    rim = 0.5 * spec.housing.outer_rotor_diameter
    for circle, radius in ((inner[1], 5e-3), (outer[0], rim)):
        assert np.hypot(*circle.T) == pytest.approx(radius, rel=1e-9)


def test_pieces_join_at_corners():
    """A square of many points is cut at its four corners; a circle into two halves."""
    side = np.linspace(-1.0, 1.0, 21)[:-1]
    ones = np.ones_like(side)
    square = np.vstack(
        [
            np.column_stack([side, -ones]),
            np.column_stack([ones, side]),
            np.column_stack([-side, ones]),
            np.column_stack([-ones, -side]),
        ]
    )
    assert len(smooth_pieces(square)) == 4
    angle = 2.0 * np.pi * np.arange(90) / 90
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    pieces = smooth_pieces(circle)
    assert len(pieces) == 2
    assert np.array_equal(pieces[0][-1], pieces[1][0])
    assert np.array_equal(pieces[1][-1], pieces[0][0])
    assert signed_area(circle) > 0.0


def test_unknown_suffix_is_refused(tmp_path):
    """One line with what is allowed."""
    section = Section(np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]]))
    with pytest.raises(GeometryError, match=r"allowed \.txt, \.dxf, \.stl, \.step"):
        export_section(section, tmp_path / "rotor.obj", 1e-3)


def assembly(folder: Path, tooth_count: int = 6) -> Path:
    """Both rotors in one STL in inches, apart by the eccentricity, axis along x."""
    trimesh = pytest.importorskip("trimesh")
    design = replace(TROCHOIDAL, inner_tooth_count=tooth_count, shaft_diameter=10e-3)
    inner, outer = export_profiles(machine(design), folder / "pump", "stl")
    meshes = [trimesh.load(inner), trimesh.load(outer)]
    meshes[0].apply_translation([0.0, -1e3 * design.eccentricity, 0.0])
    both = trimesh.util.concatenate(meshes)
    both.vertices = both.vertices[:, [2, 0, 1]] / 25.4
    both.export(folder / "assembly.stl")
    return folder / "assembly.stl"


@pytest.mark.parametrize("tooth_count", [pytest.param(4, marks=pytest.mark.slow), 6])
def test_assembly_becomes_the_machine_that_was_drawn(tmp_path, tooth_count):
    """Axis, teeth, eccentricity, width, bore and rim found; displacement that of the design."""
    file = assembly(tmp_path, tooth_count)
    target = tmp_path / "pump.toml"
    target.write_text(api.draft_case([file], "in", SectionRequest(), tmp_path))
    # the numbers of the draft may be left out: the files hold them
    names = ("inner_tooth_count", "eccentricity", "face_width")
    case = load_case(target).replace({f"machine.rotors.{name}": None for name in names})
    rotors = case.machine_spec.rotors
    assert rotors.inner_tooth_count == tooth_count
    assert rotors.eccentricity == pytest.approx(2.5e-3, abs=2e-7)
    assert rotors.face_width == pytest.approx(12e-3, abs=1e-8)
    assert rotors.shaft_diameter == pytest.approx(10e-3, abs=1e-7)
    assert case.machine_spec.housing.outer_rotor_diameter == pytest.approx(52e-3, abs=1e-7)
    design = replace(TROCHOIDAL, inner_tooth_count=tooth_count)
    exact = pockets(design, rotors_from(design), 140).displaced_area
    assert pockets(rotors, rotors_from(rotors), 140).displaced_area == pytest.approx(
        exact, rel=1e-4
    )


@pytest.mark.slow
def test_command_drafts_a_set_with_few_lobes(tmp_path, capsys):
    """Four lobes are no gear, the five around them are a ring; the case is written all the same."""
    file = assembly(tmp_path, 4)
    target = tmp_path / "few.toml"
    assert main(["gear", str(file), "--unit", "in", "--case", str(target)]) == 0
    said = capsys.readouterr()
    assert "Case:" in said.err
    assert "ring_gears" in said.out
    assert load_case(target).machine_spec.rotors.inner_tooth_count == 4


def told(text: str, key: str) -> float:
    """Length in a drafted case. [mm]."""
    return float(text.split(f'{key} = "')[1].split()[0])


def rotor(curve: np.ndarray, *others: np.ndarray, axis: tuple[float, ...] = (0.0, 0.0, 1.0)):
    return DrawnRotor(Path("a.step"), curve, 6, np.array(axis), 0.01, others)


def test_rim_and_bore_are_the_circles_round_and_within_a_rotor():
    """A bore with a flat, a rim, and a hole beside the axis of a rotor off the origin."""
    turn = 2.0 * np.pi * np.arange(360) / 360
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    center = np.array([3.0, -2.0])
    flat = np.minimum(1.5 * circle, 1.2) + center
    drawn = rotor(5.0 * circle + center, 7.0 * circle + center, 0.3 * circle + center + 3.0, flat)
    assert size_beside(drawn, outside=True) == pytest.approx(14.0)
    assert size_beside(drawn, outside=False) == pytest.approx(3.0)
    assert size_beside(rotor(circle), outside=True) is None


def test_eccentricity_is_the_distance_of_parallel_axes():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    moved = rotor(square + np.array([3e-3, -4e-3]))
    assert drawn_eccentricity(rotor(square), moved) == pytest.approx(5e-3)
    assert drawn_eccentricity(rotor(square), rotor(square)) is None
    opposite, leaning = (
        replace(moved, axis=np.array(axis)) for axis in ((0.0, 0.0, -1.0), (0.0, 0.6, 0.8))
    )
    assert drawn_eccentricity(rotor(square), opposite) == pytest.approx(5e-3)
    assert drawn_eccentricity(rotor(square), leaning) is None


def test_what_files_do_not_hold_is_asked_for(tmp_path):
    """Rotors drawn about one centre each; a file in another unit; a wrong tooth count."""
    export_profiles(machine(TROCHOIDAL), tmp_path / "pump", "dxf")
    text = api.draft_case(
        [tmp_path / f"pump_{name}.dxf" for name in ("inner", "outer")],
        "mm",
        SectionRequest(),
        tmp_path,
    )
    assert "assumed: give the distance of the rotor centres" in text
    # lobes across 43.43 mm at most, of a set of six teeth
    assert told(text, "eccentricity") == pytest.approx(0.1 * 43.43 / 6.0, rel=3e-3)
    assert told(text, "outer_rotor_diameter") == pytest.approx(1.2 * 43.43, rel=3e-3)
    assert told(text, "face_width") == 10.0
    (tmp_path / "pump.toml").write_text(text)
    case = load_case(tmp_path / "pump.toml")
    for changes, message in (
        ({"eccentricity": None}, "rotors.eccentricity: found nothing, allowed compulsory unless"),
        ({"face_width": None}, "rotors.face_width: found nothing, allowed compulsory unless"),
        ({"inner_tooth_count": 5}, "found 5, but 6 teeth in the profile"),
        ({"profile_unit": "in"}, "profile_unit: found 'in', with which"),
    ):
        with pytest.raises(CaseError, match=message):
            case.replace({f"machine.rotors.{name}": x for name, x in changes.items()}).check()
