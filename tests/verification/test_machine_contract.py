"""What every machine owes the solver, on the reference cases of all registered machine types."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.contact_machine import contact_machine
from toothspace import api
from toothspace.core.registry import machine_type, machine_type_names
from toothspace.core.types import Array
from toothspace.model.description import (
    ChamberFamily,
    ContactPair,
    FlowPath,
    MachineDescription,
)
from toothspace.model.film_faces import FILM, NO_BODY, FilmFace
from toothspace.model.ledger import FRICTION_MECHANISMS
from toothspace.model.path_category import DRAIN
from toothspace.numerics.periodic_table import PeriodicTable

CASES = Path(__file__).resolve().parents[2] / "cases"
GEARS = ("gears", "driven_gear", "rotors", "pinion", "ring")
TOY = "toy"
ANGLES = 2.0 * np.pi * np.arange(7) / 7.0 + 0.1
OVERLAP = 2e-7
"""Depth by which flanks and lobes may overlap in the tables: they touch somewhere. [m]"""


def _machines() -> dict[str, str]:
    """One reference case for every pair of gears among the shipped cases, by name."""
    found, seen = {}, set()
    for path in sorted(CASES.glob("*.toml")):
        machine = tomllib.loads(path.read_text(encoding="utf-8")).get("machine", {})
        gears = {k: v for k, v in machine.items() if k in ("type", *GEARS)}
        key = str(sorted(gears.items()))
        if "type" in machine and key not in seen:
            seen.add(key)
            found[path.stem] = machine["type"]
    return found


MACHINES = _machines()


@cache
def described(name: str, mode: str | None = None) -> MachineDescription:
    if name == TOY:
        return contact_machine()
    case = api.load_case(CASES / f"{name}.toml")
    if mode is None:
        return api.describe(case)
    spec = replace(case.machine, mode=mode).assemble()
    return machine_type(case.machine_type).describe(spec)  # type: ignore[no-any-return]


FIRST = {type_name: name for name, type_name in reversed(MACHINES.items())}.values()
"""One case of every machine type: those of other gears are slow tests."""

NAMED = [
    pytest.param(name, marks=[] if name in FIRST else pytest.mark.slow, id=name)
    for name in MACHINES
]
every_machine = pytest.mark.parametrize("name", [*NAMED, TOY])
shipped = pytest.mark.parametrize("name", NAMED)


def own_angles(part: ChamberFamily | FlowPath | ContactPair) -> Array:
    """Table angles of all members at several shaft angles."""
    return np.asarray(part.phases + part.angle_ratio * ANGLES[:, None])


def tables_of(machine: MachineDescription) -> list[tuple[str, PeriodicTable]]:
    found = [(f.name, t) for f in machine.families for t in (f.volume, f.volume_by_motion)]
    for path in machine.paths:
        # where a gap is closed over the end of its period nothing else about it counts
        closed = path.kind == "parallel_gap" and not path.geometry.values[[0, -1], 1].any()
        others = path.height_by_motion, path.drag_speed, path.shear_speed
        tables = (path.geometry, *(() if closed else others))
        found += [(path.name, table) for table in tables if table is not None]
    for contact in machine.contacts:
        gaps = PeriodicTable(contact.geometry.period, *_gap_and_share(contact))
        found += [(contact.name, gaps), (contact.name, contact.gap_by_motion)]
    return found


def _gap_and_share(contact: ContactPair) -> tuple[Array, Array]:
    """Values and slopes of what counts where surfaces face away from one another, too."""
    return contact.geometry.values[:, :2], contact.geometry.slopes[:, :2]


def test_every_registered_machine_has_a_reference_case() -> None:
    assert set(machine_type_names()) <= set(MACHINES.values())


@pytest.mark.slow
@every_machine
def test_tables_are_periodic_and_finite(name: str) -> None:
    """The step over the end of the period is one like the others."""
    for label, table in tables_of(described(name)):
        values = table.values
        assert np.all(np.isfinite(values)), label
        assert np.all(np.isfinite(table.slopes)), label
        if values.shape[0] > 8:
            steps = np.abs(np.diff(values, axis=0, append=values[:1]))
            assert np.all(steps[-1] <= 1.5 * steps[:-1].max(axis=0) + 1e-15), label


@every_machine
def test_areas_and_widths_are_not_negative_and_gaps_do_not_overlap(name: str) -> None:
    for path in described(name).paths:
        geometry = path.geometry(own_angles(path))
        if path.kind == "orifice":
            assert geometry.min() >= 0.0, path.name
        else:
            assert geometry[..., 0].min() > -OVERLAP, path.name
            assert geometry[..., 1:].min() >= 0.0, path.name


@shipped
def test_the_report_has_the_displacement_of_a_turn(name: str) -> None:
    machine = described(name)
    turn = 2e6 * np.pi * machine.displacement
    assert machine.geometry_summary["displacement_cm3_per_rev"] == pytest.approx(turn, rel=1e-6)


@every_machine
def test_volumes_are_positive_and_their_derivatives_exact(name: str) -> None:
    step = 1e-5
    for family in described(name).families:
        angle = own_angles(family)
        assert family.volume(angle).min() > 0.0
        change = (family.volume(angle + step) - family.volume(angle - step)) / (2.0 * step)
        slope = family.volume.derivative(angle)
        assert slope == pytest.approx(change, abs=1e-5 * np.abs(slope).max() + 1e-15)


@every_machine
def test_chambers_and_solids_fill_the_section_at_every_angle(name: str) -> None:
    """What solids and casing leave to the chambers together does not depend on the angle."""
    machine = described(name)
    total = sum(np.sum(f.volume(own_angles(f))[..., 0], axis=1) for f in machine.families)
    assert np.ptp(total) < 2e-6 * np.mean(total)


def test_numbers_of_a_cycloidal_set_by_hand() -> None:
    """Six and seven teeth, 2.5 mm off centre, 10 um of clearance on each rotor, rim of 52 mm."""
    machine = described("gerotor_cycloidal")
    found, (pockets, *_) = dict(machine.geometry_summary), machine.families
    teeth = {
        "face_width_mm": 12.0, "eccentricity_mm": 2.5, "inner_tip_diameter_mm": 35.0 - 0.02,
        "inner_root_diameter_mm": 25.0 - 0.02, "outer_tip_diameter_mm": 30.0 + 0.02,
        "outer_root_diameter_mm": 40.0 + 0.02, "smallest_tip_gap_um": 20.0,
    }  # fmt: skip
    assert {name: found[name] for name in teeth} == pytest.approx(teeth, rel=1e-6)
    angle = np.linspace(0.0, 2.0 * np.pi, 2001)
    volume = 1e9 * pockets.volume(angle)
    assert found["max_pocket_volume_mm3"] == pytest.approx(volume.max(), rel=1e-6)
    assert found["min_pocket_volume_mm3"] == pytest.approx(volume.min(), rel=1e-6)
    places = pockets.phases + pockets.angle_ratio * angle[:, None]
    rising = np.maximum(pockets.volume.derivative(places)[..., 0], 0.0)
    flow = pockets.angle_ratio * rising.sum(axis=1)
    assert flow.mean() == pytest.approx(machine.displacement, rel=1e-3)
    ripple = 100.0 * np.ptp(flow) / flow.mean()
    assert found["flow_ripple_percent"] == pytest.approx(ripple, rel=0.02)
    checks = {check.name: check.value for check in machine.checks}
    rules = {
        "rim of the outer rotor over the lobe height": (26.0 - 20.01) / 5.0,
        "flow ripple": found["flow_ripple_percent"],
        "smallest pocket over the largest": 100.0 * volume.min() / volume.max(),
        "tip gap over the eccentricity": 100.0 * 20e-3 / 2.5,
        # kidneys from 12.5 to 20 mm; the shaft is taken as half the roots of the inner rotor
        "land beside the kidneys to the rim": 100.0 * (26.0 - 20.0) / (26.0 - 20.01),
        "land beside the kidneys to the shaft": 100.0 * (12.5 - 6.245) / (12.49 - 6.245),
    }
    assert {name: checks[name] for name in rules} == pytest.approx(rules, rel=1e-5)


def test_numbers_of_a_trochoidal_set_by_hand() -> None:
    """Lobes of 8.5 mm on 25.2 mm, 2.5 mm off centre; a clearance of 30 um, half on each rotor."""
    machine = described("gerotor_trochoidal")
    found = dict(machine.geometry_summary)
    turn = np.linspace(0.0, 2.0 * np.pi, 20001)
    path = 25.2 * np.exp(1j * turn) + 2.5 * np.exp(7j * turn)
    rate = 25.2j * np.exp(1j * turn) + 17.5j * np.exp(7j * turn)
    bend = -25.2 * np.exp(1j * turn) - 122.5 * np.exp(7j * turn)
    sharpest = 1.0 / (np.imag(np.conj(rate) * bend) / np.abs(rate) ** 3).max()
    assert np.abs(path).max() == pytest.approx(27.7)
    teeth = {
        "inner_tip_diameter_mm": 2.0 * (27.7 - 8.5) - 0.03,
        "inner_root_diameter_mm": 2.0 * (22.7 - 8.5) - 0.03,
        "outer_tip_diameter_mm": 2.0 * (25.2 - 8.5) + 0.03,
        "outer_root_diameter_mm": 2.0 * (25.2 - 8.5 + 5.0) + 0.03,
        "no_undercut_limit_mm": sharpest,
        "smallest_tip_gap_um": 30.0,
    }
    assert {name: found[name] for name in teeth} == pytest.approx(teeth, rel=1e-5)
    checks = {check.name: check.value for check in machine.checks}
    sealed = 1e-2 * checks["volume change of a sealed pocket over the largest pocket"]
    trapped = sealed * found["max_pocket_volume_mm3"]
    assert found["trapped_volume_mm3"] == pytest.approx(trapped)
    rules = {
        "lobe radius over its no-undercut limit": 8.5 / sharpest,
        "lobe radius over half the lobe distance": 8.5 / (25.2 * np.sin(np.pi / 7.0)),
        "smallest convex radius of the inner rotor": sharpest - 8.5 - 0.015,
        "rim of the outer rotor over the lobe height": (26.0 - 21.715) / 5.0,
    }
    assert {name: checks[name] for name in rules} == pytest.approx(rules, rel=1e-4)


def test_the_film_round_an_outer_rotor_fills_its_clearance() -> None:
    """A ring 12 mm wide of 52 mm and the clearance: its mean circumference times its height."""
    machine = described("gerotor_cycloidal")
    height = api.load_case(CASES / "gerotor_cycloidal.toml").machine.housing.radial_clearance
    section = np.pi * (52e-3 + height) * height
    assert machine.families[1].volume.values == pytest.approx(12e-3 * section)
    film = shapely.Polygon(machine.chamber_outlines(0.0)[-1])
    assert film.area == pytest.approx(section, rel=1e-3)
    assert np.hypot(*film.exterior.coords.xy).min() == pytest.approx(26e-3, rel=1e-6)


@pytest.mark.parametrize("name", FIRST)
def test_machines_drain_to_a_bar_unless_the_case_says_otherwise(name: str) -> None:
    assert described(name).drain_pressure == pytest.approx(1e5)


def test_the_land_beside_the_kidneys_is_judged_as_it_is_told() -> None:
    """Kidneys that leave 52 % of the land to the shaft, taken as half the roots of 24.98 mm."""
    case = api.load_case(CASES / "gerotor_cycloidal.toml")
    inner = 6.245 * (1.0 + 0.52)
    machine = api.describe(case.replace({"machine.ports.inner_radius": f"{inner} mm"}))
    (check,) = (c for c in machine.checks if c.name == "land beside the kidneys to the shaft")
    assert check.value == pytest.approx(52.0)
    assert check.passed
    assert check.allowed.startswith("above 50 %")


NUMBER = r"(-?[0-9.]+(?:e-?[0-9]+)?)"
RANGES = (
    (rf"{NUMBER}(?: [a-z]+)?(?: \([^)]*\))? to {NUMBER}", lambda value, a, b: a <= value <= b),
    (rf"at least {NUMBER}", lambda value, least: value >= least),
    (rf"above {NUMBER}", lambda value, least: value > least),
    (rf"up to {NUMBER}", lambda value, most: value <= most),
    (rf"below {NUMBER}", lambda value, most: value < most),
    (rf"below the [a-z ]+ of {NUMBER}", lambda value, most: value < most),
    (rf"{NUMBER} [a-z0-9]+", lambda value, same: abs(value - same) < 1e-3),
)
"""How a range is told, and when a number lies in it."""
IN_WORDS = {"trapped volume change", "overlap ratio"}
"""Told by a formula, or as what lies near one of several numbers."""


@pytest.mark.parametrize("name", [*FIRST, "fuel14_pump"])
def test_what_is_allowed_in_words_is_what_a_check_is_judged_by(name: str) -> None:
    """Lengths that are told in modules too are as many of them, of one module."""
    modules = []
    judged = [check for check in described(name).checks if check.name not in IN_WORDS]
    assert len(judged) >= 8
    for check in judged:
        found = [(re.match(text, check.allowed), holds) for text, holds in RANGES]
        match, holds = next((m, holds) for m, holds in found if m)
        assert holds(check.value, *map(float, match.groups())) == check.passed, check
        for length, times in re.findall(rf"{NUMBER} mm \({NUMBER} modules\)", check.allowed):
            modules.append(float(length) / float(times))
    assert np.ptp(modules or [0.0]) <= 0.01 * max(modules, default=0.0)


def test_gaps_that_are_run_in_stay_tables_with_their_slopes() -> None:
    """A depth that varies as the cosine is added to the gap, its slope to the slope."""
    machine = described("fuel14_pump")
    worn = [path for path in machine.paths if path.worn_by]
    assert worn
    depth = 20e-6

    def nodes(path: FlowPath) -> Array:
        count = len(path.geometry.values)
        return np.asarray(path.geometry.period * np.arange(count) / count)

    def waves(path: FlowPath) -> Array:
        return 2.0 * np.pi / path.geometry.period * nodes(path)

    depths = {str(path.worn_by): depth * (1.0 + np.cos(waves(path))) for path in worn}
    deeper = {path.name: path for path in machine.with_running_in(depths).paths}
    for path in worn:
        between = nodes(path)[::7] + 0.3 * nodes(path)[1]
        turn = 2.0 * np.pi / path.geometry.period
        new, old = deeper[path.name].geometry, path.geometry
        added = new(between)[:, 0] - old(between)[:, 0]
        np.testing.assert_allclose(added, depth * (1.0 + np.cos(turn * between)), atol=2e-9)
        slope = new.derivative(between)[:, 0] - old.derivative(between)[:, 0]
        np.testing.assert_allclose(
            slope, -depth * turn * np.sin(turn * between), atol=2e-3 * depth * turn
        )
        np.testing.assert_array_equal(new.values[:, 1:], old.values[:, 1:])


DENSITY = {"external_gear": 7850.0, "gerotor": 6900.0, "crescent": 7850.0}
"""Of steel, and of sintered steel. [kg/m3]"""


def section_of(machine: MachineDescription, body: str) -> tuple[float, float, float, float]:
    """Area, polar moment, length and longest chord of a drawn body, by sums over the angle."""
    start = machine.outlines[body] @ np.array([1.0, 1j])
    end = np.roll(start, -1)
    turn, radius = np.angle(end / start), np.abs(0.5 * (start + end))
    area, moment = (float(np.sum(radius**power * turn)) / power for power in (2, 4))
    chords = np.abs(end - start)
    return area, moment, float(chords.sum()), float(chords.max())


@pytest.mark.parametrize("name", FIRST)
def test_bodies_weigh_what_their_outlines_and_journals_do(name: str) -> None:
    machine, density = described(name), DENSITY[MACHINES[name]]
    width = 1e-3 * float(machine.geometry_summary["face_width_mm"])  # type: ignore[arg-type]
    for body in machine.bodies:
        area, moment, length, longest = section_of(machine, body.name)
        mass, inertia = density * width * area, density * width * moment
        journals = [j for j in machine.journals if j.body == body.name]
        if any(j.count == 1 for j in journals):  # a ring, drawn with a cut to its outside
            length -= 2.0 * longest + np.pi * journals[0].diameter
        for j in (j for j in journals if j.count == 2):
            shaft = density * j.count * j.length * 0.25 * np.pi * j.diameter**2
            mass, inertia = mass + shaft, inertia + shaft * j.diameter**2 / 8.0
        assert body.mass == pytest.approx(mass, rel=1e-3), body.name
        assert body.inertia == pytest.approx(inertia, rel=1e-3), body.name
        assert body.wetted_area == pytest.approx(width * length, rel=2e-3), body.name


@pytest.mark.parametrize("name", FIRST)
def test_films_on_faces_cover_the_section_and_leak_as_rings(name: str) -> None:
    """Moment of the drawn section without the shaft; lands of 2 pi/ln(r_o/r_i) to the drain."""
    machine = described(name)
    drains = [path for path in machine.paths if path.category is DRAIN]
    assert drains
    for k, film in enumerate(machine.laterals):
        radii = np.hypot(*machine.outlines[film.body].T)
        assert film.outer_radius == pytest.approx(radii.max(), rel=1e-6)
        inner, root, outer = (
            0.5 * np.pi * r**4 for r in (film.inner_radius, film.root_radius, film.outer_radius)
        )
        moment = section_of(machine, film.body)[1]
        solid = film.inner_radius < 0.99 * radii.min()
        found = root - inner + film.tooth_area_fraction * (outer - root)
        land = film.inner_radius, film.root_radius
        if film.drag is not None:
            found, land = film.drag * film.height, (film.root_radius, film.outer_radius)
        assert found == pytest.approx(moment - solid * inner, rel=1e-3), film.body
        if k < len(drains):
            height, width, length = drains[k].geometry.values.T
            leaking = drains[k].count * np.mean(width / length)
            ring = 2.0 * np.pi / np.log(land[1] / land[0])
            assert leaking == pytest.approx(ring, rel=1e-3), film.body
            assert drains[k].multiplicity == film.faces == 2
            np.testing.assert_allclose(height, film.height)


@every_machine
def test_nodes_and_parts_that_are_named_exist(name: str) -> None:
    machine = described(name)
    bodies = {body.name for body in machine.bodies}
    assert [body.role for body in machine.bodies].count("shaft") == 1
    assert {motion.body for motion in machine.motions} <= bodies
    assert {journal.body for journal in machine.journals} <= bodies
    assert {film.body for film in machine.laterals} <= bodies
    assert {path.worn_by for path in machine.paths} - {None} <= bodies
    for contact in machine.contacts:
        assert {contact.body_a, contact.body_b} <= bodies
    for path in machine.paths:
        assert path.nodes_a.size == path.nodes_b.size == path.count
        assert np.concatenate([path.nodes_a, path.nodes_b]).max() <= machine.drain_node
    names = [category.name for category in machine.path_categories]
    assert len(set(names)) == len(names)
    roles = {category.role for category in machine.path_categories}
    assert {"inlet_port", "outlet_port"} <= roles


def faces_of(machine: MachineDescription) -> list[FilmFace]:
    """Faces of all presets."""
    found = machine.known_faces.values()
    shared, balance = machine.shared_faces, machine.lateral_balance
    return [
        *found,
        *(() if shared is None else shared.covers),
        *(() if balance is None else (interface.face for interface in balance.interfaces)),
    ]


@every_machine
def test_faces_have_a_film_a_chamber_or_a_recess_at_every_place(name: str) -> None:
    """Film stands between a body and the wall; no chamber reaches the inner rim."""
    machine = described(name)
    for face in faces_of(machine):
        assert {body.name for body in face.bodies} <= {body.name for body in machine.bodies}
        assert face.chambers.nodes.size == face.chambers.phases.size
        assert face.inner_node == machine.drain_node
        walls = {machine.inlet_node, machine.outlet_node}
        assert set(face.recesses.tolist()) <= walls
        for angle in ANGLES:
            node, body = face.face_map(float(angle), *places(face))
            others = set(node[node != FILM].tolist()) - {face.inner_node} - walls
            assert others <= set(range(machine.chamber_count))
            assert others >= set(face.chambers.nodes.tolist())
            assert np.all(body[node == FILM] != NO_BODY)
            assert set(np.unique(body)) <= {NO_BODY, *range(len(face.bodies))}
            edge = {FILM, face.inner_node, *face.recesses.tolist()}
            assert set(node[:, 0].tolist()) <= edge


@every_machine
def test_faces_look_the_same_after_their_period_with_the_next_chambers(name: str) -> None:
    machine = described(name)
    for face in faces_of(machine):
        before, after = (face.face_map(0.1 + turn, *places(face)) for turn in (0.0, face.period))
        phases, nodes = face.chambers.phases, face.chambers.nodes
        behind = np.cos(phases[:, None] - phases + face.chambers.pitch)
        follows = np.append(np.arange(machine.drain_node + 1), FILM)
        follows[nodes] = nodes[np.argmax(behind, axis=0)]
        own = np.isin(before.node, [FILM, *nodes])
        assert np.mean(own & (after.node != follows[before.node])) < 1e-3
        assert np.mean(after.body != before.body) < 1e-3


def places(face: FilmFace) -> tuple[Array, Array]:
    """Points of the machine frame between the rims of a face, from the inner one outwards."""
    turn = 2.0 * np.pi * (np.arange(211) + 0.5) / 211.0
    radius = np.linspace(1.0001 * face.inner_radius, 0.9999 * face.outer_radius, 40)
    return face.places(turn, radius)


@shipped
def test_equal_pressure_gives_no_net_force_or_moment(name: str) -> None:
    """All walls of a body are wetted, from one seal to the next."""
    machine = described(name)
    net = sum(np.sum(f.volume_by_motion(own_angles(f)), axis=1) for f in machine.families)
    largest = np.max([np.abs(f.volume_by_motion.values).max(axis=0) for f in machine.families], 0)
    assert np.all(np.abs(net).max(axis=0) < 1e-5 * largest)


@pytest.mark.slow
@shipped
def test_the_ideal_machine_delivers_its_displacement(name: str) -> None:
    """Volume tables and openings against the closed form of the displacement."""
    overrides = ["run.fidelity=ideal", "run.flank_sealing=single"]
    case = api.load_case(CASES / f"{name}.toml", overrides)
    if case.operating_point is None:
        pytest.skip("a case over time")
    found = api.simulate(case).summary()
    wanted = found["displacement_cm3_per_rev"] * case.operating_point.shaft_speed * 60.0  # type: ignore[operator]
    assert found["mean_flow_L_per_min"] == pytest.approx(wanted / (2e3 * np.pi), rel=5e-3)


@pytest.mark.slow
@shipped
def test_a_pump_driven_backwards_is_the_motor(name: str) -> None:
    """Mirrored about the centre line, the chambers of a pump are those of the motor."""
    pump, motor = described(name, "pump"), described(name, "motor")
    angle = np.linspace(0.0, 2.0 * np.pi, 61)
    assert pump.displacement == pytest.approx(motor.displacement, rel=1e-9)
    for one, other in zip(pump.families, motor.families, strict=True):
        if one.volume.period > 2.0 * np.pi:
            # spaces that the mating tooth cuts in two begin on another side: all of them together
            own = sum(one.volume(angle + phase) for phase in one.phases)
            mirrored = sum(other.volume(-(angle + phase)) for phase in one.phases)
            assert own == pytest.approx(mirrored, rel=1e-9)
            continue
        mirrored = other.volume(-angle)
        assert one.volume(angle) == pytest.approx(mirrored, rel=1e-5, abs=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["crescent_pump", "egm12_motor", "gerotor_trochoidal"])
def test_friction_is_listed_by_the_mechanisms_of_the_machine(name: str) -> None:
    """What the description does not name takes no energy in the ledger."""
    case = api.load_case(CASES / f"{name}.toml")
    case = replace(case, run=replace(case.run, until=None, revolutions=1))
    solution, named = api.simulate(case), described(name).friction_mechanisms
    assert tuple(solution.data["mechanism"].values) == named
    others = set(FRICTION_MECHANISMS) - set(named)
    assert others
    assert not any(solution.ledger.energy[mechanism] for mechanism in others)
    torque = solution.data["torque_loss"].mean("shaft_angle").values
    assert torque[named.index("journal_viscous")] > 0.0
