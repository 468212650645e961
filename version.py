"""Version of the package: asked for when a wheel or a source archive is built."""

from __future__ import annotations

import subprocess
from pathlib import Path

RELEASED = "0.1.0"
"""The last release, for sources that know neither a tag nor the archive that they come from."""


def version() -> str:
    """Return the version of the source archive, of the last tag ``v*``, or the last release.

    Commits after a tag count as ``.postN`` with their hash behind a plus sign.
    """
    root = Path(__file__).resolve().parent
    archive = root / "PKG-INFO"
    if archive.is_file():
        lines = archive.read_text(encoding="utf-8").splitlines()
        return next(line.split()[1] for line in lines if line.startswith("Version:"))
    if not (root / ".git").exists():
        return RELEASED  # git would answer with the tags of a repository further up
    command = ["git", "-C", str(root), "describe", "--tags", "--long", "--match", "v[0-9]*"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return RELEASED
    tag, commits, name = found.strip().rsplit("-", 2)
    return tag.removeprefix("v") + ("" if commits == "0" else f".post{commits}+{name}")
