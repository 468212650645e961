"""What the role of a body decides: who is turned through the teeth, who feels the shaft's load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.contact_machine import INERTIA, RATIO, contact_machine
from toothspace.model.arrays import (
    DRIVEN_INERTIA,
    DRIVEN_LATERAL,
    DRIVEN_SENSE,
    EXTERNAL_FORCE,
)
from toothspace.model.assembly import System, assemble
from toothspace.model.contact_pair import RigidMesh
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.lumped_films import lateral_drag
from toothspace.model.operating_point import OperatingCondition


def meshed(ratio: float) -> System:
    """The ring turned by a rigid mesh, with or against the rotor."""
    machine = contact_machine()
    rotor, ring = machine.bodies
    mesh = RigidMesh("lobe", 2, np.zeros(3), 22e-3)
    turned = replace(machine, bodies=(rotor, replace(ring, speed_ratio=ratio)), mesh=mesh)
    condition = OperatingCondition(
        shaft_speed=100.0, inlet_pressure=1e5, outlet_pressure=50e5, radial_load=(30.0, -40.0)
    )
    return assemble(
        turned, fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08)), condition
    )


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_what_resists_a_driven_body_acts_against_its_own_rotation(sense: float) -> None:
    system = meshed(sense * RATIO)
    drag = lateral_drag(system.description)["ring"]
    assert system.arrays.drive[DRIVEN_INERTIA] == pytest.approx(-sense * RATIO * INERTIA)
    assert system.arrays.drive[DRIVEN_LATERAL] == pytest.approx(-sense * RATIO * drag)
    assert system.arrays.journal[:, DRIVEN_SENSE].tolist() == [sense]


def test_load_of_the_shaft_acts_on_the_body_on_the_shaft_alone() -> None:
    assert not np.any(meshed(RATIO).arrays.motion[:, EXTERNAL_FORCE])
