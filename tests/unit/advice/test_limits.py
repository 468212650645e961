"""Limits by hand: speed of tips against the inlet pressure, of equal and unequal gears."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest

from toothspace import api
from toothspace.advice.findings import limits_of

PUMP = Path(__file__).resolve().parents[3] / "cases" / "egm12_pump.toml"
IDEAL = {"run.fidelity": "lumped", "run.samples_per_revolution": 90, "heat.model": "network"}


@pytest.mark.parametrize(
    ("unequal", "radius", "ratio"),
    [({}, 20.186e-3, 1.0), ({"tooth_count": 15, "tip_diameter": "48.9 mm"}, 24.45e-3, 0.8)],
    ids=["equal", "unequal"],
)
def test_tips_are_judged_by_bernoulli(unequal: dict[str, Any], radius: float, ratio: float) -> None:
    """The speed of the fastest tips, and what 1 bar gives the oil."""
    change = {**IDEAL, "operating_point.outlet_load": "fixed_pressure"}
    if unequal:
        change["machine.driven_gear"] = unequal
        change["machine.floating_bearing"] = None
    case = api.load_case(PUMP).replace(change)
    solution = api.simulate(case)
    [limit] = [x for x in limits_of(solution, api.describe(case)) if x.label == "Speed of the tips"]
    fastest = max(20.186e-3, radius * ratio) * 1500.0 * pi / 30.0
    density = float(solution.data["inlet_density"])
    assert float(limit.value.split()[0]) == pytest.approx(fastest, rel=1e-3)
    bernoulli = sqrt(2.0 * float(solution.data["inlet_pressure"].mean()) / density)
    assert float(limit.allowed.split()[2]) == pytest.approx(bernoulli, rel=1e-3)
