"""Events of a run."""

from __future__ import annotations

from typing import NamedTuple


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
