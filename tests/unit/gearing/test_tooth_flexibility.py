"""Flexibility of tooth pairs of unequal shifts by the standard, term by term."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from toothspace import api
from toothspace.gearing.flank_contacts import tooth_stiffness
from toothspace.machines.external_gear.assembly import assemble
from toothspace.machines.external_gear.gear_bodies import flank_pair

PUMP = Path(__file__).resolve().parents[3] / "cases" / "egm12_pump.toml"


def flexibility(counts: tuple[int, int], shifts: tuple[float, float]) -> float:
    """ISO 6336-1, equation for q' of spur gears, the larger shift first. [mm um/N]."""
    (z1, x1), (z2, x2) = sorted(zip(counts, shifts, strict=True), key=lambda tooth: -tooth[1])
    return (
        0.04723
        + 0.15551 / z1
        + 0.25791 / z2
        - 0.00635 * x1
        - 0.11654 * x1 / z1
        - 0.00193 * x2
        - 0.24188 * x2 / z2
        + 0.00529 * x1**2
        + 0.00182 * x2**2
    )


@pytest.mark.parametrize("shifts", [(0.5, 0.1), (0.1, 0.5), (0.4, -0.2)])
def test_shifts_change_the_flexibility_as_in_the_standard(shifts: tuple[float, float]) -> None:
    """The flattening that is taken off does not hang on the shifts, so it cancels."""
    case = api.load_case(PUMP).replace(
        {"machine.driven_gear": {"tooth_count": 15, "tip_diameter": "48.9 mm"}}
    )
    gears = assemble(case.machine_spec)
    counts = gears.teeth[0].tooth_count, gears.teeth[1].tooth_count
    assert counts == (12, 15)
    flanks = flank_pair(gears)
    soft = [
        1.0 / tooth_stiffness(gears, replace(flanks, profile_shifts=pair))
        for pair in (shifts, (0.0, 0.0))
    ]
    expected = flexibility(counts, shifts) - flexibility(counts, (0.0, 0.0))
    steel = flanks.materials[0].elastic_modulus / 206e9
    # c' = 0.8 / q', with moduli relative to those of the standard; 1 mm um/N = 1e-9 m2/N
    assert soft[0] - soft[1] == pytest.approx(1e-9 * expected / (0.8 * steel), rel=1e-6, abs=0.0)
