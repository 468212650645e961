"""Technical data of asset administration shells: what the template asks for, and valid."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.fake_solution import fake_solution
from toothspace.core.errors import CaseError
from toothspace.results.solution import Solution
from toothspace.results.technical_data import pump_quantities, write_technical_data


def written(folder: Path, solution: Solution | None = None, client: str = "") -> dict[str, Any]:
    path, *_ = write_technical_data(
        solution or fake_solution(36), folder / "pump.json", "ACME", "12-495", client=client
    )
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def pump() -> Solution:
    """The made-up motor, with the words of a pump."""
    motor = fake_solution(36)
    return replace(motor, data=motor.data.assign_attrs(mode="pump"))


def elements(parent: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Elements of a submodel, a collection or an entity by their names."""
    found = parent.get("submodelElements") or parent.get("statements") or parent["value"]
    return {one["idShort"]: one for one in found}


def meaning(element: dict[str, Any]) -> str:
    found: str = element["semanticId"]["keys"][0]["value"]
    return found


def test_the_submodel_has_what_its_template_asks_for(tmp_path: Path) -> None:
    """Elements of cardinality One of IDTA 02003-2-0 with their meanings, and the numbers."""
    found = written(tmp_path)
    (submodel,) = found["submodels"]
    assert submodel["semanticId"]["keys"][0]["value"] == "0173-1#01-AHX837#002"
    general, areas = submodel["submodelElements"]
    meanings = {one["idShort"]: one["semanticId"]["keys"][0]["value"] for one in general["value"]}
    assert meanings == {
        "ManufacturerName": "0173-1#02-AAO677#004",
        "ManufacturerProductDesignation": "0173-1#02-AAW338#003",
        "ManufacturerArticleNumber": "0173-1#02-AAO676#005",
        "ManufacturerOrderCode": "0173-1#02-AAO227#004",
    }
    section = areas["value"][0]["value"][-1]
    numbers = {one["idShort"]: one for one in section["value"]}
    flow = numbers["mean_flow_L_per_min"]
    assert float(flow["value"]) == fake_solution(36).summary()["mean_flow_L_per_min"]
    content = flow["embeddedDataSpecifications"][0]["dataSpecificationContent"]
    assert content["unit"] == "L/min"
    assert (
        found["assetAdministrationShells"][0]["submodels"][0]["keys"][0]["value"]
        == (submodel["id"])
    )


def test_a_pump_has_names_of_opc_40223(tmp_path: Path) -> None:
    """Browse names and numeric identifiers as the foundation publishes them; values in SI units."""
    solution = pump()
    submodel = written(tmp_path, solution)["submodels"][0]
    area = elements(submodel)["TechnicalPropertyAreas"]["value"][0]
    found = elements(elements(area)["OpcUaPump"])
    published = {
        "GeometricDisplacementVolume": 7708,
        "DifferentialPressure": 12647,
        "Speed": 12719,
        "Torque": 9465,
        "PumpPowerInput": 12697,
        "PumpPowerOutput": 12699,
        "PumpEfficiency": 12693,
        "VolumetricEfficiency": 12727,
    }
    for name, number in published.items():
        assert meaning(found[name]) == f"nsu=http://opcfoundation.org/UA/Pumps/;i={number}"
    value = {name: float(one["value"]) for name, one in found.items()}
    # its energies are still those of a motor
    power = abs(value["Torque"]) * value["Speed"] * 2.0 * math.pi
    assert value["PumpPowerInput"] == pytest.approx(power, rel=1e-3)
    assert value["PumpEfficiency"] * value["PumpPowerInput"] == pytest.approx(
        value["PumpPowerOutput"], rel=1e-9
    )
    geometric = value["GeometricDisplacementVolume"] * value["Speed"]
    assert value["GeometricalFlow"] == pytest.approx(geometric)
    summary = solution.summary()
    volume = 1e-6 * summary["displacement_cm3_per_rev"]
    assert value["GeometricDisplacementVolume"] == pytest.approx(volume)
    bars = summary["outlet_pressure_bar"] - summary["inlet_pressure_bar"]
    assert value["DifferentialPressure"] == pytest.approx(1e5 * bars)
    # SI units: kg/s, rev/s and kelvin
    density = float(solution.data["outlet_density"])
    assert value["MassFlow"] == pytest.approx(summary["mean_flow_L_per_min"] / 6e4 * density)
    assert value["Speed"] == pytest.approx(summary["shaft_speed_rpm"] / 60.0)
    for port in ("Inlet", "Outlet"):
        kelvin = summary[f"{port.lower()}_temperature_degC"] + 273.15
        assert value[f"{port}TemperatureOfThePump"] == pytest.approx(kelvin)
    # they are names of pumps
    assert pump_quantities(fake_solution(36)) == {}


def test_who_sizes_the_motor_gets_its_motion(tmp_path: Path) -> None:
    """Compulsory elements of IDTA 02021-1-0 with their meanings; the torque acts against a pump."""
    solution = pump()
    time = solution.data["time"]
    speed = solution.data["shaft_speed"] + 2.0 * (time - time[0])
    solution = replace(solution, data=solution.data.assign(shaft_speed=speed))
    sizing = written(tmp_path, solution, "Example Machines")["submodels"][1]
    iri = "https://admin-shell.io/idta/PowerDriveTrainSizing"
    assert meaning(sizing) == f"{iri}/1/0"
    parts = elements(sizing)
    information = elements(parts["SizingProjectInformation"])
    for name in ("ClientName", "SizingProjectName", "SizingProjectLink", "SizingToolName"):
        assert meaning(information[name]) == f"{iri}/{name}/1/0"
    assert {"DateCreated", "DateChanged", "ContactInformation"} < set(information)
    assert elements(parts["SizingResult"])["Messages"]
    section = parts["ApplicationRequirements"]
    for name in ("MotionPattern", "MotionPatternSections", "RotativeSection"):
        section = elements(section)[name]
    assert meaning(section) == f"{iri}/RotativeMotionPatternSection/1/0"
    columns = list(elements(elements(section)["MetadataRotativeMotionFile"]))
    file = tmp_path / elements(section)["MotionSectionFile"]["value"]
    head, *_ = file.read_text(encoding="utf-8").splitlines()
    assert [name.split(" [")[0] for name in head.split(";")] == columns
    seconds, angle, turning, acceleration, torque = np.loadtxt(file, delimiter=";", skiprows=1).T
    assert seconds[0] == angle[0] == 0.0
    np.testing.assert_allclose(turning, speed, rtol=1e-9)
    np.testing.assert_allclose(acceleration, 2.0, rtol=1e-6)
    np.testing.assert_allclose(torque, -solution.data["shaft_torque"], rtol=1e-9)
    machine = elements(parts["TransformationMechanism"])["Pump"]
    efficiency = float(elements(machine)["Efficiency"]["value"])
    assert efficiency == solution.summary()["overall_efficiency"]


@pytest.mark.parametrize("client", ["", "Example Machines"])
def test_it_keeps_the_rules_of_asset_administration_shells(tmp_path: Path, client: str) -> None:
    """The reader and the rules of the metamodel 3.0, of its own project."""
    reading = pytest.importorskip("aas_core3.jsonization")
    rules = pytest.importorskip("aas_core3.verification")
    environment = reading.environment_from_jsonable(written(tmp_path, pump(), client))
    assert [f"{error.path}: {error.cause}" for error in rules.verify(environment)] == []


def test_what_no_case_knows_must_be_given(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"--article: found nothing, allowed a text"):
        write_technical_data(fake_solution(36), tmp_path / "pump.json", "ACME", " ")


def test_energy_of_an_electric_drive_is_in_kilowatt_hours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """7.2 MJ are 2 kWh; without a drive nothing is said."""
    assert "OverallSystem" not in elements(
        elements(written(tmp_path, pump(), "Example Machines")["submodels"][1])["SizingResult"]
    )
    summary = pump().summary() | {"electric_energy_J": 7.2e6}
    monkeypatch.setattr(Solution, "summary", lambda _: summary)
    sizing = written(tmp_path, pump(), "Example Machines")["submodels"][1]
    system = elements(elements(sizing)["SizingResult"])["OverallSystem"]
    energy = elements(system)["EnergyConsumtionPerCycle"]
    assert float(energy["value"]) == pytest.approx(2.0)


def test_the_torque_of_a_motor_acts_along_its_rotation(tmp_path: Path) -> None:
    motor = fake_solution(36)
    written(tmp_path, motor, "Example Machines")
    torque = np.loadtxt(tmp_path / "pump_motion.csv", delimiter=";", skiprows=1).T[-1]
    np.testing.assert_allclose(torque, motor.data["shaft_torque"], rtol=1e-9)
