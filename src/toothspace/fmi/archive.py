"""The files of a functional mock-up unit: description, sources and binary, in one archive."""

from __future__ import annotations

import hashlib
import io
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, final
from xml.etree import ElementTree

import numpy as np

import toothspace
from toothspace.core.errors import CaseError
from toothspace.core.processes import program_named
from toothspace.core.types import Array
from toothspace.results.variables import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

SOURCE = "machine.c"
_DATA = "machine_data.h"
_OPTIONS = ("-std=c99", "-O2", "-fPIC", "-shared")
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)
"""Time of all files in the archive: the same case gives the same bytes."""

UNITS: dict[str, tuple[dict[str, int], dict[str, float]]] = {
    "Pa": ({"kg": 1, "m": -1, "s": -2}, {"bar": 1e-5}),
    "m3/s": ({"m": 3, "s": -1}, {"L/min": 6e4}),
    "rad/s": ({"rad": 1, "s": -1}, {"rpm": 30.0 / np.pi}),
    "rad": ({"rad": 1}, {"deg": 180.0 / np.pi}),
    "N.m": ({"kg": 1, "m": 2, "s": -2}, {}),
    "W": ({"kg": 1, "m": 2, "s": -3}, {}),
    "kg.m2": ({"kg": 1, "m": 2}, {}),
    "m": ({"m": 1}, {"um": 1e6}),
    "s": ({"s": 1}, {}),
    "1": ({}, {}),
}
"""Exponents of the SI base units, and units for display with their factors."""


@final
@dataclass(frozen=True)
class FmuVariable:
    """A real variable of the unit."""

    name: str
    """Name; that of the result variable where there is one."""
    causality: str
    """``input``, ``parameter`` or ``output``, empty if this unit does not have it."""
    units: str
    """SI unit in the spelling of FMI."""
    meaning: str = ""
    """Meaning and sign; of the result variable if empty."""
    start: float = 0.0
    """Value at the start of inputs and parameters. [units]"""

    @property
    def description(self) -> str:
        """Meaning and sign."""
        return self.meaning or VARIABLES[self.name].long_name


def fmu_variables(tables: xr.Dataset, *, free_shaft: bool) -> list[FmuVariable]:
    """Real variables in the order of their references: what is given first, then outputs.

    Parameters
    ----------
    tables : xarray.Dataset
        From :func:`toothspace.fmi.operating_tables.tables_of`, with ``low_pressure`` and ``mode``.
    free_shaft : bool
        Whether torques move the shaft; otherwise its speed is an input.
    """
    low = float(tables["low_pressure"])
    high = low + float(tables["pressure_difference"].max())
    motor = tables.attrs["mode"] == "motor"
    inlet, outlet = (high, low) if motor else (low, high)
    free = free_shaft
    drain = tables.attrs["drain"]
    where = "out of the machine" if drain == "external" else f"part of the flow of the {drain}"
    speed = float(tables["shaft_speed"].max())
    mean = "mean over the ripple"
    return [
        FmuVariable("inlet_pressure", "input", "Pa", start=inlet),
        FmuVariable("outlet_pressure", "input", "Pa", start=outlet),
        FmuVariable("shaft_speed", "output" if free else "input", "rad/s", start=speed),
        FmuVariable("load_torque", "input" if free else "", "N.m"),
        FmuVariable("shaft_angle_start", "parameter", "rad", "Angle of the shaft at the start"),
        FmuVariable(
            "shaft_inertia",
            "parameter" if free else "",
            "kg.m2",
            "Moment of inertia of machine, shaft and load",
            1e-3,
        ),
        FmuVariable(
            "shaft_speed_start", "parameter" if free else "", "rad/s", "Speed at the start"
        ),
        FmuVariable("inlet_flow_rate", "output", "m3/s"),
        FmuVariable("outlet_flow_rate", "output", "m3/s"),
        FmuVariable(
            "drain_flow_rate", "output", "m3/s", f"Flow from the chambers to the drain, {where}"
        ),
        FmuVariable("shaft_torque", "output", "N.m"),
        FmuVariable("shaft_angle", "output", "rad", "Angle of the shaft"),
        FmuVariable(
            "leakage", "output", "m3/s", f"Flow through all gaps from high to low port, {mean}"
        ),
        FmuVariable(
            "lost_flow_rate", "output", "m3/s", "Flow that the volumetric efficiency lacks"
        ),
        FmuVariable("shaft_power", "output", "W", f"Power of the shaft, {mean}"),
        FmuVariable(
            "hydraulic_power",
            "output",
            "W",
            f"Power given to the fluid by a pump, taken from it by a motor, {mean}",
        ),
        FmuVariable("power_loss", "output", "W", f"Dissipated power, {mean}"),
        FmuVariable("volumetric_efficiency", "output", "1", "Zero outside of pump or motor work"),
        FmuVariable("hydromechanical_efficiency", "output", "1", "As volumetric efficiency"),
        FmuVariable("overall_efficiency", "output", "1", "As volumetric efficiency"),
    ]


_BOOLEANS = (
    ("ripple", "parameter", "Whether flows and torque pulsate with the shaft angle"),
    ("within_table", "output", "Whether speed and pressures are within the tables"),
)


def identifier_of(name: str) -> str:
    """Name of a case as an identifier of C."""
    word = re.sub(r"\W", "_", name, flags=re.ASCII)
    return word if word[:1].isalpha() else f"machine_{word}"


def fmu_archive(
    tables: xr.Dataset, name: str, case_text: str, compiler: str | None, *, free_shaft: bool
) -> tuple[bytes, str]:
    """Return the archive of a unit, and the platform of its binary, empty without one.

    Raises CaseError if the compiler fails.

    Parameters
    ----------
    tables : xarray.Dataset
        As for :func:`fmu_variables`.
    name : str
        Name of the model, an identifier of C.
    case_text : str
        Case file that goes into the unit.
    compiler : str or None
        C compiler; None leaves the unit without a binary.
    """
    variables = fmu_variables(tables, free_shaft=free_shaft)
    source = files("toothspace.fmi").joinpath(SOURCE).read_text(encoding="utf-8")
    data = _data_header(tables, variables, name, free_shaft=free_shaft)
    # what names and units mean is in the description: a change there is another unit too
    description = _description(tables, variables, name, token="")
    token = hashlib.sha256("\0".join((source, data, description)).encode()).hexdigest()[:32]
    data = f'#define TOKEN "{token}"\n{data}'
    contents = {
        "modelDescription.xml": _description(tables, variables, name, token).encode(),
        f"sources/{SOURCE}": source.encode(),
        f"sources/{_DATA}": data.encode(),
        "resources/case.toml": case_text.encode(),
    }
    target, suffix = platform_folder()
    if compiler is not None:
        binary = _compiled(source, data, name + suffix, compiler)
        contents[f"binaries/{target}/{name}{suffix}"] = binary
    return packed(contents), target if compiler is not None else ""


def packed(contents: Mapping[str, bytes]) -> bytes:
    """Archive of files by their paths; the same contents give the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in contents.items():
            entry = zipfile.ZipInfo(path, _FIRST_DAY)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def found_compiler() -> str | None:
    """Return the C compiler of this computer, None if it has none."""
    return program_named("cc", "gcc", "clang")


def platform_folder() -> tuple[str, str]:
    """Folder of binaries in FMI 2.0 and the ending of a library."""
    system = {"win32": ("win", ".dll"), "darwin": ("darwin", ".dylib")}
    name, suffix = system.get(sys.platform, ("linux", ".so"))
    return f"{name}{64 if sys.maxsize > 2**32 else 32}", suffix


def _compiled(source: str, data: str, name: str, compiler: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / SOURCE).write_text(source, encoding="utf-8")
        (place / _DATA).write_text(data, encoding="utf-8")
        command = [compiler, *_OPTIONS, "-o", name, SOURCE, "-lm"]
        try:
            done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
        except OSError as error:
            found = f"{compiler!r} that does not start ({error.strerror})"
            raise CaseError("compiler", found, "a C compiler") from error
        if done.returncode != 0 or not (place / name).is_file():
            reason = " ".join(done.stderr.split())[:300]
            allowed = "allowed a C99 compiler, or a unit without binary"
            raise CaseError(f"compiler: found {compiler!r} that fails ({reason}), {allowed}")
        return (place / name).read_bytes()


def _data_header(
    tables: xr.Dataset, variables: list[FmuVariable], name: str, *, free_shaft: bool
) -> str:
    """Constants and tables of the machine in C."""
    ordered = tables.transpose("pressure_difference", "shaft_speed", "shaft_angle")
    pressures, speeds = (ordered[axis].values for axis in ("pressure_difference", "shaft_speed"))
    waves = [ordered[f"{one}_ripple"].values for one in _WAVES]
    given = sum(one.causality != "output" or one.name == "shaft_speed" for one in variables)
    constants: dict[str, Any] = {
        "MODEL_NAME": f'"{name}"',
        "SIGN": "-1.0 /* motor */" if tables.attrs["mode"] == "motor" else "1.0 /* pump */",
        "DRIVEN_BY_TORQUE": int(free_shaft),
        "DISPLACEMENT": f"{float(tables['displacement'])!r} /* m3/rad */",
        "PERIOD": f"{float(tables['period'])!r} /* of the ripple [rad] */",
        "LOW_PRESSURE": f"{float(tables['low_pressure'])!r} /* of all runs [Pa] */",
        "ROUNDING": "1e-6",
        "GIVEN_COUNT": given,
        "REAL_COUNT": len(variables),
        "BOOLEAN_COUNT": len(_BOOLEANS),
        "PRESSURE_COUNT": pressures.size,
        "SPEED_COUNT": speeds.size,
        "ANGLE_COUNT": waves[0].shape[-1],
        "HIGHEST_PRESSURE": "PRESSURE_AXIS[PRESSURE_COUNT - 1]",
        "HIGHEST_SPEED": "SPEED_AXIS[SPEED_COUNT - 1]",
    }
    by_loss, wave_table = _losses(ordered, pressures, speeds), np.stack(waves, axis=2)
    losses = np.stack(list(by_loss.values()), axis=-1)
    enumerated = (
        [one.name for one in variables],
        [word for word, *_ in _BOOLEANS],
        [*by_loss, "loss_count"],
        [*_WAVES.values(), "wave_count"],
    )
    lines = [
        f"/* {tables.attrs['mode']} {name}, written by toothspace {toothspace.__version__}. */",
        *(f"#define {key} {value}" for key, value in constants.items()),
        "",
        *(f"enum {{ {', '.join(name.upper() for name in names)} }};" for names in enumerated),
        "",
        *(
            f"static const double {name}[{sizes}] = {_braced(values)};"
            for name, sizes, values in (
                ("REAL_START", "REAL_COUNT", np.array([one.start for one in variables])),
                ("PRESSURE_AXIS", "PRESSURE_COUNT", pressures),
                ("SPEED_AXIS", "SPEED_COUNT", speeds),
                ("LOSSES", "PRESSURE_COUNT][SPEED_COUNT][LOSS_COUNT", losses),
                ("WAVES", "PRESSURE_COUNT][SPEED_COUNT][WAVE_COUNT][ANGLE_COUNT", wave_table),
            )
        ),
    ]
    return "\n".join(lines) + "\n"


_WAVES = {
    "inlet_flow_rate": "inlet_wave",
    "outlet_flow_rate": "outlet_wave",
    "shaft_torque": "torque_wave",
}


def _losses(tables: xr.Dataset, pressures: Array, speeds: Array) -> dict[str, Array]:
    """What the machine lacks of the ideal one, over pressure difference and speed.

    ``power_flow`` is the flow whose power, together with that of friction, is the power loss.
    """
    sign = -1.0 if tables.attrs["mode"] == "motor" else 1.0
    displacement = float(tables["displacement"])
    flow, difference = displacement * speeds[None, :], pressures[:, None]
    inlet, outlet = tables["inlet_flow_rate"].values, tables["outlet_flow_rate"].values
    return {
        "inlet_slip": sign * (flow - inlet),
        "outlet_slip": sign * (flow - outlet),
        "drain_flow": tables["drain_flow_rate"].values,
        "leakage_flow": tables["leakage"].values,
        "lost_flow": tables["lost_flow_rate"].values,
        "friction": sign * (tables["shaft_torque"].values - displacement * difference),
        "power_flow": sign * (flow - tables["hydraulic_power"].values / difference),
    }


def _braced(values: Array) -> str:
    """An array of C, one row of its last axis on a line, with nine digits."""
    if values.ndim == 1:
        return "{" + ",".join(f"{value:.9g}" for value in values) + "}"
    return "{" + ",\n".join(_braced(part) for part in values) + "}"


def _description(tables: xr.Dataset, variables: list[FmuVariable], name: str, token: str) -> str:
    root = ElementTree.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid=token,
        description=tables.attrs["title"],
        generationTool=f"toothspace {toothspace.__version__}",
        variableNamingConvention="flat",
    )
    kind = part(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true",
        canNotUseMemoryManagementFunctions="true",
    )
    part(part(kind, "SourceFiles"), "File", name=SOURCE)
    add_units(root, UNITS)
    categories = part(root, "LogCategories")
    for category in ("logStatusWarning", "logStatusError"):
        part(categories, "Category", name=category)
    pitch = float(tables["period"]) / float(tables["shaft_speed"].max())
    part(root, "DefaultExperiment", startTime="0", stopTime="1", stepSize=f"{pitch / 24:.1g}")
    listed = part(root, "ModelVariables")
    for reference, one in enumerate(variables):
        if one.causality:
            about = unit_attributes(one.units)
            start = {} if one.causality == "output" else {"start": repr(one.start)}
            entry = _scalar(listed, one.name, reference, one.causality, one.description)
            part(entry, "Real", **about, **start)
    for reference, (word, causality, meaning) in enumerate(_BOOLEANS):
        entry = _scalar(listed, word, reference, causality, meaning)
        part(entry, "Boolean", **({"start": "true"} if causality == "parameter" else {}))
    structure = part(root, "ModelStructure")
    for group in ("Outputs", "InitialUnknowns"):
        members = part(structure, group)
        for number, entry in enumerate(listed, start=1):
            if entry.get("causality") == "output":
                part(members, "Unknown", index=str(number))
    return document(root)


def document(root: ElementTree.Element) -> str:
    """Text of an XML file."""
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def add_units(root: ElementTree.Element, names: Iterable[str]) -> None:
    """Add the definitions of units, with those for display."""
    units = part(root, "UnitDefinitions")
    for unit in names:
        exponents, shown = UNITS[unit]
        entry = part(units, "Unit", name=unit)
        part(entry, "BaseUnit", **{base: str(power) for base, power in exponents.items()})
        for other, factor in shown.items():
            part(entry, "DisplayUnit", name=other, factor=repr(float(factor)))


def unit_attributes(unit: str) -> dict[str, str]:
    """Attributes of a variable: its unit, and the first one for display."""
    for_display = next(iter(UNITS[unit][1]), "")
    return {"unit": unit} | ({"displayUnit": for_display} if for_display else {})


def part(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    """Add an element to another one."""
    return ElementTree.SubElement(parent, tag, attributes)


def _scalar(
    parent: ElementTree.Element, name: str, reference: int, causality: str, meaning: str
) -> ElementTree.Element:
    discrete = "discrete" if name == "within_table" else "continuous"
    return part(
        parent,
        "ScalarVariable",
        name=name,
        valueReference=str(reference),
        description=meaning,
        causality=causality,
        variability="fixed" if causality == "parameter" else discrete,
    )
