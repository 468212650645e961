"""Port timing of gerotors: kidneys from files, sealed and joined pockets."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.gerotor_designs import CYCLOIDAL, TROCHOIDAL, machine
from toothspace.case import load_case
from toothspace.core.errors import GeometryError
from toothspace.machines.gerotor.describe import describe
from toothspace.machines.gerotor.parameters import PortContourParameters
from toothspace.machines.gerotor.pockets import Pockets, pockets
from toothspace.machines.gerotor.ports import Ports, openings, ports_of, timing_of
from toothspace.machines.gerotor.profiles import rotors_from
from toothspace.machines.gerotor.summary import _timing_checks

CASES = Path(__file__).resolve().parents[2] / "cases"
RIM = 26e-3
KINEMATIC = PortContourParameters(timing="kinematic")


@cache
def _pocket() -> Pockets:
    return pockets(TROCHOIDAL, rotors_from(TROCHOIDAL, 120), 280)


def _ports(maximum: float, minimum: float) -> Ports:
    stated = PortContourParameters(
        land_max_half_angle=np.deg2rad(maximum), land_min_half_angle=np.deg2rad(minimum)
    )
    return ports_of(stated, _pocket(), RIM)


def test_narrow_lands_short_circuit_the_ports():
    """Lands of 20 and 18 degrees join the ports at the largest pocket, those of 35 do not."""
    assert timing_of(_ports(20.0, 18.0), _pocket()).joined_area > 1e-6
    assert timing_of(_ports(35.0, 18.0), _pocket()).joined_area == 0.0
    # the design rule shows it in square millimetres
    for land, passed in ((20.0, False), (35.0, True)):
        timing = timing_of(_ports(land, 18.0), _pocket())
        check, *_ = _timing_checks(_pocket(), timing)
        assert check.value == pytest.approx(1e6 * timing.joined_area)
        assert bool(check.passed) is passed


def test_wide_lands_trap_volume():
    """Sealed angle: what the land is wider than the kinematic one, on the outer rotor, twice."""
    wide = timing_of(_ports(36.0, 9.7), _pocket())
    kinematic = timing_of(ports_of(KINEMATIC, _pocket(), RIM), _pocket())
    assert wide.trapped_area(_pocket()) > 5.0 * kinematic.trapped_area(_pocket())
    expected = 2.0 * np.deg2rad(36.0 - 30.97) / _pocket().angle_ratio
    # the throat moves a little faster than the pocket, and openings begin as thin wedges: on
    # tables of 2 800 nodes the angle is 7 % larger
    assert wide.sealed_angle(_pocket()) == pytest.approx(expected, rel=0.1)


def test_kidneys_from_a_dxf_file_are_the_same(tmp_path):
    """Kidneys written as polylines in millimetres and read back."""
    import ezdxf

    drawn = ports_of(KINEMATIC, _pocket(), RIM)
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = 4
    for contour in drawn.contours.values():
        drawing.modelspace().add_lwpolyline([(x, y) for x, y in contour * 1e3], close=True)
    path = tmp_path / "kidneys.dxf"
    drawing.saveas(path)
    read = ports_of(PortContourParameters(contour=path), _pocket(), RIM)
    for port in ("inlet", "outlet"):
        expected = openings(drawn, _pocket(), port)
        assert openings(read, _pocket(), port) == pytest.approx(expected, abs=1e-9)


def test_a_contour_file_needs_one_kidney_on_each_side(tmp_path):
    """One line with what was found."""
    np.savetxt(tmp_path / "one.txt", np.array([[15, 0], [20, 0], [20, 5], [15, 5], [15, 0]]))
    with pytest.raises(GeometryError, match="found 1 for the inlet, 0 for the outlet"):
        ports_of(PortContourParameters(contour=tmp_path / "one.txt"), _pocket(), RIM)


def test_radii_that_enclose_nothing_are_refused():
    """Inner radius above the outer one."""
    wrong = PortContourParameters(timing="kinematic", inner_radius=22e-3, outer_radius=20e-3)
    with pytest.raises(GeometryError, match="inner_radius: found 22 mm, allowed below 20 mm"):
        ports_of(wrong, _pocket(), RIM)


@pytest.mark.slow
def test_design_rules_warn_of_joined_ports():
    """The geometry report names the fault; the reference designs have none."""
    narrow = PortContourParameters(
        land_max_half_angle=np.deg2rad(20.0), land_min_half_angle=np.deg2rad(18.0)
    )
    found = describe(machine(TROCHOIDAL, ports=narrow), 140).geometry_summary["warnings"]
    assert any("joins both ports" in str(line) for line in found)
    for design in (TROCHOIDAL, CYCLOIDAL):
        assert describe(machine(design), 140).geometry_summary["warnings"] == []


def test_rotors_of_another_eccentricity_are_refused():
    """Profiles of 2.5 mm eccentricity overlap when set 2.7 mm apart."""
    spec = load_case(CASES / "gerotor_profiles.toml").machine_spec
    wrong = replace(spec.rotors, eccentricity=2.7e-3)
    with pytest.raises(GeometryError, match=r"eccentricity: found 2.7 mm, at which the rotors"):
        pockets(wrong, rotors_from(wrong), 140)


def test_case_with_profile_files_gives_the_displacement_of_the_design():
    """The files hold the trochoidal reference design with its clearance of 30 um."""
    spec = load_case(CASES / "gerotor_profiles.toml").machine_spec
    pocket = pockets(spec.rotors, rotors_from(spec.rotors), 280)
    volume = 2.0 * np.pi * pocket.area_per_radian * spec.rotors.face_width
    assert volume * 1e6 == pytest.approx(6.1596, rel=2e-4)
    assert pocket.path.gap == pytest.approx(30e-6, abs=1.5e-6)


def test_radial_slots_open_to_the_windows_beside_the_kidneys() -> None:
    """Closed on both lands, full width times length inside, half where its middle meets an end."""
    plain = ports_of(KINEMATIC, _pocket(), RIM)
    slotted = ports_of(
        PortContourParameters(timing="kinematic", radial_slot_width=6e-3, radial_slot_length=8e-3),
        _pocket(),
        RIM,
    )
    place = _pocket().place
    for port, sign in (("inlet", 1.0), ("outlet", -1.0)):
        more = openings(slotted, _pocket(), port) - openings(plain, _pocket(), port)
        at = np.mod(sign * place, 2.0 * np.pi)
        assert more[np.argmin(np.abs(at - 0.5 * np.pi)), 0] == pytest.approx(6e-3 * 8e-3)
        assert more[np.argmin(np.abs(at - np.pi)), 0] == 0.0
        assert more[0, 0] == 0.0
        end = np.argmin(np.abs(at - plain.land_min_half_angle))
        assert more[end, 0] == pytest.approx(0.5 * 6e-3 * 8e-3, rel=0.15)
    np.testing.assert_array_less(0.0, openings(slotted, _pocket(), "inlet")[1:100, 1][10:])
