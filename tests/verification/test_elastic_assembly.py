"""Loads on the elastic bodies of a machine with a floating bearing, one by one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity

from tests.external_gear_designs import changed, egm12, floating_block
from toothspace.api import prepare
from toothspace.case import load_case
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.types import Array
from toothspace.elasticity import AreaPressure, InfluenceMatrix, influence_matrix
from toothspace.elasticity.mesh import mesher
from toothspace.floating.elastic_faces import BodyLoads, ElasticFaces
from toothspace.floating.problem import lateral_problem
from toothspace.floating.stack import BackPressure, Snapshot
from toothspace.gearing.materials import Material
from toothspace.gearing.numbering import number
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.describe import describe
from toothspace.machines.external_gear.floating.balance import (
    ElasticAssembly,
    lateral_balance,
    seal_line,
)
from toothspace.machines.external_gear.floating.elastic_bodies import (
    BackLoads,
    MeshSize,
    bearing_body,
    bearing_section,
    gear_body,
)
from toothspace.machines.external_gear.floating.floating_parameters import (
    ElasticBodiesParameters,
    FloatingBearingParameters,
    NoseParameters,
    PressureAreaParameters,
    SpringParameters,
)
from toothspace.machines.external_gear.gear_bodies import BODIES, FaceOfGear
from toothspace.machines.external_gear.spec import FloatingBlock
from toothspace.model.film_faces import FILM
from toothspace.model.floating_bearing import BodyLoad, LateralBalance
from toothspace.run.elastic import lateral_settings

FINER = MeshSize(0.13, 0.13, 0.17)
REPOSITORY = Path(__file__).parents[2]
BRONZE = Material(elastic_modulus=100e9, poisson_ratio=0.33, hardness=1e9, density=8800.0)
LENGTH, SEAL_FORCE, NOSE = 19e-3, 120.0, (20e-6, (-6e-3, 17.2e-3))
SPRINGS = (
    SpringParameters(force=30.0, x=0.0, y=-12e-3),
    SpringParameters(force=50.0, x=0.0, y=46e-3),
)
SIZE = MeshSize(0.24, 0.25, 0.2)

needs_gmsh = pytest.mark.skipif(not mesher(), reason="gmsh is not installed")


def _pressed(**changes: object) -> FloatingBlock:
    keys = FloatingBearingParameters(
        high_pressure_area=PressureAreaParameters(seal_line_x=3e-3),
        nose=NoseParameters(area=NOSE[0], center=NOSE[1]),
        springs=SPRINGS,
        seal_preload=SEAL_FORCE,
    )
    given = FloatingBlock(keys=keys, material=BRONZE, length=LENGTH)
    return floating_block(given, **changes)


def _assembly(mode: str = "pump", /, **changes: object) -> Assembly:
    return assemble(egm12(mode, floating_block=_pressed(**changes)))


def _balance(mode: str = "pump", /, **changes: object) -> LateralBalance:
    assembly = _assembly(mode, **changes)
    found = lateral_balance(assembly, number(assembly.counts))
    assert found is not None
    return found


def _bodies(balance: LateralBalance) -> ElasticAssembly:
    assert isinstance(balance.elastic_bodies, ElasticAssembly)
    return balance.elastic_bodies


@pytest.fixture(scope="module")
def bearing() -> InfluenceMatrix:
    """The floating bearing with all its loads."""
    bodies = replace(_bodies(_balance()), size=SIZE)
    return influence_matrix(bodies()["floating"], estimate_error=False, cache=False)


@pytest.fixture(scope="module")
def gear() -> InfluenceMatrix:
    """Drive gear with the shortest of shafts."""
    return _gear(0)


def _gear(wheel: int, mode: str = "pump", /, **changes: object) -> InfluenceMatrix:
    assembly = _assembly(mode, **changes)
    short = replace(assembly.spec.keys.journal_bearings, length=0.2e-3)
    short_shaft = replace(assembly, spec=changed(assembly.spec, journal_bearings=short))
    return influence_matrix(gear_body(short_shaft, wheel, SIZE), estimate_error=False, cache=False)


@pytest.mark.parametrize("turn", [0.0, 0.7, 3.1])
@pytest.mark.parametrize("wheel", [0, 1])
def test_flanks_of_a_gear_have_the_nodes_of_the_chambers_beside_them(
    wheel: int, turn: float
) -> None:
    """Away from the mesh the film sees the same chamber there, at every shaft angle."""
    assembly = _assembly()
    face = FaceOfGear(assembly, number(assembly.counts), wheel)
    profile = assembly.profiles[wheel]
    first = face.own.tooth_angle(turn)
    angle = first + profile.pitch_angle * (np.arange(profile.tooth_count) + 0.5)
    radius = 0.5 * (profile.root_radius + profile.tip_radius)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    away = np.sin(angle) < 0.3 if wheel == 0 else np.sin(angle) > -0.3
    rise = assembly.mesh.center_distance if wheel == 1 else 0.0
    seen = face(turn, x, y + rise).node
    clear = away & (seen != FILM)
    assert clear.sum() >= 6
    nodes = face.flank_nodes(turn, np.linspace(profile.root_radius, profile.tip_radius, 5))
    assert (seen[clear] == nodes[clear].transpose(1, 2, 0)).all()


def test_pressure_in_all_tooth_spaces_swells_the_gear_between_its_faces(
    gear: InfluenceMatrix,
) -> None:
    """Even pressure round a disc: strain 2 nu p / E along its axis, nothing turns or tilts."""
    own = gear.body
    pressure, half = 20e6, 0.5 * 7.5e-3
    sizes = {name: pressure for name in gear.load_cases if name.startswith("space")}
    assert len(sizes) == 12 * 2 * 3
    zero = np.zeros(len(gear.nodes))
    moved = gear.deformation(zero, sizes)
    wanted = -2.0 * own.poisson_ratio * pressure / own.elastic_modulus * half
    inside = np.hypot(*gear.nodes.T) < 14e-3
    assert moved[inside] == pytest.approx(np.full(inside.sum(), wanted), rel=0.05)
    push = gear.resultant(zero, sizes)
    alone = gear.resultant(zero, {"space_0_left_1": pressure})
    assert np.abs(push[:3]).max() < 1e-6 * np.abs(alone[:3]).max()


def test_pressure_in_a_tooth_space_pushes_on_its_chord(gear: InfluenceMatrix) -> None:
    """From tip to tip: pressure times 2 r sin(pitch / 2) times the face width, inwards."""
    tip, pitch = _assembly().profiles[0].tip_radius, 2.0 * np.pi / 12
    force = sum(gear.resultants[f"space_0_{s}_{n}"] for s in ("left", "right") for n in range(3))
    force = np.asarray(force)[:2]
    wanted = 2.0 * tip * np.sin(0.5 * pitch) * 7.5e-3
    away = np.array([np.cos(0.5 * pitch), np.sin(0.5 * pitch)])
    assert force @ away == pytest.approx(-wanted, rel=0.01)
    assert abs(force @ np.array([-away[1], away[0]])) < 0.01 * wanted


def test_chambers_turn_both_gears_as_their_volumes_change() -> None:
    """Virtual work of the pressure on one side of the mesh: sum of p dV/dphi."""
    assembly, bodies = _assembly(), _bodies(_balance())
    machine = describe(assembly.spec)
    both = [_gear(wheel) for wheel in (0, 1)]
    ratio = (1.0, -assembly.mesh.ratio)
    for turn in (0.02, 0.15, 0.28, 0.41):
        place = [family.angle_ratio * turn + family.phases for family in machine.families]
        rate = [
            family.angle_ratio * family.volume.derivative(own).ravel()
            for family, own in zip(machine.families, place, strict=True)
        ]
        # all spaces on one side of the centre line
        pressure = 1e6 * np.concatenate([np.sin(own) > 0.0 for own in place])
        wanted = float(np.concatenate(rate) @ pressure)
        found = 0.0
        for load in bodies.loads(turn):
            if load.source == "node":
                gear = BODIES.index(load.body)
                moment = both[gear].resultants[load.load][5]
                found += ratio[gear] * moment * load.factor * pressure[load.index]
        assert found == pytest.approx(wanted, rel=0.06)


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_contacts_press_on_both_gears_against_each_other(mode: str) -> None:
    """Force along the line of contact, with the arms of the base circles; thrust on the tooth."""
    changes = {"gear_axial_force": (250.0, -250.0), "nose": None}
    assembly = _assembly(mode, **changes)
    bodies = _bodies(_balance(mode, **changes))
    both = [_gear(wheel, mode, **changes) for wheel in (0, 1)]
    base = np.cos(np.radians(20.0)) * 0.5 * assembly.mesh.center_distance
    for turn in (0.0, 0.3):
        loads = [load for load in bodies.loads(turn) if load.source.startswith("contact")]
        for contact in {load.index for load in loads}:
            pushes = []
            for gear, name in enumerate(BODIES):
                own = [x for x in loads if x.body == name and x.index == contact]
                assert len(own) == 2
                push = sum(x.factor * both[gear].resultants[x.load] for x in own)
                assert push[2] == pytest.approx((250.0, -250.0)[gear], rel=1e-6)
                pushes.append(np.asarray(push))
            for push in pushes:
                assert np.hypot(*push[:2]) == pytest.approx(1.0, rel=0.03)
                assert abs(push[5]) == pytest.approx(base, rel=0.05)
            # the driven gear is turned on by the contact, the drive gear held back
            assert pushes[0][5] * pushes[1][5] > 0.0


def test_helical_teeth_push_both_gears_at_the_pitch_point() -> None:
    assembly, balance = _assembly(), _balance(gear_axial_force=(250.0, -250.0), nose=None)
    drive, driven = balance.body_forces
    assert (drive.size, driven.size) == (250.0, -250.0)
    assert balance.thrust(balance.bodies) == 0.0
    reach = [force.place[1] for force in (drive, driven)]
    assert reach[0] == pytest.approx(reach[1] + assembly.mesh.center_distance)
    assert reach[0] == pytest.approx(-reach[1] * assembly.mesh.ratio)


def test_springs_seal_and_nose_press_with_their_forces_where_they_stand(
    bearing: InfluenceMatrix,
) -> None:
    """Force and moments about the centre of mass of every load on the back."""
    loads = {load.load: load for load in _bodies(_balance()).loads(0.0) if load.body == "floating"}
    x0, y0, _ = bearing.center_of_mass
    places = {
        "nose": (NOSE[0], *NOSE[1]),
        "spring_0": (30.0, 0.0, -12e-3),
        "spring_1": (50.0, 0.0, 46e-3),
    }
    for name, (size, x, y) in places.items():
        assert loads[name].factor == pytest.approx(size)
        force = bearing.resultants[name]
        assert force[2] == pytest.approx(-1.0, rel=1e-9)
        assert force[3:5] == pytest.approx([-(y - y0), x - x0], abs=0.5e-3)
    seal = bearing.resultants["seal"]
    assert loads["seal"].factor == SEAL_FORCE
    # the line stands 3 mm from the centre line, symmetric about the middle of the bearing
    assert seal[2:5] == pytest.approx([-1.0, 0.0, 3e-3 - x0], abs=0.1e-3)


def test_high_pressure_acts_on_the_area_of_the_force_balance(bearing: InfluenceMatrix) -> None:
    patch = _balance().floating.high_pressure
    force, x0 = bearing.resultants["high"], bearing.center_of_mass[0]
    assert force[2] == pytest.approx(-patch.area, rel=0.01)
    assert force[4] / force[2] == pytest.approx(-(patch.center[0] - x0), rel=0.02)


def test_spring_is_an_equal_pressure_on_its_patch() -> None:
    assembly = _assembly()
    place, radius = (0.0, 46e-3), 0.05 * assembly.profiles[0].tip_radius
    patch = shapely.Point(*place).buffer(radius)
    back = BackLoads(areas={"patch": patch}, points={"spring": place})
    whole = bearing_body(assembly, BRONZE, LENGTH, back=back, size=SIZE)
    body = replace(whole, loads=whole.loads[:2])
    found = influence_matrix(body, estimate_error=False, cache=False).load_cases
    assert found["spring"] == pytest.approx(found["patch"] / patch.area, rel=1e-6, abs=1e-15)


def test_journals_and_housing_hold_each_other(bearing: InfluenceMatrix) -> None:
    """Forces of both shafts are met by the walls: next to nothing is left to accelerate."""
    force = {"journal_x": (-4000.0, -5000.0), "journal_y": (-700.0, 900.0)}
    sizes: dict[str, float] = {}
    for load in _bodies(_balance()).loads(0.0):
        if load.body == "floating" and load.source in force:
            sizes[load.load] = load.factor * force[load.source][load.index]
    assert len(sizes) == 8
    zero = np.zeros(len(bearing.nodes))
    shafts = {name: size for name, size in sizes.items() if name.startswith("journal")}
    alone = bearing.resultant(zero, shafts)
    assert alone[:2] == pytest.approx([4500.0, -100.0], rel=0.02, abs=10.0)
    left = bearing.resultant(zero, sizes)
    assert np.abs(left[:3]).max() < 0.03 * 4500.0
    assert np.abs(left[3:5]).max() < 0.03 * 4500.0 * 0.5 * LENGTH


def test_equal_pressure_on_face_and_back_compresses_without_tilt() -> None:
    """Loads in equilibrium: displacement p L / (2 E) of the face everywhere, no rigid motion."""
    assembly = assemble(egm12("pump", floating_block=_pressed(), grooves=None))
    section = bearing_section(assembly)
    body = bearing_body(assembly, BRONZE, LENGTH, size=SIZE)
    pair = (AreaPressure("face", "bottom", section), AreaPressure("back", "top", section))
    found = influence_matrix(replace(body, loads=pair), estimate_error=False, cache=False)
    zero, sizes = np.zeros(len(found.nodes)), {"face": 10e6, "back": 10e6}
    wanted = 10e6 * LENGTH / (2.0 * BRONZE.elastic_modulus)
    assert found.deformation(zero, sizes) == pytest.approx(np.full(zero.size, wanted), rel=0.02)
    assert np.abs(found.resultant(zero, sizes)).max() < 1e-6


def test_high_pressure_area_without_outline_lies_behind_a_chord() -> None:
    """Its area is met; it stands on the side of its centre."""
    area, center = 300e-6, (9e-3, 17.2e-3)
    given = _balance(high_pressure_area=PressureAreaParameters(area=area, center=center))
    shape = _bodies(given).high_pressure
    assert shape.area == pytest.approx(area, rel=1e-6)
    assert shape.centroid.x > 5e-3
    line = seal_line(shape, bearing_section(_assembly()))
    assert np.ptp([x for x, _ in shapely.get_coordinates(line)]) < 1e-3


def test_second_floating_bearing_carries_the_same_loads_behind_it() -> None:
    loads = _bodies(_balance(arrangement="symmetric")).loads(0.0)
    behind = [
        {(load.load, load.factor) for load in loads if load.body == side and "_x" not in load.load}
        for side in ("floating", "solid")
    ]
    assert behind[0] == behind[1]
    alone = _bodies(_balance()).loads(0.0)
    resting = {load.load for load in alone if load.body == "solid"}
    assert not {"high", "nose", "seal", "spring_0"} & resting


def test_plates_hold_no_journals() -> None:
    loads = _bodies(_balance(length=6e-3)).loads(0.0)
    assert not [x for x in loads if x.body in ("floating", "solid") and "journal" in x.load]


def test_loads_follow_pressures_and_forces_above_the_low_pressure() -> None:
    """Also in a frame that turns with a body: force along y on a gear turned by a quarter."""

    def journals(angle: float) -> Array:
        return np.array([[0.0, 1000.0], [0.0, 0.0]])

    given = (
        BodyLoad("floating", "high", "high"),
        BodyLoad("floating", "nose", "nose", factor=2e-5),
        BodyLoad("floating", "spring", "constant", factor=30.0),
        BodyLoad("drive_gear", "flank", "node", 1, 0.25),
        BodyLoad("drive_gear", "flank", "contact", 0, 1e3),
        BodyLoad("drive_gear", "thrust", "contact_share", 0, 200.0),
        BodyLoad("drive_gear", "push_x", "journal_x", 0, -0.5),
        BodyLoad("floating", "bore_y", "journal_y", 0, -0.5),
    )
    back = BackPressure(high=60e5, low=5e5, nose=9e5)
    contacts = np.array([300.0, 100.0])
    frames = {"drive_gear": (0.25 * np.pi, 1.0)}
    loads = BodyLoads(lambda angle: given, back, journals, lambda angle: contacts, frames)
    sizes = loads(Snapshot(0.25 * np.pi, (), np.array([5e5, 25e5])))
    assert sizes["floating"] == pytest.approx(
        {"high": 55e5, "nose": 8.0, "spring": 30.0, "bore_y": -500.0}
    )
    assert sizes["drive_gear"] == pytest.approx(
        {"flank": 5e5 + 3e5, "thrust": 150.0, "push_x": -500.0}
    )


def _with_file(path: Path, **changes: object) -> ElasticAssembly:
    """Bodies whose floating bearing is that of a file."""
    assembly = _assembly()
    files = ElasticBodiesParameters(floating_bearing=path, **changes)  # type: ignore[arg-type]
    spec = changed(assembly.spec, elastic_bodies=files)
    return replace(_bodies(_balance()), assembly=replace(assembly, spec=spec), size=SIZE)


def _block(path: Path, low: float = 0.0, width: float = 1.0) -> Path:
    """The floating bearing as a STEP file, from a level up and its bores larger by a factor."""
    pytest.importorskip("OCP")
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    assembly = _assembly()
    rise = 1e3 * assembly.mesh.center_distance

    def cylinder(radius: float, y: float) -> Any:
        axis = gp_Ax2(gp_Pnt(0.0, y, 1e3 * low), gp_Dir(0.0, 0.0, 1.0))
        return BRepPrimAPI_MakeCylinder(axis, 1e3 * radius, 1e3 * LENGTH).Shape()

    tip, bore = assembly.profiles[0].tip_radius, 0.5 * assembly.spec.keys.journal_bearings.diameter
    shape = BRepAlgoAPI_Fuse(cylinder(tip, 0.0), cylinder(tip, rise)).Shape()
    for y in (0.0, rise):
        shape = BRepAlgoAPI_Cut(shape, cylinder(width * bore, y)).Shape()
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))
    return path


def _condensed(bodies: ElasticAssembly) -> InfluenceMatrix:
    return influence_matrix(bodies()["floating"], estimate_error=False, cache=False)


@needs_gmsh
@pytest.mark.slow
def test_bearing_of_a_file_deforms_as_the_swept_one(tmp_path: Path) -> None:
    """Same block without grooves as tetrahedra and as hexahedra, under every load of a run."""
    path = _block(tmp_path / "block.step")
    bodies = _with_file(path, edge_length=2.5e-3)
    plain = replace(bodies.assembly.spec, grooves=None)
    bodies = replace(bodies, assembly=replace(bodies.assembly, spec=plain), size=FINER)
    swept = changed(plain, elastic_bodies=None)
    solid = _condensed(bodies)
    wanted = _condensed(replace(bodies, assembly=replace(bodies.assembly, spec=swept)))
    assert solid.mass == pytest.approx(wanted.mass, rel=0.01)
    assert np.trace(solid.compliance) == pytest.approx(np.trace(wanted.compliance), rel=0.05)
    for name, expected in wanted.load_cases.items():
        error = np.abs(solid.load_cases[name] - expected).mean()
        assert error < 0.06 * np.ptp(expected), name


@needs_gmsh
@pytest.mark.slow
@pytest.mark.parametrize(
    ("low", "width", "message"),
    [
        (2e-3, 1.0, "found film 'face' at z = 2 mm, allowed the face of the case there"),
        (0.0, 1.5, "found faces on 6.% of film 'face', allowed the face of the case there"),
    ],
)
def test_bearing_of_another_machine_is_refused(
    low: float, width: float, message: str, tmp_path: Path
) -> None:
    path = _block(tmp_path / "block.step", low, width)
    key = r"^machine\.elastic_bodies\.floating_bearing: block\.step: "
    with pytest.raises(GeometryError, match=key + message):
        _condensed(_with_file(path, edge_length=6e-3))


def test_missing_mesher_is_named_with_the_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    path = tmp_path / "block.step"
    path.write_text("ISO-10303-21;")
    key = r"^machine\.elastic_bodies\.floating_bearing: block\.step: found no program gmsh"
    with pytest.raises(GeometryError, match=key):
        _condensed(_with_file(path))


def test_body_without_a_face_is_refused() -> None:
    """A film that looks down on a body that has its faces elsewhere."""
    bodies = replace(_bodies(_balance()), size=SIZE)
    body = bodies()["floating"]
    away = shapely.affinity.translate(bearing_section(bodies.assembly), 1.0, 0.0)
    lost = replace(body, films=(replace(body.films[0], region=away),))
    wanted = "elastic body: found no plane face that looks to the bottom under film 'face'"
    with pytest.raises(GeometryError, match=wanted):
        influence_matrix(lost, estimate_error=False, cache=False)


def test_case_names_the_files(tmp_path: Path) -> None:
    path = tmp_path / "block.step"
    path.write_text("ISO-10303-21;")
    case = REPOSITORY / "cases" / "hysteresis_055.toml"
    key = "machine.elastic_bodies.floating_bearing"
    found = load_case(case, (f'{key}="{path}"', 'machine.elastic_bodies.edge_length="3 mm"'))
    files = found.machine.elastic_bodies
    assert files == ElasticBodiesParameters(floating_bearing=path, edge_length=3e-3)
    with pytest.raises(CaseError, match=r"elastic_bodies\.drive_gear: found .*no\.step"):
        load_case(case, ('machine.elastic_bodies.drive_gear="no.step"',))


@pytest.mark.slow
def test_loads_of_a_run_balance_on_the_bodies() -> None:
    """Bearing at rest without friction: what the films, the balance area, nose, springs and seal
    do to the elastic bearing cancels along z, and shafts and housing cancel across."""
    changes = (
        "run.deformation=bodies",
        "run.film_grid=[63,9]",
        "run.film_angles_per_pitch=1",
        "run.samples_per_revolution=180",
        "machine.floating_bearing.housing_contact.friction_coefficient=0",
        "machine.floating_bearing.seal_preload=200 N",
    )
    case = load_case(REPOSITORY / "cases" / "hysteresis_055.toml", changes)
    run = prepare(case).worn().with_films()
    lumped = run.march()
    problem = lateral_problem(run.machine, run.fluid, lumped.data, lateral_settings(case), 12e5)
    found = problem.settle(problem.started(3e-6))
    assert found.settled
    state, back = found.balance.states[0], problem.loads.back
    faces = state.stack.compliance
    assert isinstance(faces, ElasticFaces)
    left = faces.resultants(state.face_pressures(back.low), state.snapshot)
    push = (back.high - back.low) * state.stack.balance.floating.high_pressure.area
    assert abs(left["floating"][2]) < 0.01 * push
    shafts = np.abs(lumped.data["journal_force"].values).max()
    for bearing in ("floating", "solid"):
        assert np.abs(left[bearing][:2]).max() < 0.03 * shafts
    for gear in ("drive_gear", "driven_gear"):
        assert abs(left[gear][2]) < 0.02 * push
        assert np.hypot(*left[gear][:2]) < 0.06 * shafts
    # friction, half of it on each gear, and what turns the drive gear are no loads of the bodies;
    # moments of chambers and contacts are those of their arms on the mesh, within 6 %
    shaft = float(lumped.data["shaft_torque"].mean())
    friction = 0.5 * float(lumped.data["torque_loss"].mean("shaft_angle").sum())
    assert abs(left["driven_gear"][5] + friction) < 0.06 * shaft
    assert abs(abs(left["drive_gear"][5]) - shaft) < 0.25 * shaft
