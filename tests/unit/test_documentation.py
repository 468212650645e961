"""Snippets of the documentation: commands exist, cases read, tutorials and notebooks run."""

from __future__ import annotations

import ast
import json
import math
import re
import shlex
import tomllib
from pathlib import Path

import matplotlib as mpl
import pytest
import typer

from toothspace import cli
from toothspace.cli.application import application

REPOSITORY = Path(__file__).resolve().parents[2]
DOCS = REPOSITORY / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if not {"_build", "api"} & set(p.parts))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
HEAVY = {"startup", "floating_bearing", "study_on_a_cluster"}
COMMANDS = typer.main.get_command(application).commands


def blocks(page: Path) -> list[tuple[str, str]]:
    return [(m[1], m[2]) for m in BLOCK.finditer(page.read_text(encoding="utf-8"))]


def command_lines(text: str) -> list[list[str]]:
    lines = text.replace("\\\n", " ").splitlines()
    words = (shlex.split(line.split(">")[0], comments=True) for line in lines)
    return [one[1:] for one in words if one[:1] == ["toothspace"]]


@pytest.mark.parametrize("page", [*PAGES, REPOSITORY / "README.md"], ids=lambda p: p.stem)
def test_snippets_are_sound(page: Path) -> None:
    """Options are those of the program, shipped files are there, TOML and Python can be read."""
    for language, text in blocks(page):
        if language == "toml":
            tomllib.loads(text)
        elif language == "python":
            ast.parse(text)
        elif language in {"sh", "bash"}:
            for name, *words in command_lines(text.replace(".venv/bin/toothspace", "toothspace")):
                known = {o for p in COMMANDS[name].params for o in (*p.opts, *p.secondary_opts)}
                given = {word for word in words if re.match(r"--?[a-z]", word)}
                assert given - known == set(), (page.name, name)
                named = [word for word in words if re.match(r"cases/[\w/]+\.toml$", word)]
                assert all((REPOSITORY / word).is_file() for word in named), words


def test_every_command_and_study_has_its_page() -> None:
    from toothspace.studies.registry import STUDY_MODULES

    assert {p.stem for p in (DOCS / "commands").glob("*.md")} == {*COMMANDS, "index"}
    assert {p.stem for p in (DOCS / "studies").glob("*.md")} == {*STUDY_MODULES, "index"}


def test_no_page_is_an_orphan() -> None:
    """From the index every page is reached through lists of contents."""
    listed = re.compile(r"```\{toctree\}\n(.*?)```", re.DOTALL)
    reached, waiting = set(), [DOCS / "index.md"]
    while waiting:
        page = waiting.pop()
        reached.add(page)
        for body in listed.findall(page.read_text(encoding="utf-8")):
            for entry in (line for line in body.split() if not line.startswith(":")):
                found = page.parent.glob(f"{entry}.md")
                waiting += [p.resolve() for p in found if p.resolve() not in reached]
    assert {p.resolve() for p in PAGES} - reached == set()


def printed_numbers(text: str) -> dict[str, float]:
    rows = (line.split() for line in text.splitlines())
    return {r[0]: float(r[1]) for r in rows if len(r) > 1 and re.match(r"-?\d[\d.e+-]*$", r[1])}


def marked(name: str) -> object:
    return pytest.param(name, marks=pytest.mark.slow) if name in HEAVY else name


def on_the_way(page: str) -> list[object]:
    folder, suffix = (DOCS / "tutorials", "md") if page == "page" else (
        REPOSITORY / "examples" / "notebooks", "ipynb")  # fmt: skip
    return [marked(p.stem) for p in sorted(folder.glob(f"*.{suffix}")) if p.stem != "index"]


@pytest.mark.parametrize("name", on_the_way("page"))
def test_tutorial_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """All commands and scripts in their order; printed numbers are within 10 % of the page."""
    if name == "own_step_pair":
        pytest.importorskip("OCP", reason="STEP files need the extra cad")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    shown: dict[str, float] = {}
    for language, text in blocks(DOCS / "tutorials" / f"{name}.md"):
        if language == "sh":
            for words in command_lines(text):
                assert cli.main(words) == 0, words
        elif language == "python":
            exec(compile(text, name, "exec"), names)
        elif language == "toml":
            (tmp_path / text.split()[1]).write_text(text, encoding="utf-8")
        elif language == "text":
            for key, value in printed_numbers(text).items():
                assert key in shown, key
                assert math.isclose(shown[key], value, rel_tol=0.1), (key, shown[key], value)
        shown |= printed_numbers(capsys.readouterr().out)


@pytest.mark.parametrize("name", on_the_way("notebook"))
def test_notebook_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The code cells as a script; every cell of the stored notebook was run without an error."""
    file = REPOSITORY / "examples" / "notebooks" / f"{name}.ipynb"
    assert file.stat().st_size < 1.5e6
    cells = [c for c in json.loads(file.read_text("utf-8"))["cells"] if c["cell_type"] == "code"]
    assert [c["execution_count"] for c in cells] == list(range(1, len(cells) + 1))
    assert not [o for c in cells for o in c["outputs"] if o["output_type"] == "error"]
    monkeypatch.chdir(tmp_path)
    mpl.use("Agg")
    names: dict[str, object] = {}
    for cell in cells:
        text = re.sub(r"^%.*$", "", "".join(cell["source"]), flags=re.MULTILINE)
        exec(compile(text, name, "exec"), names)
