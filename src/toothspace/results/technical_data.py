"""A machine in its asset administration shell: technical data, and what sizes its drive.

Submodels IDTA 02003 and IDTA 02021; quantities of a pump under their names of OPC 40223.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import write_text
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import ZERO_CELSIUS
from toothspace.results.solution import Solution
from toothspace.results.variables import label_of, stem_and_unit

_ARBITRARY = "https://admin-shell.io/SMT/General/Arbitrary"
_IEC_61360 = "https://admin-shell.io/DataSpecificationTemplates/DataSpecificationIec61360/3"
_AREA = "0173-1#02-ABL358#002/0173-1#01-AHX773#002"
_SIZING = "https://admin-shell.io/idta/PowerDriveTrainSizing"
_CONTACT = "https://admin-shell.io/zvei/nameplate/1/0/ContactInformations/ContactInformation"
_PUMPS = "nsu=http://opcfoundation.org/UA/Pumps/;i="
_TURN, _LITRE_PER_MINUTE, _KILOWATT_HOUR = 2.0 * math.pi, 1e-3 / 60.0, 3.6e6

_OPC_NAMES = {
    "GeometricDisplacementVolume": (7708, "m3"),
    "GeometricalFlow": (7707, "m3/s"),
    "DifferentialPressure": (12647, "Pa"),
    "FluidTemperature": (12653, "K"),
    "InletTemperatureOfThePump": (9433, "K"),
    "OutletTemperatureOfThePump": (9428, "K"),
    "Density": (12645, "kg/m3"),
    "MassFlow": (12673, "kg/s"),
    "Speed": (12719, "1/s"),
    "Torque": (9465, "N m"),
    "PumpPowerInput": (12697, "W"),
    "PumpPowerOutput": (12699, "W"),
    "PumpEfficiency": (12693, "1"),
    "VolumetricEfficiency": (12727, "1"),
}
"""Numeric identifiers and SI units of variables of OPC 40223 by their browse names.

They belong to its types of design, of measurements, and of measurements at drive and ports.
"""
_MOTION = {
    "Time": ("https://admin-shell.io/idta/TimeSeries/RelativePointInTime/1/1", "s"),
    "AngularPosition": (f"{_SIZING}/AngularPosition/1/0", "rad"),
    "AngularVelocity": (f"{_SIZING}/AngularVelocity/1/0", "rad/s"),
    "AngularAcceleration": (f"{_SIZING}/AngularAcceleration/1/0", "rad/s²"),
    "LoadTorque": (f"{_SIZING}/LoadTorque/1/0", "Nm"),
}
"""Columns of a motion file with their meanings and units, in the order of IDTA 02021."""
_CRITICALITY = {"serious": "Error", "caution": "Warning", "note": "Information"}


def shell_files(path: Path, client: str = "") -> list[Path]:
    """Files that a run becomes for an asset administration shell.

    Parameters
    ----------
    path : Path
        File of the shell.
    client : str
        For whom a drive is sized; empty without a submodel for it, and without its motion.
    """
    return [path, path.with_name(f"{path.stem}_motion.csv")] if client else [path]


def write_technical_data(
    solution: Solution,
    path: Path,
    manufacturer: str,
    article: str,
    *,
    client: str = "",
    project: str = "",
) -> list[Path]:
    """Write a run as submodels of a product, in the JSON of asset administration shells.

    One shell of kind ``Type``. Its submodel ``TechnicalData`` holds what the template asks for of
    the manufacturer, and sections of properties with units: dimensions of the machine, what
    the run found at its operating point, and for a pump the same in SI units under the names of
    OPC 40223, each with the identifier of its node as meaning. The order code is the article
    number.

    With a client there is a submodel ``PowerDriveTrainSizing`` as well, for who sizes the motor:
    the motion of the shaft with the torque of the machine in a CSV file beside, the efficiency of
    a pump, the energy that an electric drive took, and warnings as messages.

    Parameters
    ----------
    solution : Solution
        Result of a run.
    path : Path
        File to write, by custom ``*.json``.
    manufacturer, article : str
        Name of the manufacturer and number of the article.
    client : str
        For whom a drive is sized; empty without a submodel for it.
    project : str
        File of the result, which the submodel names as the file of the sizing.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    CaseError
        If manufacturer or article is empty.

    Notes
    -----
    The template of IDTA 02021 gives numbers the type ``xs:long``, which its own examples, such as
    an efficiency of 0.98, do not fit; they are written as ``xs:double``.

    References
    ----------
    .. [1] Industrial Digital Twin Association, *IDTA 02003 Technical Data*, version 2.0.2, and
       *IDTA 02021 Sizing of Power Drive Trains*, version 1.0.1,
       github.com/admin-shell-io/submodel-templates.
    .. [2] OPC Foundation, *OPC 40223 OPC UA for Pumps and Vacuum Pumps*, release 1.0, with its
       identifiers in github.com/OPCFoundation/UA-Nodeset.
    """
    for option, text in (("--manufacturer", manufacturer), ("--article", article)):
        if not text.strip():
            raise CaseError(option, "nothing", "a text, which technical data must have")
    identity = solution.provenance.get("case_hash") or path.stem
    files = shell_files(path, client)
    submodels = [_technical_data(solution, identity, path.stem, manufacturer, article)]
    if client:
        motion = _motion(solution)
        submodels.append(_sizing(solution, identity, files, client, manufacturer, project))
        units = {name: unit for name, (_, unit) in _MOTION.items()}
        lines = [";".join(f"{name} [{units[name]}]" for name in motion)]
        lines += [";".join(f"{x:.10g}" for x in row) for row in zip(*motion.values(), strict=True)]
        write_text(files[1], "\n".join(lines) + "\n")
    shell = {
        "modelType": "AssetAdministrationShell",
        "id": f"urn:toothspace:aas:{identity}",
        "assetInformation": {"assetKind": "Type", "globalAssetId": _asset(identity)},
        "submodels": [
            {"type": "ModelReference", "keys": [{"type": "Submodel", "value": one["id"]}]}
            for one in submodels
        ],
    }
    content = {"assetAdministrationShells": [shell], "submodels": submodels}
    write_text(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")
    return files


def _asset(identity: str) -> str:
    return f"urn:toothspace:asset:{identity}"


def _technical_data(
    solution: Solution, identity: str, name: str, manufacturer: str, article: str
) -> dict[str, Any]:
    title = solution.provenance.get("title") or name
    geometry = solution.description.geometry_summary if solution.description else {}
    sections = {
        "Machine": _properties(geometry),
        "OperatingPoint": _properties(solution.summary()),
        "OpcUaPump": [
            _number(key, value, _PUMPS + str(_OPC_NAMES[key][0]), _OPC_NAMES[key][1])
            for key, value in pump_quantities(solution).items()
        ],
    }
    return {
        "modelType": "Submodel",
        "id": f"urn:toothspace:submodel:{identity}",
        "idShort": "TechnicalData",
        "kind": "Instance",
        "administration": {
            "version": "2",
            "revision": "0",
            "templateId": "https://admin-shell.io/idta-02003-2-0",
        },
        "semanticId": _template("0173-1#01-AHX837#002"),
        "submodelElements": [
            _collection(
                "GeneralInformation",
                "0173-1#02-ABK161#002/0173-1#01-AHX838#002",
                [
                    _text("ManufacturerName", "0173-1#02-AAO677#004", manufacturer),
                    _words("ManufacturerProductDesignation", "0173-1#02-AAW338#003", title),
                    _text("ManufacturerArticleNumber", "0173-1#02-AAO676#005", article),
                    _text("ManufacturerOrderCode", "0173-1#02-AAO227#004", article),
                ],
            ),
            {
                "modelType": "SubmodelElementList",
                "idShort": "TechnicalPropertyAreas",
                "semanticId": _meaning("0173-1#02-ABK163#002"),
                "semanticIdListElement": _meaning(_AREA),
                "typeValueListElement": "SubmodelElementCollection",
                "value": [
                    {
                        "modelType": "SubmodelElementCollection",
                        "semanticId": _meaning(_AREA),
                        "value": [
                            _collection(key, _ARBITRARY, found)
                            for key, found in sections.items()
                            if found
                        ],
                    }
                ],
            },
        ],
    }


def pump_quantities(solution: Solution) -> dict[str, float]:
    """Quantities of a steady run of a pump by their browse names of OPC 40223, in SI units.

    The efficiency of the pump is that from the shaft to the fluid; an overall efficiency is in
    OPC 40223 that from the supply of the motor, and is not among them. Empty for other runs.

    Parameters
    ----------
    solution : Solution
        Result of a run.
    """
    data, found = solution.data, solution.summary()
    if data.attrs.get("mode") != "pump" or "shaft_speed_rpm" not in found:
        return {}
    speed, displacement = found["shaft_speed_rpm"] / 60.0, float(data["displacement"]) * _TURN
    inlet, outlet = found["inlet_pressure_bar"] * 1e5, found["outlet_pressure_bar"] * 1e5
    quantities = {
        "GeometricDisplacementVolume": displacement,
        "GeometricalFlow": displacement * speed,
        "DifferentialPressure": outlet - inlet,
        "FluidTemperature": float(data["fluid_temperature"]),
        "InletTemperatureOfThePump": found.get("inlet_temperature_degC", math.nan) + ZERO_CELSIUS,
        "OutletTemperatureOfThePump": found.get("outlet_temperature_degC", math.nan) + ZERO_CELSIUS,
        "Density": float(data["inlet_density"]),
        "MassFlow": found["mean_flow_L_per_min"]
        * _LITRE_PER_MINUTE
        * float(data["outlet_density"]),
        "Speed": speed,
        "Torque": found["mean_torque_N_m"],
        "PumpPowerInput": found["shaft_power_W"],
        "PumpPowerOutput": found["hydraulic_power_W"],
        "PumpEfficiency": found["overall_efficiency"],
        "VolumetricEfficiency": found["volumetric_efficiency"],
    }
    return {name: value for name, value in quantities.items() if math.isfinite(value)}


def _motion(solution: Solution) -> dict[str, Array]:
    """Columns of a motion file: time and angle from zero, torque along the rotation."""
    data = solution.data
    time, angle = np.asarray(data["time"], float), np.asarray(data["shaft_angle"], float)
    speed, torque = np.asarray(data["shaft_speed"], float), np.asarray(data["shaft_torque"], float)
    along = -1.0 if data.attrs.get("mode") == "pump" else 1.0
    acceleration = np.gradient(speed, time)
    columns = (time - time[0], angle - angle[0], speed, acceleration, along * torque)
    return dict(zip(_MOTION, columns, strict=True))


def _sizing(
    solution: Solution,
    identity: str,
    files: list[Path],
    client: str,
    manufacturer: str,
    project: str,
) -> dict[str, Any]:
    """Submodel for who sizes the motor of the machine."""
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    title = solution.provenance.get("title") or files[0].stem
    information = [
        _text("ClientName", f"{_SIZING}/ClientName/1/0", client),
        _text("SizingProjectName", f"{_SIZING}/SizingProjectName/1/0", title),
        _file(
            "SizingProjectLink",
            f"{_SIZING}/SizingProjectLink/1/0",
            project or files[0].name,
            "application/x-netcdf" if project else "application/json",
        ),
        _text("SizingToolName", f"{_SIZING}/SizingToolName/1/0", "toothspace"),
        *(
            _text(name, f"{_SIZING}/{name}/1/0", now) | {"valueType": "xs:dateTime"}
            for name in ("DateCreated", "DateChanged")
        ),
        _collection(
            "ContactInformation",
            _CONTACT,
            [_words("Company", "0173-1#02-AAW001#001", manufacturer)],
        ),
    ]
    columns = [_number(name, None, meaning, unit) for name, (meaning, unit) in _MOTION.items()]
    section = [
        _collection(
            "MetadataRotativeMotionFile", f"{_SIZING}/MetadataRotativeMotionFile/1/0", columns
        ),
        _file("MotionSectionFile", f"{_SIZING}/MotionSectionFile/1/0", files[1].name, "text/csv"),
    ]
    for name, meaning in (
        ("RotativeSection", "RotativeMotionPatternSection"),
        ("MotionPatternSections", "MotionPatternSections"),
        ("MotionPattern", "MotionPattern"),
        ("ApplicationRequirements", "ApplicationRequirements"),
    ):
        section = [_collection(name, f"{_SIZING}/{meaning}/1/0", section)]
    return {
        "modelType": "Submodel",
        "id": f"urn:toothspace:sizing:{identity}",
        "idShort": "PowerDriveTrainSizing",
        "kind": "Instance",
        "administration": {
            "version": "1",
            "revision": "0",
            "templateId": "https://admin-shell.io/idta/SubmodelTemplate/SizingofPowerDriveTrains/1/0",
        },
        "semanticId": _template(f"{_SIZING}/1/0"),
        "submodelElements": [
            _collection(
                "SizingProjectInformation",
                # the template has no slash before the version here
                f"{_SIZING}/SizingProjectInformation1/0",
                information,
            ),
            *section,
            *_mechanism(solution, identity),
            _collection(
                "SizingResult",
                f"{_SIZING}/SizingResult/1/0",
                [*_energy(solution), _messages(solution)],
            ),
        ],
    }


def _mechanism(solution: Solution, identity: str) -> Iterator[dict[str, Any]]:
    """Yield what a steady pump does to the power of its motor."""
    efficiency = pump_quantities(solution).get("PumpEfficiency")
    if efficiency is not None:
        pump = _element("Entity", "Pump", f"{_SIZING}/Pump/1/0") | {
            "entityType": "SelfManagedEntity",
            "globalAssetId": _asset(identity),
            "statements": [_number("Efficiency", efficiency, f"{_SIZING}/Efficiency/1/0", "1")],
        }
        meaning = f"{_SIZING}/TransformationMechanism/1/0"
        yield _collection("TransformationMechanism", meaning, [pump])


def _energy(solution: Solution) -> Iterator[dict[str, Any]]:
    """Yield the energy that an electric drive took from its supply, the run as one cycle."""
    energy = solution.summary().get("electric_energy_J")
    if energy is not None:
        # spelt as in the template
        name = "EnergyConsumtionPerCycle"
        meaning = f"{_SIZING}/{name}/1/0"
        yield _element("Entity", "OverallSystem", f"{_SIZING}/OverallSystem/1/0") | {
            "entityType": "CoManagedEntity",
            "statements": [_number(name, energy / _KILOWATT_HOUR, meaning, "kWh")],
        }


def _messages(solution: Solution) -> dict[str, Any]:
    said = [(_CRITICALITY[one.severity], one.sentence) for one in solution.findings]
    if solution.status is not Status.DONE:
        said.insert(0, ("Error", solution.status.value))
    messages = [
        _collection(
            f"Message{number:02d}",
            f"{_SIZING}/Message/1/0",
            [
                _text("CriticalityOfMessage", f"{_SIZING}/CriticalityOfMessage/1/0", kind),
                _words("MessageText", f"{_SIZING}/MessageText/1/0", text),
            ],
        )
        for number, (kind, text) in enumerate(said, 1)
    ]
    return _collection("Messages", f"{_SIZING}/Messages/1/0", messages)


def _template(value: str) -> dict[str, Any]:
    return {"type": "ModelReference", "keys": [{"type": "Submodel", "value": value}]}


def _meaning(value: str) -> dict[str, Any]:
    return {"type": "ExternalReference", "keys": [{"type": "GlobalReference", "value": value}]}


def _english(text: str) -> list[dict[str, str]]:
    return [{"language": "en", "text": text}]


def _element(kind: str, name: str, meaning: str) -> dict[str, Any]:
    return {"modelType": kind, "idShort": name, "semanticId": _meaning(meaning)}


def _text(name: str, meaning: str, value: str) -> dict[str, Any]:
    return _element("Property", name, meaning) | {"valueType": "xs:string", "value": value}


def _words(name: str, meaning: str, text: str) -> dict[str, Any]:
    return _element("MultiLanguageProperty", name, meaning) | {"value": _english(text)}


def _file(name: str, meaning: str, value: str, content_type: str) -> dict[str, Any]:
    return _element("File", name, meaning) | {"value": value, "contentType": content_type}


def _collection(name: str, meaning: str, elements: list[dict[str, Any]]) -> dict[str, Any]:
    # the metamodel knows no empty lists
    found = _element("SubmodelElementCollection", name, meaning)
    return found | {"value": elements} if elements else found


def _number(name: str, value: float | None, meaning: str, unit: str) -> dict[str, Any]:
    """Property of a quantity; without a value it says what a column of a file is."""
    words = stem_and_unit(name)[0].replace("_", " ")
    content = {
        "modelType": "DataSpecificationIec61360",
        "preferredName": _english(words),
        "dataType": "REAL_MEASURE",
        "unit": unit,
    }
    specification = {"dataSpecification": _meaning(_IEC_61360), "dataSpecificationContent": content}
    found = _element("Property", name, meaning) | {
        "valueType": "xs:double",
        "embeddedDataSpecifications": [specification],
    }
    return found if value is None else found | {"value": repr(float(value))}


def _properties(numbers: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Properties that are finite numbers or texts."""
    found = []
    for name, value in numbers.items():
        label = {"displayName": _english(label_of(name))}
        if isinstance(value, bool):
            truth = {"valueType": "xs:boolean", "value": str(value).lower()}
            found.append(_text(name, _ARBITRARY, "") | truth | label)
        elif isinstance(value, str) and value:
            found.append(_text(name, _ARBITRARY, value) | label)
        elif isinstance(value, (int, float)) and math.isfinite(value):
            found.append(_number(name, value, _ARBITRARY, stem_and_unit(name)[1]) | label)
    return found
