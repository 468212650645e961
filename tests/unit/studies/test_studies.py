"""Studies with a stand-in for the simulation: points, records, interrupts, files."""

from __future__ import annotations

import csv
import json
import multiprocessing
import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import toothspace as ts
from tests.study_cases import Answer, answer, case_with_study
from toothspace import api
from toothspace.case import Case
from toothspace.cli import main
from toothspace.core import registry
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.registry import STUDY_KEYS
from toothspace.core.status import Status
from toothspace.report.study import study_report_html
from toothspace.results.solution import read_dataset
from toothspace.studies import run_study, study_figures
from toothspace.studies.efficiency_map import characteristics
from toothspace.studies.study import FILE_NAME, PREVIOUS_FILE_NAME, Record, Records, Study
from toothspace.studies.workers import Workers

CLEARANCE = "machine.casing.radial_clearance"
SWEEP = f"""
kind = "sweep"
[study.vary]
"{CLEARANCE}" = {{from = "10 um", to = "30 um", count = 3}}
"fluid.temperature" = ["30 degC", "80 degC"]
"""
MAP = """
kind = "efficiency_map"
shaft_speed = ["500 rpm", "1000 rpm"]
pressure_difference = ["50 bar", "100 bar", "150 bar"]
"""


def replace_simulation(monkeypatch: pytest.MonkeyPatch, simulate: Callable[..., Any]) -> None:
    monkeypatch.setattr(api, "simulate", simulate)


def test_a_grid_runs_every_combination_last_key_fastest(calls: list[Case]) -> None:
    result = run_study(case_with_study(SWEEP))
    assert result.status is Status.DONE
    assert result.numbers[CLEARANCE] == ["10 um", "10 um", "20 um", "20 um", "30 um", "30 um"]
    assert result.data["fluid.temperature"].values.tolist() == [30.0, 80.0] * 3
    expected = 1.0 - 1e-4 * np.array([10.0, 10.0, 20.0, 20.0, 30.0, 30.0]) ** 2
    np.testing.assert_allclose(result.data["volumetric_efficiency"], expected, rtol=1e-12)
    assert len(calls) == 6
    assert all(case.study is None for case in calls)


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol"])
def test_samples_fill_the_span_and_repeat_with_their_seed(method: str, calls: list[Case]) -> None:
    study = f"""
kind = "sweep"
method = "{method}"
sample_count = 8
vary = {{"{CLEARANCE}" = {{from = "10 um", to = "30 um"}}}}
"""
    first = run_study(case_with_study(study)).data[CLEARANCE].values
    again = run_study(case_with_study(study)).data[CLEARANCE].values
    np.testing.assert_array_equal(first, again)
    # both kinds of samples put exactly one point into each eighth of the span
    assert sorted((first - 10.0) // 2.5) == list(range(8))


def test_an_efficiency_map_keeps_the_low_pressure(calls: list[Case]) -> None:
    result = run_study(case_with_study(MAP))
    assert dict(result.data.sizes) == {"shaft_speed": 2, "pressure_difference": 3}
    np.testing.assert_allclose(result.data["mean_torque_N_m"], [[5.0, 10.0, 15.0]] * 2, rtol=1e-12)
    assert {c.operating_point.outlet_pressure for c in calls if c.operating_point} == {1e5}
    assert result.numbers["shaft_speed_rpm"] == pytest.approx([500.0] * 3 + [1000.0] * 3)
    rows = list(csv.reader(result.tables[0].to_csv().splitlines()))
    assert rows[0][0] == "speed n (rpm)"
    assert [row[:2] for row in rows[1:3]] == [["500", "50"], ["500", "100"]]


def test_measured_points_are_laid_over_a_map(calls: list[Case], tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text(
        "operating_point.shaft_speed [rpm],operating_point.inlet_pressure [bar],"
        "mean_torque_N_m [N m]\n500,101,9.5\n1000,51,5.5\n"
    )
    result = run_study(case_with_study(MAP + f'measured = "{path}"\n'))
    speeds = np.array([500.0, 1000.0]) * np.pi / 30.0
    np.testing.assert_allclose(result.data["measured_shaft_speed"], speeds)
    np.testing.assert_allclose(result.data["measured_pressure_difference"], [100e5, 50e5])
    np.testing.assert_allclose(result.data["measured_mean_torque_N_m"], [9.5, 5.5])
    panel = characteristics(result.data).axes[1]
    crosses = [line for line in panel.lines if line.get_marker() == "x"]
    shown = [(*np.asarray(line.get_xdata()), *np.asarray(line.get_ydata())) for line in crosses]
    np.testing.assert_allclose(shown, [(100.0, 9.5), (50.0, 5.5)])
    path.write_text("operating_point.shaft_speed [rpm],mean_torque_N_m [N m]\n500,9.5\n")
    with pytest.raises(CaseError, match=r"measured\.csv: columns: found .*shaft_speed"):
        run_study(case_with_study(MAP + f'measured = "{path}"\n'))


def test_a_map_of_a_pump_raises_the_outlet_pressure(calls: list[Case]) -> None:
    run_study(case_with_study(MAP, "egm12_pump"))
    first = calls[0].operating_point
    assert first is not None
    assert first.outlet_pressure - first.inlet_pressure == pytest.approx(50e5)


def test_failed_points_are_rows_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def simulate(case: Case) -> Answer:
        numbers = answer(case)
        clearance = round(case.machine.casing.radial_clearance * 1e6)
        if clearance == 20:
            numbers["status"] = "step_too_small"
        if clearance == 30:
            raise FloatingPointError("underflow\nin a film")
        return Answer(numbers)

    replace_simulation(monkeypatch, simulate)
    result = run_study(case_with_study(SWEEP))
    assert result.status is Status.POINTS_FAILED
    found = result.numbers["point_status"]
    assert found == ["done", "done", "step_too_small", "step_too_small", "failed", "failed"]
    messages = result.data["point_message"].values
    assert messages[2] == Status.STEP_TOO_SMALL.value
    assert messages[4] == "FloatingPointError: underflow in a film"
    assert result.numbers["points_failed"] == 4
    assert np.isfinite(result.data["volumetric_efficiency"].values[:4]).all()
    assert np.isnan(result.data["volumetric_efficiency"].values[4:]).all()


def test_a_refused_value_is_a_row_and_all_refused_is_an_error(calls: list[Case]) -> None:
    some = f'kind = "sweep"\nvary = {{"{CLEARANCE}" = ["-1 um", "20 um"]}}'
    result = run_study(case_with_study(some))
    assert result.numbers["point_status"] == ["bad_input", "done"]
    with pytest.raises(CaseError, match=r"radial_clearances: found an unknown key.*did you mean"):
        run_study(
            case_with_study('kind = "sweep"\nvary = {"machine.casing.radial_clearances" = [1]}')
        )
    with pytest.raises(CaseError, match="'-1 um'"):
        run_study(case_with_study(f'kind = "sweep"\nvary = {{"{CLEARANCE}" = ["-1 um"]}}'))


@pytest.mark.parametrize(
    ("vary", "allowed"),
    [
        ('{from = "30 um", to = "10 um", count = 3}', "from below to"),
        ('{from = "10 um", to = "3 bar", count = 3}', "in um"),
        ('["10 um", 3]', "all have a unit"),
        ('{from = "10 um", to = "30 um"}', "for a grid"),
        ('{mean = "10 um", deviation = "-1 um"}', "deviation > 0"),
    ],
)
def test_impossible_spans_are_refused(vary: str, allowed: str) -> None:
    with pytest.raises(CaseError, match=allowed) as caught:
        run_study(case_with_study(f'kind = "sweep"\nvary = {{"{CLEARANCE}" = {vary}}}'))
    assert f"study.vary.{CLEARANCE}: found" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_one_run_of_a_study_is_asked_for_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write_case(tmp_path, MAP)
    fast = ["--fidelity", "ideal", "--json"]
    assert main(["run", str(path), *fast]) == 2
    told = capsys.readouterr().err
    assert f"{path}: study: found 'efficiency_map', allowed with 'toothspace study {path}'" in told
    assert told.count("\n") == 1
    assert main(["run", str(path), "--without-study", *fast]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "done"
    case = case_with_study(MAP).replace({"run.fidelity": "ideal"})
    with pytest.raises(CaseError, match=r"study: found 'efficiency_map', allowed .*run_study"):
        ts.simulate(case)
    assert ts.simulate(case, study=None).status is Status.DONE


def test_a_study_needs_a_kind() -> None:
    with pytest.raises(CaseError, match="found nothing, allowed a table"):
        run_study(case_with_study(MAP).at_point({}))


@pytest.mark.parametrize("kind", STUDY_KEYS)
def test_every_kind_declares_keys_run_and_figures(kind: str) -> None:
    declared = registry.study(kind)
    assert isinstance(declared, Study)
    assert STUDY_KEYS.name_of(declared.keys) == kind
    assert callable(declared.run)
    assert callable(declared.figures)


def test_an_interrupt_keeps_finished_points_and_resume_goes_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    calls = []

    def interrupted(case: Case) -> Answer:
        calls.append(case)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return Answer(answer(case))

    replace_simulation(monkeypatch, interrupted)
    first = run_study(case_with_study(SWEEP), tmp_path)
    assert first.status is Status.INTERRUPTED
    assert first.numbers["point_status"] == ["done"] * 2 + ["interrupted"] * 4
    assert first.numbers["points_failed"] == 0
    assert len((tmp_path / FILE_NAME).read_text().splitlines()) == 2

    second = run_study(case_with_study(SWEEP), tmp_path, resume=True)
    assert second.status is Status.DONE
    assert len(calls) == 3 + 4
    assert np.isfinite(second.data["volumetric_efficiency"].values).all()


def test_a_run_that_was_interrupted_is_no_finished_point(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # the solver turns an interrupt into a status and keeps the last revolution
    replace_simulation(monkeypatch, lambda case: Answer({**answer(case), "status": "interrupted"}))
    result = run_study(case_with_study(SWEEP), tmp_path)
    assert result.status is Status.INTERRUPTED
    assert not (tmp_path / FILE_NAME).exists()


def test_resume_takes_a_longer_grid_and_forgets_failures(calls: list[Case], tmp_path: Path) -> None:
    short = f'kind = "sweep"\nvary = {{"{CLEARANCE}" = ["10 um", "20 um"]}}'
    longer = f'kind = "sweep"\nvary = {{"{CLEARANCE}" = ["10 um", "20 um", "40 um"]}}'
    run_study(case_with_study(short), tmp_path)
    run_study(case_with_study(longer), tmp_path, resume=True)
    assert len(calls) == 3
    run_study(case_with_study(longer), tmp_path)
    assert len(calls) == 6
    # what a forgotten --resume would have used is kept beside
    assert len((tmp_path / PREVIOUS_FILE_NAME).read_text().splitlines()) == 3


def test_records_survive_a_line_cut_short(tmp_path: Path) -> None:
    path = tmp_path / FILE_NAME
    records = Records(path)
    records.add(Record("a", "done", {"mean_torque_N_m": 1.5}))
    records.add(Record("b", "failed", message="no"))
    with path.open("a") as file:
        file.write('{"key": "c", "sta')
    again = Records(path, resume=True)
    kept = again.get("a")
    assert kept is not None
    assert kept.number("mean_torque_N_m") == 1.5
    assert again.get("b") is None
    assert len(again) == 1


def test_processes_give_the_same_and_a_dead_one_is_told() -> None:
    with Workers(2) as workers:
        found = dict(workers.each(abs, [-1.0, 2.0, -3.0]))
    assert found == {0: 1.0, 1: 2.0, 2: 3.0}
    with Workers(2) as workers, pytest.raises(ToothspaceError, match="--resume"):
        list(workers.each(os._exit, [1]))


def test_an_interrupt_does_not_wait_for_what_is_computed() -> None:
    started = time.perf_counter()
    workers = Workers(2)
    for _ in workers.each(time.sleep, [0.0, 60.0, 60.0, 60.0]):
        break
    workers.stop()
    # the pool's own thread may have seen a process end and not have told so yet
    while multiprocessing.active_children() and time.perf_counter() - started < 30.0:
        time.sleep(0.05)
    assert time.perf_counter() - started < 30.0


def test_a_scheduler_needs_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(CaseError, match="--scheduler: found no package 'distributed'"):
        list(Workers(1, "tcp://nowhere:1").each(abs, [1.0]))


@pytest.mark.parametrize("study", [SWEEP, MAP])
def test_files_figures_and_page(study: str, calls: list[Case], tmp_path: Path) -> None:
    result = run_study(case_with_study(study), tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"study.nc", "summary.json", FILE_NAME} < names
    assert not [name for name in names if "part" in name]
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["status"] == "done"
    data = read_dataset(tmp_path / "study.nc")
    assert data.attrs["study"] == result.kind
    np.testing.assert_array_equal(data["mean_torque_N_m"], result.data["mean_torque_N_m"])
    if study == SWEEP:
        assert [figure.name for figure in study_figures(result.kind, data)] == ["sweep"]
    page = study_report_html(result)
    assert not re.search(r"""(?:src|href)=["']http|url\(http""", page)
    assert page.count("<svg") >= 1
    assert result.tables[0].name in page


def test_a_result_is_drawn_listed_and_viewed(calls: list[Case]) -> None:
    result = run_study(case_with_study(SWEEP))
    assert result.plot.names() == ["sweep"]
    assert len(result.plot.sweep().axes) >= 4
    assert "sweep" in dir(result.plot)
    with pytest.raises(CaseError, match=r"figure: found 'sweeps', allowed sweep \(did you mean"):
        result.plot.figure("sweeps")
    assert not hasattr(result.plot, "sweeps")
    frame = result.to_dataframe()
    assert len(frame) == 6
    assert frame.loc[2, CLEARANCE] == 20.0
    assert frame.attrs["units"][CLEARANCE] == "um"
    view = result._repr_html_()
    assert view.count("<svg") == 1
    assert "plot.sweep()" in view
    table = run_study(case_with_study(MAP)).to_dataframe()
    assert table.index.names == ["shaft_speed", "pressure_difference"]
    assert table["mean_torque_N_m"].tolist() == pytest.approx([5.0, 10.0, 15.0] * 2)


def write_case(folder: Path, study: str) -> Path:
    case = case_with_study(study)
    path = folder / "case.toml"
    path.write_text(case.to_toml(), encoding="utf-8")
    return path


def test_command_line(
    calls: list[Case], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_case(tmp_path, SWEEP)
    folder = tmp_path / "out"
    assert main(["study", str(path), "-o", str(folder), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert len(printed["volumetric_efficiency"]) == 6
    assert (folder / "report.html").is_file()
    assert (folder / "points.csv").is_file()


def test_command_line_exit_codes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_case(tmp_path, SWEEP)
    folder = str(tmp_path / "out")
    replace_simulation(
        monkeypatch, lambda case: Answer({**answer(case), "status": "step_too_small"})
    )
    assert main(["study", str(path), "-o", folder]) == 3
    assert "points_failed" in capsys.readouterr().err

    def interrupt(_case: Case) -> Answer:
        raise KeyboardInterrupt

    replace_simulation(monkeypatch, interrupt)
    assert main(["study", str(path), "-o", folder]) == 2
    assert "found results of a study, allowed another folder, --resume" in capsys.readouterr().err
    assert main(["study", str(path), "-o", folder, "--force"]) == 130
    assert main(["study", str(path), "-o", folder, "--force", "--set", "study.method=sobol"]) == 2
    assert "study.sample_count" in capsys.readouterr().err
    assert main(["study", str(path), "-o", str(path)]) == 2
    assert "allowed a folder" in capsys.readouterr().err
