"""Profiles from files: contact and trapped volume hang on the smooth flank, not on its noise."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from toothspace import api
from toothspace.case import load_case
from toothspace.core.errors import CaseError, GeometryError
from toothspace.geometry.cad_export import export_gear
from toothspace.geometry.gear_data import gear_report
from toothspace.geometry.involute import InvoluteGear, generate_profile, tooth_form
from toothspace.geometry.profile_detection import gear_profile_from_curve
from toothspace.machines.external_gear.part_files import check_unit
from toothspace.model.description import MachineDescription

MOTOR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3, tip_rounding=1e-4)
CASE = Path(__file__).parents[3] / "cases" / "egm12_motor_profile.toml"


def outline(points_per_tooth: int = 200, gear: InvoluteGear = MOTOR) -> np.ndarray:
    return generate_profile(gear, points_per_tooth).closed_polygon()


def wavy(points: np.ndarray, amplitude: float, length: float = 0.5e-3) -> np.ndarray:
    """Move flanks along their normal by a wave over the radius."""
    radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
    moved = angle + amplitude * np.sin(2.0 * np.pi * radius / length) / MOTOR.base_radius
    return np.column_stack([radius * np.cos(moved), radius * np.sin(moved)])


def meshed(points: np.ndarray, chord: float) -> np.ndarray:
    """Corners that a program leaves with a chord tolerance."""
    ring = shapely.simplify(shapely.LinearRing(points), chord)
    return shapely.get_coordinates(ring)[:-1]


def case_of(folder: Path, points: np.ndarray, *overrides: str):
    file = folder / "gear.csv"
    np.savetxt(file, points * 1e3, fmt="%.9f", delimiter=",")
    given = [f"machine.gears.profile={file}", "machine.gears.center_distance=34.465 mm"]
    given += overrides
    return load_case(CASE, given)


def summary_of(folder: Path, points: np.ndarray, *overrides: str) -> dict[str, object]:
    return dict(api.describe(case_of(folder, points, *overrides)).geometry_summary)


@pytest.fixture(scope="module")
def exact(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    keys = ["machine.gears.center_distance=34.465 mm"]
    case = load_case(CASE.with_name("egm12_motor.toml"), keys)
    return dict(api.describe(case).geometry_summary)


@pytest.mark.slow
@pytest.mark.parametrize(
    "drawn",
    [
        lambda: wavy(outline(), 2e-6),
        lambda: outline(2000),
        lambda: meshed(outline(2000), 1e-5),
    ],
    ids=["waves of 2 um", "refined", "chords of 10 um"],
)
def test_contact_and_trapped_volume_are_those_of_the_smooth_flank(
    tmp_path: Path, drawn: Callable[[], np.ndarray], exact: dict[str, object]
) -> None:
    found = summary_of(tmp_path, drawn())
    assert found["contact_ratio"] == pytest.approx(exact["contact_ratio"], abs=0.01)
    assert found["trapped_volume_mm3"] == pytest.approx(exact["trapped_volume_mm3"], rel=0.01)
    assert found["displacement_cm3_per_rev"] == pytest.approx(
        exact["displacement_cm3_per_rev"], rel=1e-3
    )
    assert found["base_diameter_mm"] == pytest.approx(exact["base_diameter_mm"], abs=3e-3)


def test_teeth_are_named_as_on_a_drawing(tmp_path: Path) -> None:
    found = summary_of(tmp_path, outline())
    assert found["tooth_count"] == 12
    assert found["module_mm"] == pytest.approx(2.75, abs=1e-4)
    assert found["pressure_angle_deg"] == pytest.approx(20.0)
    assert found["profile_shift"] == pytest.approx(0.3, abs=1e-4)
    assert found["normal_backlash_mm"] == pytest.approx(0.0203, abs=2e-4)
    assert found["undercut"] is False


@pytest.fixture(scope="module")
def uneven(tmp_path_factory: pytest.TempPathFactory) -> MachineDescription:
    """Flanks with waves 10 um high."""
    return api.describe(case_of(tmp_path_factory.mktemp("wavy"), wavy(outline(), 5e-6)))


def test_deviations_are_told_as_high_as_they_were_drawn(uneven: MachineDescription) -> None:
    """Waves 10 um high have a root mean square of 5 / sqrt(2) um; their mean line hardly leans."""
    found = uneven.geometry_summary
    assert found["involute_deviation_um"] == pytest.approx(10.4, abs=0.6)
    assert found["profile_form_error_um"] == pytest.approx(11.0, abs=0.8)
    assert found["fit_residual_um"] == pytest.approx(5.0 / np.sqrt(2.0), rel=0.03)
    checks = {check.name: check.value for check in uneven.checks}
    assert checks["form error of the profile"] == found["involute_deviation_um"]
    assert checks["chord height of the profile"] == found["chord_height_um"]
    assert found["chord_height_um"] == pytest.approx(1.6, rel=0.05)


def test_a_case_tells_the_deviations_that_its_gear_tells(tmp_path: Path) -> None:
    """Of the flank that is worse."""
    case = case_of(tmp_path, wavy(outline(), 5e-6))
    gear = gear_report(case.machine_spec.drive.found)
    found = api.describe(case).geometry_summary
    for name, own in (("form_deviation", "form_error"), ("slope_deviation", "slope_error")):
        flanks = [abs(gear[f"{side}_profile_{name}_um"]) for side in ("left", "right")]
        assert found[f"profile_{own}_um"] == pytest.approx(max(flanks))


def test_a_wrong_unit_is_answered_with_both_sizes(tmp_path: Path) -> None:
    """A tip circle of 40.372 mm in inches, read as millimetres."""
    with pytest.raises(CaseError) as refused:
        summary_of(tmp_path, outline() / 25.4)
    (problem,) = refused.value.problems
    assert problem.found.endswith(f"{40.372 / 25.4:.5g} mm")
    assert "it is 40.372 mm and fits" in problem.allowed


@pytest.mark.parametrize(
    ("size", "distance", "journal", "fits"),
    [
        (1.0, 9.7, 0.5, True),
        (1.0, 10.3, 0.5, False),
        (1.0, 1.05, 0.5, True),
        (1.0, 0.95, 0.5, False),
        (1.0, None, 1.0 / 7.7, True),
        (1.0, None, 1.0 / 8.3, False),
        # two tip radii over the number of teeth and two are 2.884 mm
        (48.0 / 2.884, None, 0.5, True),
        (52.0 / 2.884, None, 0.5, False),
    ],
)
def test_a_unit_fits_gears_of_possible_size(
    size: float, distance: float | None, journal: float, fits: bool
) -> None:
    """Centres 1 to 10 tip radii apart, roots up to 8 journals, modules up to 50 mm, in inches.

    Without a unit that fits, the one that is given stays.
    """
    machine = load_case(CASE).machine
    drawn = replace(generate_profile(MOTOR).scaled(size), involute=None)
    apart = None if distance is None else distance * drawn.tip_radius
    gears = replace(
        machine.gears,
        center_distance=apart,
        normal_backlash=1e-4 if apart is None else None,
        face_width=1e-2 * size,
    )
    bearings = replace(machine.journal_bearings, diameter=2.0 * journal * drawn.root_radius)
    with pytest.raises(CaseError, match="'in'") if fits else nullcontext():
        check_unit(
            replace(machine, gears=gears, journal_bearings=bearings), gears,
            drawn.scaled(1.0 / 25.4), "gears",
        )  # fmt: skip


@pytest.mark.slow
def test_coarse_mesh_is_named_with_its_chords_and_what_to_export(tmp_path: Path) -> None:
    found = summary_of(tmp_path, meshed(outline(2000), 1e-4))
    (warning,) = [line for line in found["warnings"] if line.startswith("chord height")]
    assert 30.0 < found["chord_height_um"] < 250.0
    assert "export curves, not facets, as STEP, or a mesh with a chord tolerance of 1 um" in warning


@pytest.mark.slow
def test_form_error_gives_an_interval_and_a_warning(tmp_path: Path) -> None:
    points = wavy(outline(400), 1e-5, 1.5e-3)
    keys = ["machine.gears.center_distance=34.52 mm"]
    found = summary_of(tmp_path, points, *keys)
    # the involute that fits leans on waves that the flank holds no whole number of
    assert 20.0 < found["involute_deviation_um"] < 24.0
    assert found["contact_ratio_as_drawn"] < found["contact_ratio"] - 0.1
    assert any(line.startswith("form error of the profile") for line in found["warnings"])
    drawn = case_of(tmp_path, points, *keys, "machine.gears.profile_flank=drawn").machine_spec
    assert drawn.drive.tooth is drawn.drive.found.detected.drawn


def test_run_tells_form_error_and_what_the_flanks_of_the_file_would_give(tmp_path: Path) -> None:
    points = wavy(outline(400), 1e-5, 1.5e-3)
    keys = ["machine.gears.center_distance=34.52 mm", "run.fidelity=ideal"]
    case = case_of(tmp_path, points, *keys)
    solution = api.simulate(case)
    told = " ".join(map(str, solution.findings))
    assert "Form error of the profile is" in told
    assert "Flanks as in the file, not the involute that fits them, give" in told
    drawn = api.simulate(case.replace({"machine.gears.profile_flank": "drawn"}))
    for name in ("flow_ripple_percent", "mean_flow_L_per_min"):
        found = solution.statistics[f"as_drawn_{name}"]
        assert found == pytest.approx(drawn.summary()[name], rel=1e-9)
        assert found != solution.summary()[name]


@pytest.mark.slow
def test_elastic_teeth_close_the_form_error_under_load(tmp_path: Path) -> None:
    """Chords of 20 um shorten the contact of rigid flanks, hardly that of teeth under 200 bar."""
    points = meshed(outline(2000), 2e-5)
    keys = ["machine.gears.center_distance=34.52 mm", "run.mesh=elastic"]
    case = case_of(tmp_path, points, *keys, "machine.gears.profile_flank=drawn")
    rigid = api.describe(case).geometry_summary["contact_ratio"]
    loaded = api.simulate(case).summary()["mean_loaded_contacts"]
    smooth = case.replace({"machine.gears.profile_flank": "fitted"})
    fitted = api.describe(smooth).geometry_summary["contact_ratio"]
    assert rigid < fitted - 0.05
    assert loaded == pytest.approx(api.simulate(smooth).summary()["mean_loaded_contacts"], abs=0.03)
    assert loaded > rigid + 0.05


def test_run_of_a_smooth_profile_is_one_run_without_warnings(tmp_path: Path) -> None:
    solution = api.simulate(case_of(tmp_path, outline(), "run.fidelity=ideal"))
    assert "profile" not in " ".join(map(str, solution.findings))
    assert not [name for name in solution.statistics if name.startswith("as_drawn")]


@pytest.mark.parametrize("count", [9, 17])
def test_tooth_count_of_an_outline_thinned_by_a_simplifier(count: int) -> None:
    gear = InvoluteGear(count, 2e-3, profile_shift=0.1)
    found = gear_profile_from_curve(meshed(outline(400, gear), 2e-5))
    assert found.tooth_count == count


@pytest.mark.parametrize(
    "gear",
    [InvoluteGear(30, 1e-3, np.deg2rad(14.5)), InvoluteGear(8, 3e-3), InvoluteGear(40, 1e-3)],
    ids=["z30 14.5 deg", "z8", "z40"],
)
def test_base_circle_just_below_the_involute_is_found(gear: InvoluteGear) -> None:
    found = gear_profile_from_curve(outline(200, gear))
    assert found.profile.base_radius == pytest.approx(gear.base_radius, abs=1e-6)
    form = tooth_form(gear)
    # at z = 30 the fillet cuts 0.1 um off, which counts as none
    assert found.profile.involute.undercut is (form.undercut_depth > 1e-6)
    assert found.involute.flank.form_radius == pytest.approx(form.form_radius, abs=4e-5)


@pytest.mark.slow
def test_undercut_of_a_profile_is_reported(tmp_path: Path) -> None:
    gear = InvoluteGear(9, 2.75e-3, tip_rounding=1e-4)
    points = outline(200, gear)
    distance = "machine.gears.center_distance=25 mm"
    area = "machine.floating_bearing.high_pressure_area.area=600 mm^2"
    keys = (distance, "machine.journal_bearings.diameter=12 mm", area)
    found = summary_of(tmp_path, points, *keys)
    assert found["undercut"] is True


@pytest.mark.parametrize("distance", [34.3, 34.0, 33.25, 33.0, 32.95, 25.0])
def test_overlapping_profiles_are_refused_with_their_overlap(
    tmp_path: Path, distance: float
) -> None:
    """Overlap of involutes: 2 (rb1 + rb2) (inv a_w - inv a_tight)."""
    with pytest.raises(GeometryError, match=r"overlap by|reaches") as caught:
        summary_of(tmp_path, outline(), f"machine.gears.center_distance={distance} mm")
    bases = 2.0 * MOTOR.base_radius * 1e3
    if distance > bases:
        angle, tight = np.arccos(bases / distance), np.arccos(bases / 34.44166)
        overlap = 2.0 * bases * (np.tan(tight) - tight - np.tan(angle) + angle)
        quoted = float(str(caught.value).split("overlap by ")[1].split(" mm")[0])
        assert quoted == pytest.approx(overlap, rel=0.01, abs=1e-3)


@pytest.mark.parametrize("unit", ["m", "in"])
def test_wrong_unit_is_answered_with_the_one_that_fits(tmp_path: Path, unit: str) -> None:
    with pytest.raises(CaseError, match=r"profile_unit|is the unit of the file right"):
        summary_of(tmp_path, outline(), f"machine.gears.profile_unit={unit}")


def test_inches_read_as_millimetres_are_answered_with_inches(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"profile_unit: found 'mm'.*allowed 'in'"):
        summary_of(tmp_path, outline() / 25.4)


def test_vanishing_outline_is_refused(tmp_path: Path) -> None:
    with pytest.raises(GeometryError, match="is the unit of the file right"):
        gear_profile_from_curve(outline() * 1e-200)


@pytest.mark.parametrize(
    ("suffix", "key"),
    [
        ("stl", "profile_layer=GEAR"),
        ("dxf", "profile_plane=1 mm"),
        ("dxf", "profile_axis=x"),
        ("txt", "profile_body=0"),
        ("stl", "profile_part=gear"),
        ("step", "profile_unit=in"),
    ],
)
def test_keys_that_a_format_does_not_have_are_refused(
    tmp_path: Path, suffix: str, key: str
) -> None:
    file = tmp_path / f"gear.{suffix}"
    export_gear(generate_profile(MOTOR, 60), file, 7.5e-3)
    overrides = [f"machine.gears.profile={file}", f"machine.gears.{key}"]
    with pytest.raises(CaseError, match=key.partition("=")[0]):
        load_case(CASE, overrides)


@pytest.mark.parametrize("distance", ["40.2 mm", "40.36 mm", "41 mm"])
def test_teeth_that_hardly_reach_one_another_are_refused(tmp_path: Path, distance: str) -> None:
    with pytest.raises(GeometryError, match="center_distance"):
        summary_of(tmp_path, outline(), f"machine.gears.center_distance={distance}")


def test_pitch_and_run_out_of_a_measured_gear() -> None:
    """One tooth 10 um ahead: single pitch 10 um on the circle, arcs as the teeth are turned."""
    profile = generate_profile(MOTOR, 200)
    teeth = profile.closed_polygon().reshape(12, 200, 2)
    radius = 18e-3
    turn = 10e-6 / radius
    cosine, sine = np.cos(turn), np.sin(turn)
    moved = teeth.copy()
    moved[4] = teeth[4] @ np.array([[cosine, sine], [-sine, cosine]])
    found = gear_profile_from_curve(moved.reshape(-1, 2))
    pitch = found.involute.pitch_deviation(radius)
    assert pitch.single == pytest.approx(10e-6, rel=0.02)
    assert pitch.cumulative == pytest.approx(10e-6, rel=0.02)
    # both flanks of the tooth move a ball by half an arc over tan(a), outwards and inwards
    angle = np.arccos(MOTOR.base_radius / radius)
    assert pitch.run_out == pytest.approx(10e-6 / np.tan(angle), rel=0.03)
    assert int(np.argmax(pitch.left)) == 4
