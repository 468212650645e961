"""The page of the architecture shows the packages and arrows that are there."""

from __future__ import annotations

from pathlib import Path

from tests.architecture.architecture_page import BEGIN, END, arrows, rewritten


def test_the_page_shows_the_packages_and_their_imports(repository: Path) -> None:
    page = (repository / "docs" / "developer" / "architecture.md").read_text(encoding="utf-8")
    assert page.count(BEGIN) == page.count(END) == 1
    assert page == rewritten(page), (
        "run python -m tests.architecture.architecture_page docs/developer/architecture.md"
    )


def test_the_foundation_imports_nothing_of_the_package() -> None:
    found = arrows()
    assert found["core"] == set()
    assert "machines" not in found["solver"] | found["model"] | found["results"] | found["films"]
