"""Gap that asperities hold open against faces that deform."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.reynolds.rough_surfaces import contact_field, contact_table
from toothspace.floating.compliant_film import LocalCompliance, settle_gap
from toothspace.numerics.linear_system import SATURATED

COMPLIANCE = 4e-13
PRESSURE = 2e6
PLAIN = FilmFluid(0.01)


def _walls() -> LocalCompliance:
    surfaces = RoughSurfaces(
        moving_roughness=0.25e-6,
        resting_roughness=0.4e-6,
        correlation_length=8e-6,
        effective_modulus=1.5e11,
        hardness=1e9,
    )
    return LocalCompliance(COMPLIANCE, 0.0, contact_table(surfaces), surfaces.roughness)


def _settled(rigid: Array, former: float) -> tuple[Array, Array]:
    """Gaps of film cells from an asperity pressure to begin with."""
    gap, out = np.empty_like(rigid), np.empty((4, *rigid.shape))
    kind, unknown = np.full(rigid.shape, SATURATED), np.full(rigid.size, PRESSURE)
    walls, law = (np.zeros_like(rigid), np.full_like(rigid, former)), PLAIN.reduced_law(0.0)
    settle_gap(kind, unknown, rigid, walls, law, _walls(), gap, out)
    return gap, out


@pytest.mark.parametrize("former", [0.0, 1e5, 2e7])
def test_asperities_hold_overlapping_faces_apart(former: float) -> None:
    """Closed form: the gap is open by what film and asperities press; from any first guess."""
    how, rigid = _walls(), np.linspace(-1.4e-6, 5e-6, 129)[None, :]
    gap, (contact, slope, share, yielding) = _settled(rigid, former)
    pressed, change = contact_field(gap, how.roughness, how.contact)
    assert gap == pytest.approx(rigid + COMPLIANCE * (PRESSURE + pressed), abs=2e-15)
    assert contact == pytest.approx(pressed)
    assert slope == pytest.approx(change)
    assert share == pytest.approx(1.0 / (1.0 - COMPLIANCE * change))
    assert yielding == pytest.approx(COMPLIANCE * share, rel=1e-6, abs=0.0)
    assert (np.diff(gap) > 0.0).all()


def test_share_is_the_change_of_the_gap_with_that_of_rigid_faces() -> None:
    rigid, small = np.linspace(-1.4e-6, 2e-6, 35)[None, :], 1e-12
    ahead, behind = (_settled(rigid + d, 0.0)[0] for d in (small, -small))
    share = _settled(rigid, 0.0)[1][2]
    assert (ahead - behind) / (2.0 * small) == pytest.approx(share, abs=2e-3)
