"""Gerotor profiles, pockets and ports against closed forms and polygons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import affinity

from tests.gerotor_designs import CYCLOIDAL, TROCHOIDAL
from toothspace.core.errors import GeometryError
from toothspace.machines.gerotor.flow_paths import gap_by_motion, slip_speed
from toothspace.machines.gerotor.parameters import PortContourParameters, RotorParameters
from toothspace.machines.gerotor.pockets import Pockets, area_by_motion, lobe_path, pockets
from toothspace.machines.gerotor.ports import PocketPolygons, kinematic_lands, openings, ports_of
from toothspace.machines.gerotor.profiles import Rotors, Trochoid, rotors_from, trochoid_of
from toothspace.machines.gerotor.summary import flow_ripple

RIM = 26e-3
DESIGNS = [TROCHOIDAL, CYCLOIDAL]
NAMES = ["trochoidal", "cycloidal"]


def _placed(rotors: Rotors, outer_turn: float) -> tuple[shapely.Polygon, shapely.Polygon]:
    """Return polygons of both rotors in the machine frame."""
    turn = outer_turn * rotors.outer_tooth_count / rotors.inner_tooth_count
    inner = affinity.rotate(shapely.Polygon(rotors.inner), turn, (0, 0), use_radians=True)
    inner = affinity.translate(inner, *rotors.inner_center)
    outer = affinity.rotate(shapely.Polygon(rotors.outer), outer_turn, (0, 0), use_radians=True)
    return inner, outer


def _pockets(parameters: RotorParameters, nodes: int = 700) -> Pockets:
    return pockets(parameters, rotors_from(parameters), nodes)


@pytest.mark.parametrize(
    ("design", "radii"),
    [(TROCHOIDAL, (14.2, 19.2, 16.7, 21.7)), (CYCLOIDAL, (12.5, 17.5, 15.0, 20.0))],
    ids=NAMES,
)
def test_tip_and_root_radii_of_the_reference_designs(design, radii):
    """Radii of the reference designs without clearance."""
    rotors = rotors_from(replace(design, tip_clearance=0.0))
    inner, outer = np.hypot(*rotors.inner.T) * 1e3, np.hypot(*rotors.outer.T) * 1e3
    found = (inner.min(), inner.max(), outer.min(), outer.max())
    assert found == pytest.approx(radii, abs=2e-4)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_rotors_keep_the_tip_clearance_at_every_angle(design):
    """Conjugate profiles: centred rotors never touch and are nowhere farther than the gap."""
    rotors = rotors_from(design)
    for turn in np.linspace(0.0, 2.0 * np.pi / rotors.outer_tooth_count, 9):
        inner, outer = _placed(rotors, turn)
        assert inner.exterior.distance(outer.exterior) == pytest.approx(
            design.tip_clearance, abs=0.1e-6
        )


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_rotors_without_clearance_touch_and_do_not_overlap(design):
    """Overlap of conjugate profiles is no more than the sagitta of their polygons."""
    rotors = rotors_from(replace(design, tip_clearance=0.0))
    for turn in (0.05, 0.2, 0.4):
        inner, outer = _placed(rotors, turn)
        assert inner.difference(outer).area < 1e-12


@pytest.mark.parametrize(
    ("ratio", "limit"), [(1.3, 3.27), (1.4, 3.86), (1.5, 4.40), (1.6, 4.92), (1.8, 5.89)]
)
def test_no_undercut_limit(ratio, limit):
    """Limits of 6/7 trochoids over the eccentricity, computed independently."""
    design = replace(TROCHOIDAL, generating_radius=ratio * 7 * TROCHOIDAL.eccentricity)
    found = trochoid_of(design).no_undercut_limit / design.eccentricity
    assert found == pytest.approx(limit, abs=0.006)


def test_lobes_beyond_the_undercut_limit_are_refused():
    """One line that names key, value and limit."""
    with pytest.raises(GeometryError, match=r"lobe_radius: found 10.3 mm, allowed below 10.2 mm"):
        rotors_from(replace(TROCHOIDAL, lobe_radius=10.3e-3))


def test_generating_radius_inside_the_pitch_circle_is_refused():
    """The lobe centres must lie outside the pitch circle of 17.5 mm."""
    with pytest.raises(GeometryError, match=r"generating_radius: found 17 mm, allowed above 17.5"):
        rotors_from(replace(TROCHOIDAL, generating_radius=17e-3))


@pytest.mark.parametrize("count", [4, 6, 11])
def test_floors_of_cavities_end_where_lobes_touch_for_the_last_time(count: int) -> None:
    """There the normal of the lobe is a tangent of the pitch circle about the outer centre."""
    lobes, radius = count + 1, 25e-3
    given = Trochoid(count, 0.6 * radius / lobes, radius, 1e-3)
    design = replace(given, lobe_radius=given.floor_limit)
    lean = np.arcsin(lobes * design.eccentricity / radius)
    place = radius - design.lobe_radius * np.exp(1j * lean)
    assert abs(place) == pytest.approx(design.cavity_radius, rel=1e-12)


@pytest.mark.parametrize(
    ("design", "area", "displacement"),
    [(TROCHOIDAL, 85.55, 6.160), (CYCLOIDAL, 77.18, 5.557)],
    ids=NAMES,
)
def test_displacement_of_the_reference_designs(design, area, displacement):
    """Displaced area and volume within 0.1 %."""
    pocket = _pockets(design)
    assert pocket.displaced_area * 1e6 == pytest.approx(area, rel=1e-3)
    volume = 2.0 * np.pi * pocket.area_per_radian * design.face_width
    assert volume * 1e6 == pytest.approx(displacement, rel=1e-3)


def test_flow_ripple_of_the_trochoidal_design():
    """5.46 % with two peaks on every outer pitch."""
    assert 100.0 * flow_ripple(_pockets(TROCHOIDAL)) == pytest.approx(5.46, abs=0.01)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_areas_equal_those_of_polygons(design):
    """Contact-radii integral against the polygon between two throats, every fifth of a pitch."""
    pocket = _pockets(replace(design, tip_clearance=0.0))
    for node in range(0, pocket.place.size, 20):
        polygon = shapely.Polygon(PocketPolygons(pocket)(np.array([node]))[0])
        assert pocket.area[node] == pytest.approx(polygon.area, abs=1e-9)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_pockets_and_rotors_fill_the_section(design):
    """With clearance the areas of all pockets sum to what the rotors leave, at every angle."""
    pocket = _pockets(design)
    step = 2 * pocket.half_pitch_nodes
    sums = pocket.area.reshape(pocket.rotors.outer_tooth_count, step).sum(axis=0)
    inner, outer = _placed(pocket.rotors, 0.0)
    assert sums == pytest.approx(outer.area - inner.area, rel=1e-6)
    assert pocket.area.min() > 0.0


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_area_rate_is_the_slope_of_the_area(design):
    """Central difference of the table over the shaft angle."""
    pocket = _pockets(design, 2800)
    step = pocket.place[1] / pocket.angle_ratio
    slope = (np.roll(pocket.area, -1) - np.roll(pocket.area, 1)) / (2.0 * step)
    # where the path of contact of a cycloidal pair passes the pitch point the rate has a kink
    error = np.abs(slope - pocket.area_rate) / np.abs(pocket.area_rate).max()
    assert np.percentile(error, 95) < 1e-5
    assert error.max() < 2e-3


def test_kinematic_lands_of_the_trochoidal_design():
    """Land half angles of 31.0 and 9.7 degrees."""
    lands = np.rad2deg(kinematic_lands(_pockets(TROCHOIDAL)))
    assert lands == pytest.approx([31.0, 9.7], abs=0.05)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_kinematic_ports_never_join(design):
    """No pocket is open to both kidneys, none is sealed for more than a degree from both."""
    pocket = _pockets(replace(design, tip_clearance=0.0), 140)
    ports = ports_of(PortContourParameters(timing="kinematic"), pocket, RIM)
    inlet, outlet = (openings(ports, pocket, name)[:, 0] for name in ("inlet", "outlet"))
    assert not np.any((inlet > 0.2e-6) & (outlet > 0.2e-6))
    closed = np.count_nonzero((inlet == 0.0) & (outlet == 0.0))
    assert closed <= 2
    # mirror images
    assert outlet == pytest.approx(np.roll(inlet[::-1], 1), abs=0.02e-6)
    assert inlet.max() < pocket.area.max()


def test_curvatures_of_the_trochoidal_design():
    """Inner tip 1.70 mm convex, root 9.11 mm concave, lobe 8.5 mm, relative root 127 mm."""
    bare = replace(TROCHOIDAL, tip_clearance=0.0)
    path = lobe_path(bare, rotors_from(bare), np.linspace(0.0, 2.0 * np.pi, 1401)[:-1])
    assert 1.0 / path.inner_curvature.max() == pytest.approx(1.70e-3, abs=0.005e-3)
    assert 1.0 / path.inner_curvature.min() == pytest.approx(-9.11e-3, abs=0.005e-3)
    assert 1.0 / path.outer_curvature[0] == pytest.approx(8.5e-3)
    assert path.relative_radius[0] == pytest.approx(127e-3, rel=0.01)
    assert path.relative_radius.min() == pytest.approx(1.42e-3, abs=0.01e-3)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_curvatures_are_those_of_the_outlines(design):
    """Circles through three points of the outlines beside the points of contact."""
    bare = replace(design, tip_clearance=0.0)
    rotors = rotors_from(bare, 4000)
    place = np.array([0.0, 0.1, 1.2, 2.0, 2.9, np.pi, 4.0, 5.5])
    path = lobe_path(bare, rotors, place)
    turn = place - np.pi / rotors.outer_tooth_count
    ratio = rotors.outer_tooth_count / rotors.inner_tooth_count
    for k in range(place.size):
        found = (
            _curvature_at(rotors.inner, path.point[k] - rotors.inner_center, ratio * turn[k]),
            -_curvature_at(rotors.outer, path.point[k], turn[k]),
        )
        exact = path.inner_curvature[k], path.outer_curvature[k]
        assert found == pytest.approx(exact, rel=0.01, abs=1.0)


def _curvature_at(outline: np.ndarray, point: np.ndarray, turn: float) -> float:
    """Curvature of an outline at the place of a machine point, positive where convex."""
    cosine, sine = np.cos(turn), np.sin(turn)
    own = np.array([cosine * point[0] + sine * point[1], cosine * point[1] - sine * point[0]])
    nearest = int(np.argmin(np.hypot(*(outline - own).T)))
    a, b, c = (outline[(nearest + k) % len(outline)] for k in (-12, 0, 12))
    sides = [np.hypot(*(p - q)) for p, q in ((a, b), (b, c), (c, a))]
    cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return float(2.0 * cross / np.prod(sides))


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_throats_lie_on_both_walls(design):
    """Half a gap along the normal on either side of the throat's middle there is a wall."""
    rotors = rotors_from(design)
    place = np.linspace(0.3, 2.0 * np.pi - 0.3, 25)
    path = lobe_path(design, rotors, place)
    for k, turn in enumerate(place - np.pi / rotors.outer_tooth_count):
        inner, outer = _placed(rotors, float(turn))
        half = 0.5 * path.gap[k] * path.normal[k]
        assert inner.exterior.distance(shapely.Point(path.point[k] - half)) < 0.4e-6
        assert outer.exterior.distance(shapely.Point(path.point[k] + half)) < 0.4e-6


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_profiles_without_definition_give_the_same_pockets(design, tmp_path):
    """Outlines written as text and read back: closest approach finds the same volumes."""
    rotors, exact = rotors_from(design), _pockets(design, 360)
    files = {}
    for name in ("inner", "outer"):
        files[name] = tmp_path / f"{name}.txt"
        # turned by an odd angle and moved: the reader finds centre and orientation
        points = getattr(rotors, name) @ np.array([[0.6, 0.8], [-0.8, 0.6]]) + [3e-3, -1e-3]
        np.savetxt(files[name], points * 1e3)
    read = replace(
        design,
        kind=None,
        generating_radius=None,
        lobe_radius=None,
        tip_clearance=0.0,
        inner_profile=files["inner"],
        outer_profile=files["outer"],
    )
    found = pockets(read, rotors_from(read), 360)
    assert found.displaced_area == pytest.approx(exact.displaced_area, rel=1e-4)
    scale = exact.area_rate.max()
    assert found.area_rate == pytest.approx(exact.area_rate, abs=2e-3 * scale)
    assert found.path.gap == pytest.approx(exact.path.gap, abs=3e-6)


def test_a_profile_with_other_teeth_is_refused(tmp_path):
    """A file with seven lobes is no inner rotor of six teeth."""
    rotors = rotors_from(TROCHOIDAL)
    np.savetxt(tmp_path / "outer.txt", rotors.outer * 1e3)
    read = replace(
        TROCHOIDAL,
        kind=None,
        generating_radius=None,
        lobe_radius=None,
        inner_profile=tmp_path / "outer.txt",
        outer_profile=tmp_path / "outer.txt",
    )
    with pytest.raises(GeometryError, match=r"found curves of 7 teeth in outer\.txt"):
        rotors_from(read)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_area_by_motion_is_the_swept_parallelogram(design):
    """Moving the outer rotor by a micrometre sweeps the parallelogram under its chord."""
    pocket = _pockets(replace(design, tip_clearance=0.0))
    columns = area_by_motion(pocket)
    node, step = pocket.place.size // 2 + 30, 1e-6
    for column, direction in ((2, (1.0, 0.0)), (3, (0.0, 1.0))):
        # swept area of the outer wall alone: the chord moves sideways
        ends = pocket.behind(pocket.path.point)[node], pocket.ahead(pocket.path.point)[node]
        move = step * np.array(direction)
        patch = shapely.Polygon([ends[0], ends[1], ends[1] + move, ends[0] + move])
        chord = ends[1] - ends[0]
        sign = np.sign(chord[1] * move[0] - chord[0] * move[1])
        assert columns[node, column] * step == pytest.approx(sign * patch.area, rel=1e-9)


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_virtual_work_of_both_rotors(design):
    """Rate of the area is the work of both rotations; uniform pressure gives no net force."""
    pocket = _pockets(design)
    columns = area_by_motion(pocket)
    inner = np.sum((pocket.path.point - pocket.rotors.inner_center) ** 2, axis=1)
    by_inner = 0.5 * (pocket.ahead(inner) - pocket.behind(inner))
    total = by_inner + pocket.angle_ratio * columns[:, 4]
    scale = np.abs(pocket.area_rate).max()
    assert pocket.area_rate == pytest.approx(total, abs=1e-12 * scale)
    step = 2 * pocket.half_pitch_nodes
    net = columns.reshape(pocket.rotors.outer_tooth_count, step, 5).sum(axis=0)
    assert np.abs(net).max() < 1e-12


def test_gap_by_motion_is_the_displacement_along_the_normal():
    """A displaced outer rotor opens the gap that polygons measure, to second order."""
    rotors = rotors_from(TROCHOIDAL)
    place = np.array([1.0, 2.0, np.pi, 4.5])
    path = lobe_path(TROCHOIDAL, rotors, place)
    pocket = Pockets(rotors, path, np.zeros(4), np.zeros(4))
    columns = gap_by_motion(pocket)
    for k, turn in enumerate(place - np.pi / rotors.outer_tooth_count):
        inner, outer = _placed(rotors, float(turn))
        near = shapely.Point(path.point[k]).buffer(1.5e-3)
        wall = outer.exterior.intersection(near)
        for column, move in ((2, (5e-6, 0.0)), (3, (0.0, 5e-6))):
            moved = affinity.translate(wall, *move)
            found = inner.exterior.distance(moved) - inner.exterior.distance(wall)
            assert found == pytest.approx(5e-6 * columns[k, column], abs=0.05e-6)
        turned = affinity.rotate(wall, 2e-4, (0, 0), use_radians=True)
        found = inner.exterior.distance(turned) - inner.exterior.distance(wall)
        assert found == pytest.approx(2e-4 * columns[k, 4], abs=0.1e-6)


@settings(max_examples=12, deadline=None)
@given(
    count=st.integers(4, 12),
    slenderness=st.floats(1.25, 1.9),
    share=st.floats(0.05, 0.9),
    kind=st.sampled_from(["trochoidal", "cycloidal"]),
)
def test_any_design_is_conjugate(count, slenderness, share, kind):
    """Any tooth count: no overlap, contact everywhere, areas positive and summing up."""
    e = 2e-3
    radius = slenderness * (count + 1) * e
    lobes = {"generating_radius": radius, "lobe_radius": 1e-3} if kind == "trochoidal" else {}
    design = RotorParameters(
        kind=kind,
        inner_tooth_count=count,
        eccentricity=e,
        face_width=10e-3,
        tip_clearance=0.0,
        **lobes,
    )
    if kind == "trochoidal":
        limits = trochoid_of(design)
        high = min(limits.no_undercut_limit, limits.closure_limit, limits.floor_limit)
        assume(high > 1.3 * e)
        design = replace(design, lobe_radius=1.05 * e + share * (high - 1.05 * e))
    rotors = rotors_from(design)
    for turn in (0.0, 0.3 / count):
        inner, outer = _placed(rotors, turn)
        assert inner.difference(outer).area < 1e-5 * inner.area
    pocket = pockets(design, rotors, 400)
    assert pocket.area.min() > -1e-9
    assert np.argmin(pocket.area) == 0
    rule = np.pi * (np.hypot(*rotors.inner.T).max() ** 2 - np.hypot(*rotors.inner.T).min() ** 2)
    assert count * pocket.displaced_area == pytest.approx(rule, rel=0.08)


def test_explicit_lands_are_kept():
    """Stated half angles override the kinematic ones."""
    pocket = _pockets(TROCHOIDAL, 140)
    stated = PortContourParameters(
        land_max_half_angle=np.deg2rad(35.0), land_min_half_angle=np.deg2rad(12.0)
    )
    ports = ports_of(stated, pocket, RIM)
    inlet = openings(ports, pocket, "inlet")[:, 0]
    kinematic = openings(
        ports_of(PortContourParameters(timing="kinematic"), pocket, RIM), pocket, "inlet"
    )
    assert ports.land_max_half_angle == pytest.approx(np.deg2rad(35.0))
    assert inlet.sum() < kinematic[:, 0].sum()


@pytest.mark.parametrize("design", DESIGNS, ids=NAMES)
def test_layers_of_clearance_pass_the_throats_as_walls_drag(design):
    """What drag through the tips brings to a pocket is what its wall layers grow by.

    Polygons between the walls change by the pocket's own rate and by half a gap times the length
    of its walls; the drag flow of both throats makes up for just that, to first order in the gap.
    """
    pocket = _pockets(design, 700)
    drag = design.tip_clearance * slip_speed(pocket)
    into = pocket.behind(drag) - pocket.ahead(drag)
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (into[1:] + into[:-1]))])
    brought = summed * pocket.place[1] / pocket.angle_ratio
    nodes = np.arange(0, pocket.place.size, 14)
    walls = shapely.area(
        [shapely.Polygon(one) for one in PocketPolygons(pocket)(np.asarray(nodes))]
    )
    layers = walls - pocket.area[nodes]
    found, expected = layers - layers[25], (brought - brought[350])[nodes]
    assert np.ptp(expected) > 0.2e-6
    assert found == pytest.approx(expected, abs=0.003 * np.ptp(expected))
