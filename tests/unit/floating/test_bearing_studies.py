"""Studies of a floating bearing over balanced area, speed and pressure, and measured positions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from tests.lateral_stack import conditions, loads, pressures, ring_stack
from toothspace.case import load_case
from toothspace.closures.contact_rough import real_contact_share
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.floating.coupling import CoupledPoint
from toothspace.floating.housing_friction import BREAKAWAY_RATIO
from toothspace.floating.motion import balance_force
from toothspace.floating.problem import (
    LateralProblem,
    LateralSettings,
    numbers_of,
    wear_map,
)
from toothspace.model.film_faces import FilmFace
from toothspace.model.floating_bearing import HousingContact
from toothspace.plotting.catalogue import FIGURES
from toothspace.plotting.film_maps import lateral_films
from toothspace.report.page import quantity
from toothspace.report.study import study_report_html
from toothspace.studies import balance_sweep, bearing_path, study_figures
from toothspace.studies.balance_sweep import GAPS, BalanceSweepStudy, FilmTable, claims, follow
from toothspace.studies.bearing_path import BearingMapStudy, HysteresisStudy, friction_curves
from toothspace.studies.bearing_points import stored_point
from toothspace.studies.study import StudyContext

CASES = Path(__file__).parents[3] / "cases"
STIFF = 2e-3
"""Opening force times gap of the made-up film. [N m]"""
NORMAL = 1000.0


def _table(pressure: float) -> FilmTable:
    """Film whose force is STIFF / gap plus 1 mm2 times the pressure."""
    fine = np.geomspace(GAPS[0], GAPS[-1], 6000)
    numbers = {
        name: 1e6 * GAPS
        for name in (
            "film_height_um", "smallest_film_um", "contact_force_N", "wear_power_W_per_mm2",
            "leakage_L_per_min", "torque_loss_N_m",
        )
    }  # fmt: skip
    return FilmTable(pressure, pressure, STIFF / fine + 1e-6 * pressure, NORMAL, numbers, 1e-3)


def test_bearing_without_friction_stands_where_forces_balance() -> None:
    """STIFF / gap = (area - 1 mm2) p, solved by hand."""
    table, area, pressure = _table(1e6), 1.5e-3, 1e6
    gap = follow([table], [0], (area, 0.0), 5e-6)[0]
    assert gap == pytest.approx(STIFF / ((area - 1e-6) * pressure), rel=2e-3)


def test_friction_holds_below_breakaway_and_slides_to_its_coulomb_force() -> None:
    table, pressure, mu = _table(1e6), 1e6, 0.1
    coulomb = mu * NORMAL
    held = STIFF / 4e-6 + 1.0 + 0.9 * BREAKAWAY_RATIO * coulomb
    assert follow([table], [0], (held / pressure, mu), 4e-6)[0] == 4e-6
    pushed = STIFF / 4e-6 + 1.0 + 1.1 * BREAKAWAY_RATIO * coulomb
    gap = follow([table], [0], (pushed / pressure, mu), 4e-6)[0]
    assert STIFF / gap + 1.0 == pytest.approx(pushed - coulomb, rel=2e-3)


def test_claims_tell_loops_apart() -> None:
    um = 1e-6
    assert claims(np.array([1, 2, 3, 2.5, 1.5]) * um, 10 * um) == (True, True, True)
    assert claims(np.array([1, 2, 3, 2, 1]) * um, 10 * um) == (True, False, True)
    assert claims(np.array([3, 2, 12, 2.5, 3.5]) * um, 10 * um) == (False, True, False)


def _sweep(monkeypatch: pytest.MonkeyPatch, **changes: Any) -> Any:
    case = load_case(CASES / "balance_sweep.toml")
    assert isinstance(case.study, BalanceSweepStudy)
    study = replace(case.study, balance_ratio=(1.2, 1.5, 2.0), friction_coefficient=(0.05, 0.0))
    study = replace(study, **changes)
    levels = sorted(set(study.outlet_pressures))
    tables = tuple(_table(level) for level in levels)
    monkeypatch.setattr(balance_sweep, "film_tables", lambda *_: tables)
    return balance_sweep.run(replace(case, study=study), StudyContext())


@pytest.mark.slow
def test_balance_sweep_gives_gaps_claims_and_figures(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    result = _sweep(monkeypatch)
    assert result.data["gap_um"].dims == ("friction_coefficient", "balance_ratio", "point")
    assert result.numbers["plane_area_mm2"] == pytest.approx(1000.0)
    free = result.data["gap_um"].values[1]
    assert free[:, :3] == pytest.approx(free[:, -1:-4:-1], rel=1e-9)  # no friction, no memory
    # this film closes under pressure, so friction keeps it closer on the way down
    areas = result.data["loop_area_um_bar"].values
    assert areas[0].max() < 0.0
    assert areas[1] == pytest.approx(0.0, abs=1e-9)
    assert np.all(np.diff(free, axis=0) <= 0.0)  # more area, smaller gap
    assert len(result.tables[0].rows) == 6
    other = _sweep(monkeypatch, reference_area=1.2e-3)
    assert other.data["balanced_area_mm2"].values == pytest.approx([1440.0, 1800.0, 2400.0])
    assert len(study_figures("balance_sweep", result.data)) == 4
    page = study_report_html(replace(result, kind="balance_sweep"))
    assert page.count("<svg") >= 4
    result.save(tmp_path)


def test_spring_that_holds_a_bearing_pulls_with_what_films_and_back_leave() -> None:
    """None where the bearing rests freely; further off the films push less."""
    coupled = _coupled()
    problem, stack, q = coupled.problem, coupled.problem.stack, coupled.equilibrium.balance.position
    left = []
    for lift in float(stack.opening @ q) + np.array([-0.2e-6, 0.0, 0.2e-6]):
        held = problem.held_at(float(lift))
        found = held.settle(held.started(0.8e-6))
        assert found.settled
        spring, own = held.stack.holding_spring, found.balance
        assert spring is not None
        back = problem.loads.back
        left.append(np.mean([(s.film_force() + s.back_force(back))[0] for s in own.states]))
        pull = spring.stiffness * (float(stack.opening @ own.position) - spring.opening)
        assert left[-1] == pytest.approx(pull, abs=1e-6 * balance_force(stack, back))
    assert abs(left[1]) < 1e-5 * balance_force(stack, back)
    assert left[0] > 100.0 * abs(left[1])
    assert left[2] < -100.0 * abs(left[1])


def test_bearing_map_numbers_and_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_case(CASES / "bearing_map.toml")
    assert isinstance(case.study, BearingMapStudy)

    names = [name for name in bearing_path.point_numbers(_coupled()) if name != "status"]

    def numbers(own: bearing_path.BearingNumbers, one: Any) -> dict[str, Any]:
        assert own.start_gap == pytest.approx(2e-6)
        point = one.operating_point
        film = point.shaft_speed / (1.0 + 1e-5 * point.outlet_pressure)
        return {**dict.fromkeys(names, film), "status": "done"}

    monkeypatch.setattr(bearing_path.BearingNumbers, "__call__", numbers)
    result = bearing_path.run(case, StudyContext())
    assert result.status is Status.DONE
    assert result.data["smallest_film_um"].shape == (4, 4)
    speed, pressure = result.data["shaft_speed"].values[2], result.data["outlet_pressure"].values[3]
    expected = speed / (1.0 + 1e-5 * pressure)
    assert float(result.data["contact_force_N"][2, 3]) == pytest.approx(expected, rel=1e-6)
    assert len(result.tables[0].rows) == 16
    assert [f.name for f in study_figures("bearing_map", result.data)] == ["bearing_map"]


def _coupled() -> CoupledPoint:
    stack = ring_stack(approach=3e-13, high_share=0.68, preload=400.0, cells=(12, 8))
    snapshots = tuple(stack.snapshot(angle, pressures(20e5)) for angle in (0.0, 0.3))
    problem = LateralProblem(
        stack, snapshots, loads(20e5), lambda _: pressures(20e5), LateralSettings()
    )
    settled = problem.settle(problem.started(0.8e-6))
    solution = cast(Any, SimpleNamespace(status=Status.DONE))
    numbers = numbers_of(problem, settled.balance)
    return CoupledPoint(
        problem=problem,
        equilibrium=settled,
        numbers=numbers,
        solution=solution,
        description=cast(Any, None),
        leakage_mismatch=0.0,
    )


def test_wear_map_is_the_mean_of_asperity_pressure_times_speed() -> None:
    balance = _coupled().equilibrium.balance
    found = wear_map([balance, balance])
    films = [state.films[0] for state in balance.states]
    grid = films[0].grid
    speed = balance.states[0].stack.shaft_speed * grid.radius
    assert found[0] == pytest.approx(np.mean([f.contact for f in films], axis=0) * speed)
    assert found.max() > 0.0


def test_films_of_a_run_are_drawn_on_both_sides() -> None:
    study = bearing_path.LateralStudy(conditions(20e5), (stored_point(_coupled()),))
    one = study.dataset().isel(point=0)
    figure = lateral_films(cast(Any, SimpleNamespace(data=one)))
    maps = [axes for axes in figure.axes if axes.collections and axes.get_xlabel() == ""]
    assert len(maps) >= 8
    assert {axes.get_ylabel() for axes in figure.axes} >= {"Floating side", "Solid side"}
    entry = next(entry for entry in FIGURES if entry.name == "lateral_films")
    assert all(name in one or name in one.coords for name in entry.needs)


def _rough(face: FilmFace) -> FilmFace:
    assert face.surfaces is not None
    rough = replace(face.surfaces, moving_roughness=3e-7, resting_roughness=3e-7)
    return replace(face, surfaces=rough)


def test_real_contact_area_follows_the_asperity_pressure() -> None:
    """Plastic spots carry 0.96 of the hardness; rings of the tests have smooth interfaces."""
    point = _coupled()
    assert point.numbers.contact_force > 0.0
    assert point.numbers.real_contact_area == 0.0
    grids = [
        replace(g, interface=replace(g.interface, face=_rough(g.interface.face)))
        for g in point.problem.stack.grids
    ]
    states = [
        replace(s, films=tuple(replace(f, grid=g) for f, g in zip(s.films, grids, strict=True)))
        for s in point.equilibrium.balance.states
    ]
    numbers = numbers_of(point.problem, replace(point.equilibrium.balance, states=tuple(states)))
    expected = numbers.contact_force / 0.96e9
    assert numbers.real_contact_area == pytest.approx(expected, rel=1e-12)


def test_real_contact_share_is_that_of_the_boundary_element_solution() -> None:
    """Elastic solutions (pressure and share) of periodic Gaussian surfaces of 256 x 256 points."""
    pressure = np.array([1.49e-3, 6.58e-3, 2.40e-2, 5.74e-2, 1.62e-1])
    solved = np.array([0.0066, 0.0306, 0.1046, 0.235, 0.546])
    found = real_contact_share(pressure, 2.0 / np.pi, 1.0, 1.0, 1e9)
    assert found == pytest.approx(solved, rel=0.08)
    soft = real_contact_share(pressure, 2.0 / np.pi, 1.0, 1.0, 0.1)
    assert soft == pytest.approx(np.minimum(pressure / 0.096, 1.0))


def test_measured_positions_are_corrected_for_the_sensor(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    path.write_text(
        "operating_point.outlet_pressure [bar], relative_position_um [um]\n20, 5\n40, 5.5\n20, 5.2",
        encoding="utf-8",
    )
    beside = bearing_path.overlay(bearing_path.read_positions(path), 0.01e-6 / 1e5)
    assert beside["measured_outlet_pressure_bar"].values == pytest.approx([20, 40, 20])
    # relative to the first row, and the sensor moved away by 0.01 um/bar
    assert beside["measured_relative_position_um"].values == pytest.approx([0.0, 0.7, 0.2])


def test_measured_positions_of_other_columns_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    path.write_text("operating_point.outlet_pressure [bar], mean_torque_N_m [N m]\n20, 5\n")
    with pytest.raises(CaseError, match="allowed operating_point"):
        bearing_path.read_positions(path)


def test_loop_shows_measured_positions(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    case = load_case(CASES / "hysteresis_055.toml")
    assert isinstance(case.study, HysteresisStudy)
    path = tmp_path / "bench.csv"
    rows = "\n".join(f"{p}, {x}" for p, x in zip((20, 40, 20), (0, 1, 0.5), strict=True))
    path.write_text(f"operating_point.outlet_pressure [bar], relative_position_um [um]\n{rows}\n")
    point = stored_point(_coupled())
    study = bearing_path.LateralStudy(conditions(20e5, 40e5, 20e5), (point,) * 3)
    monkeypatch.setattr(bearing_path, "solve_path", lambda *_: study)
    case = replace(case, study=replace(case.study, measured=path))
    result = bearing_path.run(case, StudyContext())
    assert result.numbers["deviation_um"] == pytest.approx([0.0, -1.0, -0.5])
    assert result.numbers["rms_deviation_um"] == pytest.approx(np.sqrt(1.25 / 3.0))
    assert isinstance(result.data, xr.Dataset)
    names = [figure.name for figure in study_figures("hysteresis", result.data)]
    assert names == ["positions", "contact", "film_height", "wear"]


def test_friction_curves_peak_at_their_breakaway_speed() -> None:
    """Peaks of 2.5 times the Coulomb force of every coefficient, at every breakaway speed."""
    contact = HousingContact(friction_coefficient=0.008, breakaway_speed=6.45e-3)
    curves = friction_curves(contact, 250.0)
    force = curves["friction_curve_force_N"].values
    velocity = curves["bearing_velocity_mm_per_s"].values
    coefficient = curves["friction_curve_coefficient"].values
    # the hyperbolic tangent at a tenth of the speed adds the Coulomb force to the peak
    assert force.max(axis=1) == pytest.approx(250.0 * coefficient / 0.008, rel=5e-3)
    peaks = curves["friction_curve_breakaway_speed_mm_per_s"].values
    assert velocity[np.argmax(force, axis=1)] == pytest.approx(peaks, rel=0.06)
    assert force == pytest.approx(-force[:, ::-1], rel=1e-12, abs=1e-9)
    study = bearing_path.LateralStudy(conditions(20e5), (stored_point(_coupled()),))
    figures = study_figures("hysteresis", study.dataset().merge(curves))
    assert "friction_law" in [figure.name for figure in figures]
    assert not friction_curves(replace(contact, friction_coefficient=0.0), 0.0).data_vars


@pytest.mark.parametrize(
    ("name", "label", "unit"),
    [
        ("wear_power_W_per_mm2", "Wear power", "W/mm²"),
        ("loop_area_um_bar", "Loop area", "µm bar"),
        ("film_temperature_rise_K", "Film temperature rise", "K"),
        ("bearing_tilt_mrad", "Bearing tilt", "mrad"),
        ("real_contact_area_mm2", "Real contact area", "mm²"),
    ],
)
def test_numbers_of_the_bearing_are_shown_with_their_units(
    name: str, label: str, unit: str
) -> None:
    found = quantity(name, 1.5)
    assert (found.label, found.unit) == (label, unit)
