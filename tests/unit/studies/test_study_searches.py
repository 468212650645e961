"""Tolerance, optimisation and calibration with a stand-in for the simulation."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

from tests.study_cases import REPOSITORY, Answer, answer, case_with_study
from toothspace import api
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.report.study import study_report_html
from toothspace.studies import run_study
from toothspace.studies.least_squares import fit
from toothspace.studies.measured import read_measured
from toothspace.studies.optimise import log_promise
from toothspace.studies.study import FILE_NAME
from toothspace.studies.surrogate import GaussianProcess
from toothspace.studies.tolerance import index_samples, rank_correlations, sobol_indices
from toothspace.studies.variation import Limit, unit_samples

CLEARANCE = "machine.casing.radial_clearance"
SPEED = "operating_point.shaft_speed"
TOLERANCE = f"""
kind = "tolerance"
sample_count = 64
limits = {{volumetric_efficiency = {{low = 0.96}}}}
[study.vary]
"{CLEARANCE}" = {{mean = "20 um", deviation = "2 um"}}
"fluid.temperature" = {{from = "30 degC", to = "70 degC"}}
"""


def test_indices_of_the_ishigami_function() -> None:
    # T. Ishigami, T. Homma, ISUMA 1990; with a = 7, b = 0.1 the indices are known
    samples = 2.0 * np.pi * index_samples(unit_samples(6, "sobol", 4096, 1)) - np.pi
    x, y, z = samples.T
    alone, total = sobol_indices(np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x), 3)
    np.testing.assert_allclose(alone, [0.3139, 0.4424, 0.0], atol=0.01)
    np.testing.assert_allclose(total, [0.5576, 0.4424, 0.2437], atol=0.01)


def test_sobol_indices_are_those_of_scipy() -> None:
    """The same estimators on the same rows; only a row without a result is left out here."""
    from scipy import stats

    x, y, z = np.pi * (2.0 * index_samples(unit_samples(6, "sobol", 64, 3)).T - 1.0)
    output = 50.0 + np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)
    first, second, *mixed = output.reshape(5, 64)
    given = {"f_A": first[None], "f_B": second[None], "f_AB": np.array(mixed)[:, None]}
    expected = stats.sobol_indices(func=given, n=64)
    alone, total = sobol_indices(output, 3)
    np.testing.assert_allclose(alone, expected.first_order.ravel(), rtol=1e-9)
    np.testing.assert_allclose(total, expected.total_order.ravel(), rtol=1e-9)


def test_rank_correlations_see_direction_and_ignore_failed_points() -> None:
    inputs = unit_samples(3, "latin_hypercube", 50, 0)
    output = np.exp(5.0 * inputs[:, 0])
    output[3] = np.nan
    found = rank_correlations(inputs, output)
    assert found[0] == pytest.approx(1.0)
    assert abs(found[1]) < 0.3
    assert rank_correlations(inputs, -output)[0] == pytest.approx(-1.0)
    assert np.isnan(rank_correlations(inputs, np.ones(50))).all()


def test_tolerance_gives_scatter_sensitivity_and_share(calls: list[Case], tmp_path: Path) -> None:
    result = run_study(case_with_study(TOLERANCE), tmp_path)
    assert result.status is Status.DONE
    assert len(calls) == 64
    numbers = result.numbers
    # efficiency 1 - 1e-4 c^2 is monotone: its percentiles are those of the clearance
    for kind, normal in (
        ("percentile_5", 1.645),
        ("percentile_50", 0.0),
        ("percentile_95", -1.645),
    ):
        expected = 1.0 - 1e-4 * (20.0 + 2.0 * normal) ** 2
        assert numbers[kind]["volumetric_efficiency"] == pytest.approx(expected, abs=6e-4)
    effect = numbers["rank_correlation"]["volumetric_efficiency"]
    assert effect[CLEARANCE] == pytest.approx(-1.0)
    assert abs(effect["fluid.temperature"]) < 0.3
    assert numbers["share_within_limits"] == pytest.approx(0.5, abs=0.02)
    assert numbers["deviation"]["outlet_temperature_degC"] == pytest.approx(40 / 12**0.5, rel=0.03)
    assert {"scatter.csv", "rank_correlation.csv", "points.csv"} < {
        p.name for p in tmp_path.iterdir()
    }
    assert study_report_html(result).count("<figure id=") == 2


def test_tolerances_that_give_a_scrap_rate(calls: list[Case], tmp_path: Path) -> None:
    """Efficiency 1 - 1e-4 c^2 above 0.8689: clearances above 36.207 um are scrap, 35 is meant.

    A tolerance of 6 um is three deviations of 2 um, cut there: the closed form is that of the cut
    normal distribution.
    """
    pytest.importorskip("sklearn")
    cut, whole = norm.cdf(-3.0), norm.cdf(3.0) - norm.cdf(-3.0)
    edge = (math.sqrt(1311.0) - 35.0) / 2.0
    study = f"""
kind = "tolerance"
sample_count = 64
scrap_rate = 0.05
limits = {{volumetric_efficiency = {{low = 0.8689}}, mean_torque_N_m = {{low = 0.0}}}}
[study.vary]
"{CLEARANCE}" = {{tolerance = "6 um"}}
"fluid.temperature" = {{tolerance = "10 degC"}}
"""
    result = run_study(case_with_study(study), tmp_path)
    numbers = result.numbers
    expected = (norm.cdf(-edge) - cut) / whole
    assert numbers["scrap_rate"] == pytest.approx(expected, abs=0.01)
    assert numbers["scrap_rate_low"] < expected < numbers["scrap_rate_high"]
    assert numbers["scrap_by_limit"] == {
        "volumetric_efficiency": numbers["scrap_rate"],
        "mean_torque_N_m": 0.0,
    }
    assert numbers["scrap_rate_of_surrogate"] == pytest.approx(expected, abs=0.005)
    factor = edge / -norm.ppf(cut + 0.05 * whole)
    assert numbers["tolerance_factor"] == pytest.approx(factor, rel=0.02)
    assert numbers["hold_out_error"]["volumetric_efficiency"] < 1e-4
    line = (tmp_path / "tolerances.csv").read_text().splitlines()[1].split(",")
    assert [float(x) for x in line[2:]] == pytest.approx([35.0, 6.0, 6.0 * factor], rel=0.02)
    with pytest.raises(CaseError, match="limits: found nothing"):
        case_with_study(study.replace("limits", "# limits"))


def test_tolerance_with_indices(calls: list[Case]) -> None:
    study = TOLERANCE.replace("= 64", '= 64\nsensitivity = "sobol_indices"\nmethod = "sobol"')
    result = run_study(case_with_study(study))
    # points whose exchanged column changes nothing are still cases of their own
    assert len(result.data["point"]) == 64 * 4
    assert result.numbers["total_index"]["volumetric_efficiency"][CLEARANCE] == pytest.approx(
        1.0, abs=0.1
    )
    assert result.numbers["total_index"]["volumetric_efficiency"]["fluid.temperature"] == 0.0
    assert len(calls) == 64 * 4


@pytest.mark.parametrize(
    ("limit", "value", "expected"),
    [
        (Limit(low=0.9), 0.95, 0.0),
        (Limit(low=0.9), 0.81, 0.1),
        (Limit(high=300.0), 330.0, 0.1),
        (Limit(low=0.0, high=0.0), 2.0, 2.0),
        (Limit(high=1.0), math.nan, 1.0),
    ],
)
def test_violation_of_a_limit(limit: Limit, value: float, expected: float) -> None:
    assert limit.violation(value) == pytest.approx(expected)


def optimise(text: str) -> str:
    return f"""
kind = "optimise"
{text}
[study.vary]
"{CLEARANCE}" = {{from = "5 um", to = "40 um"}}
"{SPEED}" = {{from = "500 rpm", to = "3000 rpm"}}
"""


def test_evolution_finds_the_constrained_best(calls: list[Case], tmp_path: Path) -> None:
    # largest flow at an efficiency of at least 0.96: full speed, clearance 20 um
    text = 'objective = "mean_flow_L_per_min"\nevaluation_count = 600\n'
    text += "constraints = {volumetric_efficiency = {low = 0.96}}"
    result = run_study(case_with_study(optimise(text)), tmp_path)
    assert result.status is Status.DONE
    best = result.numbers["best"]
    assert float(best[CLEARANCE].removesuffix(" um")) == pytest.approx(20.0, abs=0.5)
    assert float(best[SPEED].removesuffix(" rpm")) == pytest.approx(3000.0, rel=2e-3)
    assert result.numbers["best_point"]["volumetric_efficiency"] >= 0.96
    assert result.numbers["at_bounds"] == [SPEED]
    assert len(calls) <= 600
    assert study_report_html(result).count("<figure id=") == 1


def test_a_robust_search_keeps_away_from_the_edge(calls: list[Case]) -> None:
    """Of clearances with 3 um of tolerance, 9 in 10 keep the limit of 20 um.

    The 90 % quantile of a normal distribution cut at three deviations of 1 um is 1.28 um.
    """
    text = 'objective = "mean_flow_L_per_min"\nevaluation_count = 40\nquantile = 0.9\n'
    text += "constraints = {volumetric_efficiency = {low = 0.96}}\nscatter_count = 11\n"
    text += f'scatter = {{"{CLEARANCE}" = {{tolerance = "3 um"}}}}'
    study = "\n".join(line for line in optimise(text).splitlines() if SPEED not in line)
    result = run_study(case_with_study(study))
    best = float(result.numbers["best"][CLEARANCE].removesuffix(" um"))
    assert best == pytest.approx(20.0 - 1.28, abs=0.6)
    # every machine of a point is a run; a point that comes again is none
    values = len(np.unique(result.data[CLEARANCE]))
    assert len(calls) == 11 * values > 11 * 30
    with pytest.raises(CaseError, match=r"scatter\..*allowed \{tolerance = \.\.\.\}"):
        case_with_study(optimise(text.replace("tolerance =", "deviation =")))
    other = case_with_study(study.replace('"3 um"', '"-3 um"'))
    with pytest.raises(CaseError, match=r"study\.scatter\..*\.tolerance: found '-3 um'"):
        run_study(other)


def test_a_robust_surrogate_keeps_away_from_the_edge_too(calls: list[Case]) -> None:
    """The same with processes of what 9 in 10 machines reach, in a third of the runs."""
    pytest.importorskip("sklearn")
    text = 'objective = "mean_flow_L_per_min"\nmethod = "surrogate"\nevaluation_count = 12\n'
    text += "constraints = {volumetric_efficiency = {low = 0.96}}\nscatter_count = 11\n"
    text += f'scatter = {{"{CLEARANCE}" = {{tolerance = "3 um"}}}}'
    study = "\n".join(line for line in optimise(text).splitlines() if SPEED not in line)
    result = run_study(case_with_study(study))
    best = float(result.numbers["best"][CLEARANCE].removesuffix(" um"))
    assert best == pytest.approx(20.0 - 1.28, abs=0.6)
    assert len(calls) == 11 * 12


def test_a_search_replays_its_finished_points(calls: list[Case], tmp_path: Path) -> None:
    text = 'objective = "volumetric_efficiency"\nevaluation_count = 40'
    first = run_study(case_with_study(optimise(text)), tmp_path)
    count = len(calls)
    again = run_study(case_with_study(optimise(text)), tmp_path, resume=True)
    assert len(calls) == count
    assert again.numbers["best"] == first.numbers["best"]


def test_an_interrupted_search_keeps_its_best(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    calls = []

    def simulate(case: Case) -> Answer:
        calls.append(case)
        if len(calls) == 25:
            raise KeyboardInterrupt
        return Answer(answer(case))

    monkeypatch.setattr(api, "simulate", simulate)
    text = 'objective = "volumetric_efficiency"\nevaluation_count = 60'
    result = run_study(case_with_study(optimise(text)), tmp_path)
    assert result.status is Status.INTERRUPTED
    assert result.numbers["feasible"]
    assert len((tmp_path / FILE_NAME).read_text().splitlines()) == 24


def test_targets_are_reached_by_least_squares(calls: list[Case]) -> None:
    text = 'method = "least_squares"\nevaluation_count = 60\n'
    text += "targets = {volumetric_efficiency = 0.9775, mean_flow_L_per_min = 10.0}"
    result = run_study(case_with_study(optimise(text)))
    assert result.status is Status.DONE
    best = result.numbers["best"]
    assert float(best[CLEARANCE].removesuffix(" um")) == pytest.approx(15.0, abs=0.05)
    expected = (10.0 - 0.15) / 0.05 * 60.0 / (2.0 * math.pi)
    assert float(best[SPEED].removesuffix(" rpm")) == pytest.approx(expected, rel=1e-3)
    assert len(calls) < 30


def test_a_surrogate_finds_the_constrained_best(calls: list[Case], tmp_path: Path) -> None:
    """Largest flow at an efficiency of at least 0.96: full speed, clearance 20 um."""
    pytest.importorskip("sklearn")
    text = 'objective = "mean_flow_L_per_min"\nmethod = "surrogate"\nevaluation_count = 22\n'
    text += "constraints = {volumetric_efficiency = {low = 0.96}}"
    result = run_study(case_with_study(optimise(text)), tmp_path)
    assert result.status is Status.DONE
    best = result.numbers["best"]
    assert float(best[CLEARANCE].removesuffix(" um")) == pytest.approx(20.0, abs=0.2)
    assert float(best[SPEED].removesuffix(" rpm")) == pytest.approx(3000.0, rel=1e-3)
    assert result.numbers["best_point"]["volumetric_efficiency"] >= 0.96
    # both numbers are smooth: 15.8 L/min and 0.16 are their spans
    errors = result.numbers["hold_out_error"]
    assert 0.0 < errors["mean_flow_L_per_min"] < 0.02
    assert 0.0 < errors["volumetric_efficiency"] < 1e-3
    with xr.open_dataset(tmp_path / "study.nc") as data:
        assert data["merit"].attrs["hold_out_error"] == errors["mean_flow_L_per_min"]
    count = len(calls)
    again = run_study(case_with_study(optimise(text)), tmp_path, resume=True)
    assert len(calls) == count == 22
    assert again.numbers["best"] == best
    assert study_report_html(result).count("<figure id=") == 1


def test_a_surrogate_keeps_away_from_what_cannot_run(
    monkeypatch: pytest.MonkeyPatch, calls: list[Case]
) -> None:
    """Machines with less than 12 um seize: the best efficiency is beside them."""
    pytest.importorskip("sklearn")
    failed = []

    def simulate(case: Case) -> Answer:
        if case.machine.casing.radial_clearance < 12e-6:
            failed.append(case)
            raise RuntimeError("seized")
        return Answer(answer(case))

    monkeypatch.setattr(api, "simulate", simulate)
    text = 'objective = "volumetric_efficiency"\nmethod = "surrogate"\nevaluation_count = 18\n'
    study = "\n".join(x for x in optimise(text + "batch_size = 3").splitlines() if SPEED not in x)
    found = run_study(case_with_study(study))
    best = float(found.numbers["best"][CLEARANCE].removesuffix(" um"))
    # 18 points in equal steps would be 2 um apart
    assert 12.0 <= best < 12.5
    assert found.numbers["points_failed"] == len(failed) > 2
    # nothing that runs
    never = run_study(case_with_study(study.replace('"40 um"', '"11 um"')))
    assert never.status is Status.NOT_CONVERGED
    assert "hold_out_error" not in never.numbers


def test_a_surrogate_ends_when_all_is_tried(calls: list[Case]) -> None:
    """Three clearances and whole temperatures: each once, whatever the budget."""
    pytest.importorskip("sklearn")
    study = f"""
kind = "optimise"
objective = "volumetric_efficiency"
method = "surrogate"
evaluation_count = 60
[study.vary]
"{CLEARANCE}" = ["20 um", "10 um", "15 um"]
"machine.gears.tooth_count" = {{from = 11, to = 12}}
"""
    result = run_study(case_with_study(study))
    assert result.data.sizes["point"] == 6
    assert result.numbers["best"][CLEARANCE] == "10 um"
    assert len(calls) == 6


def test_promise_is_the_integral_that_it_stands_for() -> None:
    """Expected improvement by quadrature, times the probability of a limit; far away its log."""
    here = np.array([[0.5, 0.5]])
    flat = GaussianProcess(here + 10.0, np.zeros(1), 2.0, 0.5, 1.0, np.ones(2), 1e-10, 0.0)
    limit = replace(flat, mean=-0.3)
    mean, spread = flat.predict(here)
    assert (mean[0], spread[0]) == pytest.approx((2.0, 0.5), rel=1e-3)
    y = np.linspace(-3.0, 7.0, 200_001)
    for best in (1.2, 2.0, 2.9):
        gain = np.trapezoid(np.maximum(best - y, 0.0) * norm.pdf(y, 2.0, 0.5), y)
        found = log_promise(flat, [limit], best, here)[0]
        assert found == pytest.approx(math.log(gain * norm.cdf(0.3 / 0.5)), abs=1e-4)
    assert log_promise(flat, [limit], None, here)[0] == pytest.approx(norm.logcdf(0.6), abs=1e-4)
    below = [log_promise(flat, [], 2.0 - 0.5 * z, here)[0] for z in (9.9, 10.1, 40.0)]
    assert below[0] > below[1] > below[2] == pytest.approx(-0.5 * 40.0**2 - 9.0, abs=0.3)


def test_a_surrogate_needs_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn", None)
    text = 'objective = "mean_flow_L_per_min"\nmethod = "surrogate"'
    with pytest.raises(CaseError, match=r"study\.method: .*scikit-learn.*toothspace\[design\]"):
        run_study(case_with_study(optimise(text)))
    with pytest.raises(CaseError, match=r"study\.objective: found nothing"):
        case_with_study(optimise('targets = {mean_flow_L_per_min = 9}\nmethod = "surrogate"'))


def test_impossible_constraints_and_names_are_told(calls: list[Case]) -> None:
    text = 'objective = "mean_flow_L_per_min"\nevaluation_count = 20\n'
    never = text + "constraints = {volumetric_efficiency = {low = 2.0}}"
    result = run_study(case_with_study(optimise(never)))
    assert result.status is Status.NOT_CONVERGED
    assert result.numbers["feasible"] is False
    tried = len(calls)
    nearest = (
        r"study\.objective: found 'mean_flow', which is no result, allowed mean_flow_L_per_min"
    )
    with pytest.raises(CaseError, match=nearest):
        run_study(case_with_study(optimise('objective = "mean_flow"')))
    wrong = text + "constraints = {volumetric_eficiency = {low = 0.9}}"
    with pytest.raises(CaseError, match=r"constraints\.vol.*allowed volumetric_efficiency \(did"):
        run_study(case_with_study(optimise(wrong)))
    with pytest.raises(CaseError, match=r"limits\.noise: found 'noise', which is no result"):
        run_study(case_with_study(TOLERANCE.replace("volumetric_efficiency", "noise")))
    assert len(calls) == tried
    # those of a path or a mechanism are known when the first points are there
    with pytest.raises(CaseError, match="found 'leakage_nowhere_L_per_min', which is no result"):
        run_study(case_with_study(optimise(text.replace("mean_flow", "leakage_nowhere"))))


def test_covariance_of_a_straight_line() -> None:
    """A line through noisy points: intervals by the textbook formula for linear regression."""
    x = np.linspace(0.0, 1.0, 21)
    noise = 0.02 * np.sin(50.0 * x)
    wanted = 0.3 + 0.5 * x + noise
    found = fit(lambda p: p[:, :1] + p[:, 1:] * x - wanted, np.array([0.5, 0.1]), 100)
    slope, level = np.polyfit(x, wanted, 1)
    np.testing.assert_allclose(found.shares, [level, slope], atol=1e-5)
    residual = wanted - level - slope * x
    error = np.sqrt(np.sum(residual**2) / 19.0 / np.sum((x - x.mean()) ** 2))
    assert found.half_widths()[1] == pytest.approx(2.093 * error, rel=1e-3)
    assert found.converged


def test_a_fit_keeps_to_its_budget_and_survives_failures() -> None:
    asked = []

    def rosenbrock(p: Any) -> Any:
        asked.extend(p)
        return np.stack([10.0 * (p[:, 1] - p[:, 0] ** 2), 1.0 - p[:, 0], p[:, 1] - 1.0], axis=1)

    found = fit(rosenbrock, np.array([0.1, 0.9]), 7)
    assert not found.converged
    assert len(asked) <= 7
    failed = fit(lambda p: np.full((len(p), 3), np.nan), np.array([0.5, 0.5]), 50)
    assert not failed.converged
    assert np.isinf(failed.half_widths()).all()


def calibration(folder: Path, header: str, rows: list[str], name: str = "egm12_motor") -> Case:
    (folder / "measured.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    text = (REPOSITORY / "cases" / f"{name}.toml").read_text(encoding="utf-8")
    study = f"""
[study]
kind = "calibrate"
data = "measured.csv"
fit = {{"{CLEARANCE}" = ["5 um", "40 um"]}}
"""
    return Case.from_toml(text + study, folder, name)


def test_calibration_to_steady_points(calls: list[Case], tmp_path: Path) -> None:
    header = f"{SPEED} [rpm], volumetric_efficiency [1], mean_flow_L_per_min [m^3/s]"
    rows = []
    for k in range(10):
        speed = 500.0 + 250.0 * k
        flow = speed * 2.0 * math.pi / 60.0 * 0.05 + 0.13
        rows.append(f"{speed}, {1.0 - 1e-4 * 13.0**2 + 1e-5 * (-1) ** k}, {flow / 6e4}")
    result = run_study(calibration(tmp_path, header, rows), tmp_path / "out")
    assert result.status is Status.DONE
    value = float(result.numbers["fitted"][CLEARANCE].removesuffix(" um"))
    assert value == pytest.approx(13.0, abs=0.05)
    assert abs(value - 13.0) < result.numbers["half_width_95"][CLEARANCE] < 0.1
    assert result.numbers["rows_used"] == 7
    assert result.numbers["hold_out_error"]["volumetric_efficiency"] == pytest.approx(
        1e-5, rel=0.05
    )
    assert result.numbers["at_bounds"] == []
    count = len(calls)
    run_study(calibration(tmp_path, header, rows), tmp_path / "out", resume=True)
    assert len(calls) == count
    assert study_report_html(result).count("<figure id=") == 1


def test_calibration_to_signals_over_time(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    class Signal:
        status = Status.DONE

        def __init__(self, case: Case) -> None:
            clearance = case.machine.casing.radial_clearance * 1e6
            time = np.linspace(0.0, 2.0, 201)
            speed = 100.0 * (1.0 - np.exp(-time / (0.02 * clearance)))
            self.data = xr.Dataset(
                {"shaft_speed": ("time", speed), "inlet_pressure": ("time", 1e5 * clearance + time),
                 "outlet_pressure": ("time", time)},
                coords={"time": time},
            )  # fmt: skip

    monkeypatch.setattr(api, "simulate", Signal)
    times = np.linspace(0.1, 1.9, 10)
    rows = [f"{t}, {1000 / 1.0471975511965976 * (1 - np.exp(-t / 0.4))}, 20" for t in times]
    case = calibration(tmp_path, "time [s], shaft_speed [rpm], pressure_difference [bar]", rows)
    result = run_study(case)
    assert float(result.numbers["fitted"][CLEARANCE].removesuffix(" um")) == pytest.approx(
        20.0, abs=0.05
    )
    # the last part of the signals is held out
    assert result.data["used"].values.tolist() == [True] * 7 + [False] * 3
    assert study_report_html(result).count("<figure id=") == 1


@pytest.mark.parametrize(
    ("header", "row", "message"),
    [
        ("time [s], speed [rpm]", "0, 1", "found 'speed', allowed .*shaft_speed"),
        ("time [s], shaft_speed [bar]", "0, 1", r"found the unit 'bar', allowed 'rad/s'"),
        ("mean_flow_L_per_min [bar]", "1", "found the unit 'bar', allowed 'L/min'"),
        (f"{SPEED} [rpm]", "1", "allowed columns of summary numbers"),
        ("volumetric_efficiency", "x", "volumetric_efficiency: found 'x', allowed a number"),
        ("volumetric_efficiency", "", "found no rows"),
        ("volumetric efficiency !", "1", "allowed 'name .unit.'"),
    ],
)
def test_bad_measurements_are_refused(header: str, row: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text(f"{header}\n{row}\n", encoding="utf-8")
    with pytest.raises(CaseError, match=message):
        read_measured(path)


@pytest.mark.parametrize(
    ("study", "message"),
    [
        ('kind = "optimise"\nvary = {"a.b" = [1]}', "study.objective: found nothing"),
        ('kind = "optimise"\nvary = {"a.b" = [1]}\ntargets = {x = 1}\nobjective = "x"', "leave"),
        ('kind = "tolerance"\nvary = {"a.b" = {mean = 1}}', r"study.vary.a.b: found \{'mean': 1\}"),
        ('kind = "tolerance"\nvary = {"a.b" = [1]}\nlimits = {x = {}}', "limits.x: found no limit"),
        ('kind = "calibrate"\ndata = "profiles/egm12_drive.csv"\nfit = {}', "study"),
    ],
)
def test_bad_studies_are_refused(study: str, message: str) -> None:
    with pytest.raises(CaseError, match=message):
        case_with_study(study)


def test_design_scan_finds_the_best_of_many_gears(tmp_path: Path) -> None:
    text = """
kind = "design_scan"
objective = "flow_ripple_percent"
goal = "minimise"
sample_count = 2000
best_count = 3
addendum = 1.1
displacement = "4.95 cm^3/rev"
constraints = {envelope_cm3 = {high = 26.0}, contact_ratio = {low = 1.1}}
[study.vary]
"machine.gears.tooth_count" = {from = 9, to = 18}
"machine.gears.module" = {from = "1.8 mm", to = "3.4 mm"}
"machine.gears.profile_shift" = {from = 0.0, to = 0.7}
"""
    result = run_study(case_with_study(text, "egm12_pump"), tmp_path)
    assert result.status is Status.DONE
    kept = result.data["feasible"].values
    ripple = result.data["flow_ripple_percent"].values
    assert result.numbers["best_merit"] == np.min(ripple[kept])
    assert np.all(result.data["envelope_cm3"].values[kept] <= 26.0)
    assert np.all(result.data["reasons"].values[kept] == 0)
    head, *rows = (tmp_path / "best.csv").read_text().splitlines()
    assert head.startswith("machine.gears.tooth_count,machine.gears.module (mm)")
    assert len(rows) == 3
    # the best design is a case that can be run, and has these numbers
    best = result.numbers["best_point"]
    values = dict(result.numbers["best"])
    values["machine.gears.tip_diameter"] = f"{best['tip_diameter_mm']:.12g} mm"
    values["machine.gears.face_width"] = f"{best['face_width_mm']:.12g} mm"
    summary = api.describe(case_with_study(text, "egm12_pump").at_point(values)).geometry_summary
    assert summary["displacement_cm3_per_rev"] == pytest.approx(4.95)
    assert summary["flow_ripple_percent"] == pytest.approx(best["flow_ripple_percent"])
    assert "Flow ripple" in study_report_html(result)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ('objective = "noise"', "'noise', which is no result, allowed displacement_cm3_per_rev"),
        ("addendum = 2.0", "found no possible design"),
    ],
)
def test_design_scan_names_what_is_wrong(change: str, message: str) -> None:
    text = """
kind = "design_scan"
objective = "contact_ratio"
sample_count = 64
[study.vary]
"machine.gears.profile_shift" = {from = 0.0, to = 0.7}
"""
    key = change.partition(" ")[0]
    lines = [line for line in text.splitlines() if not line.startswith(key)]
    lines.insert(1, change)
    with pytest.raises(CaseError, match=message):
        run_study(case_with_study("\n".join(lines), "egm12_pump"))
