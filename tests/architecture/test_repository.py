"""Tracked files hold nothing that belongs to one machine."""

from __future__ import annotations

import re
import subprocess
from importlib.metadata import distributions, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

THIS = Path(__file__).name
TEXT = {".py", ".md", ".toml", ".txt", ".yml", ".cff", ".cfg", ".html", ".j2", ".csv", ".json", ""}

FORBIDDEN = {
    "a path of one machine": r"(?<![\w.])/(?:work|root|home/\w+|Users/\w+|tmp)/|[A-Z]:\\Users",
    "a package registry": r"pypi\.org|pythonhosted|index-url|find-links|/pypi",
}


def tracked(repository: Path) -> list[Path]:
    listing = subprocess.run(
        ["git", "ls-files", "-z"], cwd=repository, capture_output=True, text=True, check=True
    )
    paths = [repository / name for name in listing.stdout.split("\0") if name]
    return [path for path in paths if path.suffix in TEXT and path.is_file() and path.name != THIS]


@pytest.mark.parametrize("what", FORBIDDEN)
def test_tracked_files_are_free_of(what: str, repository: Path) -> None:
    pattern = re.compile(FORBIDDEN[what])
    found = [
        f"{path.relative_to(repository)}:{number}"
        for path in tracked(repository)
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if pattern.search(line)
    ]
    assert not found


def test_lock_file_is_plain(repository: Path) -> None:
    lines = (repository / "requirements" / "lock.txt").read_text(encoding="utf-8").splitlines()
    assert len(lines) > 20
    assert all(re.fullmatch(r"[A-Za-z0-9_.\-]+==[A-Za-z0-9_.+!]+", line) for line in lines)


def test_lock_file_pins_what_the_pins_ask_for(repository: Path) -> None:
    lock = (repository / "requirements" / "lock.txt").read_text(encoding="utf-8").split()
    pinned = {canonicalize_name(line.split("==")[0]) for line in lock}
    here = {canonicalize_name(found.name) for found in distributions()}
    assert not pinned - here, "pins that are not installed: run make setup"
    asked = {
        f"{canonicalize_name(one.name)} of {name}"
        for name in pinned
        for one in map(Requirement, requires(name) or [])
        if one.marker is None or one.marker.evaluate({"extra": ""})
    }
    assert not [one for one in sorted(asked) if one.split(" of ")[0] not in pinned]


def test_hashes_are_those_of_the_pins(repository: Path) -> None:
    folder = repository / "requirements"
    pins = (folder / "lock.txt").read_text(encoding="utf-8").split()
    text = (folder / "hashes.txt").read_text(encoding="utf-8").replace("\\\n", " ")
    rows = [line.split() for line in text.splitlines()]

    def plain(pin: str) -> str:
        return pin.lower().replace("_", "-")

    assert sorted(plain(row[0]) for row in rows) == sorted(map(plain, pins))
    hashes = [one for row in rows for one in row[1:]]
    assert all(len(row) > 1 for row in rows)
    assert all(re.fullmatch(r"--hash=sha256:[0-9a-f]{64}", one) for one in hashes)


def test_continuous_integration_runs_what_the_readme_says(repository: Path) -> None:
    commands = (repository / ".ci" / "run").read_text(encoding="utf-8")
    readme = (repository / "README.md").read_text(encoding="utf-8")
    made = {
        word
        for words in re.findall(r"^make (.*)$", commands, re.MULTILINE)
        for word in words.split()
    }
    assert made >= {"lint", "test", "sample"}
    assert "make test" in readme
