"""Numbers of films on three grids."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from toothspace.cli import main
from toothspace.films import grid_report

CASES = Path(__file__).parents[3] / "cases"


def test_report_of_a_number_of_second_order() -> None:
    """Error 5 / cells^2: order 2, and the error of the given grid over the finest value."""

    def solve(grid: tuple[int, int]) -> dict[str, object]:
        return {"load_N": 100.0 + 5.0 / grid[0] ** 2, "wall_time_s": 1.0, "status": "done"}

    report = grid_report(solve, (10, 4))
    assert report["grids"] == [[5, 2], [10, 4], [20, 8]]
    assert set(report) == {"grids", "load_N"}
    load = report["load_N"]
    assert load["order"] == pytest.approx(2.0)
    assert load["error"] * load["twice"] == pytest.approx(5.0 / 100.0)


def test_numbers_that_do_not_converge_have_no_order() -> None:
    report = grid_report(lambda grid: {"flow": float(grid[0] % 7)}, (10, 4))
    assert report["flow"]["order"] is None


@pytest.mark.parametrize(
    ("table", "name"), [("bearing", "journal_bearing"), ("film", "slider_pad")]
)
def test_command_lists_the_grids(table: str, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    case = str(CASES / f"{name}.toml")
    arguments = [table, case, "--grids", "--set", f"{table}.grid=[24,12]"]
    assert main([*arguments, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)["grid_report"]
    assert report["grids"] == [[12, 6], [24, 12], [48, 24]]
    assert 0.0 < report["max_pressure_bar"]["error"] < 0.1
    assert main(arguments) == 0
    assert "grids" in capsys.readouterr().out
