"""Machines whose gears have different tooth counts, and so tables of different lengths."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.core.status import Status
from toothspace.results.solution import load_solution
from toothspace.run.running_in import named_depths

PUMP = Path(__file__).resolve().parents[3] / "cases" / "egm12_pump.toml"
ONE_MORE = ["machine.driven_gear.tooth_count=13"]
FIVE_MORE = [
    "machine.driven_gear.tooth_count=17",
    'machine.driven_gear.tip_diameter="54 mm"',
]


@pytest.mark.parametrize("driven", [ONE_MORE, FIVE_MORE], ids=["12/13", "12/17"])
@pytest.mark.parametrize(
    "preset",
    ["ideal", *(pytest.param(name, marks=pytest.mark.slow) for name in ("lumped", "films"))],
)
def test_unequal_gears_run_with_every_preset(
    preset: str, driven: list[str], tmp_path: Path
) -> None:
    chosen = [*driven, f"run.fidelity={preset}", "run.revolutions=1"]
    solution = api.simulate(api.load_case(PUMP, chosen))
    assert solution.status is Status.DONE
    kept = load_solution(solution.save(tmp_path / "result.nc"))
    assert kept.summary() == pytest.approx(solution.summary(), nan_ok=True)
    if preset != "ideal":
        assert kept.data["running_in_depth"].sizes["casing_angle"] >= 720


def test_tracks_of_unequal_gears_lie_over_one_casing_angle() -> None:
    """Each gear's track keeps its place and its depth, though its table has fewer nodes."""
    description = api.describe(api.load_case(PUMP, ONE_MORE))

    def track(nodes: int) -> np.ndarray:
        angle = np.arange(nodes) * 2.0 * np.pi / nodes
        return 4e-6 * np.maximum(0.0, np.cos(angle - 4.0)) ** 4

    depths = {"drive_gear": track(720), "driven_gear": track(780)}
    bodies = [body.name for body in description.bodies]
    values = named_depths("running_in_depth", depths, bodies)
    table, angle = values["running_in_depth"], values["casing_angle"]
    assert table.shape == (2, angle.size)
    np.testing.assert_allclose(table[1], depths["driven_gear"], atol=1e-18)
    np.testing.assert_allclose(table[0], table[1], atol=1e-9)
