"""The five walks of docs/developer/extending.md, each done on something that does not exist."""

from __future__ import annotations

import ast
import importlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests import tank_circuit
from tests.architecture.call_graph import CallGraph, Module, entry_points, package_graph
from tests.architecture.reference_pages import case_pages, result_page
from tests.architecture.sources import PACKAGE, REPOSITORY
from toothspace import api, studies
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.registry import machine_modules, study_modules
from toothspace.core.status import Status
from toothspace.report.html import write_report
from toothspace.report.study import study_report_html
from toothspace.results import variables
from toothspace.results.solution import load_solution
from toothspace.studies import run_study

TYPE = """
from dataclasses import dataclass
from typing import final

from tests.toy_machine import toy_machine


@final
@dataclass(frozen=True)
class Toy:
    name: str = "toy_cylinders"

    def describe(self, spec):
        return toy_machine(spec.angles)


MACHINE = Toy()
"""
KEYS = """
from dataclasses import dataclass
from typing import final

from toothspace.core.keys import choice, integer


@final
@dataclass(frozen=True, kw_only=True)
class ToyParameters:
    mode: str = choice("What the machine is used as.", "pump", "motor")
    angles: int = integer("Angles of the tables.", low=90, high=3600)

    def assemble(self):
        return self


PARAMETERS = ToyParameters
"""
CASE = """
schema = 1
title = "Six cylinders"
[machine]
type = "toy_cylinders"
mode = "pump"
angles = 720
[fluid]
name = "iso_vg_46"
temperature = "50 degC"
[operating_point]
shaft_speed = "1000 rpm"
inlet_pressure = "2 bar"
outlet_pressure = "20 bar"
[run]
fidelity = "{preset}"
samples_per_revolution = 90
"""


def copied_package(folder: Path) -> Path:
    """Sources of the package to change, beside which a program finds them."""
    package = folder / "toothspace"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    return package


def printed_by_copy(folder: Path, program: str, given: str = "") -> str:
    """What a program that uses the copy in a folder prints."""
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=given,
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder)},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def pretend_installed(folder: Path, entry_points: str) -> None:
    """Leave what installing a package with entry points leaves."""
    installed = folder / "toy-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Name: toy\nVersion: 1.0\n", encoding="utf-8")
    (installed / "entry_points.txt").write_text(entry_points, encoding="utf-8")


@pytest.fixture
def toy_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A package outside this repository, installed as far as Python can tell."""
    package = tmp_path / "toy_cylinders"
    package.mkdir()
    (package / "__init__.py").write_text(TYPE, encoding="utf-8")
    (package / "parameters.py").write_text(KEYS, encoding="utf-8")
    pretend_installed(tmp_path, "[toothspace.machines]\ntoy_cylinders = toy_cylinders:MACHINE\n")
    monkeypatch.syspath_prepend(tmp_path)
    importlib.invalidate_caches()
    machine_modules.cache_clear()
    yield tmp_path
    machine_modules.cache_clear()
    for name in ("toy_cylinders", "toy_cylinders.parameters"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize("preset", ["ideal", pytest.param("lumped", marks=pytest.mark.slow)])
def test_machine(toy_package: Path, preset: str) -> None:
    """Two files and an entry point: it runs, balances and is reported under its own names."""
    path = toy_package / "case.toml"
    path.write_text(CASE.format(preset=preset), encoding="utf-8")
    case = api.load_case(path)
    solution = api.simulate(case)
    assert solution.status is Status.DONE, solution.provenance.get("warnings")
    summary = solution.summary()
    flow = 60e3 * float(solution.data["outlet_flow_rate"].mean())
    assert flow == pytest.approx(6.0, rel=0.1)  # six cylinders of 1 cm3 at 1000 rpm, l/min
    assert float(summary["mean_torque_N_m"]) > 0.0
    saved = load_solution(solution.save(toy_package / "result.nc"))
    assert saved.summary() == pytest.approx(summary, nan_ok=True)
    text = write_report(saved, toy_package / "report.html").read_text(encoding="utf-8")
    assert "Six cylinders" in text
    if preset == "lumped":
        assert solution.ledger.energy_balance_error < 1e-3
        assert solution.ledger.mass_balance_error < 1e-3
        assert "lateral" in text


STUDY = '''
"""Flow of a case over a few shaft speeds."""

from dataclasses import dataclass
from typing import final

from toothspace.core.keys import KeyTable, integer
from toothspace.plotting.style import StudyFigure
from toothspace.plotting.style import new_figure
from toothspace.studies.points import collected, operating_values, point, status_of
from toothspace.studies.study import Study, StudyResult
from toothspace.studies.points import map_dataset, point_lists


@final
@dataclass(frozen=True, kw_only=True)
class ToySpeedsStudy(KeyTable):
    """``kind = "toy_speeds"``: flow over shaft speeds below that of the case."""

    speed_count: int = integer("Shaft speeds.", low=2, high=9)


def run(case, context):
    count, own = case.study.speed_count, case.operating_point.shaft_speed
    speeds = [own * (k + 1) / count for k in range(count)]
    points = [point(case, operating_values(shaft_speed=speed)) for speed in speeds]
    records = collected(points, context)
    data = map_dataset({"shaft_speed": (speeds, "rad/s")}, records)
    numbers = point_lists({"shaft_speed": speeds}, records)
    return StudyResult(status=status_of(records), data=data, numbers=numbers)


def figures(data):
    figure = new_figure(3.0, 2.0)
    figure.subplots().plot(data["shaft_speed"], data["mean_flow_L_per_min"])
    return [StudyFigure("toy_flow", "Flow over shaft speed.", figure)]


STUDY = Study(ToySpeedsStudy, run, figures)
'''


@pytest.fixture(params=["one of the studies", "installed"])
def toy_study(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[None]:
    """One more file among the studies, or in a package outside this repository."""
    (tmp_path / "toy_speeds.py").write_text(STUDY, encoding="utf-8")
    if request.param == "installed":
        pretend_installed(tmp_path, "[toothspace.studies]\ntoy_speeds = toy_speeds\n")
        monkeypatch.syspath_prepend(tmp_path)
    else:
        monkeypatch.setattr(studies, "__path__", [*studies.__path__, str(tmp_path)])
        monkeypatch.setattr(studies.__spec__, "submodule_search_locations", studies.__path__)
    importlib.invalidate_caches()
    study_modules.cache_clear()
    yield
    study_modules.cache_clear()
    for name in ("toy_speeds", "toothspace.studies.toy_speeds"):
        sys.modules.pop(name, None)


def test_study(toy_study: None, tmp_path: Path) -> None:
    """One file: its keys are read, shown and refused; it runs, goes on, is drawn and reported."""
    case = api.load_case(REPOSITORY / "cases" / "egm12_pump.toml", ["run.fidelity=ideal"])
    with pytest.raises(CaseError, match=r"study\.speed_count: found 1, allowed .* from 2 to 9"):
        case.replace({"study": {"kind": "toy_speeds", "speed_count": 1}})
    case = case.replace({"study": {"kind": "toy_speeds", "speed_count": 2}})
    assert case.study_kind == "toy_speeds"
    assert Case.from_toml(case.to_toml()) == case
    assert '`kind = "toy_speeds"`' in case_pages()["case_file/study.md"]
    result = run_study(case, tmp_path / "study")
    assert result.status is Status.DONE
    frame = result.to_dataframe()
    assert frame["mean_flow_L_per_min"].is_monotonic_increasing
    assert frame.attrs["units"]["mean_flow_L_per_min"] == "L/min"
    assert result.plot.toy_flow().axes
    assert "Flow over shaft speed." in study_report_html(result)
    assert run_study(case, tmp_path / "study", resume=True).data.identical(result.data)


def test_result_variable(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """One line: the reference page names it and a file keeps it with its unit."""
    name = "toy_temperature"
    with pytest.raises(KeyError, match=name):
        variables.variable(name)
    row = (name, "sample chamber", "K", "Temperature of the fluid in a chamber")
    monkeypatch.setattr(variables, "_ROWS", (*variables._ROWS, row))
    monkeypatch.setattr(variables, "VARIABLES", variables._variables())
    assert f"| `{name}` | sample, chamber | K | {row[3]} |" in result_page()
    data = variables.dataset_from(
        {"shaft_angle": np.arange(3.0), "time": np.arange(3.0), name: np.full((3, 2), 320.0)},
        {"chamber": ("a", "b")},
    )
    data.to_netcdf(tmp_path / "toy.nc", engine="h5netcdf")
    import xarray as xr

    with xr.open_dataset(tmp_path / "toy.nc", engine="h5netcdf") as kept:
        assert kept[name].attrs["units"] == "K"
        assert kept[name].dims == ("shaft_angle", "chamber")


FILTER = '''
"""Filters: a drop that grows with the oil that has passed."""

from dataclasses import dataclass
from typing import NamedTuple, final

from toothspace.circuit.network import law_columns
from toothspace.circuit.restrictions import Restriction
from toothspace.core.compiled import kernel
from toothspace.core.keys import quantity


class FilterCake(NamedTuple):
    resistance: float
    growth: float


_RESISTANCE, _GROWTH = law_columns(FilterCake)


@kernel
def filter_flow(element, drop, time):
    resistance = element[_RESISTANCE] * (1.0 + element[_GROWTH] * time)
    return drop / resistance, 1.0 / resistance


@final
@dataclass(frozen=True, kw_only=True)
class Filter(Restriction):
    """``kind = "filter"``: clogs over time."""

    resistance: float = quantity("bar s/L", "Drop per flow when clean.", above=0, high=1e4)
    growth: float = quantity("1/s", "Growth of the drop.", low=0, high=1, default=0.0)

    @property
    def law(self):
        return FilterCake(self.resistance, self.growth)
'''
FILTER_LINES = (
    (
        "from toothspace.circuit.lines",
        "from toothspace.circuit.filters import Filter, FilterCake, filter_flow\n",
    ),
    ('    "hose": Hose,', '    "filter": Filter,\n'),
    ("FluidColumn)\n", "FilterCake, "),
    (" FLUID_COLUMN,\n", " FILTER_CAKE,"),
    (
        "    if kind == RESISTANCE:",
        "    if kind == FILTER_CAKE:\n        return filter_flow(element, drop, time)\n",
    ),
)
"""What stands before a line of the list of elements, and the line itself."""
FILTER_USE = """
import json, sys
from toothspace.api import fluid_of
from toothspace.case import Case
from toothspace.case.case import case_schema
from toothspace.circuit.circuit import build_circuit
from toothspace.circuit.elements import LAWS, element_flow
from toothspace.circuit.history import Tables

case = Case.from_dict(json.load(sys.stdin))
circuit = build_circuit(case.circuit, (1e-4, 1e-4), fluid_of(case))
tables, places = Tables(), {node.name: k for k, node in enumerate(circuit.all_nodes)}
(row,) = circuit.rows(places, LAWS, tables)
flows = [element_flow(row, tables.rows, 2e5, 850.0, time) for time in (0.0, 10.0)]
print(json.dumps({"flows": flows, "schema": "filter" in json.dumps(case_schema())}))
"""


def test_circuit_element(tmp_path: Path) -> None:
    """A family of its own with keys, law and kernel, and its lines in the list of elements."""
    package = copied_package(tmp_path)
    (package / "circuit" / "filters.py").write_text(FILTER, encoding="utf-8")
    listed = package / "circuit" / "elements.py"
    text = listed.read_text(encoding="utf-8")
    for before, line in FILTER_LINES:
        assert text.count(before) == 1
        text = text.replace(before, line + before)
    listed.write_text(text, encoding="utf-8")
    tables = tank_circuit.pump_between_tanks("600 rpm", "0.1 s", high="outlet")
    tables["circuit"]["connections"][0] = ["machine.outlet", "f"]
    tables["circuit"]["connections"].append(["f", "high"])
    tables["circuit"]["f"] = {"kind": "filter", "resistance": "20 bar s/L", "growth": "0.1 1/s"}
    found = json.loads(printed_by_copy(tmp_path, FILTER_USE, json.dumps(tables)))
    assert found["schema"]
    flow, slope = found["flows"][0]
    assert [flow, slope] == pytest.approx([1e-4, 5e-10])  # 2 bar over 20 bar s/L
    assert found["flows"][1][0] == pytest.approx(5e-5)


CLOSURE = "\n\n@inlined\ndef toy_friction(speed):\n    return speed\n"


def graph_with(**changed: str) -> CallGraph:
    """The package with other texts of some modules, dots written as double underscores."""
    modules = dict(package_graph().modules)
    for key, text in changed.items():
        name = "toothspace." + key.replace("__", ".")
        modules[name] = Module(name, ast.parse(text))
    return CallGraph(modules.values())


@pytest.mark.slow
def test_friction_closure() -> None:
    """A formula nobody calls is found; the call in the kernel of its phenomenon is enough."""
    formulas = (PACKAGE / "closures" / "friction.py").read_text(encoding="utf-8") + CLOSURE
    kernel = (PACKAGE / "model" / "drive.py").read_text(encoding="utf-8")
    formula = ("toothspace.closures.friction", "toy_friction")
    alone = graph_with(closures__friction=formulas)
    assert formula not in alone.reached(entry_points(alone))
    calling = kernel.replace("running_share", "toy_friction")
    assert calling != kernel
    called = graph_with(closures__friction=formulas, model__drive=calling)
    assert formula in called.reached(entry_points(called))


CHOSEN = """

def toy_friction(speed, breakaway, coulomb, breakaway_speed):
    return coulomb * speed / breakaway_speed, coulomb / breakaway_speed


SMOOTH_LAWS["toy"] = toy_friction
"""
CHOSEN_USE = """
from toothspace.core.keys import Source, Table
from toothspace.floating.housing_friction import housing_friction
from toothspace.model.floating_bearing import HousingContact
from toothspace.studies.bearing_path import STUDY

keys = Table(doc="", spec=HousingContact)
contact = keys.read({"friction_coefficient": 0.1, "law": "toy"}, Source())
print(*housing_friction(contact, 50.0).force(2.0 * contact.breakaway_speed))
given = {"outlet_pressures": ["10 bar", "20 bar"], "friction_law": "toy"}
assert Table(doc="", spec=STUDY.keys).read(given, Source()).friction_law == "toy"
"""


def test_friction_law_that_a_case_may_choose(tmp_path: Path) -> None:
    """One entry beside its formula: machines and studies take its name, bearings its force."""
    package = copied_package(tmp_path)
    formulas = package / "closures" / "friction.py"
    formulas.write_text(formulas.read_text(encoding="utf-8") + CHOSEN, encoding="utf-8")
    force, slope = map(float, printed_by_copy(tmp_path, CHOSEN_USE).split())
    assert force == pytest.approx(2.0 * 0.1 * 50.0)
    assert slope == pytest.approx(0.1 * 50.0 / 6.45e-3)


def test_the_page_names_files_that_are_there() -> None:
    page = (REPOSITORY / "docs" / "developer" / "extending.md").read_text(encoding="utf-8")
    named = [part.strip("`") for part in page.split() if part.startswith(("`src/", "`tests/"))]
    paths = [name.rstrip("`.,;:)") for name in named if "<" not in name]
    assert len(paths) > 6
    assert [path for path in paths if not (REPOSITORY / path).exists()] == []
