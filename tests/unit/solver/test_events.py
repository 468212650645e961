"""Events of a march in words: chambers, journals, contacts, then the shaft, each with its label."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from toothspace.model import arrays as col
from toothspace.solver.integrator import March


def words(index: int, direction: int, *, sticking: bool = False) -> tuple[str, str]:
    """What an event of four chambers, two journals and three compliant contacts is called."""
    journals = tuple(SimpleNamespace(body=body) for body in ("drive_gear", "driven_gear"))
    description = SimpleNamespace(
        chamber_count=4,
        chamber_labels=[f"chamber_{k}" for k in range(4)],
        journals=journals,
        free_blocks=None,
    )
    drive = {col.DIRECTION: 0.0 if sticking else 1.0}
    size = SimpleNamespace(journals=2, compliant=3, contacts=3)
    system = SimpleNamespace(
        description=description,
        arrays=SimpleNamespace(size=size, drive=drive),
        contact_labels=[f"contact_{k}" for k in range(3)],
    )
    march = cast(Any, SimpleNamespace(system=system))
    return March._event_text(march, index, direction)


@pytest.mark.parametrize(
    ("index", "falling", "rising", "label"),
    [
        (0, "cavitation_onset", "cavitation_end", "chamber_0"),
        (3, "cavitation_onset", "cavitation_end", "chamber_3"),
        (4, "body_at_stop", "body_off_stop", "drive_gear"),
        (5, "body_at_stop", "body_off_stop", "driven_gear"),
        (6, "contact_lost", "contact_made", "contact_0"),
        (8, "contact_lost", "contact_made", "contact_2"),
    ],
)
def test_an_event_is_named_by_its_place_and_its_direction(
    index: int, falling: str, rising: str, label: str
) -> None:
    assert words(index, -1) == (falling, label)
    assert words(index, 1) == (rising, label)


def test_the_last_event_is_that_of_the_shaft() -> None:
    assert words(9, -1) == ("shaft_stopped", "shaft")
    assert words(9, 1, sticking=True) == ("shaft_released", "shaft")
