"""The reference pages say what the package declares."""

from __future__ import annotations

import re

import toothspace
from tests.architecture.reference_pages import COMMAND, FOLDER, pages


def test_pages_are_current() -> None:
    written = pages()
    found = {name: (FOLDER / name).read_text(encoding="utf-8") for name in written}
    assert [name for name in written if found[name] != written[name]] == [], f"run {COMMAND}"
    kept = {f"case_file/{path.name}" for path in (FOLDER / "case_file").glob("*.md")}
    assert kept <= written.keys()


def test_every_public_name_stands_on_the_python_page() -> None:
    """The names that ``dir`` lists, each in the table and with its docstring."""
    page = (FOLDER / "python.md").read_text(encoding="utf-8")
    public = {name for name in dir(toothspace) if not name.startswith("_")}
    table, _, described = page.partition("\n## ")
    assert public - set(re.findall(r"`(\w+)`", table)) == set()
    assert public - set(re.findall(r":: toothspace\.(\w+)", described)) == set()
