"""Every bad input gives one line on standard error, exit code 2 and no result."""

from __future__ import annotations

import copy
import os
import re
import struct
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import posix
from toothspace.case import load_case
from toothspace.case.document import document_text
from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.core.units import split_quantity, to_si

REPOSITORY = Path(__file__).resolve().parents[3]
GEAR_CASE = REPOSITORY / "cases" / "egm12_motor.toml"
GEROTOR_CASE = REPOSITORY / "cases" / "gerotor_trochoidal.toml"
FLOATING_CASE = REPOSITORY / "cases" / "hysteresis_055.toml"
NOSE_CASE = REPOSITORY / "cases" / "nose_pressure.toml"

DELETE = object()
CONDITION = {"name": "A", "outlet_pressure": "20 bar", "shaft_speed": "3000 rpm"}
CIRCUIT = {
    "duration": "1 s",
    "connections": [["supply", "machine.inlet"], ["machine.outlet", "return"]],
    "supply": {"kind": "tank", "pressure": "20 bar"},
    "return": {"kind": "tank", "pressure": "1 bar"},
}
BEARING = {
    "diameter": "100 mm",
    "length": "80 mm",
    "radial_clearance": "150 um",
    "shaft_speed": "3000 rpm",
    "dynamic_viscosity": "0.01 Pa s",
    "eccentricity": [0.5, 0.0],
}


@dataclass(frozen=True)
class Bad:
    """A change to a good case, the key it must name and a part of what is allowed."""

    path: str
    value: Any
    key: str = ""
    allowed: str = ""
    case: Path = GEAR_CASE

    @property
    def label(self) -> str:
        value = "deleted" if self.value is DELETE else str(self.value)[:30]
        return f"{self.path}={value}"


def changed(tables: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    result = copy.deepcopy(tables)
    *folders, name = path.split(".")
    table = result
    for folder in folders:
        table = table.setdefault(folder, {})
    if value is DELETE:
        del table[name]
    else:
        table[name] = value
    return result


def complaint(capsys: pytest.CaptureFixture[str], file: Path, output: Path, *options: str) -> str:
    """Run a case that must fail; return the one line on standard error, compilation aside."""
    code = main(["run", str(file), "-o", str(output), "--without-study", *options])
    streams = capsys.readouterr()
    lines = [row for row in streams.err.splitlines() if not row.startswith("Compiling ")]
    assert code == 2, streams.err
    assert len(lines) == 1, streams.err
    assert streams.out == ""
    assert "Traceback" not in lines[0]
    assert not output.exists()
    assert lines[0].startswith(f"{file}: ")
    assert "found " in lines[0]
    assert "allowed " in lines[0]
    return lines[0]


G = "machine.gears"
B = "machine.floating_bearing"
MUTATIONS = [
    # units
    Bad(f"{G}.module", 2.75, allowed="from 0.1 mm to 50 mm"),
    Bad(f"{G}.module", "2.75", allowed="a length with its unit"),
    Bad(f"{G}.module", "2.75 bar", allowed="a length"),
    Bad(f"{G}.module", "2,75 mm", allowed="a length"),
    Bad(f"{G}.module", "2.75 furlong", allowed="a length"),
    Bad(f"{G}.module", "mm", allowed="a length"),
    Bad(f"{G}.module", "", allowed="a length"),
    Bad(f"{G}.module", True, allowed="a length"),
    Bad(f"{G}.module", ["2.75 mm"], allowed="a length"),
    Bad(f"{G}.module", {"value": "2.75 mm"}, allowed="a length"),
    Bad(f"{G}.face_width", "nan mm", allowed="above 0 mm"),
    Bad(f"{G}.face_width", "inf mm", allowed="above 0 mm"),
    Bad(f"{G}.face_width", "1e400 mm", allowed="above 0 mm"),
    Bad("operating_point.shaft_speed", "25 Hz", allowed="an angular speed"),
    Bad("operating_point.shaft_speed", "1500", allowed="an angular speed"),
    Bad("fluid.temperature", "50", allowed="a temperature"),
    Bad("fluid.temperature", "50 deg", allowed="a temperature"),
    # ranges
    Bad(f"{G}.face_width", "-7.5 mm", allowed="above 0 mm"),
    Bad(f"{G}.face_width", "0 mm", allowed="above 0 mm"),
    Bad(f"{G}.face_width", "7.5 km", allowed="at most 500 mm"),
    Bad(f"{G}.tooth_count", 0, allowed="from 5 to 200"),
    Bad(f"{G}.tooth_count", 1, allowed="from 5 to 200"),
    Bad(f"{G}.tooth_count", 1_000_000_000, allowed="from 5 to 200"),
    Bad(f"{G}.tooth_count", -12, allowed="from 5 to 200"),
    Bad(f"{G}.tooth_count", 12.5, allowed="a whole number"),
    Bad(f"{G}.tooth_count", True, allowed="a whole number"),
    Bad(f"{G}.tooth_count", [12], allowed="a whole number"),
    Bad(f"{G}.profile_shift", float("nan"), allowed="from -1 to 1.5"),
    Bad(f"{G}.profile_shift", 1e308, allowed="from -1 to 1.5"),
    Bad(f"{G}.profile_shift", "0.3", allowed="a number without unit"),
    Bad(f"{G}.roughness", "-1 um", allowed="from 0 um"),
    Bad("machine.casing.radial_clearance", "0 um", allowed="from 1 um to 1000 um"),
    Bad("machine.casing.radial_clearance", "-20 um", allowed="from 1 um to 1000 um"),
    Bad("machine.casing.radial_clearance", "20 mm", allowed="from 1 um to 1000 um"),
    Bad("machine.casing.inlet_angle", "310 deg", allowed="to 300 deg"),
    Bad("machine.casing.inlet_angle", "290 deg", allowed="330 deg"),
    Bad("machine.journal_bearings.radial_clearance", "0 um", allowed="from 1 um"),
    Bad("machine.journal_bearings.boundary_friction", 2, allowed="from 0 to 1"),
    Bad("machine.lateral.side_gap", "-8 um", allowed="from 0.1 um"),
    Bad("machine.inlet.volume", "0 cm^3", allowed="from 0.1 cm^3"),
    Bad("operating_point.shaft_speed", "0 rpm", allowed="above 0 rpm"),
    Bad("operating_point.shaft_speed", "-1500 rpm", allowed="above 0 rpm"),
    Bad("operating_point.inlet_pressure", "0 bar", allowed="above 0 bar"),
    Bad("operating_point.inlet_pressure", "-1 bar", allowed="above 0 bar"),
    Bad("operating_point.inlet_pressure", "1e9 bar", allowed="at most 1000 bar"),
    Bad("run.samples_per_revolution", 0, allowed="from 36 to 20000"),
    Bad("run.relative_tolerance", 1e-2, allowed="to 0.0001"),
    Bad("run.relative_tolerance", 0.0, allowed="from 1e-12"),
    Bad("fluid.free_air_fraction", -0.1, allowed="from 0 to 0.2"),
    # words
    Bad("machine.type", "vane", allowed="'external_gear' or 'gerotor'"),
    Bad("machine.type", 3, allowed="'external_gear' or 'gerotor'"),
    Bad("machine.type", DELETE, allowed="'external_gear' or 'gerotor'"),
    Bad("machine.mode", "Pump", allowed="'pump' or 'motor'"),
    Bad("machine.drain", "outside", allowed="'inlet' or 'outlet' or 'external'"),
    Bad("run.fidelity", "cfd", allowed="'ideal' or 'lumped' or 'films' or 'elastic'"),
    Bad("fluid.name", "water", allowed="iso_vg_46"),
    Bad("fluid.name", 46, allowed="a text"),
    Bad(f"{G}.material", "unobtainium", allowed="steel_16CrNi4"),
    Bad("title", "", allowed="a text"),
    # keys
    Bad(f"{G}.modul", "2.75 mm", allowed="module (did you mean that?)"),
    Bad("machine.gear", {}, allowed="gears (did you mean that?)"),
    Bad("operating_points", {}, allowed="operating_point (did you mean that?)"),
    Bad(f"{G}.module", DELETE, allowed="compulsory"),
    Bad(f"{G}.face_width", DELETE, allowed="a length"),
    Bad(f"{G}.normal_backlash", DELETE, key=f"{G}.center_distance", allowed="normal_backlash"),
    Bad(f"{G}.center_distance", "34.5 mm", allowed="leave this key out"),
    Bad("machine.casing", DELETE, key="machine.casing.radial_clearance", allowed="a length"),
    Bad("machine.casing", "none", allowed="a table"),
    Bad("machine", DELETE, allowed="[machine]"),
    Bad("machine", 3, allowed="type = one of"),
    Bad("fluid", DELETE, allowed="[fluid]"),
    Bad("operating_point", DELETE, allowed="exactly one of [operating_point], [circuit]"),
    Bad("operating_point.inlet_pressure", DELETE, allowed="an absolute pressure"),
    Bad("machine.drain_pressure", "2 bar", allowed='unless drain = "external"'),
    Bad("schema", 2, allowed="from 1 to 1"),
    Bad("schema", DELETE, allowed="1"),
    Bad("title", DELETE, allowed="a text"),
    Bad("circuit", CIRCUIT, allowed="exactly one of"),
    Bad("bearing", BEARING, allowed="exactly one of"),
    Bad("run.revolutions", 3, allowed="leave this key out"),
    Bad("study", {"kind": "magic"}, key="study.kind", allowed="'efficiency_map'"),
    Bad("study", {"kind": "sweep", "vary": {}}, key="study.vary", allowed="key path"),
    Bad(
        "study",
        {
            "kind": "efficiency_map",
            "shaft_speed": ["1000 rpm"],
            "pressure_difference": {"from": "20 bar", "to": "260 bar", "count": 1},
        },
        key="study.pressure_difference.count",
        allowed="from 2",
    ),
    # physics
    Bad(
        "fluid.temperature", "200 degC", allowed="-40 to 120 degC"
    ),
    Bad("operating_point.outlet_pressure", "5e-3 bar", allowed="vapour pressure"),
    Bad("operating_point.outlet_pressure", "300 bar", key="operating_point.inlet_pressure",
        allowed="at least the outlet pressure of the motor"),
    Bad("operating_point.outlet_load", "orifice", key="operating_point.outlet_pressure",
        allowed="at least 1.05 bar with outlet_load 'orifice'"),
    Bad("machine.casing.wear_in.temperature", "200 degC", allowed="-40 to 120 degC"),
    # geometry
    Bad(f"{G}.profile_shift", -0.9, key=f"{G}.tip_diameter", allowed="pointed"),
    Bad(f"{G}.tip_diameter", "20 mm", allowed="base diameter"),
    Bad(f"{G}.tip_diameter", "48 mm", allowed="pointed"),
    Bad(f"{G}.tip_rounding", "1.3 mm", allowed="tip land"),
    Bad(f"{G}.dedendum", 1.9, key=G, allowed="from 0 to 0.1"),
    Bad(f"{G}.normal_backlash", "1.9 mm", allowed="0 to 1.375 mm"),
    Bad("machine.journal_bearings.diameter", "28 mm", allowed="of the gears, 27.775 mm"),
    # gerotor
    Bad("machine.rotors.lobe_radius", DELETE, allowed="trochoidal", case=GEROTOR_CASE),
    Bad("machine.rotors.inner_tooth_count", 2, allowed="from 3", case=GEROTOR_CASE),
    Bad("machine.ports.land_max_half_angle", "31 deg", allowed="leave this key", case=GEROTOR_CASE),
    Bad("machine.gearbox", {}, allowed="rotors", case=GEROTOR_CASE),
    # floating bearing
    Bad(f"{B}.high_pressure_area.area", "9 mm^2", allowed="seal_line_x", case=FLOATING_CASE),
    Bad(f"{B}.high_pressure_area.seal_line_x", "90 mm", allowed="below 36", case=FLOATING_CASE),
    # a tip circle of 72.12 mm round each of two axes 63.06 mm apart
    Bad(f"{B}.nose.center", ["-90 mm", "31 mm"], case=FLOATING_CASE,
        allowed="within the bearing, x -36.06 to 36.06 mm, y -36.06 to 99.12 mm"),
    Bad(f"{B}.nose.center", ["12 mm", "31 mm"], allowed="beside it", case=FLOATING_CASE),
    Bad(f"{B}.nose.area", "4000 mm^2", key=f"{B}.high_pressure_area", allowed="5442.7",
        case=FLOATING_CASE),
    Bad(f"{B}.springs", [{"force": "70 N", "x": "90 mm", "y": "0 mm"}], key=f"{B}.springs[0]",
        allowed="within the bearing", case=FLOATING_CASE),
    Bad(f"{B}.high_pressure_area", {"area": "9 mm^2", "center": ["90 mm", "0 mm"]},
        key=f"{B}.high_pressure_area.center", allowed="within the bearing", case=FLOATING_CASE),
    Bad("study.sensor_deflection", "1 um/bar", allowed="measured positions", case=FLOATING_CASE),
    Bad("study.outlet_pressures", ["20 bar", "2 bar"], key="study.outlet_pressures[1]",
        allowed="7.2 bar", case=FLOATING_CASE),
    Bad("study.conditions", [CONDITION, CONDITION], allowed="name of its own", case=NOSE_CASE),
    Bad("study.conditions", [CONDITION | {"inlet_pressure": "30 bar"}],
        key="study.conditions[0].outlet_pressure", allowed="30 bar", case=NOSE_CASE),
]  # fmt: skip


@pytest.mark.parametrize("bad", MUTATIONS, ids=lambda bad: bad.label)
def test_changed_case_is_refused(
    bad: Bad, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tables = load_case(bad.case).to_dict()
    file = tmp_path / "bad.toml"
    file.write_text(document_text(changed(tables, bad.path, bad.value)), encoding="utf-8")
    line = complaint(capsys, file, tmp_path / "out.nc")
    assert f": {bad.key or bad.path}" in line
    assert bad.allowed in line[line.index("allowed ") :]
    # the value in the message is the one that was given
    said = re.search(r"found (-?[\d.e+-]+ [a-z]+), allowed", line)
    if said and not bad.key and isinstance(bad.value, str):
        given, shown = (to_si(*split_quantity(text)) for text in (bad.value, said[1]))
        assert shown == pytest.approx(given, rel=1e-3)


def edited(old: str, new: str) -> Callable[[str], bytes]:
    return lambda text: text.replace(old, new, 1).encode()


TEXTS = {
    "empty": (lambda _: b"", "schema"),
    "binary": (lambda _: bytes(range(128, 256)), "encoding"),
    "utf16": (lambda text: text.encode("utf-16"), "encoding"),
    "latin1": (lambda text: f"{text}# \xb5".encode("latin-1"), "encoding"),
    "broken_syntax": (edited("[fluid]", "[fluid"), "syntax"),
    "missing_value": (edited('mode = "motor"', "mode ="), "syntax"),
    "duplicated_key": (edited("tooth_count = 12", "tooth_count = 12\ntooth_count = 13"), "syntax"),
    "duplicated_table": (lambda text: f"{text}\n[fluid]\n".encode(), "syntax"),
    "unquoted_unit": (edited('"2.75 mm"', "2.75 mm"), "syntax"),
    "json": (lambda _: b'{"schema": 1}', "syntax"),
    "deep_nesting": (lambda _: b"a = " + b"[" * 5000, "syntax"),
    "deep_tables": (lambda text: f"{text}\n[{'.'.join('a' * 500)}]\nb = 1\n".encode(), "a.a.a"),
    "long_integer": (edited("tooth_count = 12", "tooth_count = " + "9" * 5000), "syntax"),
    "large": (lambda text: text.encode() + b"#" * 6_000_000, "case file"),
}  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_broken_text_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, key = TEXTS[name]
    file = tmp_path / "bad.toml"
    file.write_bytes(change(GEAR_CASE.read_text(encoding="utf-8")))
    line = complaint(capsys, file, tmp_path / "out.nc")
    assert f": {key}" in line
    assert len(line) < 500
    assert "set_int_max_str_digits" not in line


def test_missing_file_and_directory(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "out.nc"
    assert "No such file" in complaint(capsys, tmp_path / "absent.toml", output)
    assert "a directory" in complaint(capsys, tmp_path, output)
    assert "a drawing, which 'toothspace gear'" in complaint(capsys, tmp_path / "gear.STEP", output)
    assert "a result, which 'toothspace report'" in complaint(capsys, tmp_path / "run.nc", output)
    elsewhere = complaint(capsys, tmp_path / "cases" / "egm12_pump.toml", output)
    assert elsewhere.endswith("or egm12_pump, the shipped case")
    (tmp_path / "own.toml").write_text('base = "egm12_pump.toml"\ntitle = "x"\n')
    named = complaint(capsys, tmp_path / "own.toml", output)
    assert "'toothspace init egm12_pump' copies the shipped one" in named


def test_a_value_from_elsewhere_has_no_line() -> None:
    with pytest.raises(CaseError) as refused:
        load_case(GEAR_CASE, ["operating_point.shaft_speed=3000"])
    assert "shaft_speed: found 3000 without a unit" in str(refused.value)
    assert "(line" not in str(refused.value)


@pytest.mark.parametrize(
    ("override", "part"),
    [
        ("machine.gears.module", "allowed key.path=value"),
        ("=3 mm", "allowed key.path=value"),
        ("machine.gears.module=", "allowed key.path=value"),
        ("machine..module=3 mm", "allowed key.path=value"),
        ("title.part=3", "title is a value"),
        ("machine.gears.module=3", "machine.gears.module: found 3 without a unit"),
        ("machine.gears.modul=3 mm", "did you mean that?"),
        ("fluid.name=water", "fluid.name: found 'water'"),
    ],
)
def test_bad_override_is_refused(
    override: str, part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "good.toml"
    file.write_bytes(GEAR_CASE.read_bytes())
    assert part in complaint(capsys, file, tmp_path / "out.nc", "--set", override)


def test_bad_fidelity_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = complaint(capsys, GEAR_CASE, tmp_path / "out.nc", "--fidelity", "cfd")
    assert "run.fidelity: found 'cfd'" in line


def test_elastic_preset_asks_for_a_floating_bearing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = GEAR_CASE.read_text(encoding="utf-8")
    bare = tmp_path / "bare.toml"
    kept = [one for one in text.splitlines() if not one.startswith("high_pressure_area")]
    bare.write_text("\n".join(kept), encoding="utf-8")
    line = complaint(capsys, bare, tmp_path / "out.nc", "--fidelity", "elastic")
    assert "machine.floating_bearing: found no high_pressure_area" in line


def test_pump_at_vacuum_inlet_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # 1 kPa is the numerical floor of the vapour pressure of mineral oil
    options = ["--set", "operating_point.inlet_pressure=0.5 kPa"]
    line = complaint(capsys, REPOSITORY / "cases" / "egm12_pump.toml", tmp_path / "o.nc", *options)
    assert "operating_point.inlet_pressure: found 0.005 bar, allowed above the vapour" in line


def square(size: float) -> str:
    return f"{-size} {-size}\n{size} {-size}\n{size} {size}\n{-size} {size}\n"


def tetrahedron(faces: int, stated: int) -> bytes:
    corners = [(0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (0.0, 20.0, 0.0), (0.0, 0.0, 20.0)]
    sides = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)][:faces]
    points = [[value for corner in side for value in corners[corner]] for side in sides]
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *point, 0) for point in points)
    return bytes(80) + struct.pack("<I", stated) + body


def open_dxf() -> bytes:
    points = "".join(f"10\n{x}\n20\n{y}\n" for x, y in [(0, 0), (20, 0), (20, 20), (0, 19)])
    polyline = f"0\nLWPOLYLINE\n8\n0\n90\n4\n70\n0\n{points}"
    return f"0\nSECTION\n2\nENTITIES\n{polyline}0\nENDSEC\n0\nEOF\n".encode()


PROFILES = {
    "absent.txt": None,
    "folder.txt": DELETE,
    "gear.pdf": b"%PDF",
    "no_ending": b"0 0\n",
    "empty.txt": b"",
    "words.txt": b"this is no profile\n",
    "two_points.txt": b"0 0\n1 1\n",
    "nan.txt": b"0 0\n1 nan\n1 1\n",
    "utf16.txt": square(20.0).encode("utf-16"),
    "binary.txt": bytes(range(256)),
    "square.txt": square(20.0).encode(),
    "bow_tie.txt": b"-20 -20\n20 20\n20 -20\n-20 20\n",
    "truncated.stl": tetrahedron(4, 40),
    "not_watertight.stl": tetrahedron(3, 3),
    "open.dxf": open_dxf(),
    "broken.dxf": b"0\nSECTION\n2\n",
}


@pytest.mark.parametrize("name", PROFILES)
def test_bad_profile_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = PROFILES[name]
    if content is DELETE:
        (tmp_path / name).mkdir()
    elif content is not None:
        (tmp_path / name).write_bytes(content)
    file = tmp_path / "bad.toml"
    tables = tomllib.loads(GEAR_CASE.read_text(encoding="utf-8"))
    file.write_text(document_text(changed(tables, "machine.gears.profile", name)), encoding="utf-8")
    line = complaint(capsys, file, tmp_path / "out.nc")
    assert "machine.gears.profile: " in line
    assert name in line


TABLES = {
    "empty.csv": b"",
    "words.csv": b"hello\nworld\n",
    "header.csv": b"temperature [degC],pressure [bar]\n20,1\n",
    "unit.csv": b"temperature [bar],pressure [bar],density [kg/m3],dynamic_viscosity [Pa s]\n",
    "binary.csv": bytes(range(256)),
    "absent.csv": None,
    "fluid.xlsx": b"PK",
}


@pytest.mark.parametrize("name", TABLES)
def test_bad_fluid_table_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = TABLES[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    file = tmp_path / "bad.toml"
    tables = tomllib.loads(GEAR_CASE.read_text(encoding="utf-8"))
    tables = changed(changed(tables, "fluid.name", DELETE), "fluid.table", name)
    file.write_text(document_text(tables), encoding="utf-8")
    line = complaint(capsys, file, tmp_path / "out.nc")
    assert "fluid.table: " in line
    assert name in line


CONTOURS = ["machine.casing.contour", "machine.relief_grooves.contour"]


@pytest.mark.parametrize("key", CONTOURS)
def test_bad_contour_is_refused(
    key: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "open.dxf").write_bytes(open_dxf())
    file = tmp_path / "bad.toml"
    tables = tomllib.loads(GEAR_CASE.read_text(encoding="utf-8"))
    file.write_text(document_text(changed(tables, key, "open.dxf")), encoding="utf-8")
    assert f"{key}: " in complaint(capsys, file, tmp_path / "out.nc")


def test_undercut_beyond_repair_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = ["tooth_count=6", "profile_shift=-0.9", "tip_diameter=17 mm", "tip_rounding=0 mm"]
    options = [part for change in changes for part in ("--set", f"machine.gears.{change}")]
    line = complaint(capsys, GEAR_CASE, tmp_path / "out.nc", *options)
    assert "machine.gears.profile_shift: found -0.9" in line
    assert "undercut leaves a tooth neck" in line


def test_interfering_teeth_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tables = tomllib.loads(GEAR_CASE.read_text(encoding="utf-8"))
    tables = changed(tables, "machine.gears.normal_backlash", DELETE)
    for distance in ("34 mm", "60 mm"):
        file = tmp_path / "bad.toml"
        changed_tables = changed(tables, "machine.gears.center_distance", distance)
        file.write_text(document_text(changed_tables), encoding="utf-8")
        line = complaint(capsys, file, tmp_path / "out.nc")
        assert "machine.gears.center_distance: found" in line
        assert "no backlash" in line


@pytest.mark.parametrize(
    ("name", "changes", "found"),
    [
        (
            "nose_pressure",
            {f"{B}.nose": DELETE},
            "study.kind: found 'nose_pressure' for a floating part without nose",
        ),
        ("hysteresis_055", {B: {}}, f"{B}: found no high_pressure_area"),
        ("bearing_map", {B: {}}, f"{B}: found no high_pressure_area"),
        ("bearing_map", {"study.outlet_pressure": ["3 bar"]}, "operating_point.outlet_pressure"),
    ],
)
def test_refused_study_leaves_no_folder(
    name: str,
    changes: dict[str, Any],
    found: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    tables = load_case(REPOSITORY / "cases" / f"{name}.toml").to_dict()
    tables["machine"]["casing"].pop("wear_in")
    for path, value in changes.items():
        tables = changed(tables, path, value)
    file = tmp_path / "bad.toml"
    file.write_text(document_text(tables), encoding="utf-8")
    assert main(["study", str(file), "-o", str(tmp_path / "out")]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert found in lines[-1]
    assert not (tmp_path / "out").exists()


def test_steps_of_films_longer_than_a_third_of_a_pitch(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    short = ("--fidelity", "elastic", "--set", "run.film_steps_per_revolution=35")
    assert run_text(GEAR_CASE.read_text(encoding="utf-8"), tmp_path, *short) == 2
    allowed = "found 35, allowed at least 36, 3 for each tooth pitch"
    assert f"run.film_steps_per_revolution: {allowed}" in capsys.readouterr().err


def run_text(text: str, tmp_path: Path, *options: str) -> int:
    """Exit code of a run of a case with this text."""
    file = tmp_path / "bad.toml"
    file.write_text(text, encoding="utf-8")
    return main(["run", str(file), "-o", str(tmp_path / "out.nc"), *options])


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("a." * 499 + "a = 1", "found tables deeper than 20, allowed at most 20"),
        ("a = " + "[" * 400 + "]" * 400, "found tables deeper than 20"),
        ("a = " + "[" * 5000 + "]" * 5000, "syntax: found"),
        ("a = " + "9" * 4301, "syntax: found 'an integer of thousands of digits'"),
        ("a = " + "9" * 4299, "a: found an integer of 14281 bits, allowed at most 64"),
        ("a = 0x" + "f" * 6000, "a: found an integer of 24000 bits"),
        ('title = "a\\u0000b"', "title: found the character NUL, allowed text without it"),
        ('"a\\u0000b" = 1', "found the character NUL"),
    ],
)
def test_values_that_no_case_needs_are_refused(
    text: str, part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_text(text, tmp_path) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert part in line


@pytest.mark.parametrize(
    ("override", "part"),
    [
        ("a." * 499 + "a=1", "allowed key.path=value"),
        ("run.max_steps=" + "9" * 4301, "run.max_steps: found '999"),
        ("run.max_steps=" + "9" * 4000, "--set: found an integer of"),
        ("run.max_steps=" + "[" * 3000 + "]" * 3000, "max_steps: found '[[["),
        ("title=" + "[" * 300 + "]" * 300, "--set[0]"),
        ("title=a\udcffb", "found bytes that are not UTF-8, allowed Unicode text"),
        ("machine.gears.face_width=7.5 m**9**9**9", "unknown unit 'm**9**9**9'"),
        ("machine.gears.face_width=2**2**2**2**2**2 m", "found an unknown unit"),
        ("machine.gears.face_width=1 " + "m" * 100_000, "machine.gears.face_width: found '1 mmm"),
        ("machine.gears.profile=" + "n" * 300 + ".dxf", "cannot be read (File name too long)"),
    ],
)
def test_overrides_that_no_case_needs_are_refused(
    override: str, part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_text(GEAR_CASE.read_text(encoding="utf-8"), tmp_path, "--set", override) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert part in line


@posix
@pytest.mark.parametrize("kind", ["pipe", "zero", "long"])
def test_a_case_that_is_no_file(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    os.mkfifo(tmp_path / "pipe")
    place = {"pipe": str(tmp_path / "pipe"), "zero": "/dev/zero", "long": "n" * 300 + ".toml"}
    assert main(["run", place[kind], "-o", str(tmp_path / "out.nc")]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert "case file: found" in line


def test_rotors_that_their_clearance_consumes_are_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    case = str(GEROTOR_CASE.with_name("contact_span.toml"))
    assert main(["geometry", case, "--set", "machine.rotors.eccentricity=0.25 um"]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert "machine.rotors.tip_clearance: found 20 um, of which the half leaves nothing" in line
