"""Films of gerotor rotors: faces between the covers, ring of chambers round the outer rotor."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.contact_law import squeeze_damping
from toothspace.core.types import Array
from toothspace.films.journal.rim_film import rim_paths, sector_family
from toothspace.films.plane.conductance import (
    FaceConductance,
    FaceResolution,
    face_conductance,
)
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import FILM, NO_BODY, ChamberRing, FaceBody, FaceCells, FilmFace
from toothspace.run.solved_films import CoverFilms, with_shared_films

CASE = Path(__file__).parents[2] / "cases" / "gerotor_cycloidal.toml"
INNER, MIDDLE, RIM = 8e-3, 14e-3, 26e-3
COARSE = FaceResolution(rows=24, lanes=32, angles=2)


@cache
def machine() -> MachineDescription:
    return api.describe(api.load_case(CASE))


def ring_map(shaft_angle: float, x: Array, y: Array) -> FaceCells:
    """One body from the middle radius outwards; inside stand seven equal chambers."""
    radius = np.hypot(x, y)
    sector = np.mod(np.rint(np.arctan2(y, x) * 7 / (2.0 * math.pi)).astype(int), 7)
    film = radius > MIDDLE
    return FaceCells(np.where(film, FILM, sector), np.where(film, 0, NO_BODY))


def rings(sectors: int = 4) -> FaceConductance:
    face = FilmFace(
        bodies=(FaceBody("disc", (0.0, 0.0), RIM),),
        center=(0.0, 0.0),
        inner_radius=INNER,
        outer_radius=RIM,
        gap=20e-6,
        face_map=ring_map,
        chambers=ChamberRing(np.arange(7), 2.0 * math.pi * np.arange(7) / 7),
        recesses=np.zeros(0, dtype=np.int64),
        inner_node=10,
        sectors=sectors,
    )
    return face_conductance(face, FaceResolution(rows=28, lanes=45, angles=1))


def test_ring_between_chambers_and_rim_leaks_and_carries_like_a_ring() -> None:
    """Q = 2 pi h^3 dp / (12 mu ln(r2/r1)); pressure falls with the logarithm of the radius."""
    film = rings()
    out, chambers = film.matrix[0][8:, :7], np.ones(7)
    assert -(out @ chambers).sum() == pytest.approx(
        2.0 * math.pi / math.log(RIM / MIDDLE), rel=0.02
    )
    np.testing.assert_allclose(film.matrix[0].sum(axis=1), 0.0, atol=1e-9)
    exact = math.pi * ((RIM**2 - MIDDLE**2) / (2.0 * math.log(RIM / MIDDLE)) - MIDDLE**2)
    assert film.area[0, 0, :7].sum() == pytest.approx(exact, rel=0.02)
    assert film.area[0, 0].sum() == pytest.approx(math.pi * (RIM**2 - MIDDLE**2), rel=0.02)
    assert film.drag[0] == pytest.approx(0.5 * math.pi * (RIM**4 - MIDDLE**4), rel=0.02)


def steady_force(description: MachineDescription, sectors: int, ratio: float) -> Array:
    """Force of the full incompressible ring film, off centre along x; speed, viscosity 1."""
    faces = description.shared_faces
    assert faces is not None
    faces = replace(faces, covers=tuple(replace(c, sectors=sectors) for c in faces.covers))
    count = faces.face.sector_phases.size
    path, *_ = rim_paths(description, faces, np.arange(count))
    x = description.motion_index("outer_rotor", "x")
    move = ratio * faces.rim.clearance
    assert path.height_by_motion is not None
    assert path.drag_speed is not None
    gap = path.geometry(path.phases)[:, 0] + move * path.height_by_motion(path.phases)[:, x]
    width, length = path.geometry.values[0, 1:]
    conductance = gap**3 * width / (12.0 * length)
    drag = gap * width * path.drag_speed(path.phases)[:, 0] / faces.face.chambers.angle_ratio
    family = sector_family(description, faces)
    swept = move * family.volume_by_motion.derivative(family.phases)[:, x]
    ahead = np.roll(np.arange(count), -1)
    matrix = np.zeros((count, count))
    source = -swept
    for a, b, g, q in zip(np.arange(count), ahead, conductance, drag, strict=True):
        matrix[[a, b], [a, b]] += g
        matrix[[a, b], [b, a]] -= g
        source[a] -= q
        source[b] += q
    pressure = np.linalg.lstsq(matrix, source, rcond=None)[0]
    motions = [description.motion_index("outer_rotor", axis) for axis in "xy"]
    return np.asarray(pressure @ family.volume_by_motion(family.phases)[:, motions])


@pytest.mark.parametrize(
    ("ratio", "sectors", "within"), [(0.3, 4, 0.03), (0.6, 4, 0.06), (0.6, 16, 0.005)]
)
def test_ring_of_chambers_is_the_long_full_film(ratio: float, sectors: int, within: float) -> None:
    """Sommerfeld's film: F = 12 pi mu w R^3 L e / (c^2 (2 + e^2) sqrt(1 - e^2)), across e."""
    description = machine()
    assert description.shared_faces is not None
    rim = description.shared_faces.rim
    force = steady_force(description, sectors, ratio)
    exact = 12.0 * math.pi * rim.radius**3 * rim.length * ratio / rim.clearance**2
    exact /= (2.0 + ratio**2) * math.sqrt(1.0 - ratio**2)
    assert abs(force[0]) < 1e-3 * exact
    assert force[1] == pytest.approx(exact, rel=within)


def test_paths_of_solved_films_close_with_the_conductances() -> None:
    """What leaves the pockets over the covers at equal gaps, against the matrices of the films."""
    description = machine()
    faces = description.shared_faces
    assert faces is not None
    films = tuple(face_conductance(cover, COARSE) for cover in faces.covers)
    wider = with_shared_films(description, CoverFilms(films))
    drain = next(path for path in wider.paths if path.name == "drain")
    gap = drain.geometry(drain.phases)
    inner = faces.face.chambers.nodes.size + faces.face.recesses.size
    own = -sum(film.matrix[0, :7, inner] for film in films)
    np.testing.assert_allclose(gap[:, 1] / gap[:, 2], own, rtol=1e-6)
    np.testing.assert_allclose(gap[:, 0], faces.face.gap)
    assert wider.chamber_count == 7 + faces.face.sector_phases.size
    assert np.all(drain.nodes_b == wider.drain_node)


def test_squeeze_film_is_the_integral_of_its_pressure() -> None:
    """q/v from the pressure 6 mu R / h^2 of a parabola; the derivative from differences."""
    radius, viscosity, roughness, gap = 5e-3, 0.03, 0.1e-6, 4e-6
    height = roughness + 0.5 * (gap + math.hypot(gap, roughness))
    x = np.linspace(-6e-3, 6e-3, 400_001)
    h = height + x**2 / (2.0 * radius)
    exact = float(np.trapezoid(6.0 * viscosity * radius / h**2, x))
    far = squeeze_damping(59.99 * roughness, roughness, 1.0 / radius, viscosity)[0]
    assert far < 1e-3 * exact
    damping, slope = squeeze_damping(gap, roughness, 1.0 / radius, viscosity)
    reach = exact * (height / (60.5 * roughness + 0.504 * roughness)) ** 1.5
    assert damping == pytest.approx(exact - reach, rel=0.01)
    step = 1e-10
    beyond = squeeze_damping(gap + step, roughness, 1.0 / radius, viscosity)[0]
    assert slope == pytest.approx((beyond - damping) / step, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("ends", ["no_flow", "pressure"])
def test_pump_with_solved_films_reaches_its_cyclic_state(ends: str) -> None:
    """Ledgers close; the rotor orbits until the film has damped it; faces leak as solved."""
    case = api.load_case(
        CASE,
        (
            "run.fidelity=films",
            "operating_point.outlet_load=fixed_pressure",
            f"machine.housing.end_condition={ends}",
        ),
    )
    solution = api.simulate(case)
    assert solution.status.succeeded
    found = solution.summary()
    assert found["energy_balance_error"] < 1e-4
    assert found["mass_balance_error"] < 1e-10
    assert 0.0 < found["overall_efficiency"] < 1.0
