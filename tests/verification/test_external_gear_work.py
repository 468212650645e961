"""Forces of chamber pressures: virtual work, closure, mirror image, contact and pairing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.ops import polygonize, unary_union

from tests.external_gear_designs import ALL, TWELVE, egm12, spaces_at, unequal
from tests.reference_formulas.space_areas import section_area_rates
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import load_share, throat_drag
from toothspace.gearing.spaces import (
    Spaces,
    area_by_motion,
    drive_spaces,
    driven_spaces,
    section_areas,
    wall_ends,
)
from toothspace.geometry.involute import generate_profile
from toothspace.machines.external_gear import MACHINE
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.model.description import MachineDescription

TWO_PI = 2.0 * np.pi


@pytest.fixture(scope="module", params=list(ALL))
def description(request: pytest.FixtureRequest) -> MachineDescription:
    return MACHINE.describe(ALL[request.param])


@pytest.mark.parametrize("name", list(ALL))
def test_equal_pressure_gives_no_net_force(name: str) -> None:
    """The walls of all chambers form closed curves round each gear, so forces and moment cancel."""
    assembly = assemble(ALL[name])
    for shaft_angle in np.linspace(0.0, 0.6, 7):
        forces = np.vstack([area_by_motion(s) for s in spaces_at(assembly, shaft_angle)])
        assert np.all(np.abs(forces.sum(axis=0)) < 1e-11 * np.abs(forces).max(axis=0))


def test_interpolated_forces_of_equal_pressure_stay_small(description: MachineDescription) -> None:
    for shaft_angle in np.linspace(0.0, 0.6, 7):
        forces = np.vstack(
            [
                family.volume_by_motion(family.phases + family.angle_ratio * shaft_angle)
                for family in description.families
            ]
        )
        assert np.all(np.abs(forces.sum(axis=0)) < 1e-7 * np.abs(forces).max(axis=0))


@pytest.mark.parametrize("name", list(ALL))
def test_turning_both_gears_and_the_throat_drag_give_the_volume_rate(name: str) -> None:
    """Work of the wall pressures: dV/dphi = sum of gear speeds x dV/drotation - drag flow."""
    assembly = assemble(ALL[name])
    angles = np.linspace(-1.3, 1.3, 700)
    for build in (drive_spaces, driven_spaces):
        spaces = build(*assembly.teeth, assembly.mesh, angles)
        walls = area_by_motion(spaces)
        rate = _drive_rotation(spaces) - assembly.mesh.ratio * walls[:, 4]
        sign = 1.0 if spaces.is_drive else -1.0
        for side, leading in ((spaces.right, True), (spaces.left, False)):
            drag = side.gap * throat_drag(assembly, side, leading=leading)
            rate -= sign * drag
        exact = section_area_rates(spaces)
        settled = _settled(spaces.left) & _settled(spaces.right)
        assert np.count_nonzero(settled) > 300
        assert rate[settled] == pytest.approx(exact[settled], abs=1e-7 * np.abs(exact).max())


def _settled(side: Throats) -> np.ndarray:
    return (side.weight == 0.0) | (side.weight == 1.0)


def _drive_rotation(spaces: Spaces) -> np.ndarray:
    of_own = spaces.is_drive
    first, second = (spaces.right, spaces.left) if of_own else (spaces.left, spaces.right)
    start, end = wall_ends(spaces, first, of_own), wall_ends(spaces, second, of_own)
    return -0.5 * (np.sum(end**2, axis=1) - np.sum(start**2, axis=1))


def free_mesh() -> Assembly:
    """The 12-tooth gears with centred backlash, so that no throat is closed."""
    assembly = assemble(egm12("pump"))
    return replace(assembly, mesh=assembly.mesh._replace(turn=0.0))


@pytest.mark.parametrize("place", [-0.2, 0.05, 0.17])
def test_virtual_work_against_displaced_polygons(place: float) -> None:
    """Area change of exact polygons, driven gear shifted or turned, equals the table."""
    assembly = free_mesh()
    spaces = drive_spaces(*assembly.teeth, assembly.mesh, np.array([place]))
    assert spaces.left.weight[0] == spaces.right.weight[0] == 1.0
    table = area_by_motion(spaces)[0]
    step = 1e-6
    length = np.abs(table[:4]).max()
    for column, motion in ((2, (step, 0.0, 0.0)), (3, (0.0, step, 0.0)), (4, (0.0, 0.0, 1e-4))):
        moved = [_chamber(assembly, spaces, np.multiply(motion, s)) for s in (1.0, -1.0)]
        slope = (moved[0] - moved[1]) / (2.0 * max(motion))
        scale = length if column < 4 else length * 20e-3
        assert slope == pytest.approx(table[column], abs=2e-6 * scale)


def _chamber(assembly: Assembly, spaces: Spaces, motion: np.ndarray) -> float:
    profile = generate_profile(TWELVE, 8000)
    place = float(spaces.angles[0])
    center = np.array([0.0, assembly.mesh.center_distance])
    drive = profile.closed_polygon(0.5 * np.pi + place + np.pi / 12)
    driven = profile.closed_polygon(-0.5 * np.pi - place) + center
    window = shapely.box(-9e-3, 11e-3, 9e-3, 24e-3)
    rings = [
        shapely.LinearRing(drive).intersection(window),
        shapely.LinearRing(_moved(driven, motion, center)).intersection(window),
    ]
    for side in (spaces.left, spaces.right):
        start = side.drive.point[0]
        end = _moved(side.driven.point, motion, center)[0]
        beyond = 2e-3 * (end - start)
        rings.append(shapely.LineString([start - beyond, end + beyond]))
    pieces = list(polygonize(unary_union(rings)))
    area = section_areas(spaces)[0]
    return min((piece.area for piece in pieces), key=lambda found: abs(found - area))


def _moved(points: np.ndarray, motion: np.ndarray, center: np.ndarray) -> np.ndarray:
    c, s = np.cos(motion[2]), np.sin(motion[2])
    return (points - center) @ np.array([[c, s], [-s, c]]) + center + motion[:2]


def test_mirrored_machine_has_mirrored_tables() -> None:
    """Mirrored about the centre line, ports swapped, the pump is the motor run backwards."""
    pump = MACHINE.describe(egm12("pump"))
    motor = MACHINE.describe(egm12("motor"))
    angle = np.linspace(0.0, TWO_PI, 400)
    for first, second in zip(pump.families, motor.families, strict=True):
        assert second.volume(-angle) == pytest.approx(first.volume(angle), rel=1e-6)
        mirrored = second.volume_by_motion(-angle) * np.array([-1.0, 1.0, -1.0, 1.0, -1.0])
        scale = np.abs(mirrored).max(axis=0)
        assert np.all(np.abs(mirrored - first.volume_by_motion(angle)) < 1e-5 * scale)
    paths = {path.name: path for path in motor.paths}
    swapped = {"inlet": "outlet", "outlet": "inlet", "leading": "trailing", "trailing": "leading"}
    for path in pump.paths:
        name = "_".join(swapped.get(word, word) for word in path.name.split("_"))
        other = paths[name].geometry(-angle)
        own = path.geometry(angle)
        scale = np.abs(own).max(axis=0) + 1e-12
        assert np.all(np.abs(own - other) < 2e-3 * scale), path.name


@pytest.mark.parametrize("name", list(ALL))
def test_load_shares_sum_to_one(name: str) -> None:
    assembly = assemble(ALL[name])
    pitch = 2.0 * assembly.mesh.half_pitch
    angles = np.linspace(-0.5 * pitch, 0.5 * pitch, 200)
    total = sum(load_share(assembly, angles + k * pitch) for k in range(-3, 4))
    assert total == pytest.approx(1.0, abs=1e-12)


def test_rigid_mesh_keeps_the_contact_closed(description: MachineDescription) -> None:
    mesh, contact = description.mesh, description.contacts[0]
    assert mesh is not None
    motions = np.array([2e-6, -1e-6, 3e-6, 4e-6, 0.0])
    motions[mesh.motion] = mesh.coefficients @ motions
    shaft_angles = np.linspace(0.0, 0.5, 40)
    for k in range(contact.count):
        angle = contact.phases[k] + shaft_angles
        carried = contact.geometry(angle)[:, 1] > 0.3
        change = contact.gap_by_motion(angle)[carried] @ motions
        assert np.all(np.abs(change) < 1e-9)


@pytest.mark.parametrize("counts", [(11, 13), (12, 12), (13, 11), (9, 20)])
def test_open_throats_join_spaces_that_meet(counts: tuple[int, int]) -> None:
    """A throat is open only while its driven space stands next to the drive space in the mesh."""
    machine = MACHINE.describe(unequal(*counts))
    pitch = TWO_PI / counts[1]
    driven = machine.families[1]
    seen = 0
    for path in machine.paths[:2]:
        assert path.partner_shift == counts[0] % counts[1]
        for shaft_angle in np.linspace(0.0, 30.0, 301):
            angle = path.phases + shaft_angle
            turns = np.floor(angle / TWO_PI).astype(int)
            is_open = path.geometry(angle)[:, 1] > 0.0
            partner = np.mod(path.nodes_b - counts[0] + turns * path.partner_shift, counts[1])
            place = driven.phases[partner] + driven.angle_ratio * shaft_angle
            offset = np.mod(place, TWO_PI) - np.pi
            drive_place = np.mod(angle, TWO_PI) - np.pi
            half = 0.5 * pitch * (1.0 if path.name == "flank_leading" else -1.0)
            expected = drive_place * driven.angle_ratio + half
            error = np.abs(offset - expected)[is_open]
            assert error.max(initial=0.0) < 0.02 * pitch
            seen += np.count_nonzero(is_open)
    assert seen > 300


def test_contact_speeds_vanish_at_the_pitch_point() -> None:
    """Sliding |2 u| and rolling sum 2 rb tan(aw) per shaft radian, equal gears."""
    machine = MACHINE.describe(egm12("pump"), nodes=1440)
    assembly = assemble(egm12("pump"))
    assert assembly.pair is not None
    angles = np.linspace(-0.1, 0.4, 200) + np.pi
    table = machine.contacts[0].geometry(angles)
    roll = sum(assembly.pair.pitch_roll_lengths)
    assert table[:, 5] == pytest.approx(roll, rel=1e-3)
    assert table[:, 4].min() < 0.01 * roll
    assert table[:, 2] + table[:, 3] == pytest.approx(roll, rel=1e-3)


def test_flanks_out_of_the_mesh_do_not_touch(description: MachineDescription) -> None:
    """Gap zero only where the pair may carry; no overlap anywhere beyond the splines' error."""
    table = description.contacts[0].geometry(np.linspace(0.0, TWO_PI, 3000))
    gap, share = table[:, 0], table[:, 1]
    assert gap.min() > -1e-8
    assert np.all(gap[share > 0.05] < 1e-6)
    assert np.all(gap[share == 0.0] > -1e-9)
    assert np.median(gap[share == 0.0]) > 1e-4
