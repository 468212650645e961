"""Shafts in gears and rims round rings: sizes that are refused, mass and inertia of what turns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.external_gear_designs import CARBURISED_STEEL, TWELVE, egm12
from toothspace import api
from toothspace.core.errors import CaseError, GeometryError
from toothspace.gearing.materials import Material, reduced_modulus
from toothspace.geometry.involute import generate_profile
from toothspace.machines.shared_bearings import gear_on_shaft, require_rim, require_shaft_below


def test_a_shaft_stays_below_the_roots() -> None:
    require_shaft_below("shaft", 29.9e-3, 15e-3)
    for diameter in (30e-3, 31.5e-3):
        with pytest.raises(GeometryError) as refused:
            require_shaft_below("shaft", diameter, 15e-3)
        (problem,) = refused.value.problems
        assert problem.found == f"{1e3 * diameter:.5g} mm"
        assert problem.allowed == "below the root diameter, 30 mm"


def test_a_rim_goes_beyond_the_roots() -> None:
    require_rim("rim", 30.1e-3, 15e-3)
    for diameter in (30e-3, 28.5e-3):
        with pytest.raises(GeometryError) as refused:
            require_rim("rim", diameter, 15e-3)
        (problem,) = refused.value.problems
        assert problem.found == f"{1e3 * diameter:.5g} mm"
        assert problem.allowed.startswith("above 30 mm")


def test_journals_of_a_case_stay_below_the_roots_of_the_gears() -> None:
    case = api.load_case("egm12_pump")
    root = float(api.describe(case).geometry_summary["root_diameter_mm"])
    key = "machine.journal_bearings.diameter"
    assert case.replace({key: f"{root - 0.01} mm"}).machine_spec
    with pytest.raises(CaseError) as refused:
        _ = case.replace({key: f"{root + 0.01} mm"}).machine_spec
    (problem,) = refused.value.problems
    assert problem.found == f"{root + 0.01:.5g} mm"
    assert problem.allowed == f"below the root diameter of the gears, {root:.5g} mm"


def test_a_gear_turns_with_two_journals() -> None:
    """A sum over its triangles about the axis, and of two cylinders of 18 by 19 mm."""
    bearing = egm12().keys.journal_bearings
    steel = replace(CARBURISED_STEEL, density=8000.0)
    profile = generate_profile(TWELVE, 400)
    points = profile.closed_polygon()
    after = np.roll(points, -1, axis=0)
    crossed = points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]
    squares = (points**2 + points * after + after**2).sum(axis=1)
    gear, polar = 8.0 * 0.5 * crossed.sum(), 8.0 * (crossed * squares).sum() / 12.0
    shaft = 8000.0 * np.pi * 9e-3**2 * 2.0 * 19e-3
    body = gear_on_shaft("gear", profile, 1e-3, steel, bearing)
    assert body.mass == pytest.approx(gear + shaft, rel=1e-4)
    assert body.inertia == pytest.approx(polar + 0.5 * shaft * 9e-3**2, rel=1e-4)
    assert body.speed_ratio == 1.0
    around = np.hypot(*(after - points).T).sum()
    assert body.wetted_area == pytest.approx(1e-3 * around, rel=1e-3)


def test_unlike_materials_yield_together() -> None:
    """Halves of both compliances: (1 - 0.3^2)/200 GPa and (1 - 0.5^2)/100 GPa."""
    hard, soft = (
        Material(elastic_modulus=modulus, poisson_ratio=ratio, hardness=1e9)
        for modulus, ratio in ((200e9, 0.3), (100e9, 0.5))
    )
    wanted = 2.0 / (0.91 / 200e9 + 0.75 / 100e9)
    assert reduced_modulus(hard, soft) == pytest.approx(wanted)
    assert reduced_modulus(soft, hard) == pytest.approx(wanted)
