"""Relief grooves whose edges lean: outlines, the same from keys and from a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from tests.external_gear_designs import egm12
from toothspace import api
from toothspace.core.errors import CaseError
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.openings import groove_openings
from toothspace.gearing.spaces import section_areas
from toothspace.machines.external_gear.assembly import assemble

PITCH_POINT = 17e-3
ANGLES = {"closing_side_angle": np.deg2rad(12.0), "opening_side_angle": np.deg2rad(-20.0)}
KEYS = "machine.relief_grooves"


def test_an_edge_leans_about_the_height_of_the_pitch_point() -> None:
    straight = ReliefGrooves(closing_side_offset=3.6e-3, opening_side_offset=3.2e-3)
    leaning = ReliefGrooves(closing_side_offset=3.6e-3, opening_side_offset=3.2e-3, **ANGLES)
    for port, sign, offset, angle in (
        ("outlet", 1.0, 3.6e-3, ANGLES["closing_side_angle"]),
        ("inlet", -1.0, 3.2e-3, ANGLES["opening_side_angle"]),
    ):
        box, found = straight.outlines(PITCH_POINT)[port], leaning.outlines(PITCH_POINT)[port]
        low, high = sign * found[0, 0], sign * found[3, 0]
        assert 0.5 * (low + high) == pytest.approx(offset)
        assert (high - low) / np.ptp(found[:, 1]) == pytest.approx(np.tan(angle))
        # what the edge gains on one side of the pitch point it loses on the other
        areas = [shapely.Polygon(one).area for one in (box, found)]
        assert areas[1] == pytest.approx(areas[0], rel=1e-12)


def test_an_edge_bows_through_three_points() -> None:
    """Ends and middle are where the keys say; the bow takes a triangle from the groove."""
    keys = {"closing_side_offset": 3.6e-3, "opening_side_offset": 3.2e-3, "radial_extent": 8e-3}
    leaning = ReliefGrooves(**keys, **ANGLES)
    bowed = ReliefGrooves(**keys, **ANGLES, closing_side_bow=0.4e-3, opening_side_bow=-0.3e-3)
    for port, sign, offset, angle, bow in (
        ("outlet", 1.0, 3.6e-3, ANGLES["closing_side_angle"], 0.4e-3),
        ("inlet", -1.0, 3.2e-3, ANGLES["opening_side_angle"], -0.3e-3),
    ):
        found = bowed.outlines(PITCH_POINT)[port]
        for y, beyond in ((-4e-3, bow), (0.0, 0.0), (4e-3, bow)):
            line = shapely.LineString([(0.0, PITCH_POINT + y), (sign * 8e-3, PITCH_POINT + y)])
            edge = line.intersection(shapely.Polygon(found).buffer(1e-9))
            near = edge.bounds[0] if sign > 0.0 else edge.bounds[2]
            # an angle counts from drive to driven gear on both sides
            assert abs(near) == pytest.approx(offset + beyond + y * np.tan(angle), abs=2e-8)
        areas = [shapely.Polygon(g.outlines(PITCH_POINT)[port]).area for g in (leaning, bowed)]
        assert areas[0] - areas[1] == pytest.approx(0.5 * bow * 8e-3, rel=1e-9)


@pytest.mark.slow
def test_keys_and_a_file_of_the_same_outline_give_the_same_openings(tmp_path: Path) -> None:
    case = api.load_case("egm12_pump")
    keys = {f"{KEYS}.{name}": f"{np.rad2deg(x)} deg" for name, x in ANGLES.items()}
    leaning = case.replace({**keys, f"{KEYS}.closing_side_bow": "0.3 mm"})
    grooves = leaning.machine.relief_grooves.grooves()
    pitch_point = 0.5 * api.describe(leaning).geometry_summary["center_distance_mm"] * 1e-3
    file = tmp_path / "grooves.txt"
    loops = [1e3 * np.vstack([one, one[:1]]) for one in grooves.outlines(pitch_point).values()]
    file.write_text("\n\n".join("\n".join(f"{x} {y}" for x, y in one) for one in loops))
    drawn = case.replace({f"{KEYS}.contour": str(file)})
    areas = [
        {
            path.name: path.geometry.values[:, 0]
            for path in api.describe(one).paths
            if "groove" in path.name
        }
        for one in (leaning, drawn, case)
    ]
    assert areas[0]
    for name, area in areas[0].items():
        np.testing.assert_allclose(area, areas[1][name], atol=1e-12)
    assert any(np.max(np.abs(areas[0][name] - areas[2][name])) > 1e-7 for name in areas[0])


def test_an_edge_stays_within_its_groove() -> None:
    case = api.load_case("egm12_pump").replace({f"{KEYS}.width": "2 mm"})
    said = r"closing_side_angle: found 30 deg, with which the edge leaves the groove, allowed less"
    with pytest.raises(CaseError, match=said):
        case.replace({f"{KEYS}.closing_side_angle": "30 deg"})
    extent = case.machine.relief_grooves.radial_extent
    steepest = np.rad2deg(np.arctan(2e-3 / (0.5 * extent)))
    inside = case.replace({f"{KEYS}.closing_side_angle": f"{0.99 * steepest} deg"})
    assert inside.machine.relief_grooves.closing_side_angle > 0.0
    with pytest.raises(CaseError, match=said.split(":")[0]):
        case.replace({f"{KEYS}.closing_side_angle": f"{1.01 * steepest} deg"})
    with pytest.raises(CaseError, match=f"allowed less than {steepest:.3g} deg"):
        case.replace({f"{KEYS}.closing_side_angle": "30 deg"})
    said = r"opening_side_bow: found 2\.5 mm, with which the edge leaves the groove, allowed less"
    with pytest.raises(CaseError, match=f"{said} than 2 mm"):
        case.replace({f"{KEYS}.opening_side_bow": "2.5 mm"})
    # an edge that leans by 0.5 mm leaves 1.5 mm for the bow
    lean = {f"{KEYS}.opening_side_angle": f"{np.rad2deg(np.arctan(1e-3 / extent))} deg"}
    with pytest.raises(CaseError, match=r"allowed less than 1\.5 mm with this width and angle"):
        case.replace(lean | {f"{KEYS}.opening_side_bow": "1.6 mm"})
    assert case.replace(lean | {f"{KEYS}.opening_side_bow": "1.4 mm"})


def test_a_recess_round_all_spaces_opens_each_whole() -> None:
    """Deep as it is, the area is that of the space; no shape has more area for its perimeter."""
    spaces = assemble(egm12("pump")).spaces(72)[0]
    around = spaces.center + 0.1 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    area, diameter = groove_openings(spaces, {"all": around}, depth=10.0)["all"].T
    near = area > 0.0
    assert np.mean(near) > 0.9
    area, diameter = area[near], diameter[near]
    np.testing.assert_allclose(area, section_areas(spaces)[near], rtol=1e-3)
    circle = np.sqrt(4.0 * area / np.pi)
    assert np.all(diameter < circle)
    assert np.all(diameter > 0.3 * circle)
