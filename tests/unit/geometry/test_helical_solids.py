"""Solids of helical gears: written, found again, and drafted into a machine that runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
from toothspace.cli import main
from toothspace.geometry.cad_export import export_gear, gear_section
from toothspace.geometry.curve import signed_area
from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_finder import FoundGear, find_gears
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.machines.external_gear.cad import export_profiles

trimesh = pytest.importorskip("trimesh")

CASES = Path(__file__).resolve().parents[3] / "cases"
NORMAL_MODULE, WIDTH = 2.75e-3, 12e-3


def transverse(angle: float) -> InvoluteGear:
    """Gear of a tool of 2.75 mm, 20 deg and shift 0.3 with a helix angle. [deg]."""
    slope = np.cos(np.deg2rad(angle))
    pressure = np.arctan(np.tan(np.deg2rad(20.0)) / slope)
    return InvoluteGear(12, NORMAL_MODULE / slope, pressure, 0.3 * slope, 40.6e-3)


def helical(path: Path, angle: float, points: int) -> FoundGear:
    """What is found in the file of a gear with a helix angle [deg], positive right-handed."""
    gear = transverse(angle)
    twist = WIDTH * np.tan(np.deg2rad(angle)) / (6.0 * gear.module)
    export_gear(generate_profile(gear, points), path, WIDTH, twist=twist)
    (found,) = find_gears(path, 1e-3).gears
    return found


def agrees(found: FoundGear, angle: float, rel: float) -> None:
    data = gear_data(found.detected.profile, found.helix_angle)
    assert data is not None
    assert np.rad2deg(data.helix_angle) == pytest.approx(angle, rel=rel)
    assert data.normal_module == pytest.approx(NORMAL_MODULE, rel=3e-4)
    assert np.rad2deg(data.normal_pressure_angle) == pytest.approx(20.0, abs=0.01)
    assert data.profile_shift / np.cos(data.helix_angle) == pytest.approx(0.3, abs=2e-3)
    assert found.face_width == pytest.approx(WIDTH, rel=1e-5)


def test_mesh_winds_to_its_hand_and_holds_what_its_section_holds(tmp_path: Path) -> None:
    path = tmp_path / "left.stl"
    agrees(helical(path, -6.0, 60), -6.0, 1e-3)
    mesh = trimesh.load(path)
    assert mesh.is_watertight
    area = abs(signed_area(gear_section(generate_profile(transverse(6.0), 60)).boundary))
    assert mesh.volume == pytest.approx(1e9 * area * WIDTH, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("angle", [15.0, -6.0])
def test_step_file_gives_the_helix_and_the_tool(tmp_path: Path, angle: float) -> None:
    pytest.importorskip("OCP")
    agrees(helical(tmp_path / "gear.step", angle, 40), angle, 3e-3)


def test_draft_winds_as_the_file(tmp_path: Path) -> None:
    path, case = tmp_path / "gear.stl", tmp_path / "pump.toml"
    found = helical(path, -6.0, 60)
    assert main(["gear", str(path), "--case", str(case)]) == 0
    spec = ts.load_case(case).machine_spec
    assert spec.helix.angle == pytest.approx(found.helix_angle, rel=1e-3)
    rules = {c.name: c for c in ts.describe(ts.load_case(case)).checks}
    assert rules["helix angle of the profile"].passed
    assert rules["short circuit through the chambers"].passed
    keys = {"machine.gears.helix_angle": "0 deg", "machine.gears.helix_hand": None}
    spur = {c.name: c for c in ts.describe(ts.load_case(case).replace(keys)).checks}
    assert not spur["helix angle of the profile"].passed
    assert "left-handed" in spur["helix angle of the profile"].reason


@pytest.mark.slow
def test_step_of_a_helical_pump_becomes_a_pump_that_runs(tmp_path: Path) -> None:
    """Written by the case, read as a foreign file: displacement, overlap and axial force."""
    pytest.importorskip("OCP")
    given, target = ts.load_case(CASES / "helical_pump.toml"), tmp_path / "pump.toml"
    file = export_profiles(given.machine_spec, tmp_path / "pump", "step")[0]
    assert main(["gear", str(file), "--case", str(target)]) == 0
    drafted = ts.load_case(target).replace({"machine.gears.normal_backlash": "0.11 mm"})
    first, second = (ts.describe(case).geometry_summary for case in (given, drafted))
    for name in ("displacement_cm3_per_rev", "overlap_ratio", "contact_ratio"):
        assert second[name] == pytest.approx(first[name], rel=2e-3), name
    found = ts.simulate(drafted)
    assert found.summary()["status"] == "done"
    # the moment of 99 bar, without friction, over the lead
    moment = 99e5 * second["displacement_cm3_per_rev"] * 1e-6 / (2.0 * np.pi)
    wanted = moment * abs(drafted.machine_spec.helix.turn_per_length)
    assert found.summary()["axial_force_N"] == pytest.approx(wanted, rel=0.02)
