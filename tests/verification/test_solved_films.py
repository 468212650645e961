"""Films of a machine solved on grids: face conductances, journal impedance, and the preset."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.bearing_map import build_journal_map, journal_force
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.journal import map as journal_map
from toothspace.films.journal.bearing import JournalBearing
from toothspace.films.journal.map import solved_journal
from toothspace.films.plane.conductance import (
    FaceConductance,
    FaceResolution,
    face_conductance,
)
from toothspace.gearing.gear_face import under_recesses
from toothspace.model.film_faces import FILM, NO_BODY, ChamberRing, FaceBody, FaceCells, FilmFace
from toothspace.run.solved_films import with_solved_films

PUMP = Path(__file__).parents[2] / "cases" / "egm12_pump.toml"
SHAFT, ROOT, TIP, TEETH = 9e-3, 13e-3, 20e-3, 8


SPACES = ChamberRing(np.arange(TEETH), 2.0 * math.pi * np.arange(TEETH) / TEETH)


@dataclass(frozen=True)
class Castle:
    """Disc with teeth of radial flanks, each over the angle ``tooth``; a space on the x axis."""

    tooth: float
    recesses: tuple[tuple[int, Array], ...]

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        place = np.mod(np.arctan2(y, x) - shaft_angle, SPACES.pitch) - 0.5 * SPACES.pitch
        own = (np.hypot(x, y) < ROOT) | (np.abs(place) < 0.5 * self.tooth)
        node = np.where(own, FILM, SPACES.nearest(shaft_angle, x, y))
        return FaceCells(under_recesses(node, own, self.recesses, x, y), np.where(own, 0, NO_BODY))


def solved(
    tooth: float, recesses: tuple[tuple[int, Array], ...] = (), tip: float = TIP, lanes: int = 44
) -> FaceConductance:
    face = FilmFace(
        bodies=(FaceBody("gear", (0.0, 0.0), tip),),
        center=(0.0, 0.0),
        inner_radius=SHAFT,
        outer_radius=tip,
        gap=10e-6,
        face_map=Castle(tooth, recesses),
        chambers=SPACES,
        recesses=np.array([node for node, _ in recesses], dtype=np.int64),
        inner_node=TEETH + 1,
    )
    return face_conductance(face, FaceResolution(rows=48, lanes=lanes, angles=2))


def test_ring_without_teeth_leaks_like_a_ring() -> None:
    """Q = 2 pi h^3 dp / (12 mu ln(ro/ri)), shared by the spaces."""
    matrix = solved(1e-6).matrix[0]
    np.testing.assert_allclose(-matrix[-1, :-1], matrix[-1, -1] / TEETH, rtol=1e-9)
    assert matrix[-1, -1] == pytest.approx(2.0 * math.pi / math.log(ROOT / SHAFT), rel=0.02)


def test_narrow_tooth_leaks_like_a_gap_of_its_angle() -> None:
    """Away from its root the flow across a tooth is tangential: dG = ln(r2/r1) / angle.

    All pressures alike give no flow, and a matrix of reciprocal flows is symmetric.
    """
    tooth = 2.0 * math.pi / TEETH / 4.0
    result, shorter = solved(tooth), solved(tooth, tip=18e-3, lanes=36)
    exact = math.log(TIP / 18e-3) / tooth
    for matrix, other in zip(result.matrix, shorter.matrix, strict=True):
        assert other[3, 4] - matrix[3, 4] == pytest.approx(exact, rel=0.02)
        np.testing.assert_allclose(matrix.sum(axis=1), 0.0, atol=1e-9)
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    teeth = TEETH * tooth * (TIP**4 - ROOT**4) / 4.0
    full = math.pi * (ROOT**4 - SHAFT**4) / 2.0
    assert result.drag[0] == pytest.approx(teeth + full, rel=0.02)


def test_a_narrow_tooth_of_whole_cells_is_exact() -> None:
    """Edges half a cell from the film: thirteen cells of a ring conduct as their angle says."""
    rows = 48
    tooth = 13.0 / rows * 2.0 * math.pi / TEETH
    result, shorter = solved(tooth), solved(tooth, tip=18e-3, lanes=36)
    exact = math.log(TIP / 18e-3) / tooth
    found = shorter.matrix[0][3, 4] - result.matrix[0][3, 4]
    assert abs(found) == pytest.approx(exact, rel=1e-3)


@dataclass(frozen=True)
class Geared(Castle):
    """The same that turns with another body, about another axis."""

    ratio: float = 1.0
    centre: tuple[float, float] = (0.0, 0.0)

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        x, y = x - self.centre[0], y - self.centre[1]
        place = np.mod(np.arctan2(y, x) - self.ratio * shaft_angle, SPACES.pitch)
        own = (np.hypot(x, y) < ROOT) | (np.abs(place - 0.5 * SPACES.pitch) < 0.5 * self.tooth)
        chambers = replace(SPACES, angle_ratio=self.ratio, center=self.centre)
        near = chambers.nearest(shaft_angle, x + self.centre[0], y + self.centre[1])
        node = under_recesses(np.where(own, FILM, near), own, self.recesses, x, y)
        return FaceCells(node, np.where(own, 0, NO_BODY))


def geared(
    ratio: float = 1.0,
    centre: tuple[float, float] = (0.0, 0.0),
    plane: tuple[float, float, float] = (10e-6, 0.0, 0.0),
    pocket: bool = False,
    sectors: int = 0,
) -> FaceConductance:
    """Of teeth of 0.25 rad; a pocket of the cover in the land stands beside the first of them."""
    angle = np.linspace(0.1, 0.5, 40)[:, None]
    arc = np.hstack([np.cos(angle), np.sin(angle)])
    outline = np.vstack([12e-3 * arc, 10.5e-3 * arc[::-1]])
    recesses = ((TEETH, outline),) if pocket else ()
    face = FilmFace(
        bodies=(FaceBody("gear", centre, TIP),),
        center=centre,
        inner_radius=SHAFT,
        outer_radius=TIP,
        gap=10e-6,
        face_map=Geared(0.25, recesses, ratio, centre),
        chambers=replace(SPACES, angle_ratio=ratio, center=centre),
        recesses=np.array([node for node, _ in recesses], dtype=np.int64),
        inner_node=TEETH + 1,
        sectors=sectors,
    )
    planes = np.tile(np.array(plane), (2, 1, 1))
    return face_conductance(face, FaceResolution(rows=24, lanes=12, angles=2), planes)


def test_a_face_that_turns_with_another_body_is_the_same_at_its_own_angles() -> None:
    one = geared()
    for other in (geared(ratio=0.4), geared(ratio=-1.5), geared(centre=(0.03, -0.02))):
        np.testing.assert_allclose(other.matrix, one.matrix, atol=1e-9)
        np.testing.assert_allclose(other.turn, one.turn)


def test_a_pocket_that_stands_still_is_passed_at_the_angles_of_the_chambers() -> None:
    one = geared(pocket=True)
    np.testing.assert_allclose(geared(ratio=0.4, pocket=True).matrix, one.matrix, atol=1e-9)
    first, second = one.matrix[:, TEETH, :TEETH]
    assert np.abs(first - second).max() > 0.05 * np.abs(first).max()


def test_sectors_of_the_rim_stand_beside_their_chambers() -> None:
    """Two to a chamber, each before one half of it and of the tooth beside."""
    for matrix in geared(sectors=2).matrix:
        between = -matrix[:TEETH, TEETH + 1 :]
        for k in range(TEETH):
            own = between[k, [2 * k, 2 * k + 1]]
            further = between[k, [2 * k - 1, (2 * k + 2) % (2 * TEETH)]]
            assert own[0] == pytest.approx(own[1], rel=0.05)
            assert further[0] == pytest.approx(further[1], rel=0.05)
            assert own.min() > 1.2 * further.max() > 0.0
            assert own.sum() + further.sum() > 0.9 * between[k].sum()


def test_a_face_leans_as_the_rotations_of_its_plane_say() -> None:
    """About its own axis, where it rises with y for a turn about x and falls with x about y."""
    lean = 2e-4
    centre = (0.03, -0.02)
    about_x, about_y = geared(plane=(10e-6, lean, 0.0)), geared(plane=(10e-6, 0.0, lean))
    moved = geared(centre=centre, plane=(10e-6, lean, 0.0))
    np.testing.assert_allclose(moved.matrix, about_x.matrix, atol=1e-9)
    # a quarter turn on, two chambers of eight
    order = [*np.roll(np.arange(TEETH), -2), TEETH]
    np.testing.assert_allclose(
        about_y.matrix[0][np.ix_(order, order)], about_x.matrix[0], atol=1e-9
    )
    # chamber 2 lies on the y axis: more leaks from it to the shaft where the face is higher
    assert about_x.matrix[0][-1, 2] < 1.5 * about_x.matrix[0][-1, 6] < 0.0
    assert about_y.matrix[0][-1, 4] < 1.5 * about_y.matrix[0][-1, 0] < 0.0


def test_recess_over_the_land_shortens_the_way_to_the_shaft() -> None:
    """A ring groove from 11 mm outwards: shaft leakage comes from it alone, 2 pi/ln(11/9)."""
    angle = np.linspace(0.0, 2.0 * math.pi, 400)[:, None]
    circle = np.hstack([np.cos(angle), np.sin(angle)])
    groove = np.vstack([21e-3 * circle, 11e-3 * circle[::-1]])
    matrix = solved(0.2, ((TEETH, groove),)).matrix[1]
    assert -matrix[-1, TEETH] == pytest.approx(2.0 * math.pi / math.log(11.0 / 9.0), rel=0.03)
    np.testing.assert_allclose(matrix[-1, :TEETH], 0.0, atol=1e-9)


@pytest.mark.slow
def test_journal_map_is_the_solved_film() -> None:
    """Force of the map against films solved on a finer grid, turning and squeezing together."""
    slenderness, speed = 1.0, 120.0
    bearing = JournalBearing(
        diameter=0.02,
        length=0.02 * slenderness,
        radial_clearance=10e-6,
        dynamic_viscosity=0.02,
        grid=(240, 35),
        cavitation="reynolds",
        supply="none",
    )
    tables = solved_journal(slenderness, math.inf)
    chart = build_journal_map(slenderness)._replace(nodes=tables.force_nodes)
    scale = 0.02 * bearing.length * (0.01 / 10e-6) ** 3
    for ratio, direction in ((0.2, 1.0), (0.55, 4.0), (0.85, 2.2), (0.95, 5.5)):
        place = 10e-6 * ratio * np.array([math.cos(0.7), math.sin(0.7)])
        velocity = 3e-4 * np.array([math.cos(direction), math.sin(direction)])
        film = bearing.solve(
            eccentricity=tuple(place / 10e-6), shaft_speed=speed, velocity=tuple(velocity)
        )
        force = journal_force(*place, *velocity, speed, 10e-6, scale, chart)
        assert math.dist(force[:2], film.force) < 0.015 * film.load
    steady = replace(bearing, cavitation="jfo", supply="auto").solve(
        eccentricity=(0.7, 0.0), shaft_speed=speed
    )
    pull = 0.5 * 0.7 * 10e-6 * float(steady.force[1])
    shear = 2.0 * math.pi * 0.02 * bearing.length * 0.01**3 * speed / (10e-6 * math.sqrt(0.51))
    known = np.interp(0.7, np.linspace(0.0, tables.shear_range, tables.shear.size), tables.shear)
    assert -steady.friction_torque == pytest.approx(known * shear + pull, rel=0.01)


@pytest.mark.parametrize("thickness", [math.inf, 8.0])
def test_a_map_holds_the_films_of_any_size_that_it_was_made_of(
    thickness: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of few coarse films; smooth walls, and rough ones of an eighth of the clearance."""
    grid, steps = (36, 7), np.linspace(0.0, 1.8, 4)
    monkeypatch.setattr(journal_map, "_GRID", grid)
    monkeypatch.setattr(journal_map, "_GAP_STEPS", steps)
    monkeypatch.setattr(journal_map, "_DIRECTIONS", np.linspace(0.0, math.pi, 5))
    tables = solved_journal.__wrapped__(0.8, thickness)
    clearance, viscosity = 12e-6, 0.05
    rough = None
    if math.isfinite(thickness):
        each = clearance / thickness / math.sqrt(2.0)
        rough = RoughSurfaces(moving_roughness=each, resting_roughness=each, contact_law="none")
    bearing = JournalBearing(
        diameter=0.03,
        length=0.024,
        radial_clearance=clearance,
        dynamic_viscosity=viscosity,
        grid=grid,
        cavitation="reynolds",
        supply="none",
        surfaces=rough,
    )
    chart = build_journal_map(0.8)._replace(nodes=tables.force_nodes)
    scale = viscosity * bearing.length * (0.015 / clearance) ** 3
    for step, direction in ((steps[1], 0.0), (steps[2], 0.25 * math.pi), (steps[3], math.pi)):
        ratio = -math.expm1(-step)
        velocity = 1e-4 * np.array([math.cos(direction), math.sin(direction)])
        film = bearing.solve(eccentricity=(ratio, 0.0), shaft_speed=0.0, velocity=tuple(velocity))
        force = journal_force(ratio * clearance, 0.0, *velocity, 0.0, clearance, scale, chart)
        assert math.dist(force[:2], film.force) < 5e-3 * film.load
    ratio = 0.49
    turning = replace(bearing, cavitation="jfo", supply="auto")
    steady = turning.solve(eccentricity=(ratio, 0.0), shaft_speed=100.0)
    pull = 0.5 * ratio * clearance * float(steady.force[1])
    full = 2.0 * math.pi * viscosity * bearing.length * 0.015**3 * 100.0 / clearance
    places = np.linspace(0.0, tables.shear_range, tables.shear.size)
    found = np.interp(ratio, places, tables.shear) * full / math.sqrt(1.0 - ratio**2)
    assert found == pytest.approx(-steady.friction_torque - pull, rel=1e-3)


@pytest.mark.slow
def test_solved_films_agree_with_the_closed_forms_where_these_hold() -> None:
    """Flow and journal positions agree; a film that cavitates and faces over grooves drag less."""
    case = api.load_case(PUMP)
    lumped = api.simulate(case)
    films = api.simulate(api.load_case(PUMP, ("run.fidelity=films",)))
    assert films.status.succeeded
    near, far = lumped.summary(), films.summary()
    assert far["mean_flow_L_per_min"] == pytest.approx(near["mean_flow_L_per_min"], rel=0.005)
    name = "journal_eccentricity_ratio"
    np.testing.assert_allclose(
        films.data[name].mean("shaft_angle"), lumped.data[name].mean("shaft_angle"), rtol=0.05
    )
    for key in ("torque_loss_journal_viscous_N_m", "torque_loss_lateral_viscous_N_m"):
        assert 0.7 * near[key] < far[key] < near[key]
    key = "leakage_drain_L_per_min"
    assert far[key] == pytest.approx(near[key], rel=0.2)
    assert far["leakage_lateral_L_per_min"] > near["leakage_lateral_L_per_min"]
    assert far["energy_balance_error"] < 1e-5


def test_machine_without_face_outlines_is_refused() -> None:
    description = api.describe(api.load_case(PUMP))
    bare = replace(
        description, laterals=tuple(replace(film, face=None) for film in description.laterals)
    )
    with pytest.raises(CaseError, match=r"run\.interfaces\.lateral: found 'reynolds'"):
        with_solved_films(bare)
