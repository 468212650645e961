"""Units of a machine that was run: its ledger at the grid points, direct runs between them."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import toothspace as ts
from toothspace.case import Case
from toothspace.fmi.archive import found_compiler
from toothspace.solver.accuracy import ENERGY_BALANCE

SPEEDS, PRESSURES = (900.0, 1500.0), (60.0, 140.0)  # rpm, bar
MEANS = ("shaft_power", "hydraulic_power", "power_loss", "volumetric_efficiency")
HOST = Path(__file__).resolve().parents[1] / "unit" / "fmi" / "data" / "fmu_host.c"

pytestmark = pytest.mark.skipif(found_compiler() is None, reason="no C compiler")


@pytest.fixture(scope="module")
def case() -> Case:
    """A pump with few samples and a fair tolerance, to be run in seconds."""
    return ts.load_case("egm12_pump").replace(
        {
            "run.samples_per_revolution": 360,
            "run.relative_tolerance": 1e-5,
            "operating_point.outlet_load": "fixed_pressure",
            "heat.model": "network",  # rounds of the heat leave 0.1 K
        }
    )


@pytest.fixture(scope="module")
def folder(case: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The unpacked unit with a simulator in C beside it."""
    place = tmp_path_factory.mktemp("unit")
    result = ts.export_fmu(
        case,
        place / "unit.fmu",
        pressure_difference=[ts.Quantity(value, "bar") for value in PRESSURES],
        shaft_speed=[ts.Quantity(value, "rpm") for value in SPEEDS],
    )
    assert result.status is ts.Status.DONE
    with zipfile.ZipFile(place / "unit.fmu") as packed:
        packed.extractall(place)
    subprocess.run([str(found_compiler()), "-O2", "-o", place / "host", HOST, "-ldl"], check=True)
    return place


def means(folder: Path, speed: float, bar: float) -> dict[str, float]:
    """Means of the outputs over one tooth pitch."""
    root = ElementTree.parse(folder / "modelDescription.xml").getroot()
    reference = {v.get("name"): str(v.get("valueReference")) for v in root.iter("ScalarVariable")}
    names = (*MEANS, "inlet_flow_rate", "outlet_flow_rate", "shaft_torque")
    given = {
        "inlet_pressure": 1e5,
        "outlet_pressure": (1.0 + bar) * 1e5,
        "shaft_speed": speed * np.pi / 30.0,
    }
    step = 2.0 * np.pi / 360 / given["shaft_speed"]
    library = next((folder / "binaries").rglob("*.*"))
    words = [f"{reference[name]}={value!r}" for name, value in given.items()]
    words += [reference[name] for name in names]
    command = [folder / "host", library, str(root.get("guid")), "30", repr(float(step)), *words]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    rows = np.array([line.split(",") for line in done.stdout.splitlines()], dtype=float)
    return dict(zip(names, rows.mean(axis=0).tolist(), strict=True))


def direct(case: Case, speed: float, bar: float) -> ts.Solution:
    at = {
        "operating_point.shaft_speed": f"{speed} rpm",
        "operating_point.outlet_pressure": f"{1.0 + bar} bar",
    }
    return ts.simulate(case.replace(at))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("speed", "bar", "within", "kept"),
    [
        (SPEEDS[0], PRESSURES[1], (1e-6, 1e-6), 1e-9),  # a grid point: the error of the ledger
        (1150.0, 105.0, (1e-3, 1e-2), 1e-3),  # between: of means, and of the loss, their difference
    ],
    ids=["grid point", "between"],
)
def test_powers_and_flows_are_those_of_a_run(
    case: Case, folder: Path, speed: float, bar: float, within: tuple[float, float], kept: float
) -> None:
    found, solution = means(folder, speed, bar), direct(case, speed, bar)
    ledger, data = solution.ledger, solution.data
    of_run = {
        "shaft_power": ledger.shaft_energy / ledger.duration,
        "hydraulic_power": ledger.port_energy / ledger.duration,
        "inlet_flow_rate": ledger.mass["inlet"] / ledger.duration / float(data["inlet_density"]),
        "outlet_flow_rate": ledger.mass["outlet"] / ledger.duration / float(data["outlet_density"]),
        "shaft_torque": ledger.shaft_energy / ledger.shaft_angle,
        "volumetric_efficiency": solution.summary()["volumetric_efficiency"],
    }
    for name, value in of_run.items():
        assert found[name] == pytest.approx(value, rel=within[0]), name
    assert found["power_loss"] == pytest.approx(
        # the powers differ from the losses by what the ledger leaves open
        ledger.loss_energy / ledger.duration,
        rel=within[1],
        abs=max(within[0], ENERGY_BALANCE) * found["shaft_power"],
    )
    # what goes in comes out or is lost, at any point
    balance = found["shaft_power"] - found["hydraulic_power"] - found["power_loss"]
    assert abs(balance) < 1e-12 * found["shaft_power"]
    # mass is kept too, though flows are tabulated as volumes: what enters leaves or is stored,
    # for a run repeats itself within its tolerance only
    masses = [found[f"{p}_flow_rate"] * float(data[f"{p}_density"]) for p in ("inlet", "outlet")]
    stored = ledger.mass["stored_change"] / ledger.duration
    assert masses[0] == pytest.approx(masses[1] + stored, rel=kept)
