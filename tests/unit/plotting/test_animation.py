"""What writes moving pictures."""

from __future__ import annotations

from pathlib import Path

import pytest

from toothspace.core.errors import CaseError
from toothspace.plotting import animation

pytestmark = pytest.mark.unit


def test_without_ffmpeg_a_film_is_refused_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(animation, "program_named", lambda *_: None)
    monkeypatch.setattr(animation, "find_spec", lambda _: None)
    with pytest.raises(CaseError, match=r"toothspace\[film\]"):
        animation.require_writer(Path("x.mp4"))
    assert animation.require_writer(Path("x.gif")) is not None


def test_the_extra_brings_ffmpeg(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("imageio_ffmpeg", reason="films need the extra film")
    monkeypatch.setattr(animation, "program_named", lambda *_: None)
    assert animation.require_writer(Path("x.mp4")).isAvailable()
