"""Gears of continuous contact in files: recognised, drafted, run, refused where they are none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toothspace as ts
from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.gearing.meshing import displacement, flow_over_pitch
from toothspace.geometry.cad_export import Section, export_gear, export_section
from toothspace.geometry.continuous_contact import (
    FAMILIES,
    ContinuousGear,
    Family,
    generate_continuous,
    outlines_apart,
    rolled_outline,
)
from toothspace.geometry.curve import turned
from toothspace.geometry.gear_finder import find_gears
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.machines.external_gear.assembly import assemble
from toothspace.machines.external_gear.cad import export_profiles

CASES = Path(__file__).resolve().parents[3] / "cases"
PUMP = CASES / "continuous_pump.toml"
GEARS = "machine.gears."
INCH = 25.4e-3
GENERATED: dict[str, Any] = {
    "family": "arc_involute_arc", "tooth_count": 9, "module": "3.75 mm", "pressure_angle": "20 deg",
    "helix_angle": "23.1225 deg", "face_width": "30 mm", "normal_backlash": "0 mm",
    "center_distance": None, "profile": None, "profile_unit": "mm", "profile_part": None,
}  # fmt: skip
SHAPES: dict[Family, dict[str, float]] = {
    "arc_involute_arc": {"pressure_angle": np.deg2rad(22.0), "root_clearance": 20e-6},
    "circular_arc": {"tip_diameter": 40.5e-3},
    "sinusoidal": {"tip_diameter": 40.5e-3},
    "cycloidal": {},
}


def gear(family: Family, **changes: Any) -> ContinuousGear:
    keys = {"module": 4.08e-3, "tip_land": 0.3e-3, **SHAPES[family], **changes}
    return ContinuousGear(**{"family": family, "tooth_count": 9, **keys})


def drawn(path: Path, tooth: ContinuousGear, unit: float = 1e-3, points: int = 160) -> Path:
    """Outline with another phase and place than our own files have."""
    outline = turned(generate_continuous(tooth, points).closed_polygon(), 0.2)
    export_section(Section(outline + np.array([31e-3, -12e-3])), path, 0.03, unit)
    return path


def keys_of_file(path: Path, **changes: Any) -> dict[str, Any]:
    keys = {"family": "continuous_contact", "profile": str(path), "tooth_count": None,
            "module": None, "pressure_angle": None, **changes}  # fmt: skip
    return {GEARS + key: value for key, value in keys.items()}


@pytest.mark.parametrize("family", FAMILIES)
def test_outline_is_known_by_its_normals(tmp_path: Path, family: Family) -> None:
    """Pitch circle, half a pitch of contact on each side, no gap: from points alone."""
    tooth = gear(family)
    (found,) = find_gears(drawn(tmp_path / "gear.txt", tooth, points=400), 1e-3).gears
    rolled = rolled_outline(found.detected.drawn)
    assert not rolled.refusal
    # the curvature of a cycloid has no bound at the pitch circle
    rel = 2e-4 if family == "cycloidal" else 2e-5
    assert rolled.pitch_radius == pytest.approx(tooth.reference_radius, rel=rel)
    assert rolled.contact_ratio == pytest.approx(0.5, abs=0.04)
    assert rolled.backlash < 1e-6
    assert rolled.gaps[1] < 1e-6 + tooth.root_clearance
    if family != "cycloidal":
        assert rolled.smallest_radius == pytest.approx(tooth.smallest_radius, rel=0.05)
    assert outlines_apart(found.detected.drawn, generate_continuous(tooth, 200)) < 2e-5


def test_gap_of_outlines_is_their_backlash() -> None:
    tooth = gear("circular_arc", backlash=30e-6)
    rolled = rolled_outline(generate_continuous(tooth, 200), 2.0 * tooth.reference_radius)
    assert rolled.backlash == pytest.approx(30e-6, abs=0.5e-6)


@pytest.mark.parametrize(
    ("tip", "reason"), [(40.6e-3, "for 1.3"), (38e-3, "for 0.8"), (36.5e-3, "deeper")]
)
def test_involutes_are_none(tip: float, reason: str) -> None:
    """Whole teeth, short ones with a contact ratio below 1, and stubs over empty roots."""
    profile = generate_profile(InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip), 200)
    assert reason in rolled_outline(profile).refusal


def test_plane_outline_with_a_helix_by_key_is_the_pump_of_the_parameters(tmp_path: Path) -> None:
    given = ts.load_case(PUMP)
    spec = given.machine_spec
    tooth = spec.continuous
    file = drawn(tmp_path / "gear.txt", tooth, INCH)
    angle = np.arctan(spec.helix.turn_per_length * tooth.reference_radius)
    changes = {"profile_unit": "in", "helix_angle": f"{np.rad2deg(angle):.6f} deg"}
    found = given.replace(keys_of_file(file, **changes)).machine_spec
    gears = [assemble(one) for one in (spec, found)]
    assert displacement(gears[1]) == pytest.approx(displacement(gears[0]), rel=1e-3)
    assert gears[1].mesh.center_distance == pytest.approx(gears[0].mesh.center_distance, rel=1e-4)
    assert found.helix.overlap_ratio == pytest.approx(spec.helix.overlap_ratio, rel=1e-3)
    assert found.helix.ripple(flow_over_pitch(gears[1])) < 2e-4


def test_a_mate_half_a_percent_larger_is_as_far_off_at_its_tips(tmp_path: Path) -> None:
    tooth = gear("circular_arc")
    files = [
        drawn(tmp_path / f"{name}.txt", tooth, unit)
        for name, unit in (("drive", 1e-3), ("driven", 1e-3 / 1.005))
    ]
    keys = keys_of_file(files[0]) | {"machine.driven_gear.profile": str(files[1])}
    with pytest.raises(CaseError) as refused:
        _ = ts.load_case(PUMP).replace(keys).machine_spec
    (problem,) = refused.value.problems
    assert problem.key.endswith("driven_gear.profile")
    off = float(problem.found.removeprefix("an outline ").removesuffix(" mm off"))
    assert off == pytest.approx(0.005 * 20.25, rel=0.01)


def refusals(tmp_path: Path) -> dict[str, tuple[dict[str, Any], str]]:
    arcs, waves = (gear(family) for family in ("circular_arc", "sinusoidal"))
    first, other = drawn(tmp_path / "arcs.txt", arcs), drawn(tmp_path / "waves.txt", waves)
    involute = generate_profile(InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.6e-3))
    ordinary = tmp_path / "involute.txt"
    export_gear(involute, ordinary, 0.03)
    loose = {"normal_backlash": None, "center_distance": "36.9 mm"}
    return {
        "partner": (
            keys_of_file(first) | {"machine.driven_gear.profile": str(other)},
            "driven_gear.profile: found an outline .* mm off",
        ),
        "loose": (keys_of_file(first, **loose), "apart where they should touch"),
        "close": (
            keys_of_file(first, **{**loose, "center_distance": "36.5 mm"}), "flanks that overlap"
        ),
        "involute": (
            keys_of_file(ordinary), "gears.family: found 'continuous_contact' with flanks .* touch"
        ),
    }  # fmt: skip


@pytest.mark.parametrize("which", ["partner", "loose", "close", "involute"])
def test_files_that_are_none_are_refused(tmp_path: Path, which: str) -> None:
    keys, message = refusals(tmp_path)[which]
    with pytest.raises(CaseError, match=message):
        ts.load_case(PUMP).replace(keys).machine_spec  # noqa: B018


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [("tip_land", "0.2 mm", "tips are those of the file"), ("profile_teeth", "own", "'equal'"),
     ("profile", None, "profile"), ("axial_slices", 3, "cut its tooth spaces in two")],
)  # fmt: skip
def test_keys_that_an_outline_does_not_have_are_refused(
    tmp_path: Path, key: str, value: object, message: str
) -> None:
    file = drawn(tmp_path / "gear.txt", gear("cycloidal"))
    with pytest.raises(CaseError, match=message):
        ts.load_case(PUMP).replace(keys_of_file(file, **{key: value}))


def test_draft_says_what_gears_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One gear: an equal one beside it. Two that differ: ordinary gears, and why."""
    one, target = drawn(tmp_path / "one.txt", gear("sinusoidal")), tmp_path / "pump.toml"
    assert main(["gear", str(one), "--case", str(target)]) == 0
    assert "tips roll through the roots of an equal gear" in capsys.readouterr().err
    spec = ts.load_case(target).machine_spec
    assert spec.keys.gears.family == "continuous_contact"
    assert spec.helix.overlap_ratio == pytest.approx(1.0, rel=2e-3)
    teeth = [
        generate_continuous(gear(f), 160).closed_polygon() for f in ("sinusoidal", "circular_arc")
    ]
    pair = tmp_path / "pair.txt"
    curves = [points_of(teeth[0]), points_of(teeth[1] + np.array([0.0, 36.72e-3]))]
    pair.write_text("\n\n".join(curves))
    assert main(["gear", str(pair), "--case", str(target), "--force"]) == 0
    assert "no continuous contact: gears whose outlines are" in capsys.readouterr().err
    text = target.read_text()
    assert "# ordinary gears, not of continuous contact" in text
    assert "continuous_contact" not in text


def points_of(outline: Array) -> str:
    return "\n".join(f"{x:.7f} {y:.7f}" for x, y in 1e3 * np.vstack([outline, outline[:1]]))


def agree(file: ts.Case, parameters: ts.Case) -> None:
    """Displacement, mean pressures, flow and its ripple, and axial force of one pump."""
    found = [ts.simulate(case) for case in (file, parameters)]
    first, second = (one.summary() for one in found)
    assert first["status"] == second["status"] == "done"
    for name, rel in {
        "displacement_cm3_per_rev": 1e-3, "mean_flow_L_per_min": 1e-3, "mean_torque_N_m": 1e-3,
        "axial_force_N": 2e-3, "pressure_ripple_bar": 0.02, "max_chamber_pressure_bar": 5e-3,
    }.items():  # fmt: skip
        assert first[name] == pytest.approx(second[name], rel=rel), name
    # of the oil in the gears: a file may need another number of chambers
    means, flows = [], []
    for one in found:
        pressure, volume = one.data["chamber_pressure"].values, one.data["chamber_volume"].values
        means.append((pressure * volume).sum() / volume.sum())
        flow = one.data["dense_outlet_flow_rate"].values
        flows.append(np.std(flow) / flow.mean())
    # the lands of tips are read up to a tenth wider, so that pressure rises elsewhere on the bore
    assert means[0] == pytest.approx(means[1], rel=0.02)
    assert flows[0] == pytest.approx(flows[1], rel=0.05)


@pytest.mark.slow
def test_dxf_runs_as_the_parameters(tmp_path: Path) -> None:
    pytest.importorskip("ezdxf")
    given = ts.load_case(PUMP)
    file = drawn(tmp_path / "gear.dxf", given.machine_spec.continuous, points=400)
    angle = np.rad2deg(np.arctan(given.machine_spec.helix.turn_per_length * 18.349e-3))
    agree(given.replace(keys_of_file(file, helix_angle=f"{angle:.5f} deg")), given)


@pytest.mark.slow
def test_foreign_step_becomes_the_pump_of_the_parameters(tmp_path: Path) -> None:
    """Both gears in one file in inches, along x, off the origin, in another phase."""
    pytest.importorskip("OCP")
    spec, target = ts.load_case(PUMP).machine_spec, tmp_path / "pump.toml"
    parts = export_profiles(spec, tmp_path / "own", "step")
    assembly = tmp_path / "foreign.step"
    write_assembly(parts, 2e3 * spec.continuous.reference_radius, assembly)
    assert main(["gear", str(assembly), "--case", str(target)]) == 0
    case = ts.load_case(target)
    assert case.machine_spec.keys.gears.family == "continuous_contact"
    assert {c.name for c in ts.describe(case).checks if not c.passed} == set()
    generated = case.replace(
        {"machine.driven_gear": None} | {GEARS + key: value for key, value in GENERATED.items()}
    )
    agree(case, generated)


def write_assembly(parts: list[Path], distance: float, target: Path) -> None:
    """Put two solids [mm] into one file, apart by a distance [mm]."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer

    from toothspace.geometry.ocp import silence_ocp

    def turn(axis: tuple[float, float, float], angle: float) -> Any:
        found = gp_Trsf()
        found.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(*axis)), angle)
        return found

    def shift(x: float, y: float, z: float) -> Any:
        found = gp_Trsf()
        found.SetTranslation(gp_Vec(x, y, z))
        return found

    silence_ocp()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", "INCH")
    for path, phase, place in zip(parts, (0.12, 0.31), (0.0, distance), strict=True):
        reader = STEPControl_Reader()
        reader.ReadFile(str(path))
        reader.TransferRoots()
        moves = (turn((0, 0, 1), phase), shift(0.0, place, 0.0), turn((0, 1, 0), 0.5 * np.pi),
                 shift(120.0, -40.0, 15.0))  # fmt: skip
        whole = gp_Trsf()
        for move in moves:
            whole = move.Multiplied(whole)
        shape = BRepBuilderAPI_Transform(reader.OneShape(), whole, True).Shape()
        writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(target))
    Interface_Static.SetCVal_s("write.step.unit", "MM")
