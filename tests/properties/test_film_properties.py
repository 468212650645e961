"""What holds for every journal film."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from toothspace.films import Groove, JournalBearing, JournalBearingSolution

RATIO = st.floats(0.0, 0.97)
ANGLE = st.floats(0.0, 6.28)
SPEED = st.sampled_from([-400.0, -20.0, 30.0, 500.0])


@st.composite
def bearings(draw: st.DrawFn) -> JournalBearing:
    """Bearings with up to two grooves, open or closed ends, flooded or starved."""
    length = draw(st.sampled_from([0.01, 0.04, 0.08]))
    cavitation_pressure = draw(st.sampled_from([0.0, 1e5]))
    excess = draw(st.sampled_from([0.0, 1e5, 8e5]))
    grooves = [
        Groove(
            draw(ANGLE),
            draw(st.floats(0.05, 0.7)),
            length * draw(st.sampled_from([0.4, 1.0])),
            cavitation_pressure + draw(st.sampled_from([0.0, 1e5, 1e6])),
        )
        for _ in range(draw(st.integers(0, 2)))
    ]
    return JournalBearing(
        diameter=0.05,
        length=length,
        radial_clearance=40e-6,
        dynamic_viscosity=0.02,
        grid=(draw(st.integers(30, 64)), draw(st.integers(5, 14))),
        grooves=tuple(grooves),
        end_pressure=cavitation_pressure + excess,
        cavitation_pressure=cavitation_pressure,
        end_condition=draw(st.sampled_from(["pressure", "pressure", "no_flow"])),
    )


def _solve(
    bearing: JournalBearing, ratio: float, angle: float, speed: float
) -> JournalBearingSolution:
    place = (ratio * np.cos(angle), ratio * np.sin(angle))
    return bearing.solve(eccentricity=place, shaft_speed=speed)


@given(bearings(), RATIO, ANGLE, SPEED)
@settings(max_examples=150)
def test_film_settles_and_conserves_mass(
    bearing: JournalBearing, ratio: float, angle: float, speed: float
) -> None:
    film = _solve(bearing, ratio, angle, speed)
    assert film.status.succeeded
    assert film.mass_balance_error < 1e-10
    excess = film.pressure - bearing.cavitation_pressure
    fraction = film.film_fraction
    assert excess.min() >= 0.0
    assert fraction.max() <= 1.0 + 1e-9
    assert fraction.min() >= -1e-12
    assert np.all((excess <= 0.0) | (fraction >= 1.0))


@given(bearings(), RATIO, ANGLE, SPEED)
@settings(max_examples=20)
def test_friction_always_brakes(
    bearing: JournalBearing, ratio: float, angle: float, speed: float
) -> None:
    """Friction power of shaft and bush together is never gained without supply pressure."""
    flooded = JournalBearing(
        diameter=bearing.diameter,
        length=bearing.length,
        radial_clearance=bearing.radial_clearance,
        dynamic_viscosity=bearing.dynamic_viscosity,
        grid=bearing.grid,
    )
    film = _solve(flooded, ratio, angle, speed)
    assert film.power_loss > 0.0


@given(bearings(), RATIO, ANGLE, st.floats(1.5, 4.0))
@settings(max_examples=20)
def test_similar_films_have_similar_forces(
    bearing: JournalBearing, ratio: float, angle: float, factor: float
) -> None:
    """Viscosity and all excess pressures times a factor: forces and flows follow it."""
    base = bearing.cavitation_pressure
    scaled = JournalBearing(
        diameter=bearing.diameter,
        length=bearing.length,
        radial_clearance=bearing.radial_clearance,
        dynamic_viscosity=bearing.dynamic_viscosity * factor,
        grid=bearing.grid,
        grooves=tuple(
            Groove(g.angle, g.width, g.length, base + factor * (g.pressure - base))
            for g in bearing.grooves
        ),
        end_pressure=base + factor * (bearing.end_pressure - base),
        cavitation_pressure=base,
        end_condition=bearing.end_condition,
    )
    one, other = _solve(bearing, ratio, angle, 100.0), _solve(scaled, ratio, angle, 100.0)
    # a centred shaft carries nothing: what is left are the rounded sums of the pressures
    sums = max(bearing.end_pressure, base) * bearing.diameter * bearing.length
    allowed = 1e-6 * one.load + 1e-9 * sums + 1e-12
    assert other.force / factor == pytest.approx(one.force, rel=1e-6, abs=allowed)
