"""Bodies that lift and tilt between two covers: moments of tilted films, places, what they leak."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.toy_machine import toy_machine
from toothspace import api
from toothspace.core.types import Array
from toothspace.films import FilmFluid
from toothspace.films.plane.conductance import FaceResolution, face_conductance
from toothspace.floating.between_covers import (
    BodiesBetweenCovers,
    bodies_between_covers,
    cover_stack,
    resting_covers,
)
from toothspace.floating.face_film import film_law
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.motion import state_at
from toothspace.floating.stack import Stack, StackState, WinklerFoundation
from toothspace.model.film_faces import (
    FILM,
    NO_BODY,
    ChamberRing,
    FaceBody,
    FaceCells,
    FilmFace,
    RimFilm,
    SharedFaces,
)
from toothspace.run.condition import condition_of, fluid_of

CASE = Path(__file__).parents[2] / "cases" / "gerotor_cycloidal.toml"
INNER, RIM, GAP = 10e-3, 26e-3, 20e-6
VISCOSITY, SPEED, PRESSURE = 0.03, 80.0, 50e5
SIDE_GAP = float(api.load_case(CASE).value("machine.lateral.side_gap"))


class Ring:
    """A plain ring from the inner radius to the rim; one chamber within, one round the rim."""

    def __init__(self, inner: float) -> None:
        self.inner = inner

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        film = np.hypot(x, y) >= self.inner
        return FaceCells(np.where(film, FILM, 0), np.where(film, 0, NO_BODY))


def covers(inner: float = INNER) -> SharedFaces:
    ring = FilmFace(
        bodies=(FaceBody("rotor", (0.0, 0.0), RIM, inner),),
        center=(0.0, 0.0),
        inner_radius=0.9 * inner,
        outer_radius=RIM,
        gap=GAP,
        face_map=Ring(inner),
        chambers=ChamberRing(np.array([0]), np.zeros(1)),
        recesses=np.zeros(0, dtype=np.int64),
        inner_node=2,
        sectors=1,
    )
    rim = RimFilm("rotor", RIM, 10e-3, 50e-6, 0.0, open_ends=False, chamber=1)
    return SharedFaces((ring, ring), rim, (), (), motion="full")


def tilted(tilt: tuple[float, float], rate: tuple[float, float] = (0.0, 0.0)) -> StackState:
    """Films of the ring between both covers, tilted or tilting, all round it one pressure."""
    balance = resting_covers(toy_machine(), covers())
    grids = tuple(FaceGrid(interface, 90, 40) for interface in balance.interfaces)
    law = film_law(None, FilmFluid(VISCOSITY))
    stack = Stack(balance, grids, (law, law), WinklerFoundation((0.0, 0.0)), SPEED)
    q, v = stack.start(GAP), np.zeros(stack.size)
    q[4:6], v[4:6] = tilt, rate
    snapshot = stack.snapshot(0.0, np.full(9, PRESSURE))
    return stack.solve(snapshot, q, v, None, [np.zeros((g.rows, g.lanes)) for g in grids])


def moment_per_source() -> float:
    """Integral of p x over the ring for p'' + p'/r - p/r^2 = r, zero at both rims, times cos."""
    # p = r^3/8 + A r + B/r
    a = -0.125 * (RIM**4 - INNER**4) / (RIM**2 - INNER**2)
    b = -(INNER**4 / 8.0 + a * INNER**2)
    return math.pi * (
        (RIM**6 - INNER**6) / 48.0 + a * (RIM**4 - INNER**4) / 4.0 + b * (RIM**2 - INNER**2) / 2.0
    )


def test_wedge_of_a_tilted_ring_turns_it_about_the_other_axis() -> None:
    """Rotation drags fluid into the wedge: 6 mu w tilt / h^3 at either cover, no force."""
    tilt = 1e-3 * GAP / RIM
    force = tilted((tilt, 0.0)).film_force()[3:]
    # with h = h0 + tilt y the source is 6 mu w tilt r cos(a) / h0^3; both covers add up
    exact = 2.0 * 6.0 * VISCOSITY * SPEED * tilt / GAP**3 * -moment_per_source()
    assert force[2] == pytest.approx(exact, rel=0.01)
    assert abs(force[1]) < 1e-3 * abs(exact)
    assert abs(force[0]) * RIM < 1e-3 * abs(exact)


def test_squeeze_of_a_tilting_ring_holds_it_half_as_fast_as_the_wedge_turns_it() -> None:
    """12 mu rate / h^3 resists a tilt: with the wedge a tilted ring circles at half its speed."""
    rate = 1e-3
    force = tilted((0.0, 0.0), (rate, 0.0)).film_force()[3:]
    exact = 2.0 * 12.0 * VISCOSITY * rate / GAP**3 * moment_per_source()
    assert force[1] == pytest.approx(exact, rel=0.01)
    assert force[1] < 0.0
    assert abs(force[2]) < 1e-3 * abs(exact)


def test_one_pressure_all_round_moves_nothing() -> None:
    """The ring at rest midway between the covers has neither force nor moment."""
    np.testing.assert_allclose(tilted((0.0, 0.0)).film_force()[3:], 0.0, atol=1e-6)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 0.9])
def test_tilted_ring_leaks_by_the_mean_cube_and_drags_by_the_mean_inverse(ratio: float) -> None:
    """A narrow ring tilted by a share of its gap: 1 + 1.5 e^2 and 1 / sqrt(1 - e^2)."""
    inner = 25e-3
    face = covers(inner).face
    face = replace(face, inner_radius=inner - 0.1e-3)
    planes = np.array([[[GAP, 0.6 * ratio * GAP / RIM, -0.8 * ratio * GAP / RIM]]])
    resolution = FaceResolution(rows=180, lanes=22, angles=1)
    parallel = face_conductance(face, resolution)
    found = face_conductance(face, resolution, planes)
    leaks, drags = found.matrix[0, 0, 2] / parallel.matrix[0, 0, 2], found.drag / parallel.drag
    tilt = ratio * 25.5e-3 / RIM
    assert leaks == pytest.approx(1.0 + 1.5 * tilt**2, rel=0.01)
    assert drags[0] == pytest.approx(1.0 / math.sqrt(1.0 - tilt**2), rel=0.01)
    np.testing.assert_allclose(found.matrix[0].sum(axis=1), 0.0, atol=1e-9 * found.matrix.max())


@cache
def rotors(kidneys: str, motion: str) -> BodiesBetweenCovers:
    case = api.load_case(
        CASE,
        (
            "machine.lateral.position=free",
            f"machine.lateral.motion={motion}",
            f"machine.ports.covers={kidneys}",
        ),
    )
    description = api.describe(case)
    assert description.shared_faces is not None
    turn = description.shared_faces.face.chambers.pitch * np.arange(2) / 2
    condition = condition_of(case, description)
    return bodies_between_covers(description, condition, fluid_of(case), turn, grid=(30, 8))


@pytest.mark.slow
def test_rotors_lean_on_a_cover_and_tilt_as_far_as_it_lets_them() -> None:
    """Kidneys in one cover push; films of some roughness then hold force and moments."""
    found = rotors("one", "full")
    assert found.places.warning == ""
    lower, higher = found.planes
    np.testing.assert_allclose((lower + higher)[..., 0], 2.0 * SIDE_GAP)
    np.testing.assert_allclose((lower + higher)[..., 1:], 0.0, atol=1e-12)
    lift, tilt_x, tilt_y, least = np.moveaxis(found.places.at(np.zeros(1))[0], -1, 0)
    assert lift[0] > 0.0  # the inner rotor leaves the kidneys
    # asperities of 0.72 um begin to carry below some four times that: under the outer rotor
    assert np.all((least > 0.5e-6) & (least < 0.5 * SIDE_GAP))
    assert least[1] < 4e-6
    middle = 2.0 * SIDE_GAP - np.array([lower[0, 0, 0], higher[0, 1, 0]])
    radius = np.array([g.interface.face.outer_radius for g in found.last.stack.grids[:2]])
    assert np.all(np.hypot(tilt_x, tilt_y) * radius < middle)
    assert np.all(np.hypot(tilt_x, tilt_y) > 0.0)
    assert found.asperity_torque["outer_rotor"] > 0.0


@pytest.mark.slow
def test_rotors_that_only_lift_stay_parallel_and_carry_their_force_on_asperities() -> None:
    """The film between parallel faces pushes alike at any height: asperities hold the rest."""
    found = rotors("one", "axial")
    assert found.places.warning == ""
    assert not found.places.at(np.linspace(0.0, 1.0, 5))[..., 1:3].any()
    push = np.array([f.covered_load[0] for f in found.last.films])
    touch = [float((f.contact * f.grid.area).sum()) for f in found.last.films]
    inner = push[2] - touch[2] - (push[0] - touch[0])  # of the pressures alone
    assert touch[0] == pytest.approx(inner, rel=0.1)
    assert inner > 50.0


def test_covers_alike_neither_lift_nor_tilt_parallel_rotors() -> None:
    """Recesses opposite the kidneys: by symmetry nothing is left at any shaft angle."""
    case = api.load_case(CASE, ("machine.lateral.position=free", "machine.ports.covers=both"))
    description = api.describe(case)
    stack = cover_stack(description, fluid_of(case), SPEED, (30, 8))
    pressure = np.linspace(1e5, 41e5, description.drain_node + 1)
    snapshots = [stack.snapshot(angle, pressure) for angle in (0.1, 0.7)]
    balance = state_at(stack, snapshots, stack.start(SIDE_GAP))
    for state in balance.states:
        scale = 41e5 * math.pi * RIM**2
        np.testing.assert_allclose(state.film_force()[3:], 0.0, atol=1e-9 * scale)


@pytest.mark.slow
def test_pump_with_tilting_rotors_closes_its_ledgers() -> None:
    """Places stand in the result over the revolution, with the smallest film at the covers."""
    case = api.load_case(
        CASE,
        (
            "run.fidelity=films",
            "operating_point.outlet_load=fixed_pressure",
            "machine.lateral.position=free",
        ),
    )
    solution = api.simulate(case)
    assert solution.status.succeeded
    found = solution.summary()
    assert found["energy_balance_error"] < 1e-4
    assert found["mass_balance_error"] < 1e-10
    data = solution.data
    assert np.all(data["face_film_height"] > 0.0)
    assert float(np.abs(data["body_tilt"]).max()) * RIM < 2.0 * SIDE_GAP
    least = data["face_film_height"].min("shaft_angle")  # each leans on a cover
    assert np.all((least > 0.5e-6) & (least < 0.5 * SIDE_GAP))
