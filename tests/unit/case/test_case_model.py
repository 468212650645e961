"""A case is one checked, frozen model: its keys are what is solved."""

from __future__ import annotations

import dataclasses
import math
import pickle
import re
from pathlib import Path

import numpy as np
import pint
import pytest

import toothspace as ts
from toothspace.case import Case
from toothspace.core.keys import KeyTable, keys_of
from toothspace.core.registry import MACHINE_KEYS
from toothspace.core.units import Quantity, exact_text, parse_quantity, to_si
from toothspace.run.condition import fluid_of
from toothspace.run.run import provenance_of

REPOSITORY = Path(__file__).resolve().parents[3]
CASES = sorted((REPOSITORY / "cases").glob("*.toml"))
MOTOR = REPOSITORY / "cases" / "egm12_motor.toml"
RPM = 2.0 * math.pi / 60.0


@pytest.fixture(scope="module")
def motor() -> Case:
    return ts.load_case(MOTOR)


def changed_width(case: Case, width: float) -> Case:
    gears = dataclasses.replace(case.machine.gears, face_width=width)
    return dataclasses.replace(case, machine=dataclasses.replace(case.machine, gears=gears))


def test_what_is_replaced_in_a_dataclass_is_what_is_solved(motor: Case) -> None:
    width = motor.machine.gears.face_width
    wide = changed_width(motor, 2.0 * width)
    assert wide.machine_spec.drive.face_width == 2.0 * motor.machine_spec.drive.face_width
    ratio = ts.describe(wide).displacement / ts.describe(motor).displacement
    assert ratio == pytest.approx(2.0, rel=1e-12)
    assert wide.hash != motor.hash
    assert wide == motor.replace({"machine.gears.face_width": Quantity(2e3 * width, "mm")})
    assert f'face_width = "{2e3 * width:.10g} mm"' in provenance_of(wide)["case_toml"]


def test_provenance_follows_a_replaced_table(motor: Case) -> None:
    point = dataclasses.replace(motor.operating_point, shaft_speed=100.0)  # type: ignore[type-var]
    fast = dataclasses.replace(motor, operating_point=point)
    again = Case.from_toml(provenance_of(fast)["case_toml"], MOTOR.parent)
    assert again.operating_point is not None
    assert again.operating_point.shaft_speed == 100.0
    assert again.hash == fast.hash == provenance_of(fast)["case_hash"] != motor.hash


@pytest.mark.parametrize("value", [-1.0, 3.0, math.nan, "3 bar", "3", True, None, [3e-3]])
def test_impossible_values_are_refused_at_every_level(motor: Case, value: object) -> None:
    with pytest.raises(ts.CaseError, match=r"face_width: found .*allowed a length"):
        dataclasses.replace(motor.machine.gears, face_width=value)
    tables = motor.to_dict()
    tables["machine"]["gears"]["face_width"] = value
    with pytest.raises(ts.CaseError, match=r"machine.gears.face_width: found .*allowed a length"):
        Case.from_dict(tables)


def test_a_text_with_a_unit_becomes_a_number_in_si(motor: Case) -> None:
    gears = dataclasses.replace(motor.machine.gears, module="3 mm", tip_diameter="44 mm")
    assert gears.module == 3e-3


def test_rules_between_keys_hold_in_python(motor: Case) -> None:
    with pytest.raises(ts.CaseError, match="center_distance: found a value, allowed leave"):
        dataclasses.replace(motor.machine.gears, center_distance=34e-3)
    with pytest.raises(ts.CaseError, match=r"outlet_pressure: found 300 bar|inlet_pressure: found"):
        motor.replace({"operating_point.outlet_pressure": "300 bar"})
    with pytest.raises(ts.CaseError, match="exactly one of"):
        dataclasses.replace(motor, operating_point=None)
    with pytest.raises(ts.CaseError, match=r"machine.journal_bearings.diameter: found 30 mm"):
        motor.replace({"machine.journal_bearings.diameter": "30 mm"}).check()


def test_what_is_derived_cannot_be_replaced(motor: Case) -> None:
    for name in ("machine_spec", "hash", "machine_type"):
        with pytest.raises((TypeError, ValueError)):
            dataclasses.replace(motor, **{name: "other"})
        with pytest.raises((dataclasses.FrozenInstanceError, AttributeError)):
            setattr(motor, name, "other")


def test_mappings_of_a_case_are_frozen() -> None:
    case = ts.load_case(MOTOR.with_name("startup_fan_drive.toml"))
    assert case.circuit is not None
    with pytest.raises(TypeError, match="cannot be changed"):
        case.circuit.elements["load"] = None  # type: ignore[index]
    swept = ts.load_case(MOTOR.with_name("sweep_clearance.toml"))
    with pytest.raises(TypeError, match="cannot be changed"):
        swept.study.vary.clear()


def test_replace_by_key_paths(motor: Case) -> None:
    case = motor.replace(
        {
            "operating_point.shaft_speed": "2000 rpm",
            "machine.gears.face_width": Quantity(8.0, "mm"),
            "run.revolutions": 2,
            "machine.startup": None,
        }
    )
    assert case.operating_point is not None
    assert case.operating_point.shaft_speed == pytest.approx(2000.0 * RPM, rel=1e-12)
    assert case.machine.gears.face_width == 8e-3
    assert (case.run.revolutions, case.run.until) == (2, None)
    assert case.machine.startup is None
    assert case.source == motor.source
    assert "operating_point.shaft_speed=2000 rpm" in case.overrides
    assert motor.machine.gears.face_width != 8e-3


def test_every_wrong_key_is_named_at_once(motor: Case) -> None:
    values = {
        "machine.gears.module": "-1 mm",
        "operating_point.shaft_speed": 2000,
        "run.fidelty": "lumped",
    }
    with pytest.raises(ts.CaseError) as caught:
        motor.replace(values)
    lines = str(caught.value).splitlines()
    assert len(lines) == 3
    assert all(line.startswith("egm12_motor: ") and "allowed" in line for line in lines)
    assert "found 2000 without a unit" in str(caught.value)
    assert "fidelity (did you mean that?)" in str(caught.value)


def test_messages_give_the_line_of_the_key(tmp_path: Path) -> None:
    text = MOTOR.read_text(encoding="utf-8")
    file = tmp_path / "case.toml"
    wrong = re.sub(r"\nmodule = .*", '\nmodule = "2.75"', text)
    wrong = re.sub(r"\nlength = .*", "", wrong).replace("[run]", '[run]\nmesh = "soft"')
    file.write_text(wrong, encoding="utf-8")
    with pytest.raises(ts.CaseError) as caught:
        ts.load_case(file)
    rows = wrong.splitlines()
    expected = [
        ("machine.gears.module", rows.index('module = "2.75"') + 1),
        ("machine.journal_bearings.length", rows.index("[machine.journal_bearings]") + 1),
        ("run.mesh", rows.index('mesh = "soft"') + 1),
    ]
    lines = str(caught.value).splitlines()
    assert len(lines) == 3
    for line, (key, number) in zip(lines, expected, strict=True):
        assert line.startswith(f"{file}: {key}: found ")
        assert line.endswith(f"(line {number})")


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_tables_and_text_read_back_to_an_equal_case(path: Path) -> None:
    case = ts.load_case(path)
    for again in (Case.from_dict(case.to_dict()), Case.from_toml(case.to_toml())):
        assert again == case
        assert again.hash == case.hash
        assert again.machine_spec is case.machine_spec


def test_case_travels_between_processes(motor: Case) -> None:
    case = motor.replace({"machine.gears.face_width": "9 mm"})
    again = pickle.loads(pickle.dumps(case))
    assert again == case
    assert again.hash == case.hash
    with pytest.raises(ts.CaseError) as caught:
        motor.replace({"run.mesh": "soft", "run.foo": 1})
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_defaults_that_are_spelled_out_change_nothing(motor: Case) -> None:
    assert motor.replace({"run.mesh": "rigid"}).hash == motor.hash


def test_curves_may_be_arrays(motor: Case) -> None:
    from_file = ts.load_case(MOTOR.with_name("egm12_motor_profile.toml"))
    points = np.loadtxt(from_file.machine.gears.profile)
    case = from_file.replace({"machine.gears.profile": points})
    tooth, same = from_file.machine_spec.drive.tooth, case.machine_spec.drive.tooth
    assert same.tip_radius == pytest.approx(tooth.tip_radius, rel=1e-12)
    assert Case.from_toml(case.to_toml()) == case
    assert len(repr(case)) < 200
    grown = from_file.replace({"machine.gears.profile": 1.001 * points})
    assert grown.hash != case.hash
    with pytest.raises(ts.CaseError, match=r"gears.profile: found .*list of at least three"):
        from_file.replace({"machine.gears.profile": points[:, 0]})


def test_fluids_may_be_columns(motor: Case, tmp_path: Path) -> None:
    columns = {
        "temperature [degC]": [40.0] * 3 + [60.0] * 3,
        "pressure [bar]": [1.0, 150.0, 300.0] * 2,
        "density [kg/m3]": [860.0, 868.0, 875.0, 848.0, 857.0, 864.0],
        "dynamic_viscosity [mPa s]": [40.0, 56.0, 78.0, 17.0, 23.0, 31.0],
    }
    case = motor.replace({"fluid.table": {n: np.array(v) for n, v in columns.items()}})
    assert case.fluid is not None
    assert case.fluid.name is None
    rows = [
        ",".join(columns),
        *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True)),
    ]
    file = tmp_path / "oil.csv"
    file.write_text("\n".join(rows), encoding="utf-8")
    assert fluid_of(case) == fluid_of(motor.replace({"fluid.table": str(file)}))
    assert Case.from_toml(case.to_toml()) == case
    assert case.hash != motor.hash
    with pytest.raises(ts.CaseError, match=r"fluid.table: found .*headings with lists of numbers"):
        motor.replace({"fluid.table": {"density [kg/m3]": [1.0, 2.0], "pressure [bar]": [1.0]}})
    with pytest.raises(ts.CaseError, match=r"fluid.table: .*row 1: found"):
        motor.replace({"fluid.table": {"colour [1]": [1.0, 2.0]}})


@pytest.mark.parametrize("unit", ["mm", "um", "bar", "rpm", "deg", "degC", "cm^3/rev", "1/GPa"])
def test_written_quantities_read_back_exactly(unit: str) -> None:
    random = np.random.default_rng(0)
    for number in [*random.uniform(-1e3, 1e3, 200), 0.0, 1e-300, 7.5, 1 / 3]:
        value = to_si(float(number), unit)
        assert parse_quantity(exact_text(value, unit), unit) == value
        assert parse_quantity(exact_text(float(number), unit), unit) == float(number)


def test_quantities_of_pint_are_understood(motor: Case) -> None:
    registry = pint.UnitRegistry()
    values = {"machine.gears.face_width": 8 * registry.mm}
    values["operating_point.shaft_speed"] = 2000 * registry.rpm
    case = motor.replace(values)
    assert case.machine.gears.face_width == 8e-3
    assert case.value("operating_point.shaft_speed") == pytest.approx(2000.0 * RPM, rel=1e-12)


def test_every_table_of_the_shipped_machines_is_checked() -> None:
    def tables(spec: type) -> list[type]:
        found = [spec]
        for key, _ in keys_of(spec).values():
            for inner in (key, getattr(key, "item", None)):
                if hasattr(inner, "spec"):
                    found += tables(inner.spec)
                if hasattr(inner, "variants"):
                    found += [table for kind in inner.variants.values() for table in tables(kind)]
        return found

    assert all(issubclass(spec, KeyTable) or keys_of(spec) for spec in tables(Case))
    assert set(MACHINE_KEYS) >= {"external_gear", "gerotor"}
