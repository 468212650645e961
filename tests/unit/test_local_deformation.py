"""Gap that asperities hold open against faces that deform."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.core.types import Array
from toothspace.films.lateral.local_deformation import LocalCompliance, settle_gap
from toothspace.films.reynolds.rough_surfaces import RoughSurfaces, contact_field

COMPLIANCE = 4e-13
PRESSURE = 2e6


def _walls() -> LocalCompliance:
    surfaces = RoughSurfaces(
        moving_roughness=0.25e-6,
        resting_roughness=0.4e-6,
        correlation_length=8e-6,
        effective_modulus=1.5e11,
        hardness=1e9,
    )
    return LocalCompliance(COMPLIANCE, 0.0, surfaces.contact_table(), surfaces.roughness)


def _settled(rigid: Array, former: float) -> tuple[Array, Array]:
    how, gap, out = _walls(), np.full_like(rigid, former), np.empty((3, *rigid.shape))
    film = np.ones(rigid.shape, dtype=bool)
    settle_gap(rigid, np.full_like(rigid, PRESSURE), film, how, gap, out)
    return gap, out


@pytest.mark.parametrize("former", [-2e-6, 0.5e-6, 1e-5])
def test_asperities_hold_overlapping_faces_apart(former: float) -> None:
    """Closed form: the gap is open by what film and asperities press; from any former gap."""
    how, rigid = _walls(), np.linspace(-1.4e-6, 5e-6, 129)[None, :]
    gap, (contact, slope, share) = _settled(rigid, former)
    pressed, change = contact_field(gap, how.roughness, how.contact)
    assert gap == pytest.approx(rigid + COMPLIANCE * (PRESSURE + pressed), abs=2e-15)
    assert contact == pytest.approx(pressed)
    assert slope == pytest.approx(change)
    assert share == pytest.approx(1.0 / (1.0 - COMPLIANCE * change))
    assert (np.diff(gap) > 0.0).all()


def test_share_is_the_change_of_the_gap_with_that_of_rigid_faces() -> None:
    rigid, small = np.linspace(-1.4e-6, 2e-6, 35)[None, :], 1e-12
    ahead, behind = (_settled(rigid + d, 1e-6)[0] for d in (small, -small))
    share = _settled(rigid, 1e-6)[1][2]
    assert (ahead - behind) / (2.0 * small) == pytest.approx(share, abs=2e-3)
