"""The archive of a unit of a whole machine: its files, and a host in plain C."""

from __future__ import annotations

import io
import re
import subprocess
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from toothspace import api
from toothspace.core.compilation.library import FOLDER, MODEL, UNIT, UNIT_SOURCES, Way, chosen
from toothspace.core.errors import CaseError
from toothspace.fmi import machine_unit as units
from toothspace.fmi.archive import found_compiler, platform_folder
from toothspace.fmi.machine_file import (
    FLOW,
    INERTIA,
    NUMBER,
    PORT_FLOW,
    PORT_PRESSURE,
    SHAFT_SPEED,
    MachineFile,
    MachineVariable,
)
from toothspace.fmi.machine_unit import export_machine, machine_unit
from toothspace.results.variables import VARIABLES

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


MADE_UP = MachineFile(
    b"what the library reads",
    (
        MachineVariable("inlet_pressure", "Pa", PORT_PRESSURE, 2e5, 0),
        MachineVariable("outlet_flow_rate", "m3/s", PORT_FLOW, 3e-4, 8),
        MachineVariable("shaft_speed", "rad/s", SHAFT_SPEED, 150.0, 16),
        MachineVariable("shaft_inertia", "kg m2", INERTIA, 1e-3, 24),
        MachineVariable("inlet_flow_rate", "m3/s", FLOW, 0.0, 32),
        MachineVariable("outlet_pressure", "Pa", NUMBER, 1e7, 40),
        MachineVariable("shaft_torque", "N m", NUMBER, 0.0, 48),
        MachineVariable("chamber_pressure[drive_gear_3]", "Pa", NUMBER, 0.0, 56),
        MachineVariable("position[driven_gear x]", "m", NUMBER, 0.0, 64),
        MachineVariable("position[driven_gear rotation]", "rad", NUMBER, 0.0, 72),
    ),
    "A made-up pump",
)
"""A file with a variable of each kind."""


@pytest.fixture
def archive_of(monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, bytes]]:
    """Writes units of made-up machines and gives their files."""

    def written(machine: MachineFile = MADE_UP, fmi: str = "2") -> dict[str, bytes]:
        monkeypatch.setattr(units, "machine_file", lambda *_, **__: machine)
        packed = zipfile.ZipFile(io.BytesIO(machine_unit(api.load_case(PUMP), fmi=fmi)))
        return {name: packed.read(name) for name in packed.namelist()}

    return written


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_unit_is_the_library_with_a_machine_as_its_resource(
    archive_of: Callable[..., dict[str, bytes]], fmi: str
) -> None:
    found = archive_of(fmi=fmi)
    assert found["resources/model.machine"] == MADE_UP.content
    folder, ending = platform_folder()
    (binary,) = (name for name in found if name.startswith("binaries/"))
    assert binary.endswith(f"/egm12_pump{ending}")
    assert binary.split("/")[1] == folder or fmi == "3"
    assert found[binary] == (FOLDER / UNIT).read_bytes()
    other = f"fmi{5 - int(fmi)}.c"
    for name in {*UNIT_SOURCES, MODEL} - {other}:
        assert found[f"sources/{name}"] == (FOLDER / name).read_bytes()
    assert f"sources/{other}" not in found
    page = found["documentation/index.html"].decode()
    assert page.startswith("<!DOCTYPE html>\n<html")
    assert f"-o egm12_pump{ending}</pre>" in page


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_token_is_of_a_machine_and_its_words(
    archive_of: Callable[..., dict[str, bytes]], fmi: str
) -> None:
    """The same machine has the same token; another content, or another title, another one."""
    first, again, content, title = (
        archive_of(machine, fmi)
        for machine in (
            MADE_UP,
            MADE_UP,
            replace(MADE_UP, content=b"what it reads of another one"),
            replace(MADE_UP, title="Another pump"),
        )
    )
    tokens = [one["resources/token.txt"].decode() for one in (first, again, content, title)]
    assert tokens[0] == tokens[1]
    assert len(set(tokens)) == 3
    name = "guid" if fmi == "2" else "instantiationToken"
    for one, token in zip((first, content), (tokens[0], tokens[2]), strict=True):
        assert ElementTree.fromstring(one["modelDescription.xml"]).get(name) == token


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_variables_of_a_unit_say_what_they_are(
    archive_of: Callable[..., dict[str, bytes]], fmi: str
) -> None:
    found = archive_of(fmi=fmi)
    root = ElementTree.fromstring(found["modelDescription.xml"])
    entries = {
        one.get("name"): one for one in root.iter("ScalarVariable" if fmi == "2" else "Float64")
    }
    causality = {name: one.get("causality") for name, one in entries.items() if name != "time"}
    assert causality == {
        "inlet_pressure": "input",
        "outlet_flow_rate": "input",
        "shaft_speed": "input",
        "shaft_inertia": "parameter",
        "inlet_flow_rate": "output",
        "outlet_pressure": "output",
        "shaft_torque": "output",
        "chamber_pressure[drive_gear_3]": "local",
        "position[driven_gear x]": "local",
        "position[driven_gear rotation]": "local",
    }
    words = {name: one.get("description") for name, one in entries.items()}
    known = {name: VARIABLES[name].long_name for name in causality if name in VARIABLES}
    assert words["inlet_pressure"] == known["inlet_pressure"]
    # a mean is what an output is, and a speed is led to what is given
    assert words["outlet_flow_rate"] == known["outlet_flow_rate"]
    assert words["inlet_flow_rate"] == f"{known['inlet_flow_rate']}, mean over the last step"
    assert words["shaft_speed"].startswith(f"{known['shaft_speed']}, reached along a straight line")
    assert "drive_gear_3" in words["chamber_pressure[drive_gear_3]"]
    assert words["position[driven_gear x]"].startswith("Displacement in x of the body driven_gear")
    assert words["position[driven_gear rotation]"].startswith("Rotation ahead of the body driven")
    page = re.sub(r"\s+", " ", found["documentation/index.html"].decode())
    for name, one in causality.items():
        assert f"<td>{name}</td>" in page
        assert f"<td>{one}</td> <td>{words[name]}</td>" in page
    for one in MADE_UP.variables:
        entry = entries[one.name] if fmi == "3" else entries[one.name].find("Real")
        assert entry.get("unit") == one.unit.replace(" ", ".")
        assert entry.get("start") == (repr(one.start) if one.is_input else None)
