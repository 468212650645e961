"""The whole machine as a unit for FMI 2.0 or 3.0: every tooth space, as the program computes it.

The binary is the same for all machines; the machine itself is a resource, see
:mod:`toothspace.fmi.machine_file`.
"""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import toothspace
from toothspace.case import load_case
from toothspace.core.compilation.library import FOLDER, MODEL, UNIT, UNIT_SOURCES
from toothspace.core.errors import CaseError
from toothspace.core.files import path_of, write_bytes
from toothspace.core.progress import Progress
from toothspace.fmi.archive import (
    UNITS,
    add_units,
    document,
    identifier_of,
    packed,
    part,
    platform_folder,
    unit_attributes,
)
from toothspace.fmi.machine_file import INERTIA, MachineFile, MachineVariable, machine_file
from toothspace.results.variables import VARIABLES
from toothspace.run.run import provenance_of

if TYPE_CHECKING:
    from toothspace import api
    from toothspace.case import Case

VERSIONS = ("2", "3")
"""Versions of FMI that a unit can be written for."""

_MEANINGS = {
    "drain_pressure": "Absolute pressure of the case",
    "drain_flow_rate": "Flow out of the machine through the case drain",
    "shaft_inertia": "Moment of inertia of shaft and load, without the machine's own bodies",
}
_MEAN = ", mean over the last step"
_LINE = ", reached along a straight line at the end of a step"
_FIRST_STEP = 1e-4
"""Step that is proposed to importers. [s]"""
_COMPILED = "cc -O2 -fPIC -shared -fvisibility=hidden -DTOOTHSPACE_STATIC *.c model.o -lm -o {name}"


def export_machine(
    case: api.AnyCase,
    path: str | Path,
    *,
    drive: str = "speed",
    flows: Sequence[str] = (),
    fmi: str = "2",
    progress: Progress | None = None,
) -> None:
    """Write the whole machine for simulators of systems and for programs in C.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case with an operating point, where the machine starts.
    path : str or Path
        File to write: ``NAME.fmu``, a unit for co-simulation, or ``NAME.machine``, what the
        functions of ``toothspace.h`` read.
    drive : str
        ``speed``: the shaft speed is an input; ``torque``: the shaft starts from rest, its speed
        follows from load torque and inertia.
    flows : sequence of str
        ``inlet`` or ``outlet``: ports whose flow is an input and whose pressure is an output; of
        all others the pressure is an input.
    fmi : str
        Version of the unit, ``"2"`` (2.0) or ``"3"`` (3.0 with terminals).
    progress : callable, optional
        Called with the finished share and a short text.

    Raises
    ------
    CaseError
        If the case has no operating point, an argument is not allowed, or the library of compiled
        code is missing.
    """
    target = path_of(path, "path", "a file to write")
    found = load_case(case)
    if target.suffix == ".machine":
        file = machine_file(found, drive=drive, flows=flows, progress=progress)
        write_bytes(target, file.content)
    else:
        unit = machine_unit(found, drive=drive, flows=flows, fmi=fmi, progress=progress)
        write_bytes(target, unit)


def machine_unit(
    case: Case,
    *,
    drive: str = "speed",
    flows: Sequence[str] = (),
    fmi: str = "2",
    progress: Progress | None = None,
) -> bytes:
    """Archive of a unit; arguments are those of :func:`export_machine`."""
    if fmi not in VERSIONS:
        raise CaseError("--fmi", repr(fmi), " or ".join(map(repr, VERSIONS)))
    machine = machine_file(case, drive=drive, flows=flows, progress=progress)
    name = identifier_of(case.name)
    describe = _description_2 if fmi == "2" else _description_3
    # what names and units mean is in the description: a change there is another unit too
    content = machine.content + describe(machine, name, token="").encode()
    token = hashlib.sha256(content).hexdigest()[:32]
    folder, suffix = platform_folder()
    platform_name = folder
    if fmi == "3":
        named = {"amd64": "x86_64", "arm64": "aarch64"}
        processor = platform.machine().lower()
        system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
        platform_name = f"{named.get(processor, processor)}-{system}"
    unused = f"fmi{'3' if fmi == '2' else '2'}.c"
    sources = {one: (FOLDER / one).read_bytes() for one in (*UNIT_SOURCES, MODEL) if one != unused}
    contents = {
        "modelDescription.xml": describe(machine, name, token).encode(),
        f"binaries/{platform_name}/{name}{suffix}": (FOLDER / UNIT).read_bytes(),
        **{f"sources/{one}": text for one, text in sources.items()},
        "resources/model.machine": machine.content,
        "resources/token.txt": token.encode(),
        "resources/case.toml": provenance_of(case)["case_toml"].encode(),
        "documentation/index.html": _page(machine, name + suffix).encode(),
    }
    if fmi == "3":
        contents["terminalsAndIcons/terminalsAndIcons.xml"] = _terminals(machine).encode()
        contents["sources/buildDescription.xml"] = _build(name, platform_name).encode()
    return packed(contents)


def _causality(one: MachineVariable) -> str:
    if one.role == INERTIA:
        return "parameter"
    if one.is_input:
        return "input"
    return "local" if "[" in one.name else "output"


def _meaning(one: MachineVariable) -> str:
    """Meaning and sign of a variable."""
    word, _, place = one.name.partition("[")
    if word == "chamber_pressure":
        return f"Absolute pressure in the tooth space or pocket {place[:-1]}"
    if word == "position":
        body, axis = place[:-1].rsplit(" ", 1)
        where = "Rotation ahead" if axis == "rotation" else f"Displacement in {axis}"
        return f"{where} of the body {body} from its nominal place"
    meaning = _MEANINGS.get(word) or VARIABLES[word].long_name
    if word.endswith("flow_rate") and not one.is_input:
        return meaning + _MEAN
    return meaning + _LINE if word == "shaft_speed" and one.is_input else meaning


def _attributes(one: MachineVariable) -> dict[str, str]:
    start = {"start": repr(one.start)} if one.is_input else {}
    return unit_attributes(one.unit.replace(" ", ".")) | start


def _root(machine: MachineFile, name: str, **version: str) -> ElementTree.Element:
    """Begin of a description; ``version`` is that of FMI, with its name of the token."""
    said = {
        **version,
        "modelName": name,
        "description": machine.title,
        "generationTool": f"toothspace {toothspace.__version__}",
        "variableNamingConvention": "flat",
    }
    return ElementTree.Element("fmiModelDescription", said)


def _described(reference: int, one: MachineVariable) -> dict[str, str]:
    """What both versions say of a variable in its first element."""
    return {
        "name": one.name,
        "valueReference": str(reference),
        "description": _meaning(one),
        "causality": _causality(one),
        "variability": "tunable" if one.role == INERTIA else "continuous",
    }


def _description_2(machine: MachineFile, name: str, token: str) -> str:
    root = _root(machine, name, fmiVersion="2.0", guid=token)
    part(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative="true",
        canNotUseMemoryManagementFunctions="true",
    )
    _add_common(root)
    listed = part(root, "ModelVariables")
    for reference, one in enumerate(machine.variables):
        entry = part(
            listed,
            "ScalarVariable",
            **_described(reference, one),
        )
        part(entry, "Real", **_attributes(one))
    structure = part(root, "ModelStructure")
    for group in ("Outputs", "InitialUnknowns"):
        members = part(structure, group)
        for number, one in enumerate(machine.variables, start=1):
            if _causality(one) == "output":
                part(members, "Unknown", index=str(number), dependencies="")
    return document(root)


def _description_3(machine: MachineFile, name: str, token: str) -> str:
    root = _root(machine, name, fmiVersion="3.0", instantiationToken=token)
    part(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        providesDirectionalDerivatives="true",
        hasEventMode="true",
        mightReturnEarlyFromDoStep="true",
    )
    _add_common(root)
    listed = part(root, "ModelVariables")
    for reference, one in enumerate(machine.variables):
        part(
            listed,
            "Float64",
            **_described(reference, one),
            **_attributes(one),
        )
    part(
        listed,
        "Float64",
        name="time",
        valueReference=str(len(machine.variables)),
        description="Simulated time",
        causality="independent",
        variability="continuous",
        unit="s",
    )
    structure = part(root, "ModelStructure")
    for group in ("Output", "InitialUnknown"):
        for reference, one in enumerate(machine.variables):
            if _causality(one) == "output":
                part(structure, group, valueReference=str(reference), dependencies="")
    return document(root)


def _add_common(root: ElementTree.Element) -> None:
    """Units, categories of messages and proposed step, alike in both versions."""
    add_units(root, UNITS)
    part(part(root, "LogCategories"), "Category", name="logStatusError")
    part(root, "DefaultExperiment", startTime="0", stopTime="0.1", stepSize=repr(_FIRST_STEP))


def _terminals(machine: MachineFile) -> str:
    """Ports with pressure and flow, and the flange of the shaft."""
    names = {one.name for one in machine.variables}
    root = ElementTree.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    terminals = part(root, "Terminals")
    for port in ("inlet", "outlet", "drain"):
        if f"{port}_pressure" in names:
            flow = "inflow" if port == "inlet" else "outflow"
            members = {
                "pressure": (f"{port}_pressure", "signal"),
                "flow_rate": (f"{port}_flow_rate", flow),
            }
            _add_terminal(terminals, port, "hydraulic_port", members)
    torque = ("load_torque", "outflow") if "load_torque" in names else ("shaft_torque", "signal")
    members = {
        "speed": ("shaft_speed", "signal"),
        "angle": ("shaft_angle", "signal"),
        "torque": torque,
    }
    _add_terminal(terminals, "shaft", "rotational_flange", members)
    return document(root)


def _add_terminal(
    terminals: ElementTree.Element, name: str, kind: str, members: dict[str, tuple[str, str]]
) -> None:
    terminal = part(terminals, "Terminal", name=name, matchingRule="plug", terminalKind=kind)
    for member, (variable, variable_kind) in members.items():
        part(
            terminal,
            "TerminalMemberVariable",
            variableName=variable,
            memberName=member,
            variableKind=variable_kind,
        )


def _build(name: str, platform_name: str) -> str:
    root = ElementTree.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = part(
        root,
        "BuildConfiguration",
        modelIdentifier=name,
        platform=platform_name,
        description="C layer; the equations are object code",
    )
    files = part(configuration, "SourceFileSet", language="C99")
    for source in UNIT_SOURCES:
        if source.endswith(".c") and source != "fmi2.c":
            part(files, "SourceFile", name=source)
    part(files, "PreprocessorDefinition", name="TOOTHSPACE_STATIC")
    part(configuration, "Library", name=MODEL, description="Object code of the equations")
    return document(root)


def _page(machine: MachineFile, binary: str) -> str:
    """Documentation within the unit."""
    root = ElementTree.Element("html", lang="en")
    part(part(root, "head"), "title").text = machine.title
    body = part(root, "body")
    part(body, "h1").text = machine.title
    part(body, "p").text = (
        "Gear machine with every tooth space, written by toothspace "
        f"{toothspace.__version__}. All numbers are in SI units; pressures are absolute. Inputs "
        "hold during a step, flows are means over it, all other outputs are those at its end."
    )
    table = part(body, "table")
    for one in machine.variables:
        row = part(table, "tr")
        for text in (one.name, one.unit, _causality(one), _meaning(one)):
            part(row, "td").text = text
    part(body, "p").text = "The binary from its sources:"
    part(body, "pre").text = _COMPILED.format(name=binary)
    ElementTree.indent(root)
    return "<!DOCTYPE html>\n" + ElementTree.tostring(root, encoding="unicode", method="html")
