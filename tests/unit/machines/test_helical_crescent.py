"""Helical internal gears with crescent: limits, slices, hands, axial force."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

import toothspace as ts
from toothspace import api
from toothspace.core.errors import CaseError
from toothspace.gearing.helix import halfway_up
from toothspace.gearing.meshing import displacement
from toothspace.gearing.spaces import section_areas
from toothspace.geometry.cad_export import Section, export_section
from toothspace.machines.crescent.assembly import assemble
from toothspace.model.description import MachineDescription

CASES = Path(__file__).resolve().parents[3] / "cases"
HELICAL, SPUR = CASES / "crescent_helical.toml", CASES / "crescent_pump.toml"
ANGLE = "machine.pinion.helix_angle"


@cache
def machine(angle: str = "3 deg", hand: str | None = "right") -> MachineDescription:
    changes = {ANGLE: angle, "machine.pinion.helix_hand": hand}
    return api.prepare(ts.load_case(HELICAL).replace(changes)).machine


def test_the_transverse_section_is_that_of_the_spur_twin() -> None:
    helical, spur = (assemble(ts.load_case(case).machine_spec) for case in (HELICAL, SPUR))
    assert helical.mesh.center_distance == pytest.approx(spur.mesh.center_distance, abs=1e-8)
    found = machine().winding
    assert found is not None
    assert 2e6 * np.pi * found.section.displacement == pytest.approx(100.5087, abs=1e-3)
    assert machine().displacement == pytest.approx(found.section.displacement, rel=1e-12)


def test_a_vanishing_helix_is_a_spur_gear() -> None:
    spur, helical = machine("0 deg", None), machine("1e-4 deg")
    assert spur.winding is None
    for one, other in zip(spur.families, helical.families, strict=True):
        np.testing.assert_allclose(other.volume.values, one.volume.values, rtol=1e-6)
    for one, other in zip(spur.paths, helical.paths, strict=True):
        if one.kind == "orifice":
            largest = one.geometry.values[:, 0].max()
            areas = other.geometry.values[:, 0], one.geometry.values[:, 0]
            np.testing.assert_allclose(*areas, atol=1e-5 * largest)


def test_volumes_are_those_of_slices_of_one_hand() -> None:
    """The ring leads where the pinion leads: slices of one section, turned together."""
    assembly = assemble(ts.load_case(HELICAL).machine_spec)
    assert assembly.helix is not None
    places = [assembly.table_places(gear, 720) for gear in (0, 1)]
    leads = assembly.helix.twist * ((np.arange(12) + 0.5) / 12 - 0.5)
    for gear, ratio in enumerate((1.0, assembly.ratio)):
        turned = [
            [p + lead * (ratio if k == gear else 1.0) for k, p in enumerate(places)]
            for lead in leads
        ]
        areas = [section_areas(assembly.spaces_at(*own)[gear]) for own in turned]
        expected = assembly.face_width * np.mean(areas, axis=0)
        values = machine().families[gear].volume.values[:, 0]
        assert values.size == expected.size
        np.testing.assert_allclose(values, expected, atol=2e-4 * expected.max())


def test_spur_teeth_have_no_hand() -> None:
    with pytest.raises(CaseError, match="helix_hand"):
        ts.load_case(HELICAL, (f"{ANGLE}=0 deg",))


def drawn(folder: Path, suffix: str) -> ts.Case:
    """The helical pump with both gears from files, solids that wind or plane outlines."""
    given = ts.load_case(HELICAL)
    gears = assemble(given.machine_spec)
    helix, width = gears.helix, gears.face_width
    assert helix is not None
    rim = 0.5 * given.machine_spec.ring.outer_diameter
    angles = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
    circle = rim * np.column_stack([np.cos(angles), np.sin(angles)])
    pinion, ring = (folder / f"{name}.{suffix}" for name in ("pinion", "ring"))
    export_section(Section(gears.pinion.closed_polygon()), pinion, width, twist=helix.twist)
    whole = Section(circle, (gears.ring_curve,)) if suffix == "stl" else Section(gears.ring_curve)
    export_section(whole, ring, width, twist=helix.twist * gears.ratio)
    halfway = math.degrees(math.atan(helix.turn_per_length * halfway_up(gears.pinion)))
    left_out = ("module", "pressure_angle", "tooth_count", "tip_diameter", "normal_backlash")
    keys = {f"machine.pinion.{name}": None for name in left_out}
    return given.replace({
        **keys,
        "machine.pinion.profile": str(pinion),
        "machine.ring.profile": str(ring),
        "machine.pinion.center_distance": f"{1e3 * abs(gears.mesh.center_distance):.7f} mm",
        ANGLE: f"{halfway:.6f} deg",
    })  # fmt: skip


@pytest.mark.parametrize("suffix", ["txt", pytest.param("stl", marks=pytest.mark.slow)])
def test_gears_from_files_wind_as_those_of_the_parameters(tmp_path: Path, suffix: str) -> None:
    """The ring of a solid is the body whose bore has the teeth."""
    pytest.importorskip("trimesh")
    found, given = (
        assemble(c.machine_spec) for c in (drawn(tmp_path, suffix), ts.load_case(HELICAL))
    )
    assert found.helix is not None
    assert given.helix is not None
    assert found.helix.overlap_ratio == pytest.approx(given.helix.overlap_ratio, rel=1e-4)
    assert displacement(found) == pytest.approx(displacement(given), rel=1e-4)
    bores = [shapely.Polygon(gears.ring_curve) for gears in (found, given)]
    assert shapely.symmetric_difference(*bores).area < 1e-4 * bores[1].area


@pytest.mark.slow
def test_gears_from_files_run_as_those_of_the_parameters(tmp_path: Path) -> None:
    """Radii of curvature of the drawn ring pass an edge without changing their sign."""
    found, given = (
        ts.simulate(c).summary() for c in (drawn(tmp_path, "txt"), ts.load_case(HELICAL))
    )
    assert found["status"] == "done"
    for name, rel in {
        "mean_flow_L_per_min": 1e-3, "flow_ripple_percent": 0.01, "max_chamber_pressure_bar": 5e-3,
        "axial_force_N": 2e-3, "torque_loss_mesh_friction_N_m": 0.1,
    }.items():  # fmt: skip
        assert found[name] == pytest.approx(given[name], rel=rel), name


def test_a_tooth_space_that_joins_both_ports_is_named() -> None:
    name = "short circuit through the chambers"
    passed = [
        next(c.passed for c in machine(angle).checks if c.name == name)
        for angle in ("3 deg", "14 deg")
    ]
    assert passed == [True, False]


@pytest.mark.slow
def test_axial_force_is_the_moment_over_the_lead_and_turns_with_the_hand() -> None:
    right, left = (
        ts.simulate(ts.load_case(HELICAL, (f"machine.pinion.helix_hand={hand}",)))
        for hand in ("right", "left")
    )
    np.testing.assert_array_equal(right.data["chamber_pressure"], left.data["chamber_pressure"])
    np.testing.assert_array_equal(right.data["axial_force"], -left.data["axial_force"])
    numbers = right.summary()
    friction = sum(v for k, v in numbers.items() if k.startswith("torque_loss_"))
    moment = numbers["mean_torque_N_m"] - friction
    pinion, ring = right.data["axial_force"].mean("shaft_angle").values
    radius = 0.5 * 13 * 5e-3
    assert pinion == pytest.approx(moment * math.tan(math.radians(3.0)) / radius, rel=0.02)
    assert abs(ring) < 0.03 * pinion
    assert numbers["mass_balance_error"] < 1e-7
    assert numbers["energy_balance_error"] < 1e-5


@pytest.mark.slow
def test_solved_films_beside_the_pinion_keep_the_balances() -> None:
    closed, solved = (ts.simulate(HELICAL, run__fidelity=f).summary() for f in ("lumped", "films"))
    assert solved["status"] == "done"
    assert solved["mass_balance_error"] < 1e-7
    assert solved["energy_balance_error"] < 1e-5
    leaks = closed["volumetric_efficiency"]
    assert solved["volumetric_efficiency"] == pytest.approx(leaks, abs=3e-3)
