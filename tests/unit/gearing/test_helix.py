"""Helical gears: closed forms, limits and conservation."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toothspace as ts
from toothspace import api
from toothspace.core.errors import CaseError
from toothspace.gearing.helix import Helix
from toothspace.gearing.meshing import displacement
from toothspace.gearing.spaces import section_areas
from toothspace.geometry.involute import generate_profile
from toothspace.machines.external_gear.assembly import assemble
from toothspace.model.description import MachineDescription
from toothspace.numerics.periodic_table import smooth_table
from toothspace.run.solved_films import with_solved_films

HELICAL = Path(__file__).resolve().parents[3] / "cases" / "helical_pump.toml"
ANGLE = "machine.gears.helix_angle"


def machine(**changes: Any) -> MachineDescription:
    case = ts.load_case(HELICAL).replace({k.replace("__", "."): v for k, v in changes.items()})
    return api.prepare(case).machine


@cache
def solved(hand: str, mesh: str = "rigid") -> ts.Solution:
    case = ts.load_case(HELICAL, (f"machine.gears.helix_hand={hand}", f"run.mesh={mesh}"))
    return ts.simulate(case)


@pytest.mark.parametrize("overlap", [0.25, 0.5, 0.9])
def test_a_harmonic_falls_by_the_sine_over_its_argument(overlap: float) -> None:
    teeth, nodes = 12, 4320
    angles = 2.0 * np.pi * np.arange(nodes) / nodes
    twist = overlap * 2.0 * np.pi / teeth
    for k in (1, 2, 3):
        mean = smooth_table(2.0 * np.pi, np.cos(k * teeth * angles)).moving_mean(twist)
        assert mean.values[0, 0] == pytest.approx(np.sinc(k * overlap), abs=1e-6)


@pytest.mark.slow
def test_ideal_flow_of_a_whole_overlap_does_not_pulsate() -> None:
    """Overlap 1 at 19 degrees; the ideal machine knows no leak along the helix."""
    spur, half, whole = (
        float(ts.simulate(str(HELICAL), run__fidelity="ideal", **{  # type: ignore[arg-type]
            "machine__gears__helix_angle": "5 deg",
            "machine__gears__face_width": f"{width} mm",
        }).summary()["flow_ripple_percent"])
        for width in (0.1, 49.4, 98.754)
    )  # fmt: skip
    assert half < 0.6 * spur
    assert whole < 0.02 * spur


def test_a_vanishing_helix_is_a_spur_gear() -> None:
    spur, helical = straight(), machine(**{ANGLE: "1e-8 deg"})
    assert helical.winding is not None
    assert spur.winding is None
    tables = [
        (getattr(one, name), getattr(other, name), -np.inf if "motion" in name else 0.0)
        for part in ("families", "paths")
        for one, other in zip(getattr(spur, part), getattr(helical, part), strict=True)
        for name in ("volume", "volume_by_motion", "geometry", "height_by_motion")
        if getattr(one, name, None) is not None
    ]
    assert len(tables) > 16
    for one, other, least in tables:
        # flanks that meet may overlap by less than a nanometre; along a helix they touch
        apart = np.abs(np.maximum(other.values, least) - np.maximum(one.values, least))
        assert np.all(apart <= 1e-9 * np.abs(one.values).max(axis=0))


def straight() -> MachineDescription:
    """The case with spur gears of the same tool."""
    return machine(**{ANGLE: "0 deg", "machine.gears.helix_hand": None})


def test_a_drawn_section_winds_as_the_generated_one() -> None:
    """The helix angle of a profile is that halfway up its teeth: the same lead."""
    made = ts.load_case(HELICAL)
    spec = made.machine_spec
    profile = generate_profile(spec.drive.tooth, 300)
    halfway = 0.5 * (profile.root_radius + profile.tip_radius)
    angle = math.degrees(math.atan(spec.helix.turn_per_length * halfway))
    given = ("tooth_count", "module", "pressure_angle", "profile_shift", "dedendum",
             "tool_tip_radius", "tip_diameter", "tip_rounding")  # fmt: skip
    drawn = made.replace(
        dict.fromkeys([f"machine.gears.{name}" for name in given])
        | {"machine.gears.profile": (1e3 * profile.closed_polygon()).tolist(),
           ANGLE: f"{angle} deg"}
    )  # fmt: skip
    first, second = spec.helix, drawn.machine_spec.helix
    assert second.turn_per_length == pytest.approx(first.turn_per_length, rel=1e-5)
    assert second.base_angle == pytest.approx(first.base_angle, rel=1e-3)
    sections = [assemble(case.machine_spec) for case in (made, drawn)]
    assert displacement(sections[1]) == pytest.approx(displacement(sections[0]), rel=5e-4)
    distances = [section.mesh.center_distance for section in sections]
    assert distances[1] == pytest.approx(distances[0], abs=2e-6)  # of the same normal backlash


def test_volumes_are_those_of_slices() -> None:
    case = ts.load_case(HELICAL)
    found = api.prepare(case).machine
    spec = case.machine_spec
    assembly, twist = assemble(spec), spec.helix.twist
    places = [assembly.table_places(gear, 720) for gear in (0, 1)]
    leads = twist * ((np.arange(40) + 0.5) / 40 - 0.5)
    areas = [
        [section_areas(spaces) for spaces in assembly.spaces_at(*(p + lead for p in places))]
        for lead in leads
    ]
    for gear in (0, 1):
        expected = spec.drive.face_width * np.mean([area[gear] for area in areas], axis=0)
        values = found.families[gear].volume.values[:, 0]
        assert values.size == expected.size
        np.testing.assert_allclose(values, expected, atol=2e-5 * expected.max())
    assert found.displacement == pytest.approx(found.winding.section.displacement, rel=1e-12)


def test_shares_of_all_slices_carry_the_whole_load() -> None:
    contact = machine().contacts[0]
    angles = np.linspace(0.0, 2.0 * np.pi, 50)
    shares = contact.geometry(contact.phases + contact.angle_ratio * angles[:, None])[..., 1]
    np.testing.assert_allclose(shares.sum(axis=1), 1.0, rtol=1e-6)


def test_slices_of_a_contact_lie_evenly_about_the_middle() -> None:
    """As far apart as the twist over their number; each is as wide as the others."""
    helical = machine()
    assert helical.winding is not None
    for middle, contact in zip(helical.winding.section.contacts, helical.contacts, strict=True):
        leads = contact.phases.reshape(-1, middle.phases.size) - middle.phases
        assert np.ptp(leads, axis=1) == pytest.approx(0.0, abs=1e-12)
        assert leads.mean() == pytest.approx(0.0, abs=1e-12)
        apart = helical.winding.twist * middle.angle_ratio / len(leads)
        assert np.diff(leads[:, 0]) == pytest.approx(apart)
        assert contact.part == pytest.approx(1.0 / len(leads))


@pytest.mark.slow
def test_mirrored_hands_differ_in_the_sense_of_the_axial_force_alone() -> None:
    right, left = solved("right"), solved("left")
    np.testing.assert_array_equal(right.data["chamber_pressure"], left.data["chamber_pressure"])
    np.testing.assert_array_equal(right.data["axial_force"], -left.data["axial_force"])
    assert right.summary()["axial_force_N"] > 0.0


@pytest.mark.parametrize("mesh", ["elastic", pytest.param("rigid", marks=pytest.mark.slow)])
def test_axial_force_is_the_moment_over_the_lead(mesh: str) -> None:
    """Pressure and contact add up on the drive gear and cancel on the driven one."""
    found = solved("right", mesh)
    numbers, case = found.summary(), ts.load_case(HELICAL)
    radius = case.machine_spec.drive.tooth.reference_radius
    friction = sum(v for k, v in numbers.items() if k.startswith("torque_loss_"))
    moment = numbers["mean_torque_N_m"] - friction
    drive, driven = found.data["axial_force"].mean("shaft_angle").values
    assert drive == pytest.approx(moment * math.tan(math.radians(5.0)) / radius, rel=0.02)
    assert abs(driven) < 0.03 * drive
    assert numbers["mass_balance_error"] < 1e-7
    assert numbers["energy_balance_error"] < 1e-5


def test_helical_teeth_with_what_spur_teeth_have_alone_are_refused() -> None:
    with pytest.raises(CaseError, match="helix_hand"):
        ts.load_case(HELICAL, (f"{ANGLE}=0 deg",))
    with pytest.raises(CaseError, match="profile_teeth"):
        ts.load_case(HELICAL, ("machine.gears.profile_teeth=own",))
    with pytest.raises(CaseError, match="tooth_deviations"):
        ts.load_case(HELICAL, ("machine.gears.tooth_deviations=gear.csv",))


def test_both_ends_of_a_gap_leak_as_one() -> None:
    """Flow of a parallel gap goes with width over length: ends 2 and 6 mm long are one of 3 mm."""
    turn, nodes = 2.0 * np.pi, 720
    length = 4e-3 - 2e-3 * np.cos(turn * np.arange(nodes) / nodes)
    rows = np.column_stack([np.full(nodes, 5e-6), np.full(nodes, 1e-2), length])
    path = next(p for p in straight().paths if p.name == "lateral_drive")
    helix = Helix(math.radians(45.0), 12, 1.0, 0.3, math.pi)  # both ends half a turn apart
    found = helix.path(replace(path, geometry=smooth_table(turn, rows), drag_speed=None)).geometry
    for angle in (0.5 * math.pi, 0.0, 0.25 * math.pi):
        ends = [4e-3 - 2e-3 * math.cos(angle + lead) for lead in (-0.5 * math.pi, 0.5 * math.pi)]
        wanted = 2.0 / (1.0 / ends[0] + 1.0 / ends[1])
        assert found(np.array([angle]))[0] == pytest.approx([5e-6, 1e-2, wanted], rel=1e-5)
    assert found(np.array([0.5 * math.pi]))[0, 2] == pytest.approx(3e-3, rel=1e-5)


@pytest.mark.slow
def test_films_beside_the_gears_are_means_of_faces_that_lead_and_lag() -> None:
    """Conductances of the section alone, turned by half the twist either way."""
    helical = machine()
    assert helical.winding is not None
    models = {"journal": "closed_form", "lateral": "reynolds"}
    solved, section = (
        {p.name: p for p in with_solved_films(m, models=models).paths}
        for m in (helical, helical.winding.section)
    )
    known = {path.name for path in helical.paths}
    to_recesses = [p for name, p in solved.items() if name not in known and p.phases.size > 1]
    assert len(to_recesses) == 4
    half = 0.5 * helical.winding.twist
    for path in to_recesses:
        table = path.geometry
        nodes = table.period * np.arange(table.values.shape[0]) / table.values.shape[0]
        widths = section[path.name].geometry(np.stack([nodes - half, nodes + half]))[..., 1]
        assert np.ptp(widths, axis=0).max() > 0.05 * widths.max()
        np.testing.assert_allclose(
            table.values[:, 1], widths.mean(axis=0), rtol=1e-9, atol=1e-12 * widths.max()
        )


@pytest.mark.slow
def test_solved_films_of_helical_gears_keep_the_balances() -> None:
    numbers = ts.simulate(HELICAL, run__fidelity="films").summary()
    assert numbers["status"] == "done"
    assert numbers["mass_balance_error"] < 1e-7
    assert numbers["energy_balance_error"] < 1e-5
    closed = solved("right").summary()["volumetric_efficiency"]
    assert numbers["volumetric_efficiency"] == pytest.approx(closed, abs=1e-3)


def test_a_tooth_space_that_joins_both_ports_is_named() -> None:
    rules = {"short circuit through the chambers", "teeth that seal along the helix, drive gear"}
    for width, passes in (("23.7 mm", True), ("250 mm", False)):
        checks = machine(**{"machine.gears.face_width": width}).checks
        assert {c.name: c.passed for c in checks if c.name in rules} == dict.fromkeys(rules, passes)


@pytest.mark.parametrize(("wanted", "passed"), [(1.04, True), (0.96, False)])
def test_one_whole_tooth_seals_along_the_helix(wanted: float, passed: bool) -> None:
    """Each tooth asks for a pitch of the bore beside what the helix turns over the width."""
    case = ts.load_case(HELICAL)
    casing, gears = case.machine.casing, case.machine.gears
    pitch = 2.0 * math.pi / gears.tooth_count
    reference = 0.5 * gears.tooth_count * gears.module / math.cos(gears.helix_angle)
    twist = gears.face_width * math.tan(gears.helix_angle) / reference
    inlet = 2.0 * math.pi - casing.outlet_angle - twist - wanted * pitch
    described = machine(machine__casing__inlet_angle=f"{math.degrees(inlet):.6f} deg")
    [check] = [x for x in described.checks if x.name.endswith("helix, drive gear")]
    assert check.value == pytest.approx(wanted, abs=1e-3)
    assert bool(check.passed) is passed
