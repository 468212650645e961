"""Internal gear machines with crescent for tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from toothspace import api
from toothspace.machines.crescent.parameters import CrescentParameters

CASE = Path(__file__).resolve().parents[1] / "cases" / "crescent_pump.toml"


def crescent(mode: str = "pump", **ring: Any) -> CrescentParameters:
    """The reference design, with other keys of the ring if any are given."""
    spec = api.load_case(CASE).machine_spec
    return replace(spec, mode=mode, ring=replace(spec.ring, **ring))
