"""Recipe, citation, changelog and hooks agree with package and pins."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from jinja2 import Template

import version

pytestmark = pytest.mark.architecture

_OTHER_NAMES = {"matplotlib": "matplotlib-base"}


def _rendered(repository: Path) -> str:
    def load_file_regex(load_file: str, regex_pattern: str, *, from_recipe_dir: bool) -> object:
        assert from_recipe_dir
        text = (repository / "recipe" / load_file).read_text(encoding="utf-8")
        return re.search(regex_pattern, text)

    source = (repository / "recipe" / "meta.yaml").read_text(encoding="utf-8")
    return Template(source).render(load_file_regex=load_file_regex, PYTHON="python", compiler=str)


def test_recipe_has_the_version_of_the_last_release(repository: Path) -> None:
    assert f"\n  version: {version.RELEASED}\n" in _rendered(repository)


def test_recipe_asks_for_the_packages_of_the_core(repository: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    core = [re.split(r"(?=>=)", entry) for entry in project["dependencies"]]
    expected = {f"{_OTHER_NAMES.get(name, name)} {limit}" for name, limit in core}
    run = _rendered(repository).partition("\n  run:\n")[2].partition("# the extra cad")[0]
    assert {line.strip(" -") for line in run.splitlines() if line.strip()} == {
        *expected,
        f"python {project['requires-python']}",
    }


def test_changelog_and_citation_name_the_last_release(repository: Path) -> None:
    changes = (repository / "CHANGELOG.md").read_text(encoding="utf-8")
    named, date = re.findall(r"(?m)^## (\d\S*) \((\d{4}-\d\d-\d\d)\)$", changes)[0]
    assert named == version.RELEASED
    citation = (repository / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    assert f"version: {named}" in citation
    assert f"date-released: {date}" in citation


def test_hooks_run_the_pinned_programs(repository: Path) -> None:
    """Programs of the environment of `make setup` have the versions of the pins by themselves."""
    hooks = (repository / ".pre-commit-config.yaml").read_text(encoding="utf-8")
    lock = (repository / "requirements" / "lock.txt").read_text(encoding="utf-8")
    assert set(re.findall(r"- repo: (\S+)", hooks)) == {"local"}
    programs = set(re.findall(r"entry: \.venv/bin/([\w-]+)", hooks))
    assert programs == {"ruff", "mypy", "lint-imports"}
    assert {"ruff", "mypy", "import-linter"} <= {line.partition("==")[0] for line in lock.split()}
