"""Flow along a tooth space that winds: continuity, closed forms, limits, the warning."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

import toothspace as ts
from toothspace import api
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.space_flow import pressure_along_space
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.model.path_category import INLET_PORT, OPENINGS
from toothspace.run.run import Run
from toothspace.solver.flow_regime import along_spaces, pressure_along_spaces

LENGTH, SPEED, DENSITY, TURN = 24e-3, 157.0, 860.0, 5.3
PLACES = np.linspace(0.0, 1.0, 4001)
HELICAL = Path(__file__).resolve().parents[3] / "cases" / "helical_pump.toml"


def parts(area: Array, rate: Array, viscosity: float = 0.03, speed: float = SPEED) -> Array:
    diameter = np.full_like(area, 2e-3)
    return pressure_along_space(area, rate, diameter, TURN, LENGTH, speed, DENSITY, viscosity)


def test_a_space_that_empties_evenly() -> None:
    """A(z) = A0 (1 + z/b): v = w (1 - A0/A) and all integrals by hand."""
    shut = 10e-6
    area = shut * (1.0 + PLACES)
    rate = np.full_like(area, -shut / (TURN * LENGTH))  # dA/dz = -kappa A'
    passing = SPEED / TURN
    inertia, bernoulli, friction = parts(area, rate)
    assert bernoulli == pytest.approx(0.5 * DENSITY * (0.5 * passing) ** 2, rel=1e-12)
    mean = 1.0 - np.log(2.0)
    assert friction == pytest.approx(32 * 0.03 * passing * mean * LENGTH / 4e-6, rel=1e-6)
    # d(1 - A0/A)/dphi = -A' (A0 - A)/A^2 ... with A' = -A0/(kappa b) everywhere
    gain = passing / (TURN * LENGTH) * (np.log(2.0) - 0.5) * LENGTH
    assert inertia == pytest.approx(DENSITY * SPEED * gain, rel=1e-6)


def test_an_even_space_without_displacement_is_at_rest() -> None:
    area = np.full_like(PLACES, 8e-6)
    np.testing.assert_array_equal(parts(area, np.zeros_like(area)), 0.0)


def test_inertia_grows_with_the_square_of_the_speed() -> None:
    area = 10e-6 * (1.0 + PLACES**2)
    rate = -np.gradient(area, PLACES * LENGTH) / TURN
    slow, fast = (parts(area, rate, speed=k * SPEED) for k in (1.0, 2.0))
    np.testing.assert_allclose(fast / slow, [4.0, 4.0, 2.0], rtol=1e-12)


@cache
def prepared(hand: str = "right") -> Run:
    return api.prepare(ts.load_case(HELICAL, (f"machine.gears.helix_hand={hand}",)))


def test_a_machine_needs_more_the_faster_it_turns_and_the_same_for_both_hands() -> None:
    run = prepared()
    slow, fast = (pressure_along_spaces(run.machine, run.fluid, k * SPEED) for k in (1.0, 2.0))
    assert 2.0 < fast / slow <= 4.0
    assert 1e5 < slow < 5e5
    left = prepared("left")
    assert pressure_along_spaces(left.machine, left.fluid, SPEED) == pytest.approx(slow, rel=1e-9)
    assert pressure_along_spaces(run.machine, run.fluid, 0.0) == 0.0


def test_spaces_that_shrink_evenly_by_hand() -> None:
    """A(angle) = A0 [1 - s (angle - pi/2)], open at the leading end until it meshes."""
    first, shrink, ratio, twist, width = 20e-6, 0.4, 0.75, 0.5, LENGTH
    run = prepared()
    fluid = run.fluid

    class Volume:
        def __call__(self, angle: Array) -> Array:
            return width * first * (1.0 - shrink * (angle[..., None] - 0.5 * np.pi))

        def derivative(self, angle: Array) -> Array:
            return np.full((*angle.shape, 1), -width * first * shrink)

    def still_open(angle: Array) -> Array:
        return np.where(angle < np.pi - 1e-9, 1e-6, 0.0)[:, None]

    opening = next(path for path in run.machine.paths if path.category.role in OPENINGS)
    path = SimpleNamespace(category=opening.category, nodes_a=np.array([0]), geometry=still_open)
    family = SimpleNamespace(volume=Volume(), angle_ratio=ratio, phases=np.zeros(7))
    section = SimpleNamespace(families=[family], paths=[path])
    winding = SimpleNamespace(twist=twist, turn_per_length=-twist / width, section=section)
    machine = cast(MachineDescription, SimpleNamespace(winding=winding))
    shut = first * (1.0 - shrink * 0.5 * np.pi)
    end = shut + first * shrink * twist * ratio
    largest = first * (1.0 + shrink * twist * ratio)
    passing = SPEED * width / twist
    per_area = width / (end - shut)
    gain = passing * shrink * first * per_area * (np.log(end / shut) - 1.0 + shut / end)
    inertia = fluid.reference_density * SPEED * ratio * gain
    bernoulli = 0.5 * fluid.reference_density * (passing * (1.0 - shut / end)) ** 2
    curved = 1.0 / shut - 1.0 / end - 0.5 * shut * (1.0 / shut**2 - 1.0 / end**2)
    friction = 32.0 * fluid.dynamic_viscosity * passing * largest * per_area * curved
    found = pressure_along_spaces(machine, fluid, SPEED)
    assert found == pytest.approx(inertia + bernoulli + friction, rel=1e-3)


@pytest.mark.slow
def test_nothing_is_needed_while_the_end_that_leads_is_open() -> None:
    """The recess of the cover is open to the pinion until the spaces are as good as empty."""
    run = api.prepare(ts.load_case(HELICAL.with_name("crescent_helical.toml")))
    assert pressure_along_spaces(run.machine, run.fluid, SPEED) < 1e5


def test_what_one_pressure_cannot_hold_is_said_with_its_number() -> None:
    assert not list(along_spaces(5e5, 120e5))
    (finding,) = along_spaces(9e5, 120e5)
    assert "9 bar" in finding.text
    assert "6 bar" in finding.text


A_START, FALL, TWIST, RATIO, KAPPA = 30e-6, 8e-6, 0.6, 0.5, 25.0
"""Section of a space at a quarter of a turn [m2], how much it shrinks with the angle [m2/rad]."""


def even_spaces(closed_at: float, fall: float = FALL) -> MachineDescription:
    """Spaces whose sections shrink evenly, enclosed at one angle only."""
    width = TWIST / KAPPA

    def area(angle: Array) -> Array:
        return (A_START - fall * (angle - 0.5 * np.pi))[..., None]

    volume = SimpleNamespace(derivative=lambda angle: np.full((*angle.shape, 1), -fall * width))
    table = type("Volume", (), {"__call__": lambda _, angle: area(angle) * width})()
    table.derivative = volume.derivative
    port = SimpleNamespace(
        category=INLET_PORT,
        nodes_a=[0],
        geometry=lambda angle: 1e-6 * (np.abs(angle - closed_at) > 1e-9)[:, None],
    )
    family = SimpleNamespace(angle_ratio=RATIO, volume=table, phases=np.zeros(6))
    winding = SimpleNamespace(
        twist=TWIST,
        turn_per_length=-KAPPA,
        section=SimpleNamespace(families=[family], paths=[port]),
    )
    return cast(MachineDescription, SimpleNamespace(winding=winding))


def test_what_a_space_needs_is_looked_for_from_a_quarter_of_a_turn_on() -> None:
    """A(z) = A0 + (A1 - A0) z/b: the integrals by hand where all is open at later angles."""
    closed_at = 0.5 * np.pi
    fluid = cast(FluidLaw, SimpleNamespace(reference_density=DENSITY, dynamic_viscosity=0.3))
    found = pressure_along_spaces(even_spaces(closed_at), fluid, SPEED)
    lead = TWIST * RATIO
    shut = A_START - FALL * (closed_at - 0.5 * np.pi)
    end, largest = shut + FALL * lead, A_START + FALL * lead
    growth, passing = FALL * lead / (TWIST / KAPPA), SPEED / KAPPA
    inertia = np.log(end / shut) - (1.0 - shut / end)
    inertia *= DENSITY * SPEED * RATIO * passing * FALL / growth
    bernoulli = 0.5 * DENSITY * (passing * (1.0 - shut / end)) ** 2
    drag = (1.0 / shut - 1.0 / end) - 0.5 * shut * (1.0 / shut**2 - 1.0 / end**2)
    drag *= 32.0 * 0.3 * passing * largest / growth
    assert found == pytest.approx(inertia + bernoulli + drag, rel=2e-3)


def test_a_space_below_a_tenth_of_the_largest_section_is_shut() -> None:
    """What is left at the shut end neither shrinks nor leaves: its section counts as a tenth."""
    fall = 18e-6
    fluid = cast(FluidLaw, SimpleNamespace(reference_density=DENSITY, dynamic_viscosity=0.0))
    found = pressure_along_spaces(even_spaces(np.pi, fall), fluid, SPEED)
    lead = TWIST * RATIO
    end, largest = A_START + fall * (lead - 0.5 * np.pi), A_START + fall * lead
    shut, passing = 0.1 * largest, SPEED / KAPPA
    growth = fall * lead / (TWIST / KAPPA)
    inertia = -DENSITY * SPEED * RATIO * passing * fall / growth * (1.0 - shut / end)
    bernoulli = 0.5 * DENSITY * (passing * (1.0 - shut / end)) ** 2
    assert found == pytest.approx(max(inertia + bernoulli, 0.0), rel=0.03)


def test_pressures_along_spaces_are_told_in_bar() -> None:
    """A twentieth of 120 bar for each of two slices."""
    (finding,) = along_spaces(13e5, -120e5, 2)
    assert (finding.found, finding.allowed) == ("13 bar", "up to 12 bar")
