"""Floating bearing and ring as elastic bodies: Hooke's law, shares of the bodies, balance."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.lateral_stack import HIGH, HIGH_NODE, INNER, LOW, OUTER, loads, pressures, ring_stack
from toothspace.api import prepare
from toothspace.case import load_case
from toothspace.core.types import Array
from toothspace.elasticity import (
    ElasticBody,
    LateralFaces,
    LateralPressure,
    PlaneSurface,
    Prism,
    Support,
    SweptShape,
    annulus,
    influence,
    influence_matrix,
)
from toothspace.floating.compliant_film import Accuracy
from toothspace.floating.deformation import Fineness, film_coefficients, fitted, response
from toothspace.floating.elastic_faces import (
    ElasticFaces,
    elastic_faces,
    face_deflection,
)
from toothspace.floating.equilibrium import (
    Equilibrium,
    SearchSettings,
    find_equilibrium,
    march_angles,
)
from toothspace.floating.motion import Balance, StepSettings, state_at
from toothspace.floating.problem import LateralProblem, lateral_problem, numbers_of
from toothspace.floating.stack import PreviousStep, Snapshot, Stack, StackState
from toothspace.numerics.acceleration import Mixing
from toothspace.run.elastic import lateral_settings

pytestmark = pytest.mark.slow

REPOSITORY = Path(__file__).parents[2]
MODULUS, LENGTH, WIDTH = 100e9, 20e-3, 16e-3
SECTION = annulus(INNER, OUTER)
SIZE = (5e-3, 5e-3)
CELLS = (36, 10)
MEMORY = 8
PREDICTED = StepSettings(film_tolerance=1e-4, memory=2, fineness=Fineness(4, 2), jacobian_age=60)


def _face(name: str, side: str) -> PlaneSurface:
    return PlaneSurface(name, side, SECTION, 5.5e-3)  # type: ignore[arg-type]


def _bodies() -> dict[str, ElasticBody]:
    def body(
        bottom: float, top: float, films: tuple[PlaneSurface, ...], *rest: Support
    ) -> ElasticBody:
        shape = SweptShape((Prism(SECTION, bottom, top),), *SIZE)
        return ElasticBody(shape, MODULUS, 0.0, 8000.0, films, (), rest)

    return {
        "floating": body(0.0, LENGTH, (_face("face", "bottom"),)),
        "solid": body(-LENGTH, 0.0, (_face("face", "top"),), Support("bottom", SECTION)),
        "ring": body(
            -0.5 * WIDTH, 0.5 * WIDTH, (_face("floating", "top"), _face("solid", "bottom"))
        ),
    }


@pytest.fixture(scope="module")
def faces(tmp_path_factory: pytest.TempPathFactory) -> ElasticFaces:
    patch = pytest.MonkeyPatch()
    patch.setattr(influence, "matrix_folder", lambda: tmp_path_factory.getbasetemp() / "elastic")
    found = elastic_faces(ring_stack(cells=CELLS).grids, _bodies())
    patch.undo()
    return found


def _stack(faces: ElasticFaces) -> Stack:
    return replace(ring_stack(high_share=0.72, cells=CELLS), compliance=faces)


def test_even_pressure_gives_hookes_law(faces: ElasticFaces) -> None:
    """Ring pressed on both sides: p b / (2 E); a bearing held by its inertia alone: p L / (3 E);
    a bearing on its foundation: p L / E, without lateral strain."""
    stack = _stack(faces)
    snapshot = stack.snapshot(0.0, pressures(HIGH))
    p = [np.full_like(grid.area, 1e7) for grid in stack.grids]
    floating, solid = faces.deformation(p, snapshot)
    ring = 1e7 * WIDTH / (2.0 * MODULUS)
    free, held = 1e7 * LENGTH / (3.0 * MODULUS), 1e7 * LENGTH / MODULUS
    for found, wanted in ((floating, ring + free), (solid, ring + held)):
        assert found.mean() == pytest.approx(wanted, rel=0.02)
        # cells beyond the chords between the nodes of the rim lie outside the interpolation
        assert np.abs(found - wanted).max() < 0.15 * wanted


def test_turned_pressure_gives_turned_deformation(faces: ElasticFaces) -> None:
    """A pressure that turns with the grid: round bodies deform alike in all directions."""
    stack = _stack(faces)
    snapshot = stack.snapshot(0.0, pressures(HIGH))
    wave = 1e7 * (1.0 + np.cos(stack.grids[0].angle))[:, None] * np.ones(stack.grids[0].lanes)
    zero = np.zeros_like(wave)
    first = faces.deformation([wave, zero], snapshot)[0]
    turned = faces.deformation([np.roll(wave, 9, axis=0), zero], snapshot)[0]
    assert np.abs(np.roll(first, 9, axis=0) - turned).max() < 0.05 * np.ptp(first)


def test_rings_frame_turns_with_the_shaft(faces: ElasticFaces) -> None:
    stack = _stack(faces)
    wave = 1e7 * (1.0 + np.cos(2 * stack.grids[0].angle))[:, None] * np.ones(stack.grids[0].lanes)
    found = [
        faces.deformation([wave, wave], stack.snapshot(turn, pressures(HIGH)))[0]
        for turn in (0.0, 1.0)
    ]
    assert np.abs(found[0] - found[1]).max() < 0.05 * np.ptp(found[0])


def test_turned_body_is_read_at_its_turned_places(faces: ElasticFaces) -> None:
    """Beside the interpolation at the places themselves; loads keep their sum."""
    grid, turn = faces.grids[0], 1.234
    own, ring = grid.interface, faces.bodies["ring"]
    cos, sin = np.cos(turn * own.speed_ratio), np.sin(turn * own.speed_ratio)
    x, y = grid.points.x.ravel(), grid.points.y.ravel()
    places = np.column_stack([cos * x + sin * y, cos * y - sin * x])
    nodes = ring.nodes[ring.of(own.side)]
    wave = np.cos(3.0 * np.arctan2(nodes[:, 1], nodes[:, 0]))
    spread = faces._body_spread(0, turn)
    assert spread @ wave == pytest.approx(ring.interpolation(own.side, places) @ wave, abs=1e-3)
    assert spread.sum(axis=1) == pytest.approx(1.0)


def _round_the_ring(faces: ElasticFaces) -> ElasticFaces:
    """The ring of softer material with the pressure of a node on its outer and inner face."""
    ring = faces.bodies["ring"].body
    round_it = LateralPressure("round", LateralFaces(annulus(0.5 * INNER, 1.5 * OUTER)))
    ring = replace(ring, poisson_ratio=0.3, loads=(round_it,))

    def named(snapshot: Snapshot) -> dict[str, dict[str, float]]:
        return {"ring": {"round": float(snapshot.node_pressure[HIGH_NODE]) - LOW}}

    bodies = {**_bodies(), "ring": ring}
    return elastic_faces(faces.grids, bodies, named)


def test_pressure_all_round_shrinks_the_ring_as_hydrostatic_pressure_does(
    faces: ElasticFaces, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A named load follows the node pressure of the snapshot: round the ring alone it swells by
    nu p b / E, with both faces pressed as well it shrinks by (1 - 2 nu) p b / (2 E)."""
    monkeypatch.setattr(influence, "matrix_folder", lambda: tmp_path)
    loaded = _round_the_ring(faces)
    stack = _stack(loaded)
    rise, poisson = 1e7, 0.3
    quiet, snapshot = (stack.snapshot(0.0, pressures(LOW + rise * k)) for k in (0, 1))
    none = [np.zeros_like(grid.area) for grid in stack.grids]
    even = [np.full_like(grid.area, rise) for grid in stack.grids]
    hooke = rise * WIDTH / (2.0 * MODULUS)
    assert loaded.deformation(none, quiet)[0] == pytest.approx(none[0], abs=1e-15)
    swelling = loaded.deformation(none, snapshot)
    films = loaded.deformation(even, quiet)
    both = loaded.deformation(even, snapshot)
    bearings = (rise * LENGTH / (3.0 * MODULUS), rise * LENGTH / MODULUS)
    for k, bearing in enumerate(bearings):
        assert swelling[k].mean() == pytest.approx(-2.0 * poisson * hooke, rel=0.02)
        assert films[k].mean() == pytest.approx(hooke + bearing, rel=0.02)
        shrinking = both[k].mean() - bearing
        assert shrinking == pytest.approx((1.0 - 2.0 * poisson) * hooke, rel=0.05)
    left = loaded.resultants(even, snapshot)["ring"]
    assert np.abs(left).max() < 1e-6 * rise * np.pi * OUTER**2


def test_mesh_error_is_the_difference_to_finer_bodies(
    faces: ElasticFaces, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Richardson from elements 1.5 times as small covers what a mesh of half the size changes."""
    monkeypatch.setattr(influence, "matrix_folder", lambda: tmp_path)
    stack = _stack(faces)
    snapshot = stack.snapshot(0.0, pressures(HIGH))
    wave = 1e7 * (1.0 + np.cos(2 * stack.grids[0].angle))[:, None] * np.ones(stack.grids[0].lanes)
    reported = faces.mesh_error([wave, wave], snapshot)[0]
    finer = {
        name: influence_matrix(body.body, estimate_error=False, scale=0.5)
        for name, body in faces.bodies.items()
    }
    found = faces.deformation([wave, wave], snapshot)[0]
    change = found - replace(faces, bodies=finer).deformation([wave, wave], snapshot)[0]
    assert 0.0 < np.abs(change).max() < 1.3 * np.abs(reported).max()
    assert np.abs(reported).max() < 0.1 * np.ptp(found)


def test_run_reports_the_largest_deformation_and_its_error(
    faces: ElasticFaces, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Over the films; nothing where faces are Winkler foundations."""
    stack = _stack(faces)
    snapshot = stack.snapshot(0.0, pressures(HIGH))
    zero = np.zeros(stack.size)
    distant = [np.zeros_like(grid.area) for grid in stack.grids]
    state = stack.solve(snapshot, stack.start(3e-6), zero, None, distant)
    wide = faces.deformation(state.face_pressures(LOW), snapshot)
    monkeypatch.setattr(ElasticFaces, "mesh_error", lambda self, p, s: [-0.1 * w for w in wide])
    reported = face_deflection(state)
    largest = max(np.abs(w).max() for w in wide)
    assert reported["film_deformation_largest"] == pytest.approx(largest)
    assert reported["film_deformation_error"] == pytest.approx(0.1 * largest)
    columns = replace(state, stack=ring_stack(cells=CELLS))
    assert face_deflection(columns) == {}


def test_equilibrium_between_elastic_bodies(faces: ElasticFaces) -> None:
    """Forces balance to 1e-6, and the gap is the rigid gap widened by the pressures found."""
    stack = _stack(faces)
    snapshots = (stack.snapshot(0.0, pressures(HIGH)),)
    first = state_at(stack, snapshots, stack.start(2e-6))
    found = find_equilibrium(
        stack,
        snapshots,
        loads(HIGH),
        first,
        SearchSettings(first_step=10.0),
        PREDICTED,
    )
    assert found.settled
    assert found.balance.residual < 1e-6
    state = found.balance.states[0]
    wanted = faces.deformation(state.face_pressures(LOW), snapshots[0])
    for k, film in enumerate(state.films):
        rigid = stack.film_face_motion(k, found.balance.position, found.balance.velocity).position[
            0
        ]
        assert film.gap - rigid == pytest.approx(wanted[k], abs=2e-3 * float(film.gap.mean()))


def test_equilibrium_over_several_snapshots_is_that_of_the_plain_iteration(
    faces: ElasticFaces,
) -> None:
    """Every snapshot has a response of its own, the coordinates are common to all."""
    stack = _stack(faces)
    snapshots = tuple(
        stack.snapshot(k * np.pi, pressures(share * HIGH)) for k, share in enumerate((0.9, 1.1))
    )
    first = state_at(stack, snapshots, stack.start(2e-6))
    plain = StepSettings(film_tolerance=1e-4, memory=MEMORY)
    predicted = replace(PREDICTED, fineness=Fineness(4, 2, 2))
    found = [
        find_equilibrium(
            stack, snapshots, loads(HIGH), first, SearchSettings(first_step=10.0), step
        )
        for step in (predicted, plain)
    ]
    assert all(own.settled for own in found)
    assert found[0].balance.position == pytest.approx(found[1].balance.position, rel=1e-4)
    assert sorted(found[0].balance.responses) == [0, 1]


def test_stiffness_and_damping_are_those_of_small_motions_of_bending_bodies(
    faces: ElasticFaces,
) -> None:
    """Differences of films that are solved anew, their deformation settled."""
    stack = _stack(faces)
    snapshot = stack.snapshot(0.0, pressures(HIGH))
    q, step = np.array([4.2, 0.0, 0.0, 2.1, 0.0, 0.0]) * 1e-6, 2e-9

    def settled(place: Array, rate: Array) -> StackState:
        mixing, shape = Mixing(MEMORY, 0.2), (len(stack.grids), *CELLS)
        used, state = np.zeros(shape), None
        for _ in range(30):
            state = stack.solve(snapshot, place, rate, state, list(used))
            new = np.array(faces.distant(state.face_pressures(LOW), snapshot))
            if np.abs(new - used).max() < 1e-13:
                break
            used = mixing.following(used.ravel(), (new - used).ravel()).reshape(shape)
        assert state is not None
        return state

    still = np.zeros(stack.size)
    reported = film_coefficients([settled(q, still)], Fineness(8, 3))
    for k in (0, 3):
        unit = np.eye(stack.size)[k]
        sides = [settled(q + s * step * unit, still).film_force() for s in (-1.0, 1.0)]
        stiffness = (sides[0] - sides[1]) / (2.0 * step)
        assert reported[0][::3, k] == pytest.approx(stiffness[::3], rel=0.02)
        sides = [settled(q, s * 1e-5 * unit).film_force() for s in (-1.0, 1.0)]
        damping = (sides[0] - sides[1]) / 2e-5
        assert reported[1][::3, k] == pytest.approx(damping[::3], rel=0.02)


def _fuel_pump(*changes: str) -> tuple[LateralProblem, Equilibrium]:
    """Rest of the fuel pump between bodies at the chamber pressures of small gaps."""
    coarse = (
        "run.deformation=bodies",
        "run.film_grid=[84,10]",
        "run.film_angles_per_pitch=2",
        "run.samples_per_revolution=180",
    )
    case = load_case(REPOSITORY / "cases" / "hysteresis_078.toml", (*coarse, *changes))
    run = prepare(case).worn().with_films()
    data = run.march().data
    problem = lateral_problem(run.machine, run.fluid, data, lateral_settings(case))
    return problem, problem.settle(problem.started(3e-6))


def test_fuel_pump_settles_at_high_pressure() -> None:
    """136 bar: faces bend by as much as the films are thick; at 155 bar films push them away."""
    problem, found = _fuel_pump("operating_point.outlet_pressure=135.8 bar")
    assert found.settled
    assert found.steps <= 24
    assert found.balance.residual < 1e-6
    numbers = numbers_of(problem, found.balance)
    assert 0.9e-6 < numbers.smallest_gap < 1.2e-6
    assert 4.5e-6 < numbers.gaps.mean() < 5.5e-6


def test_plates_that_the_films_push_away_do_not_rest_near_the_gears() -> None:
    """Plates of 15 mm at 58 bar: behind each lies the area that holds one bearing, too small.

    Begun with films of 3 um they bend by 57 um at once. Rounding decides whether the search follows
    them to where ten times that gap leaks more than the pump delivers, or says why it cannot.
    """
    plates = "machine.lateral.arrangement=plates", "machine.floating_bearing.length=15 mm"
    problem, found = _fuel_pump(*plates)
    if not found.settled:
        assert "has lifted to its cover" in found.reason or "do not settle" in found.reason
        return
    numbers = numbers_of(problem, found.balance)
    assert numbers.gaps.mean() > 20e-6
    assert numbers.leakage > problem.stack.shaft_speed * 14e-6 / (2.0 * np.pi)


def _march(stack: Stack, settings: StepSettings) -> list[Balance]:
    """Six steps of half a degree while the pressure of the chambers and behind rises and falls."""
    angles = np.arange(1, 7) * np.pi / 360.0

    def beats(angle: float) -> np.ndarray:
        return pressures(HIGH * (1.0 + 0.05 * np.sin(60.0 * angle)))

    rest = state_at(stack, (stack.snapshot(0.0, beats(0.0)),), stack.start(2e-6))
    # what a search with finer basis functions leaves at the phase where the march begins
    rest = replace(rest, responses={0: response(rest.states[0], Fineness(3, 1), 0.0)})
    return list(march_angles(stack, beats, loads(HIGH), rest, angles, settings))


def test_films_and_forces_respond_to_basis_functions_as_to_small_changes(
    faces: ElasticFaces,
) -> None:
    """Derivatives beside differences of films that are solved anew."""
    stack = _stack(faces)
    march = _march(stack, StepSettings(memory=MEMORY))
    before, last = (march[k].states[0] for k in (-2, -1))
    duration = (last.snapshot.shaft_angle - before.snapshot.shaft_angle) / stack.shaft_speed
    found = response(last, Fineness(2, 1), 1.0 / duration)
    for k in (0, 3, 13):
        change = found.fields(1e-10 * np.eye(len(found.gain))[k])
        moved = [d + c for d, c in zip(last.distant, change, strict=True)]
        previous = PreviousStep(before, duration)
        place = last.position, last.velocity
        base = stack.solve(last.snapshot, *place, last, last.distant, previous)
        near = stack.solve(last.snapshot, *place, last, moved, previous)
        gain = [
            b - a
            for a, b in zip(
                faces.distant(base.face_pressures(LOW), last.snapshot),
                faces.distant(near.face_pressures(LOW), last.snapshot),
                strict=True,
            )
        ]
        size = np.abs(found.gain[:, k]).max()
        assert fitted(found.basis, gain) / 1e-10 == pytest.approx(found.gain[:, k], abs=0.02 * size)
        force = (near.film_force() - base.film_force()) / 1e-10
        size = np.abs(found.force[:, k]).max()
        assert force == pytest.approx(found.force[:, k], abs=0.02 * size)


def test_march_that_predicts_the_deformation_takes_the_same_way(faces: ElasticFaces) -> None:
    """To the accuracy that a step asks for, in fewer passes."""
    stack, settings = _stack(faces), StepSettings(force_tolerance=5e-5, memory=MEMORY, passes=1)
    marched = Accuracy(settled=1e-3, linear=5e-2)
    stack = replace(stack, laws=tuple(law._replace(accuracy=marched) for law in stack.laws))
    # what is only iterated needs more of the yield within the films
    more = replace(faces, local=tuple(3.0 * c for c in faces.local))
    plain = _march(replace(stack, compliance=more), settings)
    quick = _march(stack, replace(settings, fineness=Fineness(2, 1), jacobian_age=60))
    for a, b in zip(plain, quick, strict=True):
        assert a.converged
        assert b.converged
        assert b.position == pytest.approx(a.position, abs=1e-3 * a.position[0])
    used = [sum(b.iterations for b in m[2:]) for m in (plain, quick)]
    assert used[1] < 0.7 * used[0], used
