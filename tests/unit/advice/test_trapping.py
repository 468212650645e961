"""Design rules of groove edges, backlash and seal in the mesh."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from tests.external_gear_designs import egm12
from toothspace.advice.gear_rules import backlash_check
from toothspace.advice.trapping import Trapping, trapping_checks
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.machines.external_gear import MACHINE
from toothspace.machines.external_gear.assembly import assemble
from toothspace.machines.external_gear.summary import enclosed_mesh
from toothspace.model.description import RunningIn

BAR = 1e5


def _pump(backlash: float, closing: float, opening: float, mode: str = "pump"):
    """12-tooth machine with offsets in mm and a condition of 200 bar, 1500 rpm."""
    casing = replace(
        egm12(mode).keys.casing,
        wear_in=RunningIn(pressure=200 * BAR, shaft_speed=1500 * math.pi / 30, temperature=323.0),
    )
    grooves = ReliefGrooves(closing_side_offset=closing * 1e-3, opening_side_offset=opening * 1e-3)
    return assemble(egm12(mode, normal_backlash=backlash * 1e-3, grooves=grooves, casing=casing))


def _checks(assembly):
    mesh = enclosed_mesh(assembly, assembly.spaces(720))
    return {check.name.split(",")[0]: check for check in trapping_checks(mesh)}


def _trapping(assembly) -> Trapping:
    return enclosed_mesh(assembly, assembly.spaces(720)).trapping


@pytest.mark.parametrize(
    ("closing", "opening", "simulated"), [(3.4, 3.4, 242.9), (3.2, 3.652, 211.9), (3.5, 3.5, 302.1)]
)
def test_peak_agrees_with_the_run_of_the_machine(closing, opening, simulated):
    """Lumped runs of the pump at 1500 rpm, 200 bar, backlash 0.107 mm; within 15 %."""
    assembly = _pump(0.107, closing, opening)
    found = _trapping(assembly)
    assert found.peak_pressure / BAR == pytest.approx(simulated, rel=0.15)


@pytest.mark.parametrize(("opening", "lost"), [(2.8, 0.0069), (2.4, 0.0232), (2.0, 0.0519)])
def test_short_circuit_is_no_less_than_the_flow_of_the_run_loses(opening, lost):
    """Loss of volumetric efficiency against grooves at 3.4 mm, in lumped runs at 200 bar.

    Both ports' full difference at the orifices, gears in the middle: 1.3 to 1.7 times the loss.
    """
    assembly = _pump(0.107, 3.4, opening)
    found = _trapping(assembly)
    assert lost < found.short_circuit < 1.75 * lost


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_grooves_at_single_flank_timing_trap_and_the_edge_to_move_is_named(mode):
    check = _checks(_pump(0.11, 3.641, 3.641, mode))["trapped pressure"]
    assert not check.passed
    assert "Move the closing-side edge to 3." in check.reason
    assert _checks(_pump(0.11, 3.4, 3.4, mode))["trapped pressure"].passed


def test_a_narrow_backlash_asks_for_dual_flank_timing():
    narrow = _checks(_pump(0.02, 3.652, 3.652))["exchange through the backlash"]
    wide = _checks(_pump(0.11, 3.4, 3.4))["exchange through the backlash"]
    trapped = _checks(_pump(0.02, 3.652, 3.652))["trapped pressure"]
    assert "widen the backlash" in trapped.reason
    assert not narrow.passed
    assert "dual-flank timing" in narrow.reason
    assert wide.passed
    assert "single-flank timing" in wide.reason


def test_joined_grooves_are_judged_once_with_the_edge_that_parts_them():
    """In the running-in condition 200 bar, 1500 rpm as without one; estimate of the mesh alone."""
    assembly = _pump(0.107, 3.4, 2.0)
    keys = assembly.spec.keys
    bare = replace(keys, casing=replace(keys.casing, wear_in=None))
    found = []
    for spec in (assembly.spec, replace(assembly.spec, keys=bare)):
        checks = MACHINE.describe(spec, nodes=720).checks
        found += [check for check in checks if check.name.startswith("short circuit")]
    worn, unworn = found
    assert not worn.passed
    assert "Move the opening-side edge to 2." in worn.reason
    assert worn == unworn
    mesh = _trapping(assembly)
    assert worn.value == pytest.approx(100.0 * mesh.short_circuit, rel=0.02)


def test_short_circuit_is_judged_at_the_running_in_condition():
    """Flow through orifices over the ideal flow goes with the root of pressure over speed."""
    assembly = _pump(0.107, 3.4, 2.4)
    keys = assembly.spec.keys
    wear = replace(keys.casing.wear_in, pressure=100 * BAR, shaft_speed=8000 * math.pi / 30)
    fast = replace(keys, casing=replace(keys.casing, wear_in=wear))
    slow_check, fast_check = (
        next(
            check
            for check in MACHINE.describe(spec).checks
            if check.name.startswith("short circuit")
        )
        for spec in (assembly.spec, replace(assembly.spec, keys=fast))
    )
    shrunk = math.sqrt((100 - 1.01325) / (200 - 1.01325)) * 1500 / 8000
    assert fast_check.value == pytest.approx(shrunk * slow_check.value, rel=1e-12)
    assert fast_check.passed
    assert not slow_check.passed
    assert fast_check.allowed.endswith("at 100 bar, 8000 rpm")


def test_nothing_is_said_without_condition_or_grooves():
    def judged(spec) -> list[str]:
        names = [check.name for check in MACHINE.describe(spec, nodes=720).checks]
        return [name for name in names if "trapped pressure" in name or "exchange" in name]

    spec = _pump(0.11, 3.4, 3.4).spec
    assert len(judged(spec)) == 2
    assert judged(egm12()) == []
    assert judged(replace(spec, grooves=None)) == []


@pytest.mark.parametrize(
    ("backlash", "passed"), [(0.104, False), (0.109, True), (0.27, True), (0.28, False)]
)
def test_backlash_has_a_least_and_a_largest_value(backlash, passed):
    """Module 2.75 mm at 34.5 mm: 2/3 (0.06 + 0.01725 + 0.0825) = 0.1065 mm to a tenth module."""
    assert bool(backlash_check(backlash * 1e-3, 2.75e-3, 34.5e-3).passed) is passed
