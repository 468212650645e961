"""Tooth spaces in slices along the helix: closed forms, limits and conservation."""

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
from toothspace.closures.gap_flow import parallel_gap_conductance
from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.gearing.helix import Helix
from toothspace.gearing.helix_slices import ALONG, Slices
from toothspace.gearing.spaces import section_areas
from toothspace.machines.external_gear.assembly import assemble
from toothspace.model.description import FlowPath, MachineDescription
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table
from toothspace.run.solved_films import with_solved_films
from toothspace.solver.flow_regime import along_spaces

CASES = Path(__file__).resolve().parents[3] / "cases"
HELICAL, CRESCENT = CASES / "helical_pump.toml", CASES / "crescent_helical.toml"
KEYS = {HELICAL: "machine.gears.axial_slices", CRESCENT: "machine.pinion.axial_slices"}
ANGLES = np.linspace(0.0, 7.0, 40)


@cache
def machine(case: Path, slices: int | None = None) -> MachineDescription:
    return api.prepare(ts.load_case(case).replace({KEYS[case]: slices})).machine


def conductance(path: FlowPath, channel: int) -> Array:
    """Sum of one channel of a path over its members, both faces and slices counted."""
    table = path.geometry(path.phases + path.angle_ratio * ANGLES[:, None])
    return np.asarray(path.multiplicity * table[..., channel].sum(axis=1))


@pytest.mark.parametrize("case", [HELICAL, CRESCENT])
def test_slices_hold_and_open_what_the_whole_space_does(case: Path) -> None:
    whole, sliced = machine(case), machine(case, 3)
    assert sliced.chamber_count == 3 * whole.chamber_count
    for k, family in enumerate(whole.families):
        places = family.phases + family.angle_ratio * ANGLES[:, None]
        parts = sliced.families[3 * k : 3 * k + 3]
        for name in ("volume", "volume_by_motion"):
            one = getattr(family, name)(places)
            all_ = sum(
                getattr(part, name)(part.phases + part.angle_ratio * ANGLES[:, None])
                for part in parts
            )
            np.testing.assert_allclose(all_, one, atol=2e-5 * np.abs(one).max())
    for path in whole.paths:
        if path.kind != "orifice":
            continue
        area = conductance(path, 0)
        own = [part for part in sliced.paths if part.name.startswith(f"{path.name}_")]
        assert len(own) == (2 if path.multiplicity == 2 else 3)
        found = sum(conductance(part, 0) for part in own)
        np.testing.assert_allclose(found, area, atol=1e-2 * area.max())  # between nodes


def test_paths_join_the_spaces_that_those_of_the_section_join() -> None:
    """A slice of a space meets the same slice of the mating gear, and its own ports."""
    section, sliced = machine(HELICAL).winding.section, machine(HELICAL, 3)
    count = section.families[0].count
    for path in section.paths:
        for part in (0, 2):
            ends = f"slice_{part}", ("lower", "", "upper")[part]
            own = [p for p in sliced.paths if p.name in {f"{path.name}_{end}" for end in ends}]
            assert len(own) == 1

            def named(nodes: Array, chambers: int) -> list[tuple[int, int]]:
                """Gear and number of spaces; ports by number."""
                each = chambers // 2
                return [
                    (int(n) // each, int(n) % count) if n < chambers else (2, int(n) - chambers)
                    for n in nodes
                ]

            for side in ("nodes_a", "nodes_b"):
                assert named(getattr(own[0], side), 6 * count) == named(
                    getattr(path, side), 2 * count
                )


def test_slices_are_polygons_of_their_sections() -> None:
    case = ts.load_case(HELICAL)
    assembly, helix = assemble(case.machine_spec), case.machine_spec.helix
    sliced, width = machine(HELICAL, 4), case.machine_spec.drive.face_width
    places = np.linspace(-0.9, 0.9, 9)  # of a space, from the mesh
    for part in (0, 3):
        heights = width * ((part + (np.arange(20) + 0.5) / 20) / 4 - 0.5)
        areas = [
            section_areas(assembly.spaces_at(places + lead, places)[0])
            for lead in helix.turn_per_length * heights
        ]
        family = sliced.families[part]
        # slices of a space stand together: the phase has the lead of the middle of the slice
        ahead = family.phases[0] - sliced.winding.section.families[0].phases[0]
        found = family.volume(np.pi + places + ahead)[:, 0]
        expected = 0.25 * width * np.mean(areas, axis=0)
        np.testing.assert_allclose(found, expected, atol=1e-4 * expected.max())


@pytest.mark.parametrize("slices", [2, 4, 16])
def test_joints_lose_the_friction_of_a_pipe_and_one_dynamic_head_together(slices: int) -> None:
    sliced, viscosity = machine(HELICAL, slices), 0.03
    width, section = 23.7e-3, sliced.winding.section.families[0]
    joints = [path for path in sliced.paths if path.category is ALONG]
    assert len(joints) == 2 * (slices - 1)
    height, wide, long = joints[0].geometry.values.T
    area = section.volume.values[:, 0] / width
    diameter = area / np.sqrt(area.max())
    pipe = area * diameter**2 / (32.0 * viscosity * width / slices)
    np.testing.assert_allclose(
        parallel_gap_conductance(height, wide, long, viscosity), pipe, rtol=1e-12
    )
    heads = (area / (DISCHARGE_COEFFICIENT * wide * height)) ** 2
    # a space squeezed evenly: the speed at a joint goes with its distance from the shut end
    share = np.sum((np.arange(1, slices) / slices) ** 2)
    np.testing.assert_allclose(heads * share, (slices - 1) / slices, rtol=1e-12)


def test_faces_see_the_slice_at_their_end() -> None:
    """Conductances of the section at the lead of each face, to the chambers of that end."""
    sliced = machine(HELICAL, 3)
    winding = sliced.winding
    assert winding is not None
    half, count = 0.5 * winding.twist, winding.section.families[0].count
    paths = {path.name: path for path in sliced.paths}
    section = {path.name: path for path in winding.section.paths}
    for end, lead, first in (("lower", -half, 0), ("upper", half, 2 * count)):
        own, one = paths[f"groove_outlet_drive_{end}"], section["groove_outlet_drive"]
        np.testing.assert_allclose(own.phases - one.phases, lead, rtol=1e-12)
        np.testing.assert_array_equal(own.nodes_a, one.nodes_a + first)
        chambers = sliced.chambers_in_section(0.3, lead)
        np.testing.assert_array_equal(chambers[:count], np.arange(count) + first)


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_openings_in_one_face_see_the_slice_beside_it(turn: float) -> None:
    """Leading ones that at the end whose teeth lead, on whichever side that is."""
    helix, count = Helix(math.atan(turn), 12, 0.02, 0.3, 0.015), 5
    slices = Slices(helix, 3, (count, count))
    nodes, ports = np.arange(count), np.full(count, 2 * count)
    shut = monotone_table(2.0 * math.pi, np.zeros((8, 3)))
    opening = FlowPath("recess", ALONG, "orifice", nodes, ports, 1.0, 0.4 * nodes, shut)
    for end in (1.0, -1.0):
        (found,) = slices(replace(opening, end=end))
        assert found.name == "recess"
        np.testing.assert_allclose(found.phases - opening.phases, 0.5 * end * helix.twist)
        upper = end * helix.turn_per_length > 0.0
        np.testing.assert_array_equal(found.nodes_a, nodes + (2 * count if upper else 0))
        np.testing.assert_array_equal(found.nodes_b, 3 * 2 * count)


def test_a_section_sees_the_slice_that_it_passes() -> None:
    """Right up to the joints, and with the outer slices beyond the ends."""
    slices = 4
    sliced = machine(HELICAL, slices)
    winding = sliced.winding
    assert winding is not None
    count = winding.section.families[0].count
    along = float(np.copysign(winding.twist, winding.turn_per_length))
    for at, slice_ in ((-0.1, 0), (0.01, 0), (0.24, 0), (0.26, 1), (0.74, 2), (0.76, 3), (1.1, 3)):
        chambers = sliced.chambers_in_section(0.3, along * (at - 0.5))
        np.testing.assert_array_equal(chambers[:count], np.arange(count) + slice_ * count)


def test_a_rule_judges_a_slice_as_it_does_a_space() -> None:
    assert not list(along_spaces(17e5, 120e5, 3))
    (finding,) = along_spaces(19e5, 120e5, 3)
    assert "a slice of it holds up to 18 bar" in finding.text
    short = "short circuit through the chambers"
    values = [
        next(c.value for c in machine(HELICAL, n).checks if c.name == short) for n in (None, 3)
    ]
    assert values[0] == values[1]


@pytest.mark.parametrize(
    ("case", "changes"),
    [
        (HELICAL, {"machine.gears.helix_angle": "0 deg", "machine.gears.helix_hand": None}),
        (CASES / "continuous_pump.toml", {}),
    ],
)
def test_spaces_that_have_no_slices_are_refused_them(case: Path, changes: dict[str, Any]) -> None:
    with pytest.raises(CaseError, match="axial_slices"):
        ts.load_case(case).replace({**changes, "machine.gears.axial_slices": 3})


@pytest.mark.slow
def test_wide_joints_give_the_machine_of_one_pressure() -> None:
    case = ts.load_case(HELICAL, ("run.samples_per_revolution=360", "run.relative_tolerance=1e-5"))
    run = api.prepare(case.replace({KEYS[HELICAL]: 3}))
    scale = np.array([1.0, 1e3, 1.0])
    paths = [
        replace(
            p,
            geometry=PeriodicTable(
                p.geometry.period, p.geometry.values * scale, p.geometry.slopes * scale
            ),
        )
        if p.category is ALONG
        else p
        for p in run.machine.paths
    ]
    wide = replace(run, machine=replace(run.machine, paths=tuple(paths))).march()
    one = api.prepare(case).march()  # neither is worn in
    first, second = wide.summary(), one.summary()
    # gas stays where it comes out, so that cavities of slices cost a little torque more
    for name, tolerance in (
        ("mean_flow_L_per_min", 3e-4), ("mean_torque_N_m", 1.5e-3), ("flow_ripple_percent", 1e-3),
        ("max_chamber_pressure_bar", 1e-3), ("axial_force_N", 2e-3),
    ):  # fmt: skip
        assert first[name] == pytest.approx(second[name], rel=tolerance), name


@pytest.mark.slow
@pytest.mark.parametrize("case", [HELICAL, CRESCENT])
def test_runs_of_slices_keep_the_balances(case: Path) -> None:
    found = ts.simulate(ts.load_case(case).replace({KEYS[case]: 3})).summary()
    assert found["status"] == "done"
    assert found["mass_balance_error"] < 1e-7
    assert found["energy_balance_error"] < 1e-5


@pytest.mark.slow
def test_films_beside_slices_are_those_of_the_section_at_each_end() -> None:
    sliced = machine(HELICAL, 3)
    models = {"journal": "closed_form", "lateral": "reynolds"}
    known = {path.name for path in sliced.paths}
    solved = with_solved_films(sliced, models=models)
    new = [path for path in solved.paths if path.name not in known]
    assert {path.name.rpartition("_")[2] for path in new} == {"lower", "upper"}
    numbers = ts.simulate(
        ts.load_case(HELICAL).replace({KEYS[HELICAL]: 3}), run__fidelity="films"
    ).summary()
    assert numbers["status"] == "done"
    assert numbers["energy_balance_error"] < 1e-5
