"""Lobes with wide tip clearances still touch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.gerotor_designs import TROCHOIDAL, machine
from toothspace.machines.gerotor.lobe_pairs import rotor_contacts
from toothspace.machines.gerotor.profiles import rotors_from

SMALL = replace(
    TROCHOIDAL,
    inner_tooth_count=12,
    eccentricity=0.88e-3,
    generating_radius=14.65e-3,
    lobe_radius=1.82e-3,
)


@pytest.mark.parametrize("share", [0.012, 0.43])
def test_lobes_are_possible_contacts_at_any_tip_clearance(share: float) -> None:
    parameters = machine(replace(SMALL, tip_clearance=share * SMALL.eccentricity))
    rotors = rotors_from(parameters.rotors)
    pairs = rotor_contacts(parameters, rotors, parameters.rotors.tip_clearance)
    longest = pairs[0]
    possible = longest.geometry.values[:, 0] < longest.facing_gap
    assert possible.any()
    # at any time some lobe can touch
    nodes = possible.size // longest.count
    assert np.all(possible.reshape(longest.count, nodes).any(axis=0))
