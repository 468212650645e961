"""Friction of a rough journal over its speed, and the curve through it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.closures.journal_friction import PUBLISHED_CURVE
from toothspace.films import JournalBearing, RoughSurfaces
from toothspace.films.journal.mixed_lubrication import (
    fit_friction_curve,
    machine_bearing,
    sweep_friction,
)

CASES = Path(__file__).resolve().parents[3] / "cases"
BEARING = JournalBearing(
    diameter=18e-3,
    length=19e-3,
    radial_clearance=8e-6,
    dynamic_viscosity=0.026,
    grid=(48, 9),
    surfaces=RoughSurfaces(moving_roughness=0.3e-6, resting_roughness=0.2e-6),
)
LOAD = 2000.0


def test_a_sweep_is_the_equilibria_at_its_numbers() -> None:
    """S = (eta N/P)(R/c)^2; asperities carry nearly all at the slowest, nothing at the fastest."""
    numbers = np.array([1e-6, 0.01, 0.2])
    sweep = sweep_friction(BEARING, load=LOAD, sommerfeld_numbers=numbers)
    assert sweep.converged
    pressure = LOAD / (18e-3 * 19e-3)
    turns = numbers * pressure / 0.026 * (8e-6 / 9e-3) ** 2
    assert sweep.shaft_speed == pytest.approx(2.0 * np.pi * turns, rel=1e-9, abs=0.0)
    assert sweep.contact_share[0] == pytest.approx(1.0, abs=0.02)
    assert sweep.contact_share[-1] == 0.0
    film = BEARING.equilibrium(load=(LOAD, 0.0), shaft_speed=float(sweep.shaft_speed[1]))
    share = np.hypot(*film.contact_force) / LOAD
    assert 0.0 < share < 1.0
    assert sweep.contact_share[1] == pytest.approx(share, rel=1e-4)
    torque = -film.friction_torque
    assert sweep.friction_coefficient[1] == pytest.approx(torque / (9e-3 * LOAD), rel=1e-4)
    assert sweep.eccentricity_ratio[1] == pytest.approx(film.eccentricity_ratio, rel=1e-4)


def test_a_fit_to_its_own_formula_is_the_curve() -> None:
    numbers = np.geomspace(1e-4, 0.4, 30)
    found = fit_friction_curve(numbers, PUBLISHED_CURVE(numbers))
    for name in ("boundary", "decay", "rise", "transition", "offset"):
        assert getattr(found, name) == pytest.approx(getattr(PUBLISHED_CURVE, name), rel=1e-3), name
    # without points of the full film the line goes through the fit at 0.5
    at_half = found.rise * np.tanh(0.5 / found.transition) + found.offset
    assert found.line == pytest.approx(2.0 * at_half, rel=1e-9)
    further = np.append(numbers, [0.8, 1.0])
    friction = np.append(PUBLISHED_CURVE(numbers), [0.8 * 0.02, 1.0 * 0.03])
    assert fit_friction_curve(further, friction).line == pytest.approx(0.025, rel=1e-9)


def test_the_film_of_a_machine_has_its_combined_roughness() -> None:
    machine = api.describe(api.load_case(CASES / "egm12_pump.toml"))
    journal = replace(machine.journals[0], roughness=0.5e-6)
    bearing = machine_bearing(journal, 0.02)
    assert bearing.surfaces is not None
    assert bearing.surfaces.roughness == pytest.approx(0.5e-6, rel=1e-12, abs=0.0)
    assert bearing.surfaces.moving_roughness == bearing.surfaces.resting_roughness
