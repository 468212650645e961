"""Internal gear machine: teeth, mesh, chambers and flow against polygons and closed forms."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import shapely

from tests.crescent_designs import CASE, crescent
from tests.reference_formulas.space_areas import section_area_rates
from toothspace.api import describe, load_case
from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.gearing.mesh_split import (
    FREE,
    Closest,
    Placement,
    closest_points,
    distance,
    search_of,
    starting_places,
)
from toothspace.gearing.meshing import (
    FULL_TURN,
    contact_range,
    facing_throats,
    flow_over_pitch,
)
from toothspace.gearing.openings import groove_openings, space_outlines
from toothspace.gearing.ring_gear import InternalPair, RingGear, pair_from_backlash
from toothspace.gearing.spaces import area_by_motion, section_areas
from toothspace.geometry.gear_pair import pair_from_backlash as external_pair
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.crescent.assembly import (
    CrescentAssembly,
    assemble,
    cover_recesses,
    filler_outline,
    involute_pair,
)
from toothspace.machines.crescent.summary import (
    geometry_summary,
    overlap,
    sealed_teeth,
    tip_clearance,
    trimming_distance,
)

ALPHA = np.deg2rad(27.5)
MODULE = 5e-3
HELIX = ("machine.pinion.helix_angle=3 deg", "machine.pinion.helix_hand=right")


@cache
def machine(mode: str = "pump") -> CrescentAssembly:
    return assemble(crescent(mode))


def moved(points: Array, turn: float, center: Array) -> shapely.Polygon:
    c, s = np.cos(turn), np.sin(turn)
    return shapely.Polygon(points @ np.array([[c, s], [-s, c]]) + center)


def solids(assembly: CrescentAssembly, angle: float) -> tuple[shapely.Polygon, shapely.Polygon]:
    """Pinion, and the space inside the ring's teeth, at a shaft angle."""
    start = 0.5 * np.pi + assembly.mesh.half_pitch
    pinion = shapely.Polygon(assembly.pinion.closed_polygon(start + angle))
    turn = assembly.ratio * angle + assembly.mesh.turn
    return pinion, moved(assembly.ring_curve, turn, assembly.ring_center)


def places(assembly: CrescentAssembly, angle: float) -> tuple[Array, Array]:
    """Places of all tooth spaces of both gears at a shaft angle."""
    first, second = assembly.counts
    pinion = angle - FULL_TURN * np.arange(first) / first
    ring = assembly.ratio * angle - FULL_TURN * (np.arange(second) + 0.5) / second
    return tuple(np.mod(p + np.pi, FULL_TURN) - np.pi for p in (pinion, ring))  # type: ignore[return-value]


@pytest.mark.parametrize("mode", ["pump", "motor"])
@pytest.mark.parametrize("angle", [0.0, 0.11, 0.23, 0.37])
def test_chambers_and_solids_fill_the_section(mode: str, angle: float) -> None:
    """Tooth spaces reach to the tip circles; in the lens each point belongs to one of them."""
    assembly = machine(mode)
    pinion, bore = solids(assembly, angle)
    first, second = assembly.tip_radii
    inner = shapely.Point(0.0, 0.0).buffer(first, quad_segs=2000)
    outer = bore.difference(shapely.Point(*assembly.ring_center).buffer(second, quad_segs=2000))
    fluid = bore.difference(pinion).intersection(inner.union(outer)).area
    spaces = assembly.spaces_at(*places(assembly, angle))
    areas = np.concatenate([section_areas(s) for s in spaces])
    assert areas.sum() == pytest.approx(fluid, rel=5e-5)
    drawn = [shapely.Polygon(outline) for s in spaces for outline in space_outlines(s)]
    assert [one.area for one in drawn] == pytest.approx(areas, abs=3e-8)
    together = shapely.union_all([shapely.make_valid(one) for one in drawn])
    assert together.area == pytest.approx(fluid, rel=1e-4)


@pytest.mark.parametrize("gear", [0, 1])
def test_area_rates_are_derivatives(gear: int) -> None:
    assembly, step = machine(), 2e-4
    grid = np.linspace(-3.0, 3.0, 41)
    ratio = (1.0, assembly.ratio)[gear]

    def areas(shift: float) -> Array:
        return section_areas(assembly.spaces_at(grid + shift, grid + shift)[gear])

    change = ratio * (areas(step) - areas(-step)) / (2.0 * step)
    rate = section_area_rates(assembly.spaces_at(grid, grid)[gear])
    wrong = np.abs(rate - change) > 2e-4 * np.abs(rate).max()
    # where the closest points change their places the area has a step
    assert np.count_nonzero(wrong) <= 2


def test_turning_the_ring_displaces_what_its_moment_says() -> None:
    """Virtual work of the ring's rotation: the same table is its pressure moment."""
    assembly, turn = machine(), 2e-6
    pinion, ring = assembly.table_places(0, 240), assembly.table_places(1, 240)
    start = assembly.spaces_at(pinion, ring)
    ahead = replace(assembly, mesh=assembly.mesh._replace(turn=assembly.mesh.turn + turn))
    moved_by = ahead.spaces_at(pinion, ring)
    for before, after in zip(start, moved_by, strict=True):
        change = (section_areas(after) - section_areas(before)) / turn
        wanted = area_by_motion(before)[:, 4]
        largest = np.abs(wanted).max()
        sides = (before.left, before.right)
        narrow = np.all([(s.weight >= 1.0) & (s.gap < 0.2e-3) for s in sides], axis=0)
        assert np.count_nonzero(narrow) > 10
        assert change[narrow] == pytest.approx(wanted[narrow], abs=2e-2 * largest)


def test_loaded_flanks_touch_and_the_others_have_the_backlash() -> None:
    for mode in ("pump", "motor"):
        assembly = machine(mode)
        angles = np.linspace(-0.15, 0.2, 41) if mode == "pump" else np.linspace(-0.2, 0.15, 41)
        for is_left in (True, False):
            side = facing_throats(assembly.teeth, assembly.mesh, is_left, angles)
            wanted = 0.0 if is_left == assembly.loaded_is_left else 100e-6
            assert side.gap[side.weight >= 1.0].min() == pytest.approx(wanted, abs=5e-9)


def test_contact_ratio_is_that_of_the_path_of_contact() -> None:
    assembly = machine()
    start, end = contact_range(assembly)
    assert assembly.pair is not None
    found = (end - start) / (2.0 * assembly.mesh.half_pitch)
    # rounded edges and gaps below a micrometre lengthen what counts as touching
    assert found == pytest.approx(assembly.pair.contact_ratio, abs=0.12)


def test_displacement_and_ripple_are_the_closed_form() -> None:
    assembly = machine()
    assert assembly.pair is not None
    flow = flow_over_pitch(assembly)
    wanted = assembly.pair.displacement_per_radian(assembly.face_width)
    assert flow.mean() == pytest.approx(wanted, rel=1e-4)
    ripple = (flow.max() - flow.min()) / flow.mean()
    assert ripple == pytest.approx(assembly.pair.flow_ripple(), rel=0.03)


def test_numbers_of_the_report_by_hand() -> None:
    """A module of 5 mm, 13 and 19 teeth; radii of tips 39.5 and 46 mm, of roots 29.25 and 56 mm."""
    assembly = machine()
    assert assembly.pair is not None
    found = geometry_summary(assembly, assembly.spaces(360), ())
    turn = 2e6 * np.pi * assembly.pair.displacement_per_radian(assembly.face_width)
    assert found["displacement_cm3_per_rev"] == pytest.approx(turn, rel=1e-4)
    ripple = 100.0 * assembly.pair.flow_ripple()
    assert found["flow_ripple_percent"] == pytest.approx(ripple, rel=0.03)
    assert found["face_width_mm"] == pytest.approx(49.26)
    apart = 1e3 * assembly.pair.center_distance
    assert found["center_distance_mm"] == pytest.approx(apart)
    working = np.degrees(np.arccos(0.5 * 5.0 * (19 - 13) * np.cos(ALPHA) / apart))
    assert found["operating_pressure_angle_deg"] == pytest.approx(working)
    free = min(46.0 - apart - 29.25, 56.0 - apart - 39.5)
    assert found["root_clearance_mm"] == pytest.approx(free)
    # 160 degrees of filler less 20 mm of notch and the land itself, in pitches
    span = np.radians(160.0) - 20.0 / 39.5 - abs(assembly.teeth[0].land_angle)
    assert found["sealed_pinion_teeth"] == pytest.approx(13.0 * span / (2.0 * np.pi))
    land = min(abs(t.land_angle * t.tip_radius) for t in assembly.teeth)
    assert found["tip_land_mm"] == pytest.approx(1e3 * land, rel=1e-3)
    ends = filler_outline(assembly)[[0, 179]]
    thick = 1e3 * np.hypot(*ends.T).min() - 39.5
    assert found["filler_thickness_mm"] == pytest.approx(thick, abs=0.05)
    least = sum(section_areas(s).min() for s in assembly.spaces(360)) * 49.26e-3
    assert found["smallest_chamber_volumes_mm3"] == pytest.approx(1e9 * least)


def test_a_ring_with_very_many_teeth_acts_as_a_rack_does() -> None:
    """A large ring and a large gear tend to the same rack from both sides."""
    pinion = InvoluteGear(13, MODULE, ALPHA, 0.3, tip_diameter=76e-3, tip_rounding=0.05e-3)
    apart = [_differences(pinion, count) for count in (100, 200, 400)]
    for before, after in pairwise(apart):
        assert np.all(after < 0.6 * before)
    assert np.all(apart[-1] < (0.01, 0.05, 0.01))


def _differences(pinion: InvoluteGear, count: int) -> Array:
    """Internal less external mate: working angle [rad], contact ratio [-], flow over its size."""
    large = InvoluteGear(count, MODULE, ALPHA, 0.0, tip_diameter=MODULE * (count + 1.6))
    outer = external_pair(pinion, large, 0.0)
    spaces = InvoluteGear(count, MODULE, ALPHA, 0.0, tip_diameter=MODULE * (count + 2.4))
    inner = pair_from_backlash(pinion, RingGear(spaces, 0.5 * MODULE * (count - 1.6)), 0.0)
    flow = [pair.flow_per_radian(0.02, 0.002) for pair in (inner, outer)]
    return np.abs(
        [
            inner.operating_pressure_angle - outer.operating_pressure_angle,
            inner.contact_ratio - outer.contact_ratio,
            flow[0] / flow[1] - 1.0,
        ]
    )


def test_backlash_is_that_of_the_centre_distance() -> None:
    pair = involute_pair(crescent())
    again = InternalPair(pair.pinion, pair.ring, pair.center_distance)
    assert again.normal_backlash == pytest.approx(100e-6, rel=1e-9)


def test_tips_inside_the_base_circle_are_refused_with_its_diameter() -> None:
    ring = involute_pair(crescent()).ring
    base = 2e3 * ring.space.base_radius
    with pytest.raises(GeometryError) as refused:
        replace(ring, tip_radius=0.9 * ring.space.base_radius)
    (problem,) = refused.value.problems
    assert problem.found == f"{0.9 * base:.5g} mm"
    assert float(problem.allowed.split()[5]) == pytest.approx(base, rel=1e-3)


def test_fouling_tips_and_trimming_are_seen() -> None:
    """With one tooth less between pinion and ring tips foul; the polygons say so as well."""
    good = machine()
    assert good.pair is not None
    assert tip_clearance(good.pair) > 0.0
    assert trimming_distance(good) == 0.0
    assert overlap(good) < 1e-9
    close = crescent(tooth_count=15, tip_diameter=72e-3, root_diameter=90e-3, profile_shift=0.6)
    assert tip_clearance(involute_pair(close)) < 0.0
    with pytest.raises(GeometryError):
        assemble(close)


@pytest.mark.parametrize("count", [19, 20])
def test_tips_pass_each_other_by_how_much_later_the_pinion_crosses(count: int) -> None:
    """Flanks that touch at the pitch point, and the turns after which their tips cross circles."""
    pair = involute_pair(crescent(tooth_count=count))
    turned_by = []
    for gear, radius, ratio, sense in (
        (pair.pinion, pair.pitch_radii[0], 1.0, 1.0),
        (pair.ring, pair.pitch_radii[1], pair.speed_ratio, -1.0),
    ):
        tip = gear.tip_radius
        # where the tip circles cross, from the centre of the ring with that of the pinion on x
        first, second, apart = *pair.tip_radii, pair.center_distance
        x = (second**2 - first**2 + apart**2) / (2.0 * apart)
        y = np.sqrt(second**2 - x**2)
        crossing = np.arctan2(y, x - (apart if ratio == 1.0 else 0.0))
        behind = sense * (gear.half_angle(radius) - gear.half_angle(tip))
        turned_by.append((crossing + behind) / ratio)
    wanted = pair.pinion.tip_radius * (turned_by[0] - turned_by[1])
    assert tip_clearance(pair) == pytest.approx(wanted, rel=1e-9)


def test_a_pinion_that_fouls_on_the_way_in_does_so_over_a_part_of_it() -> None:
    """Twenty teeth of the ring: teeth overlap over an eighth of the way, within one of 24 steps."""
    assembly = assemble(crescent(tooth_count=20))
    way = -assembly.mesh.center_distance
    ring, pinion = assembly.ring_curve, solids(assembly, 0.0)[0]
    fouls = [
        pinion.difference(shapely.Polygon(ring - np.array([0.0, part * way]))).area > 1e-10
        for part in np.linspace(0.0, 1.0, 120, endpoint=False)
    ]
    assert 0.05 < np.mean(fouls) < 0.5
    assert trimming_distance(assembly) == pytest.approx(np.mean(fouls) * way, abs=way / 24)


def test_rules_count_in_working_modules() -> None:
    """Of the working pitch: twice the centre distance over the difference of the tooth counts."""
    found = describe(load_case(CASE))
    checks = {check.name: check.allowed for check in found.checks}
    (fouled,) = (c.value for c in found.checks if c.name == "overlap of the teeth")
    assert fouled == pytest.approx(1e6 * overlap(assemble(load_case(CASE).machine_spec)))
    apart = found.geometry_summary["center_distance_mm"]
    for name, modules in (("root clearance, ring", 0.05), ("tip land, pinion", 0.2)):
        least = float(checks[name].split()[2])
        assert least == pytest.approx(modules * 2.0 * apart / (19 - 13), rel=6e-3)


def test_teeth_that_seal_along_a_helix_are_fewer_by_its_overlap() -> None:
    """160 degrees of filler less 20 mm of notch and the land itself, in pitches."""
    helical = assemble(load_case(CASE, HELIX).machine_spec)
    assert helical.helix is not None
    pinion = helical.teeth[0]
    span = np.radians(160.0) - 20e-3 / pinion.tip_radius - pinion.land_angle
    pitches = 13.0 * span / (2.0 * np.pi)
    assert sealed_teeth(helical, 0) == pytest.approx(pitches - helical.helix.overlap_ratio)


@pytest.mark.parametrize("gear", [0, 1])
def test_recesses_open_and_close_without_jumps(gear: int) -> None:
    """A space passes its recess in some 40 degrees; 5 % of the opening are as many nodes' share."""
    assembly = machine()
    spaces = assembly.spaces(728)[gear]
    for table in groove_openings(spaces, cover_recesses(assembly), 10e-3).values():
        area = table[:, 0]
        assert np.abs(np.diff(area, append=area[:1])).max() < 0.05 * area.max()


def test_ends_of_a_wide_throat_are_the_closest_points() -> None:
    """Flanks far apart have other common normals, too; areas jumped where one of them was taken."""
    assembly = assemble(
        replace(crescent(), pinion=replace(crescent().pinion, normal_backlash=5e-5))
    )
    (pinion, ring), mesh = assembly.teeth, assembly.mesh
    for angle in np.deg2rad(np.linspace(-86.7, -86.4, 13)):
        first = Placement(0.5 * np.pi + angle + mesh.half_pitch, 0.0)
        second = Placement(-0.5 * np.pi - mesh.ratio * angle + mesh.turn, mesh.center_distance)
        search = search_of(pinion.right, ring.right)
        near = closest_points(pinion.right, first, ring.right, second, search)
        count = starting_places(pinion.right, first, ring.right, second, search)
        found = distance(pinion.right, first, ring.right, second, near)
        for start in search.starts[:count]:
            begun = Closest(start[0], start[1], FREE)
            assert found <= distance(pinion.right, first, ring.right, second, begun)
