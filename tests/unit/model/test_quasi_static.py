"""Pressures at rest: what closed forms of resistances in series and parallel give."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.fake_solution import HIGH, LOW, TEETH, fake_description
from toothspace.model.description import FlowPath, MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import PathCategory
from toothspace.model.quasi_static import bush_positions, mean_force, quasi_static_pressures
from toothspace.numerics.periodic_table import smooth_table

CONDITION = OperatingCondition(shaft_speed=100.0, inlet_pressure=HIGH, outlet_pressure=LOW)
TIP = PathCategory("tip", "tips", "#000000", "gap")
GAP = (20e-6, 8e-3, 1e-3)
"""Height, width and length of the gaps between neighbours. [m]"""


def with_gaps(machine: MachineDescription) -> MachineDescription:
    """Both gears with gaps from every space to the next, twice each."""
    table = smooth_table(2.0 * np.pi, np.tile(GAP, (12, 1)))
    phases = np.zeros(TEETH)
    gaps = tuple(
        FlowPath(
            f"tip_{first}", TIP, "parallel_gap", first + np.arange(TEETH),
            first + (np.arange(TEETH) + 1) % TEETH, 1.0, phases, table, multiplicity=2.0,
        )
        for first in (0, TEETH)
    )  # fmt: skip
    return replace(machine, paths=(*machine.paths, *gaps))


def test_a_space_open_to_both_ports_has_their_mean_by_areas() -> None:
    machine = fake_description()
    angle = np.array([0.3, 1.1])
    found = quasi_static_pressures(machine, CONDITION, angle)
    area = np.zeros((2, 2, 2 * TEETH))
    for path in machine.paths:
        opened = np.maximum(path.geometry(path.phases + angle[:, None])[..., 0], 0.0)
        for k in range(path.count):
            area[:, path.nodes_b[k] - 2 * TEETH, path.nodes_a[k]] += opened[:, k]
    inlet, outlet = area.transpose(1, 0, 2)
    total = inlet + outlet
    both = total > 0.0
    assert 4 < both.sum() < both.size
    expected = (inlet * HIGH + outlet * LOW)[both] / total[both]
    assert found[both] == pytest.approx(expected, rel=1e-9)


def test_flows_of_every_space_sum_to_nothing() -> None:
    """Through gaps of 2 b h^3/(12 L) and openings; pressures fall between neighbours."""
    machine = with_gaps(fake_description())
    pressure = quasi_static_pressures(machine, CONDITION, 0.3)
    assert LOW <= pressure.min() < pressure.max() <= HIGH
    height, width, length = GAP
    gap = 2.0 * width * height**3 / (12.0 * length)
    # openings conduct as their area times a length of the machine
    opening = 1.083e-5 * machine.displacement ** (1.0 / 3.0)
    own = np.concatenate([pressure, [HIGH, LOW, LOW]])
    into = np.zeros(own.size)
    for path in machine.paths:
        area = np.maximum(path.geometry(path.phases + 0.3)[:, 0], 0.0)
        conductance = opening * area if path.kind == "orifice" else np.full(path.count, gap)
        flow = conductance * (own[path.nodes_a] - own[path.nodes_b])
        np.add.at(into, path.nodes_b, flow)
        np.add.at(into, path.nodes_a, -flow)
    assert np.abs(into[: 2 * TEETH]).max() < 1e-9 * np.abs(into).max()


def test_equal_ports_leave_no_difference() -> None:
    condition = replace(CONDITION, inlet_pressure=LOW)
    machine = with_gaps(fake_description())
    assert quasi_static_pressures(machine, condition, 0.3) == pytest.approx(LOW, rel=1e-9)


def test_blocks_rest_along_the_mean_load_of_both_gears() -> None:
    """Spaces that are drawn together push with their pressure along x: the blocks lie there."""
    machine = with_gaps(fake_description())
    force = np.zeros((360, 4))
    force[:, 0], force[:, 3] = 2e-5, 1e-5
    families = tuple(
        replace(family, volume_by_motion=smooth_table(2.0 * np.pi, force))
        for family in machine.families
    )
    journals = tuple(
        replace(journal, seat_clearance=clearance)
        for journal, clearance in zip(machine.journals, (30e-6, 50e-6), strict=True)
    )
    machine = replace(machine, families=families, journals=journals)
    total = mean_force(machine, CONDITION)
    angles = 2.0 * np.pi * 0.381966 * np.arange(24)
    sums = quasi_static_pressures(machine, CONDITION, angles).sum(axis=1).mean()
    assert total == pytest.approx(sums * np.array([2e-5, 0.0, 0.0, 1e-5]), rel=1e-9)
    found = bush_positions(machine, CONDITION, np.eye(4), [0, 1, 2, 3])
    along = np.array([2.0, 1.0]) / np.sqrt(5.0)
    assert np.array(found["drive_gear"]) == pytest.approx(30e-6 * along)
    assert np.array(found["driven_gear"]) == pytest.approx(50e-6 * along)
