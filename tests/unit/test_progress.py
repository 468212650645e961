"""Progress of phases that nobody has handed a listener to."""

from __future__ import annotations

from toothspace.core.progress import heard_by, say


def test_only_the_innermost_listener_hears_what_is_said_inside_its_block() -> None:
    outer: list[tuple[float, str]] = []
    inner: list[tuple[float, str]] = []
    with heard_by(lambda share, text: outer.append((share, text))):
        with heard_by(lambda share, text: inner.append((share, text))):
            say(0.5, "condensing")
        say(1.0, "done")
    say(0.0, "nobody listens")
    assert inner == [(0.5, "condensing")]
    assert outer == [(1.0, "done")]
