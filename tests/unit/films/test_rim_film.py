"""Film round the rim of a rotor as chambers: its volumes, gaps and open ends by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.films.journal.rim_film import rim_paths, sector_family
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import SharedFaces

CASE = Path(__file__).resolve().parents[3] / "cases" / "gerotor_cycloidal.toml"


@cache
def _machine() -> MachineDescription:
    return api.describe(api.load_case(CASE))


def _faces(sectors: int, open_ends: bool = False) -> SharedFaces:
    faces = _machine().shared_faces
    assert faces is not None
    covers = tuple(replace(cover, sectors=sectors) for cover in faces.covers)
    return replace(faces, covers=covers, rim=replace(faces.rim, open_ends=open_ends))


@pytest.mark.parametrize("sectors", [1, 3])
def test_sectors_hold_the_ring_and_lose_what_the_rotor_sweeps(sectors: int) -> None:
    faces = _faces(sectors)
    rim, family = faces.rim, sector_family(_machine(), faces)
    volumes = family.volume(family.phases)[:, 0]
    ring = math.pi * ((rim.radius + rim.clearance) ** 2 - rim.radius**2) * rim.length
    assert volumes.sum() == pytest.approx(ring, rel=1e-3)
    half = math.pi / family.phases.size
    across = np.linspace(-half, half, 1001)
    swept = family.volume_by_motion(family.phases)
    polar = family.phases + faces.face.chambers.zero_angle
    for axis, normal in (("x", np.cos), ("y", np.sin)):
        per_angle = -normal(polar[:, None] + across) * rim.radius * rim.length
        wanted = np.trapezoid(per_angle, across, axis=1)
        found = swept[:, _machine().motion_index(rim.body, axis)]
        assert found == pytest.approx(wanted, abs=1e-4 * np.abs(wanted).max())


def test_a_parabola_of_pressure_leaves_by_both_ends() -> None:
    """Of a mean pressure p its slope at an end is 6 p / L: 2 * 2 pi R h^3 / 12 * 6 / L in all."""
    faces = _faces(2, open_ends=True)
    rim, nodes = faces.rim, np.arange(faces.face.sector_phases.size)
    ends = rim_paths(_machine(), faces, nodes)[1]
    height, width, length = ends.geometry(ends.phases).T
    found = ends.multiplicity * np.sum(height**3 * width / (12.0 * length))
    circumference = 2.0 * math.pi * rim.radius
    wanted = 2.0 * circumference * rim.clearance**3 / 12.0 * 6.0 / rim.length
    assert found == pytest.approx(wanted, rel=1e-9, abs=0.0)
    assert ends.drag_speed is None
    assert set(ends.nodes_b.tolist()) == {faces.face.inner_node}


def test_neighbours_leak_through_the_gap_between_their_middles() -> None:
    faces = _faces(2)
    rim, count = faces.rim, faces.face.sector_phases.size
    (path,) = rim_paths(_machine(), faces, np.arange(count))
    pitch = 2.0 * math.pi / count
    wanted = [rim.clearance, rim.length, rim.radius * pitch]
    assert path.geometry(path.phases)[0] == pytest.approx(wanted)
    # half way between two middles, where the wall drags with half its speed
    assert np.cos(path.phases - faces.face.sector_phases - 0.5 * pitch) == pytest.approx(1.0)
    ratio = faces.face.chambers.angle_ratio
    assert path.drag_speed is not None
    assert path.drag_speed(path.phases) == pytest.approx(-0.5 * rim.radius * ratio)
    # towards the bore the rotor closes the gap
    assert path.height_by_motion is not None
    polar = path.phases + faces.face.chambers.zero_angle
    closing = path.height_by_motion(path.phases)
    for axis, normal in (("x", np.cos), ("y", np.sin)):
        found = closing[:, _machine().motion_index(rim.body, axis)]
        assert found == pytest.approx(-normal(polar), abs=1e-4)
