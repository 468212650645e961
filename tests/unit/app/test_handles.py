"""Handles lie where their dimension is drawn, and move with it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from toothspace.app.drawing import DRAG_NODES
from toothspace.app.handles import closed_form_of, handles_of
from toothspace.app.side_view import side_view
from toothspace.case import Case, load_case
from toothspace.core.registry import machine_type
from toothspace.model.description import MachineDescription

pytestmark = pytest.mark.unit

CASES = {
    "egm12_pump": {
        "machine.gears.face_width",
        "machine.gears.profile_shift",
        "machine.gears.normal_backlash",
        "machine.lateral.side_gap",
        "machine.casing.radial_clearance",
        "machine.journal_bearings.radial_clearance",
        "machine.journal_bearings.length",
        "machine.relief_grooves.depth",
    },
    "gerotor_trochoidal": {
        "machine.rotors.face_width",
        "machine.rotors.generating_radius",
        "machine.rotors.lobe_radius",
        "machine.lateral.side_gap",
        "machine.ports.inner_radius",
        "machine.ports.outer_radius",
    },
    "crescent_pump": {
        "machine.pinion.face_width",
        "machine.pinion.profile_shift",
        "machine.pinion.normal_backlash",
        "machine.relief_grooves.depth",
        "machine.lateral.side_gap",
    },
}
PLACES = [(name, path) for name, paths in CASES.items() for path in sorted(paths)]


def described(case: Case) -> MachineDescription:
    return machine_type(case.machine_type).describe(case.machine_spec, DRAG_NODES)


def handles(case: Case) -> dict[str, Any]:
    description = described(case)
    found = handles_of(case, description, side_view(case, description))
    return {one["path"]: one for one in found}


@pytest.fixture(scope="module")
def seen() -> dict[str, dict[str, Any]]:
    return {}


@pytest.mark.parametrize(("name", "path"), PLACES)
def test_a_handle_moves_by_its_direction(
    name: str, path: str, seen: dict[str, dict[str, Any]]
) -> None:
    case = load_case(name)
    if name not in seen:
        seen[name] = handles(case)
    before = seen[name][path]
    step = 0.03 * before["value"]
    value = before["value"] + step
    given = f"{value:.9g} {before['unit']}" if before["unit"] else value
    after = handles(case.replace({path: given}))
    moved = np.subtract(after[path]["place"]["point"], before["place"]["point"])
    wanted = step * np.array(before["place"]["direction"])
    # places are rounded to a micrometre; play and distance of a mesh are not in proportion
    assert moved == pytest.approx(wanted, abs=2e-3, rel=0.02)
    assert np.hypot(*wanted) > 2e-3


def test_edges_of_ports_are_handles() -> None:
    """Also those that follow from the timing, which both lands then replace."""
    found = handles(load_case("crescent_pump"))
    for path in ("filler.inlet_angle", "filler.outlet_angle", "ports.outlet_start"):
        assert found[f"machine.{path}"]["place"]["kind"] == "arc"
    case = load_case("gerotor_trochoidal")
    lands = handles(case)
    largest = lands["machine.ports.land_max_half_angle"]
    assert largest["value"] == pytest.approx(31.0, abs=0.5)
    given = {largest["path"]: "25 deg", **largest["with"]}
    other = case.replace(given)
    assert other.machine.ports.timing is None
    place = largest["place"]
    angle = place["zero"] + place["turn"] * 25.0
    edge = described(other).outlines["port_inlet"]
    # the kidney ends there, on the side of the inlet
    assert np.arctan2(edge[:, 1], edge[:, 0]).max() == pytest.approx(angle, abs=1e-3)


def test_the_side_view_is_as_wide_as_its_parts() -> None:
    case = load_case("egm12_pump")
    view = side_view(case, described(case))
    gear = next(part for part in view.parts if part["kind"] == "metal")
    walls = [part["edges"] for part in view.parts if part["kind"] == "wall"]
    assert gear["edges"][1] - gear["edges"][0] == pytest.approx(7.63, abs=1e-3)
    assert walls[0][1] - walls[0][0] == pytest.approx(19.0, abs=1e-3)
    # both gaps of 5.2 um, each as many times its size
    times = view.places["machine.lateral.side_gap"]["times"]
    gap = gear["edges"][0] - walls[0][1]
    assert gap == pytest.approx(times * 5.2e-3, abs=1e-3)
    assert walls[1][0] - gear["edges"][1] == pytest.approx(gap, abs=1e-3)


def test_closed_forms_are_of_gears_given_by_numbers() -> None:
    found = closed_form_of(load_case("egm12_pump"))
    assert found is not None
    assert found["kind"] == "external_gear"
    assert found["values"]["machine.gears.module"] == 2.75
    assert found["limits"]["strength"] == [20.0, 100.0, 1500.0, 430.0]
    assert closed_form_of(load_case("egm12_motor_profile")) is None
    continuous = closed_form_of(load_case("continuous_pump"))
    assert continuous is not None
    assert continuous["family"] == "arc_involute_arc"
    assert "strength" not in continuous["limits"]  # no running-in, no condition to judge at
    rotors = closed_form_of(load_case("gerotor_trochoidal"))
    assert rotors is not None
    assert rotors["kind"] == "trochoidal"
