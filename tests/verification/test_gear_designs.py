"""Closed forms over arrays of gears against single pairs, polygons and the tables of a run."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
from tests.reference_formulas.trapped_area import trapped_area
from toothspace import api
from toothspace.advice.gear_rules import pair_checks
from toothspace.core.types import Array
from toothspace.geometry.curve import signed_area
from toothspace.geometry.evaluated_designs import REASON_TEXTS, DesignReason
from toothspace.geometry.gear_pair import GearPair, flank_clearance, pair_from_backlash
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.geometry.involute_gear import InvoluteGears
from toothspace.machines.external_gear.designs import GearDesigns, distance_of_backlash

WIDTH = 1e-2
SHAPE = DesignReason.FILLET | DesignReason.TIP | DesignReason.NO_INVOLUTE | DesignReason.NO_MESH
RULES = {
    "contact ratio": "CONTACT_RATIO",
    "tip land": "TIP_LAND",
    "undercut": "UNDERCUT",
    "fillet interference": "INTERFERENCE",
    "root clearance": "ROOT_CLEARANCE",
    "normal backlash": "BACKLASH",
    "trapped volume change": "TRAPPED_VOLUME",
}


class RandomPairs:
    """Pairs of unequal gears, many of them impossible, as arrays and one by one."""

    def __init__(self, count: int, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.module, self.angle = rng.uniform(2e-3, 4e-3, count), rng.uniform(0.2, 0.5, count)
        self.backlash = rng.uniform(0.0, 0.13, count) * self.module
        self.dedendum = rng.uniform(1.0, 1.45, count)
        self.teeth = [self._teeth(rng, count) for _ in range(2)]

    def _teeth(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        teeth, shift = rng.integers(6, 20, count), rng.uniform(-0.8, 0.9, count)
        height = teeth + 2.0 * (shift + rng.uniform(0.9, 1.25, count))
        rounding = rng.uniform(0.0, 0.15e-3, count) * (rng.random(count) < 0.7)
        return {
            "tooth_count": teeth,
            "module": self.module,
            "pressure_angle": self.angle,
            "profile_shift": shift,
            "tip_diameter": self.module * height,
            "dedendum": self.dedendum,
            "tip_rounding": rounding,
        }

    def designs(self) -> GearDesigns:
        default = np.full(self.module.shape, np.nan)
        drive, driven = (InvoluteGears(**g, tool_tip_radius=default) for g in self.teeth)
        distance = distance_of_backlash(drive, driven, self.backlash)
        return GearDesigns(drive, driven, distance, np.full(self.module.shape, WIDTH))

    def gears(self, index: int) -> list[InvoluteGear]:
        return [
            InvoluteGear(**{name: values[index].item() for name, values in teeth.items()})
            for teeth in self.teeth
        ]

    def pair(self, index: int) -> GearPair:
        drive, driven = self.gears(index)
        return pair_from_backlash(drive, driven, self.backlash[index])


def test_designs_are_those_of_single_pairs_and_refused_where_they_are() -> None:
    pairs = RandomPairs(350, 7)
    with np.errstate(all="ignore"):
        found = pairs.designs().evaluated()
    outcomes: Counter[bool] = Counter()
    for index, valid in enumerate(found.valid):
        pair = pair_or_none(pairs, index)
        turns = pair is not None and pair.contact_ratio >= 1.0
        assert valid == turns, f"{index}: {found.why(index)}"
        if pair is not None and turns:
            for name, value in numbers_of(pair).items():
                assert found[name][index] == pytest.approx(value, rel=1e-11), (index, name)
            assert int(found.reasons[index]) == broken_rules(pair), index
        else:
            assert np.isnan(found["displacement_cm3_per_rev"][index])
            assert found.why(index)
        outcomes[bool(valid)] += 1
    assert min(outcomes.values()) > 50
    missing = {reason for reason in DesignReason if not np.any(found.reasons & int(reason))}
    assert missing == {
        DesignReason.OUT_OF_RANGE,
        DesignReason.TOOL_TIP,
        DesignReason.ROOT_CIRCLE,
        DesignReason.BASE_PITCH,
        DesignReason.OVERLAP,
        # of continuous contact
        DesignReason.CONTINUOUS,
        DesignReason.OVERLAP_RULE,
        DesignReason.CURVATURE_RULE,
    }


def pair_or_none(pairs: RandomPairs, index: int) -> GearPair | None:
    try:
        return pairs.pair(index)
    except ts.GeometryError:
        return None


def broken_rules(pair: GearPair) -> DesignReason:
    found = DesignReason(0)
    for check in pair_checks(pair, WIDTH):
        if not check.passed:
            found |= DesignReason[f"{RULES[check.name.partition(',')[0]]}_RULE"]
    return found


def numbers_of(pair: GearPair) -> dict[str, float]:
    lands = zip(pair.forms, (pair.drive, pair.driven), strict=True)
    return {
        "displacement_cm3_per_rev": pair.displacement_per_radian(WIDTH) * 2e6 * np.pi,
        "flow_ripple_percent": 100.0 * pair.flow_ripple(),
        "flow_ripple_dual_percent": 100.0 * pair.flow_ripple("dual"),
        "contact_ratio": pair.contact_ratio,
        "tip_land_mm": 1e3 * min(form.tip_land_angle * gear.tip_radius for form, gear in lands),
        "root_clearance_mm": 1e3 * min(pair.root_clearances),
        "center_distance_mm": 1e3 * pair.center_distance,
        "operating_pressure_angle_deg": np.rad2deg(pair.operating_pressure_angle),
    }


def test_tips_clear_fillets_where_polygons_do() -> None:
    """Polygons of 1000 points on a tooth and 641 angles miss overlaps of some micrometres."""
    pairs = RandomPairs(60, 0)
    with np.errstate(all="ignore"):
        designs = pairs.designs()
        deep = np.minimum(*designs.involute_margins) < 0.0
        single = np.flatnonzero(deep & (designs.reasons() & SHAPE == 0))[:6]
    gears = designs.drive.chosen(single), designs.driven.chosen(single)
    distance = designs.center_distance[single]
    plays = np.minimum(
        gears[0].fillet_play(gears[1], distance), gears[1].fillet_play(gears[0], distance)
    )
    assert np.any(plays < -1e-5)
    for index, play in zip(single, plays, strict=True):
        profiles = [generate_profile(gear, 1000) for gear in pairs.gears(int(index))]
        found = flank_clearance(*profiles, designs.center_distance[index], 641)
        outcomes = play < -5e-6, found < -5e-6
        assert outcomes[0] == outcomes[1] or abs(play - found) < 1e-5


def test_areas_of_teeth_and_mesh_are_those_of_polygons() -> None:
    """The polygon of a profile loses a share of the square of its point distance."""
    pairs = RandomPairs(80, 5)
    with np.errstate(all="ignore"):
        designs = pairs.designs()
        valid, dead = designs.evaluated().valid, designs.trapped_volumes[1]
    checked = 0
    for index in np.flatnonzero(valid)[:8]:
        pair = pairs.pair(int(index))
        profiles = [generate_profile(gear, 1000) for gear in (pair.drive, pair.driven)]
        for gears, profile in zip((designs.drive, designs.driven), profiles, strict=True):
            area = signed_area(profile.closed_polygon(0.0)) / profile.tooth_count
            assert gears.tooth_area[index] == pytest.approx(area, rel=1e-5)
        start, end = pair.path_of_contact
        half = 0.5 * pair.base_pitch
        area = trapped_area(pair, *profiles, float(np.clip(0.0, start + half, end - half)))
        assert dead[index] == pytest.approx(area * WIDTH, rel=1e-4)
        checked += 1
    assert checked == 8


@pytest.mark.parametrize("name", ["egm12_pump", "egm12_motor", "fuel14_pump"])
def test_numbers_agree_with_the_tables_of_a_run(name: str) -> None:
    """Tables with 720 angles hold areas between their nodes to 5e-4."""
    case = ts.load_case(name)
    summary = api.describe(case).geometry_summary
    found = ts.evaluate_designs(case, {"machine.gears.module": case.machine.gears.module})
    assert found.keeps_rules.item()
    for number in set(found) & set(summary):
        rel = 5e-4 if "volume" in number else 1e-9
        assert found[number].item() == pytest.approx(summary[number], rel=rel), number


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_unequal_gears_agree_with_the_tables_of_a_run(mode: str) -> None:
    """The second contact of a motor begins at the other end of the path."""
    case = ts.load_case(f"egm12_{mode}").replace(
        {
            "machine.driven_gear.profile_shift": 0.2,
            "machine.driven_gear.tip_diameter": "39.6 mm",
            "machine.gears.normal_backlash": "0.12 mm",
        }
    )
    summary = api.describe(case).geometry_summary
    found = ts.evaluate_designs(case, {"machine.gears.face_width": case.machine.gears.face_width})
    for number in ("trapped_volume_mm3", "dead_volume_mm3"):
        assert found[number].item() == pytest.approx(summary[number], rel=1e-3)


@pytest.mark.parametrize("rounding", ["0 mm", "0.1 mm"])
def test_tips_close_to_the_roots_mesh_on_their_flanks(rounding: str) -> None:
    """A root clearance of 2 um, far less than the backlash, is no contact of flanks."""
    case = ts.load_case("egm12_pump")
    room = ts.describe(case).geometry_summary["root_clearance_mm"]
    tip = 1e3 * case.machine.gears.tip_diameter + 2.0 * (room - 2e-3)
    given = {"machine.gears.tip_diameter": f"{tip} mm", "machine.gears.tip_rounding": rounding}
    found = ts.evaluate_designs(case, {"machine.gears.tip_diameter": [f"{tip} mm"]})
    assert found.valid.item()
    summary = ts.describe(case.replace(given)).geometry_summary
    assert summary["root_clearance_mm"] == pytest.approx(2e-3, abs=1e-9)
    assert summary["normal_backlash_mm"] == pytest.approx(found["normal_backlash_mm"].item())


def test_undercut_begins_at_the_known_profile_shift() -> None:
    limit = InvoluteGear(9, 3e-3, tool_tip_radius=0.38).smallest_shift_without_undercut
    found = ts.evaluate_designs(
        "egm12_pump",
        {
            "machine.gears.tooth_count": 9,
            "machine.gears.pressure_angle": "20 deg",
            "machine.gears.profile_shift": [limit - 1e-6, limit + 1e-6],
        },
        addendum=1.0,
    )
    assert (found.reasons & DesignReason.UNDERCUT_RULE != 0).tolist() == [True, False]
    # the involute that is lost there is infinitely short
    assert found["contact_ratio"][0] == pytest.approx(found["contact_ratio"][1], rel=1e-4)


def test_shapes_units_and_the_chosen_face_width() -> None:
    modules = ts.Quantity(2.5, "mm"), ts.Quantity(3.0, "mm")
    found = ts.evaluate_designs(
        "egm12_pump",
        {
            "machine.gears.module": [[one] for one in modules],
            "machine.gears.tooth_count": [11, 12, 13],
            "machine.gears.tip_rounding": 0.1e-3,
        },
        addendum=1.0,
        displacement="4.95 cm^3/rev",
    )
    assert found["contact_ratio"].shape == (2, 3)
    np.testing.assert_allclose(found["displacement_cm3_per_rev"], 4.95)
    assert np.all(np.diff(found["face_width_mm"], axis=0) < 0.0)
    assert found.to_dataset()["contact_ratio"].shape == (2, 3)


def test_values_outside_their_range_are_marked_and_wrong_keys_refused(tmp_path: Path) -> None:
    found = ts.evaluate_designs("egm12_pump", {"machine.gears.tooth_count": [12, 4, 12.5]})
    assert found.valid.tolist() == [True, False, False]
    assert found.why(1)[0] == REASON_TEXTS[DesignReason.OUT_OF_RANGE]
    with pytest.raises(ts.CaseError, match=r"machine\.casing\.radial_clearance.*gears\.module"):
        ts.evaluate_designs("egm12_pump", {"machine.casing.radial_clearance": ["20 um"]})
    with pytest.raises(ts.CaseError, match="gears given by parameters"):
        ts.evaluate_designs("egm12_motor_profile", {"machine.gears.face_width": ["9 mm"]})
    with pytest.raises(ts.CaseError, match=r"machine\.type"):
        ts.evaluate_designs("gerotor_trochoidal", {"machine.gears.face_width": ["9 mm"]})
