"""Wear over hours, with stand-ins for the machine, and once with a machine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.study_cases import REPOSITORY, case_with_study
from toothspace import api
from toothspace.case import Case, load_case
from toothspace.closures.wear import cutting_time, wear_depth_rate, worn_time
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.studies import run_study
from toothspace.studies.variation import Limit
from toothspace.studies.wear import WornMachine, crossing

JOURNALS = '[study.journals]\nwear_coefficient = "1e-8 mm^3/(N m)"\nfilm_share = 1.0\n'
K, FORCE, AREA, SPEED = 1e-17, 5e3, 684e-6, 1.5
HOUR = 3600.0
Rubbing = Callable[[Case], Mapping[str, Any]]


@pytest.fixture
def rubs(monkeypatch: pytest.MonkeyPatch) -> list[Rubbing]:
    """What the machine rubs with, as a function that a test puts in."""
    law: list[Rubbing] = []

    def evaluate(self: WornMachine, case: Case) -> Mapping[str, Any]:
        deepest = max((float(d.max()) for d in self.tracks.values()), default=0.0)
        return {
            "volumetric_efficiency": 0.98 - 1e-3 * 1e6 * deepest,
            "overall_efficiency": 0.9,
            "track_depth_um": 1e6 * deepest,
            "rubbing": {"faces": {"power": 0.0, "speed": 2.0}, "tracks": {}} | law[-1](case),
            "status": "done",
        }

    monkeypatch.setattr(WornMachine, "__call__", evaluate)
    return law


def journals(force: float = FORCE, asperity_force: float = 0.0) -> dict[str, Any]:
    one = {"force": force, "asperity_force": asperity_force, "area": AREA, "speed": SPEED}
    return {"journals": {"drive_gear": one}}


def wear_study(tables: str, hours: str = '["100 h", "1000 h"]') -> Case:
    return case_with_study(f'kind = "wear"\nhours = {hours}\n{tables}')


def test_a_steady_load_wears_the_depth_of_archard(rubs: list[Rubbing]) -> None:
    """Worn volume is k times load times way, or k times work of friction over its coefficient."""
    rubs.append(lambda _: journals())
    result = run_study(wear_study(JOURNALS))
    assert result.status is Status.DONE
    depth = 1e-6 * result.data["journal_wear_um"].values
    way = SPEED * 1000.0 * HOUR
    np.testing.assert_allclose(depth[-1] * AREA, K * FORCE * way, rtol=1e-9)
    friction = 0.05
    np.testing.assert_allclose(depth[-1] * AREA, K * (friction * FORCE * way) / friction, rtol=1e-9)
    opened = result.data["journal_clearance_um"].values
    np.testing.assert_allclose(np.diff(opened), np.diff(1e6 * depth), rtol=1e-9)


def test_only_what_touches_wears_without_dirt(rubs: list[Rubbing]) -> None:
    rubs.append(lambda _: journals(asperity_force=50.0))
    bare = JOURNALS.replace("film_share = 1.0", "")
    depth = run_study(wear_study(bare)).data["journal_wear_um"].values[-1]
    expected = wear_depth_rate(K, 50.0 / AREA, SPEED) * 1000.0 * HOUR
    assert depth == pytest.approx(1e6 * expected)


def test_without_coefficients_the_machine_stays_new(rubs: list[Rubbing]) -> None:
    rubs.append(lambda _: journals())
    text = JOURNALS.replace("1e-8", "0") + '[study.casing]\nwear_coefficient = "0 mm^3/(N m)"\n'
    result = run_study(wear_study(text, '["1 h", "1e6 h"]'))
    assert (result.data["journal_wear_um"] == 0.0).all()
    assert (result.data["track_depth_um"] == 0.0).all()
    assert np.ptp(result.data["volumetric_efficiency"].values) == 0.0


def test_break_in_adds_its_excess_once(rubs: list[Rubbing]) -> None:
    rubs.append(lambda _: journals())
    early = '[study.break_in]\nfactor = 5.0\ntime = "50 h"\n'
    depth = run_study(wear_study(JOURNALS + early)).data["journal_wear_um"].values
    steady = run_study(wear_study(JOURNALS)).data["journal_wear_um"].values
    excess = depth - steady
    # four more times the rate over 50 h, all of it after 1000 h
    assert excess[-1] == pytest.approx(steady[-1] * 4.0 * 50.0 / 1000.0, rel=1e-6)
    assert excess[1] == pytest.approx(excess[-1] * (1.0 - math.exp(-2.0)), rel=1e-6)


def test_halving_the_steps_quarters_the_error(rubs: list[Rubbing]) -> None:
    """A load that grows with the worn depth makes it grow as an exponential of the hours."""
    path, growth = "machine.bearing_blocks.radial_clearance", 1.0 / 100e-6

    def load(case: Case) -> Mapping[str, Any]:
        return journals(FORCE * (1.0 + growth * (case.value(path) - new)))

    new = wear_study(JOURNALS).value(path)
    rubs.append(load)
    rate = K * FORCE * SPEED / AREA
    exact = (math.exp(growth * rate * 300.0 * HOUR) - 1.0) / growth
    errors = []
    for count in (10, 20, 40):
        hours = [f"{300.0 * (k + 1) / count:.12g} h" for k in range(count)]
        depth = run_study(wear_study(JOURNALS, str(hours))).data["journal_wear_um"].values[-1]
        errors.append(1e-6 * depth - exact)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.2)


def test_shares_of_a_duty_cycle_wear_as_their_mean(rubs: list[Rubbing]) -> None:
    def load(case: Case) -> Mapping[str, Any]:
        assert case.operating_point is not None
        return journals(FORCE * case.operating_point.inlet_pressure / 100e5)

    rubs.append(load)
    points = [(0.25, 199.0), (0.75, 39.0)]
    duty = ", ".join(
        f'{{share = {share}, shaft_speed = "1000 rpm", pressure_difference = "{high} bar"}}'
        for share, high in points
    )
    result = run_study(wear_study(f"duty = [{duty}]\n{JOURNALS}"))
    assert result.data["volumetric_efficiency"].dims == ("hours", "duty_point")
    expected = wear_depth_rate(K, FORCE * 0.8 / AREA, SPEED) * 1000.0 * HOUR
    assert result.data["journal_wear_um"].values[-1] == pytest.approx(1e6 * expected)


def test_tips_cut_until_nothing_overlaps_and_life_ends_at_a_limit(rubs: list[Rubbing]) -> None:
    path = "machine.bearing_blocks.radial_clearance"
    new = wear_study(JOURNALS).value(path)

    def sink(case: Case) -> Mapping[str, Any]:
        cut = {"stiffness": 2e9, "radius": 20e-3, "width": 7.6e-3, "speed": 3.0}
        overlap = np.maximum(case.value(path) - new - done[-1], 0.0) * np.ones(8)
        done.append(case.value(path) - new)
        return journals() | {"tracks": {"drive_gear": {**cut, "overlap": overlap.tolist()}}}

    done = [0.0]
    rubs.append(sink)
    text = '[study.casing]\nwear_coefficient = "1e-6 mm^3/(N m)"\n'
    limits = "[study.limits]\ntrack_depth_um = {high = 0.2}\nvolumetric_efficiency = {low = 0.5}\n"
    result = run_study(wear_study(JOURNALS + text + limits))
    depth = result.data["journal_wear_um"].values
    np.testing.assert_allclose(result.data["track_depth_um"].values, depth, rtol=1e-6)
    assert result.numbers["life_ended_by"] == "track_depth_um"
    assert result.numbers["life_h"] == pytest.approx(1000.0 * 0.2 / depth[-1], rel=1e-6)


def test_first_crossing_of_a_limit() -> None:
    hours, values = [0.0, 10.0, 30.0], np.array([1.0, 0.9, 0.7])
    assert crossing(hours, values, Limit(low=0.8)) == pytest.approx(20.0)
    assert crossing(hours, values, Limit(low=0.6)) == math.inf
    assert crossing(hours, values, Limit(low=1.1)) == 0.0


def test_pressure_of_the_overlap_balances_the_bearings() -> None:
    """Depth by k p v over the track, with p as the overlap, fades by 1/e in the cutting time."""
    k, stiffness, radius, width, speed, shift = 1e-15, 2e9, 20e-3, 7.6e-3, 3.2, 1e-6
    angle = np.linspace(-np.pi / 2, np.pi / 2, 2001)
    shape = shift * np.cos(angle)
    scale = stiffness * shift / np.trapezoid(shape * np.cos(angle) * radius * width, angle)
    rate = wear_depth_rate(k, scale * shape, speed)
    np.testing.assert_allclose(
        rate, shape / cutting_time(k, stiffness, radius, width, speed), rtol=1e-6
    )
    assert cutting_time(0.0, stiffness, radius, width, speed) == math.inf


def test_worn_time_begins_at_the_break_in_rate() -> None:
    assert worn_time(1e-3, 5.0, 100.0) == pytest.approx(5e-3, rel=1e-4)
    assert worn_time(1e6, 5.0, 100.0) == pytest.approx(1e6 + 400.0)


@pytest.mark.parametrize(
    ("text", "hours", "told"),
    [
        ("", '["1 h"]', "nothing that wears"),
        (JOURNALS, '["2 h", "1 h"]', "hours that rise"),
        (
            'duty = [{share = 0.5, shaft_speed = "1000 rpm", pressure_difference = "9 bar"}]\n'
            + JOURNALS,
            '["1 h"]',
            "shares that sum to 1",
        ),
    ],
)
def test_studies_that_are_refused(text: str, hours: str, told: str) -> None:
    with pytest.raises(CaseError, match=told):
        wear_study(text, hours)


def test_limits_of_no_number_and_machines_that_do_not_wear(rubs: list[Rubbing]) -> None:
    rubs.append(lambda _: journals())
    with pytest.raises(CaseError, match=r"study\.limits\.flow: .*track_depth_um"):
        run_study(wear_study(JOURNALS + "[study.limits]\nflow = {low = 1}\n"))
    gerotor = case_with_study(f'kind = "wear"\nhours = ["1 h"]\n{JOURNALS}', "gerotor_trochoidal")
    with pytest.raises(CaseError, match="'gerotor'"):
        run_study(gerotor)


@pytest.mark.slow
def test_a_worn_pump_has_tips_that_just_touch(tmp_path: Path) -> None:
    """Bushes sink, the track follows, faces open the gap that leaks; the numbers are a run's."""
    case = load_case(REPOSITORY / "cases" / "wear_egm12_pump.toml").replace(
        {
            "study.hours": ["500 h", "2000 h"],
            "study.faces.opening": 0.1,
            "run.samples_per_revolution": 360,
        }
    )
    result = run_study(case, tmp_path)
    data = result.data
    assert result.status is Status.DONE
    # gears lie a micrometre from the bore when new: the track is what the bushes lost, less that
    sunk = data["journal_wear_um"].values - data["track_depth_um"].values
    assert (np.diff(data["track_depth_um"].values) > 0.0).all()
    assert 2.0 < sunk[-1] < 5.0
    lost = data["leakage_lateral_L_per_min"].values[:, 0]
    gap = data["side_gap_um"].values
    assert lost[-1] / lost[0] == pytest.approx((gap[-1] / gap[0]) ** 3, rel=0.3)
    new = case.at_point({})
    assert float(data["volumetric_efficiency"][0, 0]) == pytest.approx(
        api.simulate(new).summary()["volumetric_efficiency"], rel=1e-6
    )
    again = run_study(case, tmp_path, resume=True)
    np.testing.assert_array_equal(again.data["track_depth_um"], data["track_depth_um"])
