"""Snippets of the documentation: commands exist, cases read, tutorials and notebooks run."""

from __future__ import annotations

import ast
import json
import math
import re
import shlex
import shutil
import tomllib
from importlib import import_module
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import typer

from examples import pump_from_cad as drawing
from toothspace import cli
from toothspace.case import load_case
from toothspace.case.shipped import cases
from toothspace.cli.application import application
from toothspace.core.errors import CaseError

REPOSITORY = Path(__file__).resolve().parents[3]
DOCS = REPOSITORY / "docs"
PAGES = sorted(p for p in DOCS.rglob("*.md") if not {"_build", "api"} & set(p.parts))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
HEAVY = {
    "first_pump",
    "gerotor",
    "startup",
    "floating_bearing",
    "own_cad_pair",
    "own_step_pair",
    "study_on_a_cluster",
}
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
                if "case_file" in {p.name for p in COMMANDS[name].params}:
                    assert words[0].endswith(".toml") or words[0] in cases(), words


def pages_with(language: str, wanted: str) -> list[object]:
    """Pages beside the tutorials with such blocks."""
    return [
        pytest.param(page, id=page.stem)
        for page in [*PAGES, REPOSITORY / "README.md"]
        if page.parent.name != "tutorials"
        and any(re.search(wanted, text) for kind, text in blocks(page) if kind == language)
    ]


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder with the cases that come along."""
    shutil.copytree(REPOSITORY / "cases", tmp_path / "cases")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("page", pages_with("toml", r"(?m)^\[(?!project)"))
def test_keys_of_a_page_make_a_case(page: Path, workplace: Path) -> None:
    """Each block, laid over the complete case of its page or a shipped one, can be read."""
    shipped = sorted(
        (workplace / "cases").glob("*.toml"), key=lambda f: ("base =" in f.read_text(), f)
    )
    for text in (text for kind, text in blocks(page) if kind == "toml"):
        named = re.findall(r'"([\w/]+\.(?:step|csv|txt|nc|mka|fmu))"', text)
        for name in named:
            (workplace / "cases" / name).write_text("of a reader\n", encoding="utf-8")
        own = workplace / "cases" / "own.toml"
        if re.search(r"(?m)^(base|schema) =", text):
            own.write_text(text, encoding="utf-8")
            load_case(own)
            shipped.insert(0, own.rename(own.with_name("complete.toml")))
            continue
        assert any(readable_over(base, text, own, named) for base in shipped), text


def readable_over(base: Path, text: str, own: Path, named: list[str]) -> bool:
    """Whether nothing is wrong but the contents of the files that a reader has."""
    own.write_text(f'base = "{base.name}"\n{text}', encoding="utf-8")
    try:
        return bool(load_case(own))
    except CaseError as error:
        return all(any(name in line for name in named) for line in str(error).splitlines())


@pytest.mark.slow
@pytest.mark.parametrize("page", pages_with("python", "^(from|import)(?s:(?!lobe_pump).)*$"))
def test_script_of_a_page_runs(page: Path, workplace: Path) -> None:
    """All Python blocks of a page, one after the other in one session."""
    if page.stem == "elasticity":
        pytest.importorskip("gmsh", reason="meshes of bodies need the extra bodies")
        pytest.importorskip("OCP", reason="and STEP files the extra cad")
        bushing = import_module("OCP.BRepPrimAPI").BRepPrimAPI_MakeCylinder(25.0, 12.0).Shape()
        writer = import_module("OCP.STEPControl").STEPControl_Writer()
        writer.Transfer(bushing, import_module("OCP.STEPControl").STEPControl_AsIs)
        writer.Write("bushing.step")
    if page.stem == "surrogates":
        pytest.importorskip("sklearn", reason="surrogates need the extra design")
    if page.stem == "design_a_pump":  # a front of one design
        row = "point,machine.relief_grooves.closing_side_angle\n7,10 deg\n"
        (workplace / "contours").mkdir()
        (workplace / "contours" / "front.csv").write_text(row, encoding="utf-8")
    if page.stem == "simulate_a_system":
        pytest.importorskip("fmpy", reason="running units needs the extra fmi")
        assert cli.main(["fmu", "cases/egm12_pump.toml", "-o", "pump.fmu"]) == 0
    outline = np.loadtxt(workplace / "cases" / "profiles" / "egm12_drive.txt")
    np.savetxt("measured.csv", outline, delimiter=",")
    mpl.use("Agg")
    names: dict[str, object] = {}
    for text in (text for kind, text in blocks(page) if kind == "python"):
        exec(compile(text, page.name, "exec"), names)
    assert names.keys() - {"__builtins__"}


def draw_parts_of_a_reader() -> None:
    """One gear and a whole pump as STEP files, the pump part by part as meshes too."""
    pytest.importorskip("OCP", reason="STEP files need the extra cad")
    assert cli.main(["geometry", "cases/egm12_motor.toml", "--export", "step", "--force"]) == 0
    Path("egm12_motor_drive.step").replace("gear.step")
    pump = drawing.Pump()
    drawing.write_assembly(Path("pump.step"), pump)
    parts = {
        "gear1.stl": drawing.gear_on_shaft(pump, 0.0, -20.0, pump.width + 60.0),
        "gear2.stl": drawing.gear_on_shaft(pump, pump.distance, -20.0, pump.width + 20.0),
        "housing.stl": drawing.housing(pump),
        "middle.stl": drawing.housing(pump),
    }
    for name, shape in parts.items():
        import_module("OCP.BRepMesh").BRepMesh_IncrementalMesh(shape, 0.005)
        import_module("OCP.StlAPI").StlAPI_Writer().Write(shape, name)


@pytest.mark.slow
@pytest.mark.parametrize("page", pages_with("sh", "(?m)^toothspace"))
def test_commands_of_a_page_run(page: Path, workplace: Path) -> None:
    """All commands; of studies, starts and shipped tables, which take minutes, the case is read."""
    run = workplace / "cases" / "egm12_pump.toml"
    shutil.copy(run, "CASE.toml")
    shutil.copy(workplace / "cases" / "journal_bearing.toml", "bearing.toml")
    done: set[str] = set()
    for words in (w for kind, text in blocks(page) if kind == "sh" for w in command_lines(text)):
        shipped = any(word.startswith("cases/tables/") for word in words)
        if words[0] == "study" or "fan_drive" in words[1:2] or shipped:
            assert load_case(words[1])
        elif words[0] == "gear":
            draw_parts_of_a_reader()
            assert cli.main(words) == 0
        elif words[0] == "compare":
            for name in words[1:3]:
                assert cli.main(["run", str(run), "-o", name]) == 0
            assert cli.main(words) == 0
        elif words[0] == "export" and words[1] == "map/study.nc":
            few = ['study.shaft_speed=["1500 rpm"]', 'study.pressure_difference=["100 bar"]']
            given = [word for one in few for word in ("--set", one)]
            if not Path("map").is_dir():
                assert cli.main(["study", "efficiency_map_egm12", "-o", "map", *given]) == 0
            assert cli.main([*words, "--force"]) == 0
        elif words[0] != "warmup":
            assert cli.main([*words, *(["--force"] if " ".join(words) in done else [])]) == 0, words
        done.add(" ".join(words))


def test_every_command_and_study_has_its_page() -> None:
    from toothspace.core.registry import STUDY_KEYS

    assert {p.stem for p in (DOCS / "commands").glob("*.md")} == {*COMMANDS, "index"}
    assert {p.stem for p in (DOCS / "studies").glob("*.md")} == {*STUDY_KEYS, "index"}


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


def test_tests_that_pages_name_exist() -> None:
    texts = {p.name: p.read_text(encoding="utf-8") for p in REPOSITORY.glob("tests/**/test_*.py")}
    named = {
        (page.stem, m[1], m[2])
        for page in PAGES
        for m in re.finditer(r"\b(test_\w+\.py)(?:::(\w+))?", page.read_text(encoding="utf-8"))
    }
    assert len(named) > 20
    assert {n for n in named if f"def {n[2] or 'test_'}" not in texts.get(n[1], "")} == set()


def printed_numbers(text: str) -> dict[str, float]:
    rows = (line.split() for line in text.splitlines())
    return {r[0]: float(r[1]) for r in rows if len(r) > 1 and re.match(r"-?\d[\d.e+-]*$", r[1])}


def marked(name: str) -> object:
    return pytest.param(name, marks=pytest.mark.slow) if name in HEAVY else name


def on_the_way(page: str) -> list[object]:
    folder, suffix = (DOCS / "tutorials", "md") if page == "page" else (
        REPOSITORY / "examples" / "notebooks", "ipynb")  # fmt: skip
    return [marked(p.stem) for p in sorted(folder.glob(f"*.{suffix}")) if p.stem != "index"]


@pytest.mark.usefixtures("few_figures")
@pytest.mark.parametrize("name", on_the_way("page"))
def test_tutorial_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """All commands and scripts in their order; printed numbers are within 10 % of the page."""
    if name == "own_step_pair":
        pytest.importorskip("OCP", reason="STEP files need the extra cad")
    if name == "study_on_a_cluster":
        pytest.importorskip("zarr", reason="Zarr stores need the extra zarr")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    shown: dict[str, float] = {}
    for language, text in blocks(DOCS / "tutorials" / f"{name}.md"):
        if language == "sh":
            for words in command_lines(text):
                assert cli.main(words) == 0, words
        elif language == "python" and not re.search("(SLURM|Kube)Cluster", text):
            # those need a computer with a queue
            exec(compile(text, name, "exec"), names)
        elif language == "toml":
            (tmp_path / text.split()[1]).write_text(text, encoding="utf-8")
        elif language == "text":
            for key, value in printed_numbers(text).items():
                assert key in shown, key
                assert math.isclose(shown[key], value, rel_tol=0.1), (key, shown[key], value)
        shown |= printed_numbers(capsys.readouterr().out)


@pytest.mark.slow
@pytest.mark.usefixtures("few_figures")
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
