"""Film heights of the bodies that turn in journal bearings, and of no others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from toothspace.model.arrays import BUSH_X, BUSH_Y, JOURNAL_CLEARANCE, MOTION_X
from toothspace.solver.outcome import _journal_values, journal_bodies

NAMES = ["inner_rotor", "outer_rotor"]
_COLUMNS = 1 + max(BUSH_X, BUSH_Y, JOURNAL_CLEARANCE, MOTION_X)


def system(*bodies: str) -> Any:
    """What is read of a system with a journal bearing for each of some bodies."""
    journal = np.zeros((len(bodies), _COLUMNS))
    journal[:, MOTION_X] = np.arange(len(bodies))
    journal[:, JOURNAL_CLEARANCE] = 50e-6
    motions = tuple(SimpleNamespace(body=body) for body in bodies)
    return SimpleNamespace(
        arrays=SimpleNamespace(journal=journal),
        free_motions=list(range(len(bodies))),
        description=SimpleNamespace(motions=motions),
    )


def test_every_number_is_finite() -> None:
    position = np.zeros((3, 2, 3))
    position[:, 1, 0] = [0.0, 10e-6, 30e-6]
    machine = system("outer_rotor")
    values = _journal_values(machine, position, NAMES)
    assert journal_bodies(machine) == ["outer_rotor"]
    np.testing.assert_allclose(values["journal_film_height"], [[50e-6], [40e-6], [20e-6]])
    assert all(np.isfinite(value).all() for value in values.values())


def test_a_machine_without_journal_bearings_has_no_film_heights() -> None:
    assert "journal_film_height" not in _journal_values(system(), np.zeros((3, 2, 3)), NAMES)
