"""What notebooks and scripts call, as the documentation shows it."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import toothspace as ts
from tests.fake_solution import fake_solution
from tests.study_cases import Answer, answer
from toothspace import api
from toothspace.case import Case
from toothspace.core.signals import read_columns
from toothspace.run import ideal
from toothspace.run import run as lumped
from toothspace.run.run import Run

REPOSITORY = Path(__file__).resolve().parents[3]
MOTOR = REPOSITORY / "cases" / "egm12_motor.toml"

USER_SCRIPT = """
import toothspace as ts

case: ts.Case = ts.load_case("motor.toml")
faster = case.replace({"operating_point.shaft_speed": ts.Quantity(2000, "rpm")})
solution = ts.simulate(faster)
doubled = solution.summary()["volumetric_efficiency"] * 2.0
shown = solution.summary()["status"].upper()
solution.plot.pressures().savefig("pressures.png")
solution.to_csv("samples.csv")
page = solution.report("motor.html").read_text()
numbers = ts.compare(solution, ts.simulate("motor.toml")).to_dataframe()
study = ts.sweep(case, {"machine.gears.module": ["2.5 mm", "2.75 mm"]})
again: ts.Case = ts.Case.from_dict(case.to_dict())
film = ts.films.JournalBearing
done: bool = solution.status is ts.Status.DONE
"""


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Replace the simulation by a made-up result; the cases that it was asked for."""
    seen: list[Case] = []

    def simulate(run: Run, progress: object = None) -> ts.Solution:
        seen.append(run.case)
        return fake_solution()

    for preset in (ideal, lumped):
        monkeypatch.setattr(preset, "simulate", simulate)
    return seen


@pytest.fixture
def solution(ran: list[Case]) -> ts.Solution:
    return ts.simulate(MOTOR)


def test_names_are_listed_and_all_exist() -> None:
    assert set(dir(ts)) >= {"Case", "simulate", "compare", "sweep", "Quantity", "films"}
    assert all(getattr(ts, name) is not None for name in ts.__all__)
    with pytest.raises(AttributeError, match="nonexistent"):
        ts.nonexistent  # type: ignore[attr-defined]  # noqa: B018


def test_importing_the_package_imports_nothing_heavy() -> None:
    code = (
        "import sys, toothspace; print([m for m in ('numpy', 'numba', 'pint') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_stub_names_what_the_package_has() -> None:
    stub = (REPOSITORY / "src" / "toothspace" / "__init__.pyi").read_text(encoding="utf-8")
    named = {line.rpartition(" as ")[2] for line in stub.splitlines() if " as " in line}
    assert named | {"__version__"} == set(ts.__all__)
    assert not [name for name in named if getattr(ts, name, None) is None]


WRONG_SCRIPT = """\
import toothspace as ts
ts.nonexistent()
ts.simulate(3)
ts.load_case("a").repalce({})
print(ts.simulate("a").summary()["status"] * 2.0)
"""


WRONG = [
    (2, 'has no attribute "nonexistent"'),
    (3, "incompatible type"),
    (4, '"repalce"'),
    (5, "Unsupported operand types"),
]


def test_type_checker_reads_scripts_of_a_user(tmp_path: Path) -> None:
    """It finds nothing in one, every mistake in the other."""
    pytest.importorskip("mypy")
    scripts = [tmp_path / "right.py", tmp_path / "wrong.py"]
    for script, text in zip(scripts, (USER_SCRIPT, WRONG_SCRIPT), strict=True):
        script.write_text(text, encoding="utf-8")
    options = [
        "--strict",
        "--follow-imports=silent",
        "--cache-dir",
        str(REPOSITORY / ".mypy_cache" / "scripts"),  # other options than those of make lint
    ]
    command = [sys.executable, "-m", "mypy", *options, "--config-file=", *map(str, scripts)]
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=tmp_path, check=False,
        env={"MYPYPATH": str(REPOSITORY / "src"), "PATH": ""},
    )  # fmt: skip
    told = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert len(told) == len(WRONG), done.stdout
    for line, (number, words) in zip(told, WRONG, strict=True):
        assert f"wrong.py:{number}:" in line
        assert words in line


def test_simulate_takes_paths_tables_and_overrides(ran: list[Case]) -> None:
    ts.simulate(MOTOR, operating_point__shaft_speed="2000 rpm", run__fidelity="ideal")
    ts.simulate(str(MOTOR), **{"machine.gears.face_width": ts.Quantity(8, "mm")})
    ts.simulate(ts.load_case(MOTOR).to_dict())
    assert ran[0].run.fidelity == "ideal"
    assert ran[0].value("operating_point.shaft_speed") == pytest.approx(209.4395, rel=1e-6)
    assert ran[1].machine.gears.face_width == 8e-3
    assert ran[2] == ts.load_case(MOTOR)
    with pytest.raises(ts.CaseError, match="fidelty"):
        ts.simulate(MOTOR, run__fidelty="ideal")


@pytest.mark.parametrize("wrong", [3, None, [1], b"x", 2.5, object()])
@pytest.mark.parametrize("name", ["load_case", "simulate", "describe", "load_solution"])
def test_what_is_no_case_and_no_result_is_refused_by_name(name: str, wrong: object) -> None:
    kind = "result" if name == "load_solution" else "case"
    with pytest.raises(ts.CaseError, match=rf"^{kind}: found .*, allowed a"):
        getattr(ts, name)(wrong)


def test_wrong_types_end_in_one_message(solution: ts.Solution) -> None:
    case = ts.load_case(MOTOR)
    calls = {
        "result: found 3": lambda: ts.compare(solution, 3),  # type: ignore[arg-type]
        "cases: found 'egm12_pump'": lambda: ts.simulate_all("egm12_pump"),
        "workers: found '2'": lambda: ts.simulate_all([], workers="2"),  # type: ignore[arg-type]
        "workers: found 0": lambda: ts.sweep(case, {"run.max_revolutions": [9]}, workers=0),
        "values: found 3": lambda: case.replace(3),  # type: ignore[arg-type]
        "case: found None": lambda: ts.Case.from_dict(None),  # type: ignore[arg-type]
        "folder: found 3": lambda: ts.Case.from_dict({}, 3),  # type: ignore[arg-type]
        "--set: found 3": lambda: ts.load_case(MOTOR, 3),  # type: ignore[arg-type]
        "CSV: found 3": lambda: solution.to_csv(3),  # type: ignore[arg-type]
        "report: found 3": lambda: solution.report(3),  # type: ignore[arg-type]
        "bearing.diameter: found '1 mm'": lambda: ts.films.JournalBearing(
            diameter="1 mm",  # type: ignore[arg-type]
            length=0.1,
            radial_clearance=1e-4,
            dynamic_viscosity=0.01,
        ),
    }
    for message, call in calls.items():
        with pytest.raises(ts.CaseError, match=f"^{message}"):
            call()


def test_unknown_fluid_stands_among_the_other_problems() -> None:
    tables = ts.load_case(MOTOR).to_dict()
    tables["machine"]["gears"]["module"] = "3"
    tables["fluid"]["name"] = "iso_vg_45"
    with pytest.raises(ts.CaseError) as refused:
        ts.Case.from_dict(tables)
    assert [line.split(": ")[1] for line in str(refused.value).splitlines()] == [
        "machine.gears.module",
        "fluid.name",
    ]


def test_several_cases(ran: list[Case]) -> None:
    found = ts.simulate_all([MOTOR, ts.load_case(MOTOR)])
    assert all(isinstance(one, ts.Solution) for one in found)


def test_solution_is_shown_short(solution: ts.Solution) -> None:
    assert len(repr(solution)) < 200
    assert "done" in repr(solution)
    assert type(pickle.loads(pickle.dumps(solution))) is ts.Solution
    page = solution._repr_html_()
    assert "volumetric_efficiency" in page
    assert len(page) < 2_000_000


def test_figures_are_objects_of_the_library(solution: ts.Solution) -> None:
    for draw in (
        solution.plot.pressures,
        solution.plot.ripple,
        solution.plot.losses,
        solution.plot.torques,
        solution.plot.leakage,
        solution.plot.orbits,
        solution.plot.forces,
    ):
        assert isinstance(draw(), Figure)
    assert "chamber_pressure" in solution.plot.names()
    with pytest.raises(ts.CaseError, match="figure: found 'portrait', allowed for this result"):
        solution.plot.figure("portrait")


def test_samples_as_table_and_file(solution: ts.Solution, tmp_path: Path) -> None:
    frame = solution.to_dataframe()
    assert frame.index.name == "shaft_angle"
    assert np.array_equal(frame["shaft_torque"], solution.data["shaft_torque"])
    assert any(name.startswith("chamber_pressure[") for name in frame.columns)
    assert frame.attrs["units"]["shaft_torque"] == "N m"
    file = solution.to_csv(tmp_path / "samples.csv")
    columns = read_columns(file, {"shaft_angle": "rad", "shaft_torque": "N m"})
    assert columns["shaft_torque"] == pytest.approx(frame["shaft_torque"].to_numpy(), rel=1e-12)


@pytest.mark.usefixtures("few_figures")
def test_report_and_file(solution: ts.Solution, tmp_path: Path) -> None:
    assert solution.report(tmp_path / "page.html").read_text(encoding="utf-8").startswith("<!")
    again = ts.load_solution(solution.save(tmp_path / "result.nc"))
    assert type(again) is ts.Solution
    assert again.summary() == pytest.approx(solution.summary(), nan_ok=True)


def test_two_results_side_by_side(solution: ts.Solution) -> None:
    case = ts.load_case(MOTOR)
    wide = case.replace({"machine.gears.face_width": "9 mm"})

    def of(given: Case) -> ts.Solution:
        texts = {"case_toml": given.to_toml(), "case_file": str(given.source)}
        return ts.Solution(
            solution.status, solution.data, solution.ledger, solution.statistics,
            {**solution.provenance, **texts},
        )  # fmt: skip

    comparison = ts.compare(of(case), of(wide))
    assert comparison.keys()["machine.gears.face_width"][1] == "9 mm"
    row = comparison.to_dataframe().loc["volumetric_efficiency"]
    assert row["difference"] == 0.0
    assert "face_width" in comparison._repr_html_()
    assert "volumetric_efficiency" in repr(comparison)


def test_sweep_over_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(api, "simulate", lambda case: Answer({**answer(case), "status": "done"}))
    clearances = ["15 um", ts.Quantity(20, "um"), "30 um"]
    result = ts.sweep(MOTOR, {"machine.casing.radial_clearance": clearances})
    found = result.data["volumetric_efficiency"].values
    assert found == pytest.approx([1.0 - 1e-4 * c**2 for c in (15.0, 20.0, 30.0)], rel=1e-9)
