"""The archive of a unit of a whole machine: its files, and a host in plain C."""

from __future__ import annotations

import io
import subprocess
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from tests.unit.fmi.test_machine_file import cylinders
from toothspace import api
from toothspace.core.compilation.library import Way, chosen
from toothspace.core.errors import CaseError
from toothspace.fmi.archive import found_compiler
from toothspace.fmi.machine_file import MachineFile, _file
from toothspace.fmi.machine_unit import export_machine, machine_unit
from toothspace.solver.initial import start_state

PUMP = Path(__file__).resolve().parents[3] / "cases" / "egm12_pump.toml"
HOST = Path(__file__).parent / "data" / "fmu_host.c"

pytestmark = pytest.mark.skipif(chosen()[0] != Way.LIBRARY, reason=chosen()[1])


def _written(folder: Path, **options: Any) -> Path:
    path = folder / "unit.fmu"
    export_machine(PUMP, path, **options)
    return path


@pytest.mark.slow
def test_ports_and_shaft_are_terminals(tmp_path: Path) -> None:
    with zipfile.ZipFile(_written(tmp_path, fmi="3")) as archive:
        names = set(archive.namelist())
        root = ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        build = ElementTree.fromstring(archive.read("sources/buildDescription.xml"))
    found = {
        terminal.get("name"): [member.get("variableName") for member in terminal]
        for terminal in root.iter("Terminal")
    }
    assert found["inlet"] == ["inlet_pressure", "inlet_flow_rate"]
    assert found["outlet"] == ["outlet_pressure", "outlet_flow_rate"]
    assert found["shaft"] == ["shaft_speed", "shaft_angle", "shaft_torque"]
    listed = [e.get("name") for e in build.iter() if e.tag in {"SourceFile", "Library"}]
    assert {f"sources/{name}" for name in listed} <= names


@pytest.mark.slow
@pytest.mark.skipif(found_compiler() is None, reason="no C compiler")
def test_a_host_in_c_runs_the_binary_and_one_from_the_sources(tmp_path: Path) -> None:
    with zipfile.ZipFile(_written(tmp_path)) as archive:
        archive.extractall(tmp_path)
    compiler = str(found_compiler())
    subprocess.run([compiler, "-O2", "-o", tmp_path / "host", HOST, "-ldl"], check=True)
    binary = next((tmp_path / "binaries").rglob("*.so"))
    sources = [str(p) for p in sorted((tmp_path / "sources").iterdir()) if p.suffix in {".c", ".o"}]
    own = binary.with_name("own.so")
    flags = ["-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-DTOOTHSPACE_STATIC"]
    subprocess.run([compiler, *flags, *sources, "-lm", "-o", own], check=True)
    root = ElementTree.parse(tmp_path / "modelDescription.xml").getroot()
    numbers = {v.get("name"): v.get("valueReference") for v in root.iter("ScalarVariable")}
    token = str(root.get("guid"))
    words = ["20", "1e-4", f"+{numbers['outlet_pressure']}=15000000", numbers["shaft_torque"]]
    printed = []
    for library in (binary, own):
        command: Sequence[Any] = [tmp_path / "host", library, token, *words]
        printed.append(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    torques = [float(line) for line in printed[0].splitlines()]
    assert len(torques) == 20
    assert torques[-1] < 0.85 * torques[0]
    assert printed[0] == printed[1]
    refused = [tmp_path / "host", binary, "another token", *words]
    done = subprocess.run(refused, capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert "The resources do not belong to modelDescription.xml" in done.stderr


def test_what_cannot_be_is_refused() -> None:
    case = api.load_case(PUMP)
    with pytest.raises(CaseError, match="--fmi: found '1', allowed '2' or '3'"):
        machine_unit(case, fmi="1")
    with pytest.raises(CaseError, match="--flow: found 'drain', allowed 'inlet' or 'outlet'"):
        machine_unit(case, flows=("drain",))


@pytest.mark.parametrize(("fmi", "described"), [("2", "ScalarVariable"), ("3", "Float64")])
def test_what_a_unit_says_of_its_variables(
    fmi: str, described: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the description and on its page: which are means, and how the speed gets to its value."""
    system = cylinders()
    content, variables = _file(system, start_state(system), "0123456789abcdef")
    monkeypatch.setattr(
        "toothspace.fmi.machine_unit.machine_file",
        lambda *_, **__: MachineFile(content, variables, "Six cylinders"),
    )
    with zipfile.ZipFile(io.BytesIO(machine_unit(api.load_case(PUMP), fmi=fmi))) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        page = archive.read("documentation/index.html").decode()
        binaries = [name for name in archive.namelist() if name.startswith("binaries/")]
        assert archive.read("resources/model.machine") == content
    said = {str(one.get("name")): str(one.get("description")) for one in root.iter(described)}
    said.pop("time", None)
    assert set(said) == {one.name for one in variables}
    assert [name for name, text in said.items() if text.endswith("mean over the last step")] == [
        "inlet_flow_rate",
        "outlet_flow_rate",
    ]
    assert said["shaft_speed"].endswith("reached along a straight line at the end of a step")
    assert page.startswith("<!DOCTYPE html>")
    assert all(f"<td>{name}</td>" in page for name in said)
    (binary,) = binaries
    assert binary.rpartition("/")[2] in page
