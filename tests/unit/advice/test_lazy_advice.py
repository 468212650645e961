"""Advice is given when it is asked for, once, and never in the way of a run."""

from __future__ import annotations

import cProfile
import pickle
import pstats
from pathlib import Path

import pytest

from tests.external_gear_designs import egm12
from toothspace import advice, api
from toothspace.case import load_case
from toothspace.machines.external_gear import MACHINE

ROOM = str(Path(advice.__file__).parent)
CASES = ["egm12_pump", "crescent_pump", "gerotor_trochoidal", "egm12_motor_profile"]


def passed_in_advice(profile: cProfile.Profile) -> set[str]:
    """Functions of the room that were passed, and rules that machines declare."""
    found = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    return {
        name
        for file, _, name in found
        if file.startswith(ROOM) or name in {"design_checks", "geometry_summary"}
    }


@pytest.mark.parametrize("name", CASES)
def test_a_description_computes_no_advice(name: str) -> None:
    case = load_case(name)
    api._machines.clear()
    profile = cProfile.Profile()
    description = profile.runcall(api.describe, case)
    assert passed_in_advice(profile) == set()
    asked = cProfile.Profile()
    asked.runcall(list, description.checks)
    assert "bearing_checks" in passed_in_advice(asked)


def test_advice_is_computed_once_for_a_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    from toothspace.machines.external_gear import summary

    counted = []
    original = summary.bearing_checks
    monkeypatch.setattr(
        summary, "bearing_checks", lambda *given: counted.append(1) or original(*given)
    )
    description = MACHINE.describe(egm12(), nodes=72)
    assert counted == []
    worn = description.with_running_in({})
    assert len(worn.checks) == len(description.checks) > 10
    assert description.geometry_summary["warnings"] is not None
    assert worn.geometry_summary["contact_ratio"] == description.geometry_summary["contact_ratio"]
    assert len(counted) == 1


def test_a_description_travels_with_its_advice() -> None:
    description = MACHINE.describe(egm12(), nodes=72)
    again = pickle.loads(pickle.dumps(description))
    assert list(again.checks) == list(description.checks)
    assert dict(again.geometry_summary) == dict(description.geometry_summary)


def test_enclosed_fluid_without_relief_grooves_fails_the_design_rule() -> None:
    def verdict(spec: object) -> tuple[bool, str]:
        checks = {check.name: check for check in MACHINE.describe(spec, nodes=72).checks}
        return checks["trapped volume change"].passed, checks["trapped volume change"].allowed

    passed, allowed = verdict(egm12())
    assert passed
    assert "vented by relief grooves at most" in allowed
    passed, allowed = verdict(egm12(grooves=None))
    assert not passed
    assert allowed.startswith("below 0.002 face_width module^2, without relief grooves; below 0.5")
