"""The reference pages say what the package declares."""

from __future__ import annotations

import pytest

from tests.architecture.reference_pages import COMMAND, FOLDER, PAGES


@pytest.mark.parametrize("name", PAGES)
def test_page_is_current(name: str) -> None:
    assert (FOLDER / name).read_text(encoding="utf-8") == PAGES[name](), f"run {COMMAND}"
