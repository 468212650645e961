"""Outcome of a run, and what happened in it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Status(Enum):
    """Outcome of a run; the text says what to do next."""

    DONE = "Done."
    NOT_CYCLIC = (
        "The run reached its last revolution before two successive revolutions agreed. "
        "Raise run.max_revolutions."
    )
    NOT_REPEATING = (
        "Successive revolutions differ and no longer come closer, and those averaged leave more "
        "than half a percent of the means open. Raise run.averaged_revolutions."
    )
    STEP_TOO_SMALL = (
        "The time step fell below its limit. Look at the warnings and at the last events in the "
        "result; check clearances, the timing of the ports and pressures."
    )
    FLUID_ENCLOSED = (
        "A space shrinks by more than a liquid can be compressed and nothing lets the fluid out: "
        "its pressure passed that at which oils are solid. A warning says what lets it out. "
        "Follow it."
    )
    OUT_OF_MESH = (
        "A body turned so far from its place in the mesh that its teeth would have skipped: a "
        "warning says which. Follow it."
    )
    MAX_STEPS = (
        "The maximum number of steps was reached. Raise run.max_steps if the run went on well; a "
        "revolution of more than a million steps is astray: check clearances, the timing of the "
        "ports and pressures."
    )
    NOT_CONVERGED = (
        "An iteration did not converge. Start from a nearby condition or refine the grid."
    )
    NOT_STORED = (
        "The temporary folder took no more samples; what was computed is kept. Point TMPDIR at a "
        "folder with more space, lower run.time_samples or choose run.channels."
    )
    NOT_REACHED = (
        "The run did not reach what was asked: a warning says by how much, and what can be asked. "
        "Follow it."
    )
    RUNAWAY = (
        "The film has no solution: its viscosity grows with the pressure so fast that no finite "
        "pressure balances the flow. Lower pressure_viscosity, speed or load, or open the gap."
    )
    POINTS_FAILED = (
        "Some points of the study failed; their rows say why. "
        "Correct the case, then go on with --resume."
    )
    INTERRUPTED = "Interrupted; what was computed is kept."

    @property
    def succeeded(self) -> bool:
        """Whether the run did what was asked."""
        return self is Status.DONE


class Event(NamedTuple):
    """Something that happened during a run."""

    shaft_angle: float
    """Shaft angle. [rad]"""
    time: float
    """Time. [s]"""
    kind: str
    """For example ``cavitation_onset``, ``contact_change`` or ``body_at_stop``."""
    label: str
    """Chamber, contact or body concerned."""
