"""Bodies that turn out of their mesh end a march at once, with advice that helps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from toothspace import api
from toothspace.case import Case, load_case
from toothspace.core.status import Status
from toothspace.model.assembly import assemble
from toothspace.solver.integrator import skips

WIDE = (
    "machine.rotors.tip_clearance=350 um",
    "machine.lateral.side_gap=1.8 um",
    "machine.mode=motor",
    "operating_point.inlet_pressure=5.7 bar",
    "operating_point.outlet_pressure=3.8 bar",
    "operating_point.outlet_load=fixed_pressure",
    "operating_point.shaft_speed=6000 rpm",
    "run.samples_per_revolution=180",
)


@pytest.fixture(scope="module")
def loose() -> Case:
    """Gerotor whose outer rotor drags on its covers while no lobe holds it."""
    return load_case("gerotor_cycloidal", WIDE)


@pytest.mark.slow
def test_a_rotor_that_loses_its_mate_ends_the_run(loose: Case) -> None:
    found = api.simulate(loose)
    assert found.status is Status.OUT_OF_MESH
    assert found.statistics["steps"] < 1e6
    told = next(x for x in found.findings if x.quantity == "Turning out of the mesh")
    assert told.severity == "serious"
    assert told.text.startswith("Outer rotor has turned by ")
    closer: dict[str, Any] = {"machine.rotors.tip_clearance": "30 um"}
    assert "machine.rotors.tip_clearance" in told.advice
    assert api.simulate(loose.replace(closer)).status is Status.DONE


def test_half_a_pitch_is_the_limit(loose: Case) -> None:
    run = api.prepare(loose)
    system = assemble(run.machine, run.fluid, run.condition)
    states = np.zeros((3, system.arrays.size.total))
    place = system.arrays.size.position + len(system.free_motions) - 1
    half = np.pi / run.machine.families[0].count
    states[:, place] = [0.0, -0.99 * half, 1.01 * half]
    assert skips(system, states).tolist() == [False, False, True]
