"""Halves of a split bearing that bend: their loads, their shapes, their rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity

from tests.external_gear_designs import changed, egm12, floating_block
from tests.lateral_stack import (
    AREA,
    HIGH,
    INNER,
    LOW,
    OUTER,
    PLACES,
    loads,
    pressures,
    ring_stack,
    split_stack,
)
from toothspace.api import prepare
from toothspace.case import load_case
from toothspace.core.errors import GeometryError
from toothspace.elasticity import (
    ElasticBody,
    InfluenceMatrix,
    PlaneSurface,
    Prism,
    SweptShape,
    annulus,
    influence_matrix,
)
from toothspace.floating.deformation import Fineness
from toothspace.floating.elastic_faces import ElasticFaces, elastic_faces
from toothspace.floating.equilibrium import Equilibrium, SearchSettings, find_equilibrium
from toothspace.floating.motion import StepSettings, state_at
from toothspace.floating.problem import LateralProblem, lateral_problem
from toothspace.floating.stack import Stack
from toothspace.gearing.materials import Material
from toothspace.gearing.numbering import number
from toothspace.machines.external_gear.assembly import assemble
from toothspace.machines.external_gear.floating.balance import ElasticAssembly, lateral_balance
from toothspace.machines.external_gear.floating.elastic_bodies import MeshSize
from toothspace.machines.external_gear.floating.floating_parameters import (
    ElasticBodiesParameters,
    FloatingBearingParameters,
    NoseParameters,
    PressureAreaParameters,
    SpringParameters,
)
from toothspace.machines.external_gear.spec import FloatingBlock
from toothspace.model.floating_bearing import LateralBalance
from toothspace.run.elastic import lateral_settings

REPOSITORY = Path(__file__).parents[2]
SIZE = MeshSize(0.24, 0.25, 0.2)
BRONZE = Material(elastic_modulus=100e9, poisson_ratio=0.33, hardness=1e9, density=8800.0)
LENGTH, MIDDLE = 19e-3, 17.2e-3
HALVES = ("floating_drive_gear", "floating_driven_gear")
MODULUS = 100e9
SHARES = (0.70, 0.72)
CELLS = (24, 8)


def _balance(**changes: object) -> LateralBalance:
    keys = FloatingBearingParameters(
        high_pressure_area=PressureAreaParameters(seal_line_x=3e-3),
        nose=NoseParameters(area=20e-6, center=(-6e-3, MIDDLE)),
        springs=(
            SpringParameters(force=30.0, x=2e-3, y=-12e-3),
            SpringParameters(force=50.0, x=0.0, y=46e-3),
        ),
        seal_preload=120.0,
        split=True,
    )
    given = FloatingBlock(keys=keys, material=BRONZE, length=LENGTH)
    pressed = floating_block(given, **changes)
    assembly = assemble(egm12("pump", floating_block=pressed))
    found = lateral_balance(assembly, number(assembly.counts))
    assert found is not None
    return found


def _bodies(balance: LateralBalance) -> ElasticAssembly:
    assert isinstance(balance.elastic_bodies, ElasticAssembly)
    return replace(balance.elastic_bodies, size=SIZE)


@pytest.fixture(scope="module")
def halves() -> tuple[LateralBalance, list[InfluenceMatrix]]:
    balance = _balance()
    made = _bodies(balance)()
    assert set(made) == {*HALVES, "solid", "drive_gear", "driven_gear"}
    return balance, [influence_matrix(made[n], estimate_error=False, cache=False) for n in HALVES]


def _sizes(balance: LateralBalance, half: int) -> dict[str, float]:
    """Loads of a half that are told by the case alone, and one pascal at high pressure."""
    found = {}
    for load in _bodies(balance).loads(0.0):
        if load.body == HALVES[half] and load.source in ("constant", "high", "nose"):
            found[load.load] = load.factor
    return found


def test_films_know_the_half_that_they_run_against() -> None:
    names = [i.bearing for i in _balance().interfaces]
    assert names == [*HALVES, "solid", "solid"]
    both = [i.bearing for i in _balance(arrangement="symmetric").interfaces]
    assert both[2:] == ["solid_drive_gear", "solid_driven_gear"]
    assert [i.bearing for i in _balance(split=False).interfaces][:2] == ["floating"] * 2


def test_halves_carry_their_parts_of_the_loads_behind(
    halves: tuple[LateralBalance, list[InfluenceMatrix]],
) -> None:
    """Force and moments of all loads on the back as in the force balance of every half."""
    balance, bodies = halves
    seal = 120.0
    for k, (half, body) in enumerate(zip(balance.halves, bodies, strict=True)):
        sizes = _sizes(balance, k)
        assert set(sizes) == {"high", "nose", "seal", f"spring_{k}"}
        share = half.face.area / balance.floating.face.area
        assert sizes["seal"] == pytest.approx(share * seal, rel=1e-3)
        assert sizes["nose"] == pytest.approx(half.nose.area, rel=1e-6)
        assert body.resultants["high"][2] == pytest.approx(-half.high_pressure.area, rel=0.02)
        assert body.mass == pytest.approx(half.mass, rel=0.05)
        del sizes["high"]
        push = body.resultant(np.zeros(len(body.nodes)), sizes)
        assert push[2] == pytest.approx(-half.preload.size - half.nose.area, rel=1e-2)


def test_shaft_and_housing_hold_every_half_on_their_own(
    halves: tuple[LateralBalance, list[InfluenceMatrix]],
) -> None:
    force = {"journal_x": (-4000.0, -5000.0), "journal_y": (-700.0, 900.0)}
    for name, body in zip(HALVES, halves[1], strict=True):
        sizes = {
            load.load: load.factor * force[load.source][load.index]
            for load in _bodies(halves[0]).loads(0.0)
            if load.body == name and load.source in force
        }
        assert len(sizes) == 4
        left = body.resultant(np.zeros(len(body.nodes)), sizes)
        assert np.abs(left[:3]).max() < 0.03 * 2500.0


def test_mirrored_halves_bend_alike(
    halves: tuple[LateralBalance, list[InfluenceMatrix]],
) -> None:
    """Equal gears: pressure behind one half opens its face as that behind the other, mirrored."""
    moved = [body.deformation(np.zeros(len(body.nodes)), {"high": 5e6}) for body in halves[1]]
    rise = 2.0 * float(shapely.union_all([b.body.films[0].region for b in halves[1]]).centroid.y)
    mirrored = halves[1][0].nodes * [1.0, -1.0] + [0.0, rise]
    found = halves[1][1].interpolation("face", mirrored) @ moved[1]
    assert np.ptp(moved[0]) > 0.2e-6
    assert np.abs(found - moved[0]).max() < 0.12 * np.ptp(moved[0])


def test_files_are_refused_for_halves(tmp_path: Path) -> None:
    bodies = _bodies(_balance())
    file = tmp_path / "block.step"
    file.write_text("ISO-10303-21;", encoding="utf-8")
    files = ElasticBodiesParameters(floating_bearing=file)
    spec = changed(bodies.assembly.spec, elastic_bodies=files)
    given = replace(bodies, assembly=replace(bodies.assembly, spec=spec))
    with pytest.raises(GeometryError, match=r"floating_bearing: found a file of a split bearing"):
        given()


@dataclass(frozen=True)
class _Rings:
    """Bodies of rings: both bearings of every ring, and the rings."""

    modulus: float

    def alone(self) -> dict[str, ElasticBody]:
        """Those of one ring about the origin."""
        return {
            "floating": self._block((0.0, 0.0), 20e-3),
            "solid": self._block((0.0, 0.0), -20e-3),
            "ring": self._ring(),
        }

    def of_pair(self) -> dict[str, ElasticBody]:
        """Those of two rings, their bearings as halves at their places."""
        found = {f"ring_{k}": self._ring() for k in range(2)}
        for k, place in enumerate(PLACES):
            found[f"floating_{k}"] = self._block(place, 20e-3)
            found[f"solid_{k}"] = self._block(place, -20e-3)
        return found

    def _block(self, place: tuple[float, float], height: float) -> ElasticBody:
        section = shapely.affinity.translate(annulus(INNER, OUTER), *place)
        shape = SweptShape((Prism(section, *sorted((0.0, height))),), 7e-3, 7e-3)
        side = "bottom" if height > 0.0 else "top"
        face = PlaneSurface("face", side, section, 7.5e-3)  # type: ignore[arg-type]
        return ElasticBody(shape, self.modulus, 0.3, 8000.0, (face,))

    def _ring(self) -> ElasticBody:
        section = annulus(INNER, OUTER)
        shape = SweptShape((Prism(section, -8e-3, 8e-3),), 7e-3, 7e-3)
        faces = (
            PlaneSurface("floating", "top", section, 7.5e-3),
            PlaneSurface("solid", "bottom", section, 7.5e-3),
        )
        return ElasticBody(shape, self.modulus, 0.3, 8000.0, faces)


def _settled(stack: Stack, faces: ElasticFaces | None) -> Equilibrium:
    bending = stack if faces is None else replace(stack, compliance=faces)
    snapshots = (bending.snapshot(0.0, pressures(HIGH)),)
    start = state_at(bending, snapshots, bending.start(2e-6))
    step = StepSettings(film_tolerance=1e-4, memory=2, fineness=Fineness(4, 2), jacobian_age=60)
    return find_equilibrium(
        bending, snapshots, loads(HIGH), start, SearchSettings(first_step=10.0), step
    )


def _pair() -> Stack:
    return split_stack(SHARES, arrangement="symmetric", cells=CELLS)


def _single(share: float) -> Stack:
    return ring_stack(high_share=share, arrangement="symmetric", cells=CELLS)


@pytest.mark.slow
def test_elastic_halves_settle_where_two_elastic_bearings_would() -> None:
    """A half against the same bearing computed alone; all loads meet on every body."""
    stack, rings, single = _pair(), _Rings(MODULUS), _single(SHARES[0])
    faces = elastic_faces(stack.grids, rings.of_pair())
    both = _settled(stack, faces)
    alone = _settled(single, elastic_faces(single.grids, rings.alone()))
    assert both.settled
    assert alone.settled
    first, second = both.balance.states[0].mean_gaps()[:2]
    assert first == pytest.approx(alone.balance.states[0].mean_gaps()[0], rel=2e-3)
    assert second < 0.99 * first
    state = both.balance.states[0]
    left = faces.resultants(state.face_pressures(LOW), state.snapshot)
    back = loads(HIGH).back
    behind = [s * AREA * (back.high - back.low) + 100.0 for s in SHARES]
    for k in range(2):
        # the load behind is no part of the bodies of this test
        assert left[f"floating_{k}"][2] == pytest.approx(behind[k], rel=1e-3)
        assert left[f"solid_{k}"][2] == pytest.approx(-behind[k], rel=1e-3)
        assert abs(left[f"ring_{k}"][2]) < 1e-3 * behind[k]


@pytest.mark.slow
def test_stiff_halves_settle_where_rigid_ones_do() -> None:
    stack = _pair()
    stiff = _settled(stack, elastic_faces(stack.grids, _Rings(1e6 * MODULUS).of_pair()))
    rigid = _settled(_pair(), None)
    assert stiff.settled
    assert rigid.settled
    assert stiff.balance.position == pytest.approx(rigid.balance.position, rel=1e-3, abs=1e-12)


def _fuel_pump(split: str) -> tuple[LateralProblem, Equilibrium]:
    changes = (
        "run.deformation=bodies",
        "run.film_grid=[63,9]",
        "run.film_angles_per_pitch=1",
        "run.samples_per_revolution=180",
        "operating_point.outlet_pressure=58.2 bar",
        "machine.floating_bearing.housing_contact.friction_coefficient=0",
        "machine.floating_bearing.seal_preload=360 N",  # with less the half without nose lifts off
        f"machine.floating_bearing.split={split}",
    )
    case = load_case(REPOSITORY / "cases" / "hysteresis_055.toml", changes)
    run = prepare(case).worn().with_films()
    data = run.march().data
    problem = lateral_problem(run.machine, run.fluid, data, lateral_settings(case), 12e5)
    return problem, problem.settle(problem.started(3e-6))


@pytest.mark.slow
def test_split_fuel_pump_floats_between_bodies_that_bend() -> None:
    """58 bar: every half rests on its films, and nothing is left of the loads on it.

    Pressures of either gear tip its half about the line that joins the gears, one against the
    other: a bearing in one piece cannot follow and rides higher. Behind the gears gaps are alike.
    """
    found = {split: _fuel_pump(split) for split in ("false", "true")}
    gaps = {}
    for split, (problem, rest) in found.items():
        assert rest.settled
        state, back = rest.balance.states[0], problem.loads.back
        faces = state.stack.compliance
        assert isinstance(faces, ElasticFaces)
        left = faces.resultants(state.face_pressures(back.low), state.snapshot)
        push = (back.high - back.low) * state.stack.balance.floating.high_pressure.area
        moving_bearings = HALVES if split == "true" else ("floating",)
        for name in moving_bearings:
            assert abs(left[name][2]) < 0.01 * push
            assert np.abs(left[name][:2]).max() < 0.02 * push
        gaps[split] = state.mean_gaps()
    assert gaps["true"][2:] == pytest.approx(gaps["false"][2:], abs=0.3e-6)
    assert np.all(gaps["true"][:2] < gaps["false"][:2])
