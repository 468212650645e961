"""Parts of the external gear machine, one at a time."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.external_gear_designs import (
    ALL,
    CARBURISED_STEEL,
    TWELVE,
    changed,
    egm12,
    fuel14,
    gear_of,
    unequal,
)
from toothspace.api import describe, load_case
from toothspace.core.errors import CaseError, GeometryError
from toothspace.gearing.gear_face import tooth_fraction
from toothspace.gearing.materials import reduced_modulus
from toothspace.gearing.mesh_split import Placement, project
from toothspace.gearing.numbering import number
from toothspace.gearing.openings import port_lengths
from toothspace.gearing.tooth import (
    flank_curvature,
    flank_point,
    flank_swept_area,
    tooth_curves,
)
from toothspace.geometry.curve import polar_moment
from toothspace.geometry.involute import generate_profile
from toothspace.machines.external_gear import MACHINE
from toothspace.machines.external_gear.assembly import assemble
from toothspace.machines.external_gear.flow_paths import bore, bore_cover
from toothspace.machines.external_gear.summary import profile_checks
from toothspace.model.description import MachineDescription, RunningIn

REFERENCE_PUMP = Path(__file__).parents[3] / "cases" / "egm12_pump.toml"
REFERENCE_MOTOR = Path(__file__).parents[3] / "cases" / "egm12_motor.toml"


@pytest.fixture(scope="module")
def pump() -> MachineDescription:
    return MACHINE.describe(egm12("pump"))


def test_splines_follow_the_involute() -> None:
    """Points between the knots lie on the exact flank, which has radius sqrt(r^2 - rb^2)."""
    tooth = tooth_curves(generate_profile(TWELVE, 200))
    for flank in (tooth.left, tooth.right):
        for place in np.linspace(0.5, 0.9, 30) * flank.knots[-1]:
            x, y = flank_point(flank, place)
            radius = np.hypot(x, y)
            if 15.9e-3 < radius < 19.9e-3:
                angle = abs(np.arctan2(y, x))
                assert radius * angle == pytest.approx(
                    radius * float(TWELVE.half_angle(radius)), abs=2e-9
                )
                roll = np.sqrt(radius**2 - TWELVE.base_radius**2)
                assert flank_curvature(flank, place) == pytest.approx(1.0 / roll, rel=2e-3)


def test_swept_area_ends_at_the_sum_over_the_knots() -> None:
    flank = tooth_curves(generate_profile(TWELVE, 200)).left
    assert flank_swept_area(flank, flank.knots[-1]) == pytest.approx(flank.area[-1], rel=1e-13)
    assert flank_swept_area(flank, flank.knots[40]) == pytest.approx(flank.area[40], rel=1e-12)


def test_projection_is_at_right_angles() -> None:
    flank = tooth_curves(generate_profile(TWELVE, 200)).left
    at = Placement(0.3, 0.01)
    place = project(flank, at, 0.018, 0.022, 0.8 * flank.knots[-1])
    assert 0.0 < place < flank.knots[-1]
    c, s = np.cos(0.3), np.sin(0.3)
    near = []
    for offset in (-1e-7, 0.0, 1e-7):
        x, y = flank_point(flank, place + offset)
        near.append(np.hypot(c * x - s * y - 0.018, s * x + c * y + 0.01 - 0.022))
    assert near[1] == min(near)


def test_polar_moment_of_a_ring_of_points() -> None:
    """A fine circle is a disc: pi r^4 / 2."""
    angles = 2.0 * np.pi * np.arange(3200) / 3200
    disc = np.column_stack([np.cos(angles), np.sin(angles)])
    assert polar_moment(disc) == pytest.approx(0.5 * np.pi, rel=1e-5)
    assert 0.3 < tooth_fraction(generate_profile(TWELVE, 200)) < 0.6


def test_reduced_modulus_of_steel_on_steel() -> None:
    """206 GPa / (1 - 0.3^2) = 226.4 GPa."""
    assert reduced_modulus(CARBURISED_STEEL, CARBURISED_STEEL) == pytest.approx(226.4e9, rel=1e-3)


def test_masses_and_inertias_are_those_of_steel_cylinders(pump: MachineDescription) -> None:
    """A disc of the pitch radius and the two journals bound the gear within a few per cent."""
    body = pump.bodies[0]
    gear = 7850.0 * np.pi * 0.0168**2 * 7.5e-3
    shaft = 7850.0 * np.pi * 9e-3**2 * 38e-3
    assert body.mass == pytest.approx(gear + shaft, rel=0.03)
    # teeth beyond the pitch radius count with its square
    assert body.inertia == pytest.approx(0.5 * gear * 0.0168**2 + 0.5 * shaft * 9e-3**2, rel=0.15)
    assert pump.bodies[1].speed_ratio == -1.0


def test_angle_zero_is_the_documented_one(pump: MachineDescription) -> None:
    """Drive space 0 is open towards the driven gear, and driven tooth 0 stands in it."""
    phases = pump.families[0].phases
    assert phases[0] == pytest.approx(np.pi)
    assert np.mod(phases[0] - phases[1], 2.0 * np.pi) == pytest.approx(np.pi / 6.0)
    assert np.argmin(pump.families[0].volume(phases)[:, 0]) == 0
    numbering = number(assemble(egm12("pump")).counts)
    assert numbering.met_spaces[0] == 0
    assert numbering.met_spaces[1] == 1
    assert numbering.met_spaces[11] == 11


def test_node_numbers_and_labels(pump: MachineDescription) -> None:
    assert pump.chamber_count == 24
    assert len({path.name for path in pump.paths}) == len(pump.paths)
    for path in pump.paths:
        assert path.nodes_a.shape == path.nodes_b.shape == path.phases.shape
        assert np.all(path.nodes_a < 24)
        assert np.all(path.nodes_a != path.nodes_b)
    tips = next(path for path in pump.paths if path.name == "tooth_tip_drive")
    # from the space behind to the space ahead
    assert tips.nodes_a[3] == 4
    assert tips.nodes_b[3] == 3


def test_tip_gap_closes_when_the_gear_moves_to_the_wall(pump: MachineDescription) -> None:
    """A tooth opposite to the mesh meets the wall at -y (drive) or +y (driven)."""
    for name, column, sign in (("tooth_tip_drive", 1, -1.0), ("tooth_tip_driven", 3, 1.0)):
        path = next(p for p in pump.paths if p.name == name)
        assert path.height_by_motion is not None
        opposite = path.height_by_motion(0.0)
        # the driven gear stands back by half the backlash, 0.6 mrad
        assert opposite[column] == pytest.approx(-sign, abs=1e-6)
        assert np.delete(opposite, column) == pytest.approx(0.0, abs=1e-3)
        # a quarter turn on, the drive tooth stands at +x and the driven tooth too
        quarter = path.height_by_motion(0.5 * np.pi)
        assert quarter[column - 1] == pytest.approx(-1.0, abs=1e-6)


def test_tip_drag_carries_half_the_tip_speed(pump: MachineDescription) -> None:
    path = next(p for p in pump.paths if p.name == "tooth_tip_drive")
    assert path.drag_speed is not None
    assert path.shear_speed is not None
    assert path.drag_speed(1.0)[0] == pytest.approx(0.5 * 20.186e-3)
    assert path.shear_speed(1.0)[0] == pytest.approx(20.186e-3)


def test_bore_covers_a_tip_between_the_ports_only() -> None:
    assembly = assemble(egm12("pump"))
    for gear in (0, 1):
        inside = np.deg2rad([75.0, 120.0, 180.0, 240.0, 300.0])
        outside = np.deg2rad([0.0, 40.0, 60.0, 310.0, 350.0])
        assert bore_cover(assembly, gear, inside) == pytest.approx(1.0)
        assert bore_cover(assembly, gear, outside) == pytest.approx(0.0)


def test_ports_open_and_close_at_their_edges() -> None:
    """A space is open to the inlet until its trailing tip corner has passed 70 degrees."""
    assembly = assemble(egm12("pump"))
    half_mouth = np.pi / 12 - 0.5 * assembly.teeth[0].land_angle
    for spaces in assembly.spaces(3600):
        inlet, outlet = port_lengths(spaces, (np.deg2rad(70.0), np.deg2rad(55.0)))
        last = spaces.angles[inlet > 0.0].max()
        assert last == pytest.approx(np.deg2rad(70.0) + half_mouth, abs=2e-3)
        first = spaces.angles[outlet > 0.0].min()
        assert first == pytest.approx(-np.deg2rad(55.0) - half_mouth, abs=2e-3)
        mouth = 2.0 * half_mouth * assembly.teeth[0].tip_radius
        assert inlet.max() == pytest.approx(mouth, rel=0.1)
        assert not np.any((inlet > 0.0) & (outlet > 0.0))


@pytest.mark.parametrize("edges", [(200.0, 55.0), (55.0, 200.0)])
def test_a_port_that_reaches_beyond_the_far_side_opens_spaces_there(
    edges: tuple[float, float],
) -> None:
    """From where a space has left the mesh to 200 degrees its whole mouth is open."""
    assembly = assemble(egm12("pump"))
    half_mouth = np.pi / 12 - 0.5 * assembly.teeth[0].land_angle
    mouth, edge = 2.0 * half_mouth * assembly.teeth[0].tip_radius, np.deg2rad(200.0)
    far = int(edges[0] < edges[1])
    for spaces in assembly.spaces(720):
        opened = port_lengths(spaces, tuple(np.deg2rad(edges)))[far]
        place = np.mod(spaces.angles if far == 0 else -spaces.angles, 2.0 * np.pi)
        whole = (place > np.deg2rad(90.0)) & (place < edge - half_mouth - 1e-3)
        assert opened[whole] == pytest.approx(mouth, rel=1e-9)
        cut = (place > edge - half_mouth + 1e-3) & (place < edge + half_mouth - 1e-3)
        assert np.count_nonzero(cut) > 10
        rest = (edge + half_mouth - place) * assembly.teeth[0].tip_radius
        assert opened[cut] == pytest.approx(rest[cut], rel=1e-6)


def test_grooves_join_their_own_side_and_end_at_their_edge(pump: MachineDescription) -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 3000)
    for path in pump.paths:
        if not path.name.startswith("groove"):
            continue
        place = np.mod(angles, 2.0 * np.pi) - np.pi
        area = path.geometry(angles)[:, 0]
        sign = 1.0 if "inlet" in path.name else -1.0
        assert np.all(area[sign * place < 0.0] == 0.0), path.name
        assert area.max() > 5e-6
        assert path.multiplicity == 2.0


def test_trapped_volume_is_never_closed_nor_short_circuited(pump: MachineDescription) -> None:
    """With edges base pitch x cos(aw) apart no drive space is open to both grooves."""
    paths = {path.name: path for path in pump.paths}
    angle = np.linspace(0.0, 2.0 * np.pi, 2000)
    for gear in ("drive", "driven"):
        both = (
            paths[f"groove_inlet_{gear}"].geometry(angle)[:, 0]
            * paths[f"groove_outlet_{gear}"].geometry(angle)[:, 0]
        )
        assert both.max() < (1e-7) ** 2


def test_drain_and_running_in_follow_mode_and_casing() -> None:
    assert MACHINE.describe(egm12("pump"), nodes=72).drain == "inlet"
    assert MACHINE.describe(egm12("motor"), nodes=72).drain == "outlet"
    wear = RunningIn(pressure=260e5, shaft_speed=157.1, temperature=323.15)
    spec = egm12("pump")
    worn = changed(spec, casing=replace(spec.keys.casing, wear_in=wear))
    running_in = MACHINE.describe(worn, nodes=72).running_in
    assert running_in is not None
    assert running_in.pressure == 260e5


def test_summary_has_the_contract_names() -> None:
    names = {
        "displacement_cm3_per_rev", "contact_ratio", "tip_land_mm", "undercut",
        "root_clearance_mm", "center_distance_mm", "base_diameter_mm",
        "operating_pressure_angle_deg", "flow_ripple_percent", "trapped_volume_mm3",
        "dead_volume_mm3", "warnings",
    }  # fmt: skip
    summary = MACHINE.describe(fuel14(), nodes=72).geometry_summary
    assert names <= set(summary)
    assert summary["center_distance_mm"] == pytest.approx(63.06)


def test_numbers_of_the_report_by_hand() -> None:
    """Twelve teeth of 2.75 mm; a contact at k on its line sweeps b (r_a^2 - r_w^2 - k^2)."""
    machine = describe(load_case(REFERENCE_PUMP))
    found = machine.geometry_summary
    apart, tip, root, width = (
        float(found[name])  # type: ignore[arg-type]
        for name in ("center_distance_mm", "tip_diameter_mm", "root_diameter_mm", "face_width_mm")
    )
    base = 12 * 2.75 * np.cos(np.radians(20.0))
    pitch = np.pi * base / 12
    working = np.arccos(base / apart)
    swept = 0.25 * (tip**2 - apart**2) - pitch**2 / 12.0
    path = np.sqrt(tip**2 - base**2) - apart * np.sin(working)
    expected = {
        "tip_diameter_mm": 40.372,
        "face_width_mm": 7.63,
        "normal_backlash_mm": 0.11,
        "base_diameter_mm": base,
        "operating_pressure_angle_deg": np.degrees(working),
        "root_clearance_mm": apart - 0.5 * (tip + root),
        "displacement_cm3_per_rev": 2e-3 * np.pi * width * swept,
        "flow_ripple_percent": 25.0 * pitch**2 / swept,
        "contact_ratio": path / pitch,
    }
    assert {name: found[name] for name in expected} == pytest.approx(expected, rel=2e-2)
    close = ("displacement_cm3_per_rev", "operating_pressure_angle_deg", "base_diameter_mm")
    assert [found[name] for name in close] == pytest.approx([expected[n] for n in close], rel=1e-5)
    checks = {check.name: check.value for check in machine.checks}
    change = float(found["trapped_volume_mm3"]) - float(found["dead_volume_mm3"])  # type: ignore[arg-type]
    assert checks["trapped volume change"] == pytest.approx(change, rel=0.02)


def test_base_pitches_differ_with_the_modules_and_not_with_the_teeth() -> None:
    """Eleven and thirteen teeth of one rack, and drawn teeth of 2.75 and 2.752 mm."""
    larger = replace(TWELVE, module=2.752e-3, tip_diameter=40.4e-3)
    drive, driven = (gear_of(generate_profile(gear, 200), 7.5e-3) for gear in (TWELVE, larger))
    drawn = egm12("pump", drive=drive, driven=driven, normal_backlash=None, center_distance=34.6e-3)
    for spec, wanted in ((unequal(11, 13), 0.0), (drawn, 100.0 * (2.752 / 2.75 - 1.0))):
        (check,) = profile_checks(assemble(spec))
        assert check.name == "difference of the base pitches"
        assert check.value == pytest.approx(wanted, abs=1e-9)
        assert check.passed


def test_profile_from_points_gives_the_generated_machine() -> None:
    """Displacement within 0.1 %, volumes within 0.2 % of their range, without involute data."""
    gear = gear_of(replace(generate_profile(TWELVE, 200), involute=None, breaks=()), 7.5e-3)
    read = MACHINE.describe(egm12("pump", drive=gear, driven=gear), nodes=360)
    made = MACHINE.describe(egm12("pump"), nodes=360)
    assert read.displacement == pytest.approx(made.displacement, rel=1e-3)
    volume = made.families[0].volume.values
    error = np.abs(read.families[0].volume.values - volume).max()
    assert error < 2e-3 * np.ptp(volume)
    assert read.geometry_summary["flow_ripple_percent"] == pytest.approx(15.69, abs=0.1)


def contour_with_ports(clearance: float) -> np.ndarray:
    """Figure-eight bore of the 12-tooth pump with port pockets 70 and 55 degrees wide."""
    distance, radius = 34.4647e-3, 20.186e-3 + clearance
    low = np.deg2rad(np.linspace(70.0, 305.0, 600))
    bottom = radius * np.column_stack([-np.sin(low), np.cos(low)])
    top = np.column_stack([bottom[:, 0], distance - bottom[:, 1]])[::-1]
    outlet = np.array([[30e-3, 5e-3], [30e-3, distance - 5e-3]])
    inlet = np.array([[-30e-3, distance - 5e-3], [-30e-3, 5e-3]])
    return np.vstack([bottom, outlet, top, inlet])


def test_casing_contour_gives_port_edges_and_clearance() -> None:
    """Port edges within two rays, 0.5 degrees; chords of the contour cost 0.1 um of clearance."""
    assembly = assemble(egm12("pump", casing_contour=contour_with_ports(20e-6)))
    for gear in (0, 1):
        found = bore(assembly, gear)
        assert np.rad2deg(found.inlet_angle) == pytest.approx(70.0, abs=0.5)
        assert np.rad2deg(found.outlet_angle) == pytest.approx(55.0, abs=0.5)
        assert np.interp(np.pi, found.places, found.clearance) == pytest.approx(20e-6, abs=2e-7)


def test_casing_that_cuts_the_gear_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"machine\.casing\.contour"):
        MACHINE.describe(egm12("pump", casing_contour=contour_with_ports(-1e-4)))


def test_gears_that_do_not_reach_one_another_are_refused() -> None:
    gear = gear_of(generate_profile(TWELVE, 200), 7.5e-3)
    spec = egm12("pump", drive=gear, driven=gear, normal_backlash=None, center_distance=41e-3)
    with pytest.raises(GeometryError, match="center_distance"):
        MACHINE.describe(spec)


def test_overlapping_profiles_are_refused() -> None:
    gear = gear_of(generate_profile(TWELVE, 200), 7.5e-3)
    spec = egm12("pump", drive=gear, driven=gear, normal_backlash=None, center_distance=34.3e-3)
    with pytest.raises(GeometryError, match="overlap"):
        MACHINE.describe(spec)


def test_distance_or_backlash_is_needed() -> None:
    with pytest.raises(CaseError, match="unless normal_backlash is given"):
        egm12("pump", normal_backlash=None)


def test_displacement_of_unequal_gears_equals_the_mean_flow() -> None:
    """Closed form of Manring and Kasaragadda against the mean of the tables' contact radii."""
    spec = unequal(11, 13)
    bare = tuple(
        replace(g, tooth=replace(generate_profile(g.tooth, 200), involute=None))
        for g in (spec.drive, spec.driven)
    )
    exact = MACHINE.describe(spec, nodes=72).displacement
    found = MACHINE.describe(replace(spec, drive=bare[0], driven=bare[1]), nodes=72).displacement
    assert found == pytest.approx(exact, rel=2e-4)
    assert set(ALL) == {"egm12_motor", "egm12_pump", "fuel14", "unequal"}


def test_strength_of_the_motor_at_260_bar() -> None:
    """By hand: 3391 N on bushes of 18 by 19 mm; 658 N on a flank, 0.90 GPa at R = 3.82 mm."""
    checks = {check.name: check for check in describe(load_case(REFERENCE_MOTOR)).checks}
    assert checks["bearing specific load"].value == pytest.approx(3391.0 / 342.0, rel=0.01)
    assert checks["bearing p v, lubricated"].value == pytest.approx(
        3391.0 / 342.0 * 9e-3 * 157.1, rel=0.01
    )
    assert checks["flank pressure at the pitch point"].value == pytest.approx(902.0, rel=0.01)
    # six times 86 N/mm over some 5.5 mm of height and thickness
    assert 60.0 < checks["root stress"].value < 160.0
    assert all(check.passed for check in checks.values())


def test_faces_of_two_heights_leak_with_their_cubes_and_shear_with_their_inverses():
    """10 and 40 um: (10^3 + 40^3) / 2 of the cube, 2 / (1/10 + 1/40) = 16 um of the height."""
    lateral = egm12("pump").keys.lateral
    fixed, floating = lateral.each
    films = replace(lateral, side_gap=None, **{fixed: 10e-6, floating: 40e-6})
    assert films.leakage_height == pytest.approx(32500.0 ** (1 / 3) * 1e-6)
    assert films.shear_height == pytest.approx(16e-6)
    alike = replace(lateral, side_gap=12e-6)
    assert alike.leakage_height == pytest.approx(alike.shear_height) == pytest.approx(12e-6)
