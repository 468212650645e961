"""Helical internal gears with crescent: limits, slices, hands, axial force."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
from toothspace import api
from toothspace.core.errors import CaseError
from toothspace.gearing.spaces import section_areas
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


@pytest.mark.slow
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


@pytest.mark.slow
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


def test_helical_teeth_are_generated() -> None:
    with pytest.raises(CaseError, match="helix_hand"):
        ts.load_case(HELICAL, (f"{ANGLE}=0 deg",))
    with pytest.raises(CaseError, match="leave this key out with a helix_angle"):
        ts.load_case(HELICAL, ("machine.pinion.profile=[[0, 0], [1, 0], [0, 1]]",))


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
