"""Case files become frozen cases in SI units."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest

from toothspace.case import Case, load_case
from toothspace.case.document import document_text, parse_document
from toothspace.case.presets import PRESETS
from toothspace.circuit.lines import Hose
from toothspace.circuit.pumps import PumpMap
from toothspace.circuit.restrictions import ReliefValve
from toothspace.circuit.shaft_loads import Fan
from toothspace.circuit.stores import Tank
from toothspace.core.errors import CaseError
from toothspace.studies.bearing_path import HysteresisStudy, NosePressureStudy
from toothspace.studies.calibrate import CalibrateStudy
from toothspace.studies.contact_span import ContactSpanStudy
from toothspace.studies.efficiency_map import EfficiencyMapStudy
from toothspace.studies.sweep import SweepStudy

REPOSITORY = Path(__file__).resolve().parents[3]
CASES = sorted((REPOSITORY / "cases").glob("*.toml"))
MOTOR = REPOSITORY / "cases" / "egm12_motor.toml"
RPM = 2.0 * math.pi / 60.0

CIRCUIT = """
[circuit]
duration = "20 s"
initial_shaft_speed = "0 rpm"
connections = [["supply", "line"], ["line", "relief"], ["line", "machine.inlet"],
               ["machine.outlet", "return"], ["relief", "return"]]
[circuit.supply]
kind = "pump_map"
displacement = "4.95 cm^3"
speed = [["0 s", "0 rpm"], ["1 s", "0 rpm"], ["3 s", "300 rpm"], ["14 s", "300 rpm"]]
volumetric_efficiency = {offset = 0.97, per_100_bar = -0.02}
[circuit.line]
kind = "hose"
length = "2.5 m"
bore = "8 mm"
effective_bulk_modulus = "0.6 GPa"
[circuit.relief]
kind = "relief_valve"
opening_pressure = "60 bar"
[circuit.load]
kind = "fan"
linear = "0.0002 N m/rpm"
cubic = "4e-7 N m s^3/rad^3"
inertia = "0.0035 kg m^2"
[circuit.return]
kind = "tank"
pressure = "1 bar"
"""
BEARING = """
schema = 1
title = "journal"
[bearing]
diameter = "100 mm"
length = "80 mm"
radial_clearance = "150 um"
shaft_speed = "3000 rpm"
dynamic_viscosity = "0.01 Pa s"
eccentricity = [0.5, 0.0]
velocity = ["0 m/s", "0 m/s"]
tilt = ["0 rad", "0 rad"]
end_pressure = "1 bar"
cavitation_pressure = "1 bar"
cavitation = "jfo"
grid = [200, 53]
[[bearing.grooves]]
angle = "90 deg"
width = "15 deg"
length = "60 mm"
pressure = "1.7 bar"
"""
PAD = """
schema = 1
title = "pad"
[film]
kind = "pad"
length = "20 mm"
width = "10 mm"
speed = "1 m/s"
inlet_height = "20 um"
outlet_height = "10 um"
pocket = {depth = "0.4 um", x = "4 mm", length = "6 mm", width = "7 mm"}
dynamic_viscosity = "0.01 Pa s"
ambient_pressure = "1 bar"
cavitation_pressure = "0 bar"
cavitation = "jfo"
grid = [256, 128]
"""
EFFICIENCY_MAP = """
[study]
kind = "efficiency_map"
shaft_speed = ["500 rpm", "1000 rpm", "2000 rpm", "3000 rpm"]
pressure_difference = {from = "20 bar", to = "260 bar", count = 10}
"""
HYSTERESIS = """
[study]
kind = "hysteresis"
outlet_pressures = ["19.4 bar", "38.8 bar", "58.2 bar", "38.8 bar", "19.4 bar"]
start_gap = "1 um"
friction_coefficient = 0.008
breakaway_speed = "6.45 mm/s"
friction_law = "stick"
"""
NOSE = """
[study]
kind = "nose_pressure"
nose_pressure_fractions = [0.0, 0.0625, 0.125, 0.1875, 0.25]
conditions = [{name = "OC1", outlet_pressure = "29.1 bar", shaft_speed = "4675 rpm"}]
"""
SWEEP = """
[study]
kind = "sweep"
vary = {"machine.casing.radial_clearance" = {from = "15 um", to = "40 um", count = 6}}
method = "grid"
"""
CALIBRATE = """
[study]
kind = "calibrate"
data = "measured.csv"
fit = {"machine.startup.breakaway_torque" = ["0.2 N m", "3 N m"]}
hold_out = 0.3
"""


def motor_text() -> str:
    return MOTOR.read_text(encoding="utf-8")


def with_circuit() -> str:
    text = motor_text()
    start, end = text.index("[operating_point]"), text.index("[run]")
    return text[:start] + CIRCUIT + text[end:].replace('until = "cyclic"\n', "")


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_case_in_the_repository_is_accepted(path: Path) -> None:
    case = load_case(path)
    assert case.title
    assert case.run.fidelity in PRESETS


def test_values_are_in_si_units() -> None:
    case = load_case(MOTOR)
    tooth = case.machine_spec.drive.tooth
    assert (tooth.tooth_count, tooth.module) == (12, pytest.approx(2.75e-3, rel=1e-12))
    assert case.machine.casing.inlet_angle == pytest.approx(math.radians(205.0), rel=1e-12)
    assert case.machine.casing.wear_in.pressure == pytest.approx(260e5, rel=1e-12)
    assert case.machine.bearing_blocks.radial_clearance == pytest.approx(25e-6, rel=1e-12)
    assert case.fluid is not None
    assert case.fluid.temperature == pytest.approx(323.15, rel=1e-12)
    assert case.operating_point is not None
    assert case.operating_point.shaft_speed == pytest.approx(1500.0 * RPM, rel=1e-12)


def test_case_is_frozen() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        load_case(MOTOR).title = "other"  # type: ignore[misc]


def test_profile_case_has_the_teeth_of_the_parameters() -> None:
    profile = load_case(MOTOR.with_name("egm12_motor_profile.toml")).machine_spec.drive.tooth
    tooth = load_case(MOTOR).machine_spec.drive.tooth
    assert profile.tooth_count == tooth.tooth_count
    # the text file holds nanometres
    assert profile.tip_radius == pytest.approx(tooth.tip_radius, abs=1e-8)
    assert profile.base_radius == pytest.approx(tooth.base_radius, rel=1e-5)


def test_driven_gear_differs_where_it_says() -> None:
    changes = [
        "machine.driven_gear.tooth_count=14",
        "machine.driven_gear.tip_diameter=45.7 mm",
        "machine.driven_gear.roughness=0.3 um",
    ]
    spec = load_case(MOTOR, changes).machine_spec
    assert (spec.drive.tooth.tooth_count, spec.driven.tooth.tooth_count) == (12, 14)
    assert spec.driven.tooth.profile_shift == spec.drive.tooth.profile_shift
    assert spec.driven.roughness == pytest.approx(0.3e-6, rel=1e-12)


def test_circuit_case() -> None:
    circuit = Case.from_toml(with_circuit()).circuit
    assert circuit is not None
    supply, line, relief, load, tank = (
        circuit.elements[name] for name in ("supply", "line", "relief", "load", "return")
    )
    assert isinstance(supply, PumpMap)
    assert supply.displacement == pytest.approx(4.95e-6 / (2.0 * math.pi), rel=1e-12)
    assert supply.speed is not None
    assert supply.speed[2] == pytest.approx((3.0, 300.0 * RPM), rel=1e-12)
    assert isinstance(line, Hose)
    assert line.effective_bulk_modulus == pytest.approx(0.6e9, rel=1e-12)
    assert isinstance(relief, ReliefValve)
    assert isinstance(load, Fan)
    assert load.linear == pytest.approx(0.0002 / RPM, rel=1e-12)
    assert load.cubic == pytest.approx(4e-7, rel=1e-12)
    assert isinstance(tank, Tank)
    assert circuit.connections[0] == ("supply", "line")


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ('"relief", "return"', '"relief", "nowhere"', "circuit.connections: found 'nowhere'"),
        ('"relief", "return"', '"relief", "load"', "circuit.connections: found 'load'"),
        ('[["supply", "line"], ', "[", "circuit.supply: found an element without connection"),
        ('kind = "fan"', 'kind = "windmill"', "circuit.load.kind: found 'windmill'"),
        ('["1 s", "0 rpm"]', '["0 s", "0 rpm"]', "circuit.supply.speed: found times"),
        ('bore = "8 mm"', "", "circuit.line.bore: found nothing"),
        ('duration = "20 s"', 'duration = "0 s"', "circuit.duration: found '0 s'"),
        ('"0.6 GPa"', '"0.6 GPa"\nwall_modulus = "1 GPa"', "circuit.line.wall_modulus: found"),
        ('pressure = "1 bar"', 'pressure = "5 Pa"', "circuit.return.pressure: found 5e-05 bar"),
    ],
)
def test_bad_circuit_is_refused(old: str, new: str, part: str) -> None:
    text = with_circuit()
    assert old in text
    with pytest.raises(CaseError) as caught:
        Case.from_toml(text.replace(old, new, 1))
    assert part in str(caught.value)


def test_stand_alone_bearing_and_film() -> None:
    bearing = Case.from_toml(BEARING).bearing
    assert bearing is not None
    assert bearing.eccentricity == (0.5, 0.0)
    assert bearing.grid == (200, 53)
    assert bearing.grooves[0].angle == pytest.approx(math.pi / 2.0, rel=1e-12)
    film = Case.from_toml(PAD).film
    assert film is not None
    assert film.pocket is not None
    assert film.pocket.depth == pytest.approx(0.4e-6, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "old", "new", "part"),
    [
        (BEARING, "[0.5, 0.0]", "[0.8, 0.8]", "bearing.eccentricity: found [0.8, 0.8]"),
        (BEARING, "[0.5, 0.0]", "[0.5]", "bearing.eccentricity: found [0.5]"),
        (BEARING, "eccentricity = [0.5, 0.0]", "", "bearing.eccentricity: found nothing"),
        (BEARING, 'dynamic_viscosity = "0.01 Pa s"', "", "bearing.dynamic_viscosity: found no"),
        (BEARING, '"90 deg"', '"90"', "bearing.grooves[0].angle: found '90'"),
        (PAD, 'kind = "pad"', 'kind = "wedge"', "film.kind: found 'wedge', allowed 'pad'"),
        (PAD, 'outlet_height = "10 um"', 'outlet_height = "0 um"', "film.outlet_height: found"),
        (PAD, "[256, 128]", "[256, 2.5]", "film.grid[1]: found 2.5"),
    ],
)
def test_bad_stand_alone_film_is_refused(text: str, old: str, new: str, part: str) -> None:
    with pytest.raises(CaseError) as caught:
        Case.from_toml(text.replace(old, new, 1))
    assert part in str(caught.value)


def test_studies_of_an_operating_point(tmp_path: Path) -> None:
    (tmp_path / "measured.csv").write_text("time,shaft_torque\n0,1\n", encoding="utf-8")
    kinds = {
        EFFICIENCY_MAP: EfficiencyMapStudy,
        HYSTERESIS: HysteresisStudy,
        NOSE: NosePressureStudy,
        SWEEP: SweepStudy,
        CALIBRATE: CalibrateStudy,
        '[study]\nkind = "contact_span"\n': ContactSpanStudy,
    }
    for text, kind in kinds.items():
        assert isinstance(Case.from_toml(motor_text() + text, tmp_path).study, kind)


def test_grid_of_values_includes_both_ends() -> None:
    study = Case.from_toml(motor_text() + EFFICIENCY_MAP).study
    assert len(study.pressure_difference) == 10
    assert study.pressure_difference[0] == pytest.approx(20e5, rel=1e-12)
    assert study.pressure_difference[-1] == pytest.approx(260e5, rel=1e-12)


def test_study_of_a_stand_alone_film_is_refused() -> None:
    with pytest.raises(CaseError, match=r"study: found a study with \[film\]"):
        Case.from_toml(PAD + SWEEP)


def test_override_replaces_and_is_recorded() -> None:
    overrides = ["operating_point.shaft_speed=2000 rpm", "run.samples_per_revolution = 360"]
    case = load_case(MOTOR, overrides)
    assert case.operating_point is not None
    assert case.operating_point.shaft_speed == pytest.approx(2000.0 * RPM, rel=1e-12)
    assert case.run.samples_per_revolution == 360
    assert case.overrides == tuple(overrides)
    assert '"2000 rpm"' in case.to_toml()


def test_override_takes_the_place_of_its_alternative() -> None:
    changes = ["run.revolutions=2", "machine.gears.center_distance=34.5 mm"]
    case = load_case(MOTOR, changes)
    assert (case.run.revolutions, case.run.until) == (2, None)
    assert case.machine.gears.normal_backlash is None
    assert case.machine_spec.center_distance == pytest.approx(34.5e-3, rel=1e-12)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_normalised_text_gives_the_same_case(path: Path) -> None:
    case = load_case(path)
    again = Case.from_toml(case.to_toml(), path.parent)
    assert again.to_toml() == case.to_toml()
    assert again.hash == case.hash
    assert (again.machine, again.run, again.fluid) == (case.machine, case.run, case.fluid)


def test_hash_follows_values_and_files_but_not_layout(tmp_path: Path) -> None:
    def of(text: str) -> Case:
        return Case.from_toml(text, tmp_path)

    profile = (REPOSITORY / "cases/profiles/egm12_drive.txt").read_text(encoding="utf-8")
    (tmp_path / "profiles").mkdir()
    file = tmp_path / "profiles" / "egm12_drive.txt"
    file.write_text(profile, encoding="utf-8")
    text = MOTOR.with_name("egm12_motor_profile.toml").read_text(encoding="utf-8")
    first = of(text).hash
    assert of(f"# a comment\n{text}").hash == first
    assert of(text.replace("1500 rpm", "1501 rpm", 1)).hash != first
    file.write_text(f"# measured again\n{profile}", encoding="utf-8")
    assert of(text).hash != first


def test_document_text_is_read_back() -> None:
    tables = {
        "a": 'quote " backslash \\ tab \t newline \n µ \x7f',
        "b": [1, 2.5, True, {"x": "1 mm", "y.z": []}],
        "c": {"d e": {"f": -0.0}, "g": {}},
        "h": 1e-300,
        "i": float("inf"),
    }
    assert parse_document(document_text(tables), "text").tables == tables


def test_former_word_is_accepted_with_a_note(capsys: pytest.CaptureFixture[str]) -> None:
    former = load_case(MOTOR, ['run.deformation="columns"'])
    note = capsys.readouterr().err
    assert former.run.deformation == "winkler"
    assert note.count("\n") == 1
    assert note.startswith("run.deformation: 'columns' is now spelled 'winkler'")
    assert load_case(MOTOR, ['run.deformation="winkler"']).run == former.run
    assert capsys.readouterr().err == ""
