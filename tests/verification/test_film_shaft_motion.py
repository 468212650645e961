"""Stability threshold and orbit of a rigid shaft."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.films import Groove, JournalBearing
from toothspace.films.journal.shaft_motion import (
    OrbitSettings,
    critical_mass,
    shaft_orbit,
    threshold_speed,
)

BEARING = JournalBearing(
    diameter=0.06,
    length=0.03,
    radial_clearance=60e-6,
    dynamic_viscosity=0.02,
    grid=(60, 9),
    grooves=tuple(Groove(side * np.pi / 2, 0.35, 0.03, 2e5) for side in (1.0, -1.0)),
    end_pressure=1e5,
    cavitation_pressure=1e5,
)
LOAD, SPEED = (600.0, 0.0), 300.0


def test_critical_mass_puts_an_eigenvalue_on_the_imaginary_axis() -> None:
    film = BEARING.equilibrium(load=LOAD, shaft_speed=SPEED)
    mass, whirl = critical_mass(film.stiffness, film.damping)
    zero, one = np.zeros((2, 2)), np.eye(2)
    system = np.block([[zero, one], [-film.stiffness / mass, -film.damping / mass]])
    values = np.linalg.eigvals(system)
    closest = values[np.argmin(np.abs(values - 1j * whirl))]
    assert closest == pytest.approx(1j * whirl, abs=1e-6 * whirl)
    assert values.real.max() < 1e-6 * whirl
    assert 0.3 * SPEED < whirl < 0.6 * SPEED


def test_threshold_speed_has_the_given_critical_mass() -> None:
    film = BEARING.equilibrium(load=LOAD, shaft_speed=SPEED)
    mass, _ = critical_mass(film.stiffness, film.damping)
    found = threshold_speed(BEARING, load=LOAD, mass=mass, speeds=(0.5 * SPEED, 2.0 * SPEED))
    assert found == pytest.approx(SPEED, rel=1e-3)
    with pytest.raises(CaseError, match="both sides"):
        threshold_speed(BEARING, load=LOAD, mass=mass, speeds=(0.1 * SPEED, 0.2 * SPEED))


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "grows"), [(0.6, False), (1.6, True)])
def test_orbit_grows_only_beyond_the_critical_mass(factor: float, grows: bool) -> None:
    """Small disturbance followed over eight revolutions."""
    film = BEARING.equilibrium(load=LOAD, shaft_speed=SPEED)
    mass, _ = critical_mass(film.stiffness, film.damping)
    rest = film.motion.place[:2]
    settings = OrbitSettings(
        position=(float(rest[0]) + 2e-7, float(rest[1])),
        velocity=(0.0, 0.0),
        duration=8 * 2 * np.pi / SPEED,
        time_step=2 * np.pi / SPEED / 24,
    )
    orbit = shaft_orbit(
        BEARING, mass=factor * mass, load=lambda t: LOAD, shaft_speed=SPEED, settings=settings
    )
    assert orbit.converged
    distance = np.hypot(*(orbit.position - rest).T)
    third = distance.size // 3
    early, late = distance[third : 2 * third].max(), distance[-third:].max()
    assert (late > early) == grows


@pytest.mark.slow
def test_orbit_of_a_falling_shaft_has_second_order() -> None:
    """Free start without rotation: the error falls by four when the step is halved."""
    plain = replace(BEARING, grooves=(), cavitation="guembel")
    ends = []
    for steps in (20, 40, 80):
        settings = OrbitSettings((0.0, 0.0), (0.0, 0.0), 2e-3, 2e-3 / steps)
        orbit = shaft_orbit(
            plain, mass=3.0, load=lambda t: (500.0, 0.0), shaft_speed=SPEED, settings=settings
        )
        ends.append(orbit.position[-1])
    ratio = np.hypot(*(ends[0] - ends[1])) / np.hypot(*(ends[1] - ends[2]))
    # 4.06 here, 4.04 with half the steps: what is left is of third order
    assert ratio == pytest.approx(4.0, abs=0.1)


def test_film_memory_conserves_the_liquid() -> None:
    """Content after a step equals content before plus what flowed in."""
    film = BEARING.solve(eccentricity=(0.5, 0.0), shaft_speed=SPEED)
    step = 1e-4
    later = BEARING.solve(eccentricity=(0.52, 0.01), shaft_speed=SPEED, history=film.history(step))
    assert later.status.succeeded
    grid = later.solved.film.grid
    free = grid.mark == 0
    before = film.history(step).content
    after = later.history(step).content
    gained = 2.0 * float(((after - before) * grid.area)[free].sum())
    inflow = (later.supply_flow - later.side_flow) * step
    # the balance of the supply cells contains their own change of content
    own = 2.0 * float(((after - before) * grid.area)[~free].sum())
    assert gained == pytest.approx(inflow - own, rel=1e-8, abs=0.0)


def test_long_steps_with_memory_reach_the_steady_film() -> None:
    steady = BEARING.solve(eccentricity=(0.5, 0.0), shaft_speed=SPEED)
    film = BEARING.solve(eccentricity=(0.45, 0.0), shaft_speed=SPEED)
    for _ in range(4):
        film = BEARING.solve(eccentricity=(0.5, 0.0), shaft_speed=SPEED, history=film.history(10.0))
    assert film.force == pytest.approx(steady.force, rel=1e-4)


@pytest.mark.parametrize(("ratio", "memory"), [(0.2, False), (0.8, False), (0.5, True)])
def test_every_step_of_an_orbit_is_in_balance(ratio: float, memory: bool) -> None:
    """Backward differences, the first of first order: m a = load + film; close to the bush too."""
    plain = replace(BEARING, grooves=(), grid=(48, 9), supply="none")
    mass, step = 2.0, 5e-5
    settings = OrbitSettings(
        position=(ratio * 60e-6, 0.0), velocity=(0.01, 0.0), duration=5 * step, time_step=step,
        film_memory=memory,
    )  # fmt: skip
    orbit = shaft_orbit(
        plain, mass=mass, load=lambda t: (200.0 * t / step, 500.0), shaft_speed=SPEED,
        settings=settings,
    )  # fmt: skip
    assert orbit.converged
    assert orbit.time == pytest.approx(step * np.arange(6), rel=1e-12)
    load = np.column_stack([200.0 * orbit.time / step, np.full(6, 500.0)])

    def rate(values: np.ndarray) -> np.ndarray:
        later = 1.5 * values[2:] - 2.0 * values[1:-1] + 0.5 * values[:-2]
        return np.vstack([values[1:2] - values[:1], later]) / step

    speed = np.abs(orbit.velocity).max()
    np.testing.assert_allclose(rate(orbit.position), orbit.velocity[1:], atol=1e-9 * speed)
    missing = load[1:] + orbit.force[1:] - mass * rate(orbit.velocity)
    assert np.abs(missing).max() < 1e-5 * np.abs(orbit.force).max()
