"""Two results side by side, from Python, as text and as a page."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fake_solution import fake_solution
from toothspace.case import Case, load_case
from toothspace.cli import main
from toothspace.core.status import Status
from toothspace.report.comparison import Comparison, shown_change
from toothspace.results.solution import Solution

MOTOR = Path(__file__).resolve().parents[3] / "cases" / "egm12_motor.toml"


def result(case: Case, energy: float = 1.0, status: Status = Status.DONE) -> Solution:
    """A made-up result of a case, with another mesh friction."""
    made = fake_solution()
    ledger = replace(made.ledger, energy={**made.ledger.energy, "mesh_friction": energy})
    texts = {"case_toml": case.to_toml(), "case_file": str(case.source)}
    return replace(made, ledger=ledger, status=status, provenance={**made.provenance, **texts})


def changed(**values: str) -> Case:
    return load_case(MOTOR).replace({k.replace("__", "."): v for k, v in values.items()})


def test_losses_are_mean_powers() -> None:
    first, second = result(load_case(MOTOR), 1.0), result(load_case(MOTOR), 3.0)
    found = Comparison(first, second).losses()["friction, mesh and contacts"]
    assert found == pytest.approx((1.0 / first.ledger.duration, 3.0 / first.ledger.duration))
    assert all(one == two for name, (one, two) in Comparison(first, first).losses().items())


def test_equal_cases_give_no_warning() -> None:
    first = result(load_case(MOTOR))
    again = result(changed(title="the same machine"))
    comparison = Comparison(first, again)
    assert list(comparison.keys()) == ["title"]
    assert comparison.warnings() == []
    assert {difference for _, _, difference, _ in comparison.to_dict()["numbers"].values()} == {0.0}


def test_one_changed_key_is_a_fair_comparison() -> None:
    wide = result(changed(machine__gears__face_width="9 mm"))
    comparison = Comparison(result(load_case(MOTOR)), wide)
    assert comparison.warnings() == []
    assert comparison.answer() == [
        "Changed: gears, face width, from 7.63 mm to 9 mm.",
        "Efficiency, flow, torque, peak and ripple are the same within 0.1 %.",
    ]


@pytest.mark.parametrize(
    ("values", "status", "reason"),
    [
        (
            {"machine__gears__face_width": "9 mm", "operating_point__shaft_speed": "900 rpm"},
            Status.DONE,
            "differ in 2 keys",
        ),
        ({"run__fidelity": "ideal"}, Status.DONE, "other settings: run.fidelity"),
        ({}, Status.NOT_CYCLIC, "second run is no result"),
    ],
)
def test_why_a_difference_may_come_from_elsewhere(
    values: dict[str, str], status: Status, reason: str
) -> None:
    comparison = Comparison(result(load_case(MOTOR)), result(changed(**values), status=status))
    (warning,) = comparison.warnings()
    assert reason in warning


@pytest.mark.parametrize(
    ("name", "first", "second", "change"),
    [
        ("mean_flow_L_per_min", 10.0, 8.0, "-20.00 %"),
        ("mean_flow_L_per_min", -10.0, -8.0, "+20.00 %"),
        ("mean_flow_L_per_min", 10.0, 0.0, "-100.00 %"),
        ("mean_flow_L_per_min", 0.0, 10.0, "-"),
        ("mean_flow_L_per_min", -10.0, 8.0, "-"),
        ("mean_flow_L_per_min", 0.02, 1.0, "x 50"),
        ("outlet_temperature_degC", 50.0, 60.0, "K"),
        ("flow_ripple_percent", 16.0, 8.0, "points"),
        ("start_angle_deg", 10.0, 20.0, "-"),
        ("mass_balance_error", 1e-14, 3e-14, "-"),
    ],
)
def test_a_share_is_told_only_where_it_says_something(
    name: str, first: float, second: float, change: str
) -> None:
    assert shown_change(name, first, second) == change


@pytest.mark.slow
def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result(load_case(MOTOR)).save(tmp_path / "a.nc")
    faster = changed(operating_point__shaft_speed="2000 rpm", machine__gears__face_width="9 mm")
    result(faster, 2.0).save(tmp_path / "b.nc")
    files = [str(tmp_path / "a.nc"), str(tmp_path / "b.nc")]
    page = tmp_path / "compared.html"
    assert main(["compare", *files, "-o", str(page)]) == 0
    streams = capsys.readouterr()
    assert "operating_point.shaft_speed: 1500 rpm -> 2000 rpm" in streams.out
    assert "+100.00 %" in next(x for x in streams.out.splitlines() if "mesh and contacts, W" in x)
    assert "differ in 2 keys" in streams.err
    text = page.read_text(encoding="utf-8")
    assert "mesh and contacts, W" in text
    assert "2000 rpm" in text
    assert main(["compare", *files, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["losses_W"]["friction, mesh and contacts"][3] == pytest.approx(1.0)
    assert main(["compare", *files, "-o", str(page)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["compare", files[0], str(tmp_path / "none.nc")]) == 2
    assert "found nothing, allowed a NetCDF file" in capsys.readouterr().err


def test_the_shell_completes_commands_without_what_is_heavy() -> None:
    program = (
        "import sys\nfrom toothspace.cli import main\n"
        "try:\n    main([])\n"
        "except SystemExit:\n    pass\n"
        "heavy = {'numpy', 'numba', 'scipy', 'xarray', 'pint'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    words = {"_TOOTHSPACE_COMPLETE": "complete_bash", "COMP_WORDS": "toothspace comp"}
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env={**os.environ, **words, "COMP_CWORD": "1"},
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["compare"]
