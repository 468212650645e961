"""Validation book: published numbers against this version, with a verdict for each source."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, final
from xml.etree import ElementTree as ET

import toothspace
from toothspace.core.errors import CaseError
from toothspace.core.files import write_text
from toothspace.library import shipped_folder

_TEMPLATES = Path(__file__).parent / "templates"
_FOLDER = Path("tests") / "validation"


@final
@dataclass(frozen=True)
class Check:
    """One comparison with published numbers.

    Parameters
    ----------
    name : str
        What is compared.
    verdict : str
        ``agrees``, ``deviates`` or ``skipped``.
    reason : str
        What deviates, in one line.
    duration : float
        Time that it took. [s]
    """

    name: str
    verdict: str
    reason: str
    duration: float


@final
@dataclass(frozen=True)
class Source:
    """A publication and the comparisons with it.

    Parameters
    ----------
    name : str
        Folder, by custom author and year.
    title : str
        Heading of its ``SOURCE.md``.
    paragraphs : tuple of str
        The rest of that file: where the numbers come from, tolerances and why.
    checks : tuple of Check
        Comparisons.
    """

    name: str
    title: str
    paragraphs: tuple[str, ...]
    checks: tuple[Check, ...]

    @property
    def verdict(self) -> str:
        """``agrees`` if every comparison does, ``deviates`` if one does not, else ``skipped``."""
        found = {check.verdict for check in self.checks}
        if "deviates" in found:
            return "deviates"
        return "agrees" if "agrees" in found else "skipped"

    def count(self, verdict: str) -> int:
        """Return the number of comparisons with a verdict. [-]."""
        return sum(check.verdict == verdict for check in self.checks)


def find_validation(folder: Path | None = None) -> Path:
    """Return the folder of the validation cases: given, here, or that of the package.

    Raises
    ------
    CaseError
        If there is none.
    """
    shipped = shipped_folder(_FOLDER.parts[0]) / _FOLDER.parts[1]
    candidates = [folder] if folder is not None else [Path.cwd() / _FOLDER, shipped]
    for candidate in candidates:
        if list(candidate.glob("*/SOURCE.md")):
            return candidate
    allowed = "a folder with */SOURCE.md, as tests/validation of the package"
    raise CaseError(f"validate: found no validation cases in {candidates[-1]}, allowed {allowed}")


def run_validation(folder: Path, selection: str = "") -> list[Source]:
    """Compare this version with all publications.

    Parameters
    ----------
    folder : Path
        Folder of the validation cases.
    selection : str
        Part of the names of those to run; empty runs all.

    Returns
    -------
    list of Source
        In the order of their names.

    Raises
    ------
    CaseError
        If pytest is missing, nothing is selected, or the cases cannot be run at all.
    """
    if find_spec("pytest") is None:
        raise CaseError("validate: found no package 'pytest', allowed an environment with it")
    chosen = [p.parent for p in sorted(folder.glob("*/SOURCE.md")) if selection in p.parent.name]
    if not chosen:
        known = ", ".join(p.parent.name for p in sorted(folder.glob("*/SOURCE.md")))
        raise CaseError(f"validate: found no case {selection!r}, allowed a part of {known}")
    with tempfile.TemporaryDirectory() as place:
        report = Path(place) / "report.xml"
        command = [
            sys.executable, "-m", "pytest", "-q", "-m", "slow or not slow",
            "-p", "no:cacheprovider", f"--junitxml={report}", "-o", "junit_family=xunit1",
            "--import-mode=importlib", f"--rootdir={_root(folder)}",
            "-o", f"pythonpath={_root(folder)}",
            *map(str, chosen),
        ]  # fmt: skip
        run = subprocess.run(command, cwd=_root(folder), capture_output=True, text=True)
        if run.returncode not in {0, 1} or not report.is_file():
            lines = (run.stdout + run.stderr).strip().splitlines() or ["nothing"]
            raise CaseError(f"validate: found {lines[-1]!r} from pytest, allowed cases that run")
        checks = _checks(report)
    return [_source(path, checks.get(path.name, ())) for path in chosen]


def write_book(sources: Sequence[Source], path: Path) -> Path:
    """Write the validation book as one HTML page that opens offline."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    page = environment.get_template("validation.html.j2").render(
        sources=sources,
        version=toothspace.__version__,
        style=(_TEMPLATES / "report.css").read_text(encoding="utf-8"),
    )
    return write_text(path, page)


def summary_of(sources: Sequence[Source]) -> dict[str, Any]:
    """Return what ``toothspace validate --json`` prints."""
    deviating = [source.name for source in sources if source.verdict == "deviates"]
    return {
        "sources": {
            source.name: {
                "title": source.title,
                "verdict": source.verdict,
                "agrees": source.count("agrees"),
                "deviates": source.count("deviates"),
                "skipped": source.count("skipped"),
            }
            for source in sources
        },
        "deviating": deviating,
        "status": "deviates" if deviating else "done",
        "wall_time_s": sum(check.duration for source in sources for check in source.checks),
    }


def _root(folder: Path) -> Path:
    """Folder with the settings of the tests, or the one that the tests lie in."""
    for parent in folder.resolve().parents:
        if (parent / "pyproject.toml").is_file():
            return parent
    inside = folder.resolve().parts[-2:] == _FOLDER.parts
    return folder.resolve().parents[1] if inside else folder


def _checks(report: Path) -> Mapping[str, tuple[Check, ...]]:
    found: dict[str, list[Check]] = {}
    for case in ET.parse(report).getroot().iter("testcase"):
        path = Path(case.get("file") or case.get("classname", "").replace(".", "/"))
        names = [part for part in path.parts if part not in {"tests", "validation"}]
        if names:
            found.setdefault(names[0], []).append(_check(case))
    return {name: tuple(checks) for name, checks in found.items()}


def _check(case: ET.Element) -> Check:
    name = case.get("name", "").removeprefix("test_").replace("_", " ")
    duration = float(case.get("time", "0"))
    for kind in ("failure", "error"):
        trouble = case.find(kind)
        if trouble is not None:
            return Check(name, "deviates", " ".join(trouble.get("message", "").split()), duration)
    skipped = case.find("skipped")
    if skipped is not None:
        return Check(name, "skipped", " ".join(skipped.get("message", "").split()), duration)
    return Check(name, "agrees", "", duration)


def _source(folder: Path, checks: Sequence[Check]) -> Source:
    text = (folder / "SOURCE.md").read_text(encoding="utf-8")
    blocks = [" ".join(block.split()) for block in text.split("\n\n") if block.strip()]
    title = blocks[0].lstrip("# ") if blocks else folder.name
    paragraphs = tuple(block.lstrip("# ") for block in blocks[1:])
    return Source(folder.name, title, paragraphs, tuple(checks))
