"""The 12-tooth pump between two tanks at a constant speed, for tests of how it turns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from toothspace import api

CASES = Path(__file__).resolve().parents[1] / "cases"


def pump_between_tanks(speed: str, duration: str, *, high: str) -> dict[str, Any]:
    """Tables of a case with 100 bar at the port ``high`` and 1 bar at the other, without a run."""
    tables = api.load_case(CASES / "egm12_pump.toml").to_dict()
    del tables["operating_point"]
    low = "outlet" if high == "inlet" else "inlet"
    tables["circuit"] = {
        "duration": duration,
        "initial_shaft_speed": speed,
        "connections": [[f"machine.{high}", "high"], [f"machine.{low}", "low"]],
        "high": {"kind": "tank", "pressure": "100 bar"},
        "low": {"kind": "tank", "pressure": "1 bar"},
        "spin": {"kind": "speed_source", "speed": [["0 s", speed]]},
    }
    return tables
