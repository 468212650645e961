"""Gears whose teeth differ: deviations read back from outlines and files of gear testers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.core.errors import CaseError
from toothspace.gearing.numbering import number
from toothspace.gearing.spaces import section_areas
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.geometry.profile_detection import gear_profile_from_curve
from toothspace.geometry.tooth_deviations import read_tooth_deviations
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.own_teeth import OwnTeeth, own_teeth

GEAR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3, tip_rounding=1e-4)
PROFILE = generate_profile(GEAR)
FLANK = PROFILE.involute
PUMP = Path(__file__).parents[3] / "cases" / "egm12_pump.toml"
ROLL = np.linspace(FLANK.roll_length(FLANK.form_radius), FLANK.roll_length(GEAR.tip_radius), 120)


def known(seed: int = 3, size: float = 4e-6) -> tuple[np.ndarray, np.ndarray]:
    """Deviations of both flanks of all teeth, counter-clockwise: offset, slope and crowning."""
    random = np.random.default_rng(seed)
    place = np.linspace(-1.0, 1.0, len(ROLL))
    shapes = np.stack([np.ones_like(place), 0.5 * place, -0.5 * place**2])
    left, right = size * random.uniform(-1.0, 1.0, (2, 12, 3)) @ shapes
    return left, right


def table_file(path: Path, left: np.ndarray, right: np.ndarray) -> Path:
    lines = ["tooth [1],roll_length [mm],left [um],right [um]"]
    for tooth in range(12):
        rows = zip(ROLL * 1e3, left[tooth] * 1e6, right[tooth] * 1e6, strict=True)
        lines += [f"{tooth + 1},{a:.6f},{b:.6f},{c:.6f}" for a, b, c in rows]
    path.write_text("\n".join(lines))
    return path


def curve_file(path: Path, left: np.ndarray, right: np.ndarray) -> Path:
    """Curve file as gear testers of Klingelnberg write it; teeth count clockwise."""
    diameters = [2e3 * float(np.hypot(FLANK.base_radius, ROLL[k])) for k in (0, -1)]
    circle = np.cos(FLANK.pressure_angle(0.25e-3 * sum(diameters)))
    lines = [
        "HEADER KS.MK.FILE",
        "UNDEFINED -2147483.648 ! undefined point",
        "  21 :Zähnezahl z..............: 12",
        f"  41 :Start Messbereich.....da  [mm]..: {diameters[0]:.5f} {diameters[0]:.5f}",
        f"  42 :Ende Messbereich......de  [mm]..: {diameters[1]:.5f} {diameters[1]:.5f}",
        "Flankenlinie:",
        "Zahn-Nr.: 1 links / 12 Werte  x= 8.742",
        " ".join(["9.999"] * 12),
        "Profil:",
    ]
    tables = []
    for name, side, sign in (("links", left, -1.0), ("rechts", right, 1.0)):
        title = "linke Zahnflanke" if name == "links" else "rechte Zahnflanke"
        tables += [title, "Zahn-Nr.  fp  Fp  Fr"]
        for place in range(1, 13):
            curve = side[(1 - place) % 12] * 1e6
            index = sign * curve[60] / circle
            values = [f"{value:.4f}" for value in curve - curve[60]]
            if place == 2:
                values[5] = "-2147483.648"
            lines.append(f"Zahn-Nr.: {place} {name} / {len(values)} Werte  z= 3.8")
            lines += [" ".join(values[k : k + 12]) for k in range(0, len(values), 12)]
            tables.append(f"{place} 0.0 {index:.4f} 0.0")
        tables.append("")
    path.write_text("\n".join([*lines, "", *tables]), encoding="utf-8-sig")
    return path


@pytest.mark.parametrize("write", [table_file, curve_file], ids=["csv", "mka"])
def test_deviations_of_a_tester_are_read_back(tmp_path: Path, write) -> None:
    left, right = known()
    suffix = "csv" if write is table_file else "mka"
    found = read_tooth_deviations(write(tmp_path / f"gear.{suffix}", left, right), FLANK, 12)
    for side, given in ((found.left, left), (found.right, right)):
        wanted = np.array([np.interp(found.roll_length, ROLL, row) for row in given])
        assert np.abs(side - wanted).max() < 2e-8


def test_every_tooth_of_an_outline_is_found() -> None:
    left, right = known()
    pitch = 2.0 * np.pi / 12.0
    teeth = []
    for k in range(12):
        points = generate_profile(GEAR, 400).points[:-1]
        radius, angle = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])
        roll = np.sqrt(np.maximum(radius**2 - FLANK.base_radius**2, 0.0))
        excess = np.where(
            angle > 0.0, np.interp(roll, ROLL, left[k]), -np.interp(roll, ROLL, right[k])
        )
        turned = angle + excess / FLANK.base_radius + k * pitch
        teeth.append(np.column_stack([radius * np.cos(turned), radius * np.sin(turned)]))
    found = gear_profile_from_curve(np.vstack(teeth))
    first = round(float(np.angle(np.exp(1j * found.phase))) / pitch) % 12
    inner = slice(6, -6)
    differences = []
    for side, given in ((found.deviations.left, left), (found.deviations.right, right)):
        rows = np.roll(given, -first, axis=0)
        wanted = np.array([np.interp(found.deviations.roll_length, ROLL, row) for row in rows])
        differences.append((side - wanted)[:, inner].mean(axis=1))
        # the shape of every flank, up to the involute that fits all of them
        shape = (side - wanted)[:, inner]
        shape = shape - shape.mean(axis=1, keepdims=True)
        assert np.abs(shape - np.median(shape, axis=0)).max() < 3e-7
    # the fit takes thickness, turn and eccentricity of the gear for itself: no higher orders
    for difference in differences:
        order = np.abs(np.fft.rfft(difference))[2:] / 6.0
        assert order.max() < 3e-7


def pump(*overrides: str):
    return load_case(PUMP, ["machine.gears.normal_backlash=0.2 mm", *overrides])


def test_even_excess_is_a_thicker_tooth(tmp_path: Path) -> None:
    """All flanks of the drive gear 8 um thicker."""
    excess = np.full((12, len(ROLL)), 8e-6)
    file = table_file(tmp_path / "gear.csv", excess, excess)
    measured = api.describe(pump(f"machine.gears.tooth_deviations={file}"))
    even = api.describe(pump())
    found, plain = (
        next(path for path in one.paths if path.name == "flank_leading") for one in (measured, even)
    )
    gap = plain.geometry.values[:, 0]
    complete = plain.geometry.values[:, 1] > 0.9 * plain.geometry.values[:, 1].max()
    open_ = np.flatnonzero(complete & (gap < gap[complete].min() + 1e-7))
    assert len(open_) > 20
    for own in found.own:
        # the driven gear turns back by the excess, the coast flanks lose it twice
        change = (own.values - plain.geometry.values)[open_, 0]
        assert np.abs(change + 16e-6).max() < 1e-7
    loaded = next(path for path in measured.paths if path.name == "flank_trailing")
    assert min(own.values[open_, 0].min() for own in loaded.own) > -2e-7
    family = measured.families[0]
    lost = family.volume.values[:, 0] - np.array([own.values[:, 0] for own in family.own])
    width = 7.63e-3
    length = np.hypot(*np.diff(PROFILE.left_flank, axis=0).T).sum()
    far = np.arange(lost.shape[1]) < 0.1 * lost.shape[1]
    assert lost[:, far] == pytest.approx(2.0 * 8e-6 * length * width, rel=2e-2)


def test_one_high_flank_turns_the_driven_gear_once(tmp_path: Path) -> None:
    left, right = np.zeros((2, 12, len(ROLL)))
    left[5] = 5e-6
    file = table_file(tmp_path / "gear.csv", left, right)
    keys = [f"machine.gears.tooth_deviations={file}"]
    case = pump(*keys)
    assembly = assemble(case.machine_spec)
    own = own_teeth(assembly, number(assembly.counts), assembly.spaces(720))
    base = FLANK.base_radius
    assert np.ptp(own.turn) * base == pytest.approx(5e-6, rel=1e-2)
    assert 0.05 < np.mean(np.abs(own.turn) > 1e-5) < 0.4


def deviating(folder: Path, gear: str, flank: int, tooth: int | None) -> tuple[Assembly, OwnTeeth]:
    """Teeth of which one, or all, stand out by 5 um at the left (0) or right (1) flank."""
    heights = np.zeros((2, 12, len(ROLL)))
    heights[flank, slice(None) if tooth is None else tooth] = 5e-6
    file = table_file(folder / "gear.csv", *heights)
    assembly = assemble(pump(f"machine.{gear}.tooth_deviations={file}").machine_spec)
    return assembly, own_teeth(assembly, number(assembly.counts), assembly.spaces(720))


def over_shaft(tables: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Tables of the spaces of both gears at the nodes of the shaft angle."""
    rows = []
    for table, phases in zip(tables, number((12, 12)).space_phases, strict=True):
        shifts = np.rint(phases * 720 / (2.0 * np.pi)).astype(int)
        rows += [np.roll(row, -shift) for row, shift in zip(table, shifts, strict=True)]
    return np.array(rows)


@pytest.mark.parametrize("gear", ["gears", "driven_gear"])
def test_a_flank_that_bears_no_load_takes_its_section_from_the_spaces(
    gear: str, tmp_path: Path
) -> None:
    """Wherever the tooth stands, its own space and the mate's lose 5 um along the flank."""
    section = 5e-6 * np.hypot(*np.diff(PROFILE.left_flank, axis=0).T).sum()
    borders = []
    for tooth in (0, 5):
        flank = 1 if assemble(pump().machine_spec).loaded_is_left else 0
        _, own = deviating(tmp_path, gear, flank, tooth)
        assert np.abs(own.turn).max() < 1e-6
        lost = -over_shaft(own.areas)
        assert lost.sum(axis=0) == pytest.approx(section, rel=2e-2)
        own_space = int(lost.mean(axis=1).argmax())
        assert lost[own_space].max() == pytest.approx(section, rel=2e-2)
        borders.append(own_space)
    # five teeth on, five spaces on: against the rotation of the drive gear, with that of the mate
    first, second = borders
    assert (second - first) % 12 == (7 if gear == "gears" else 5)


def test_flanks_that_bear_load_turn_the_driven_gear_whichever_has_them(tmp_path: Path) -> None:
    """Back by their height over the base radius; volumes are those of the turned mesh less it."""
    loaded = 0 if assemble(pump().machine_spec).loaded_is_left else 1
    section = 12.0 * 5e-6 * np.hypot(*np.diff(PROFILE.left_flank, axis=0).T).sum()
    turns = []
    for gear in ("gears", "driven_gear"):
        assembly, own = deviating(tmp_path, gear, loaded, None)
        assert np.abs(own.turn) * FLANK.base_radius == pytest.approx(5e-6, rel=1e-2)
        turns.append(own.turn)
        mesh = assembly.mesh
        turned = replace(assembly, mesh=mesh._replace(turn=mesh.turn + own.turn.mean()))
        change = tuple(
            np.tile(section_areas(after) - section_areas(before), (12, 1))
            for before, after in zip(assembly.spaces(720), turned.spaces(720), strict=True)
        )
        lost = over_shaft(change).sum(axis=0) - over_shaft(own.areas).sum(axis=0)
        assert lost == pytest.approx(section, rel=3e-2)
    assert turns[0] == pytest.approx(turns[1], rel=2e-2)


def eccentric(folder: Path, radius: float) -> Path:
    """Drive gear whose teeth stand off the axis: each flank moves by a sine of its place."""
    angle = 2.0 * np.pi * np.arange(12) / 12.0
    turn = np.arccos(FLANK.base_radius / 17.28e-3)
    left = np.repeat((radius * np.sin(angle + turn))[:, None], len(ROLL), axis=1)
    right = np.repeat((-radius * np.sin(angle - turn))[:, None], len(ROLL), axis=1)
    return table_file(folder / f"gear_{radius * 1e6:.0f}.csv", left, right)


@pytest.mark.slow
def test_run_out_ripples_the_flow_once_a_revolution(tmp_path: Path) -> None:
    """Order one follows the run-out, about as the driven gear's speed: e/(2 rb) of the flow."""
    orders = []
    for radius in (0.0, 10e-6, 20e-6):
        file = eccentric(tmp_path, radius)
        solution = api.simulate(pump(f"machine.gears.tooth_deviations={file}"))
        flow = np.asarray(solution.data["outlet_flow_rate"])[:-1]
        orders.append(2.0 * np.abs(np.fft.rfft(flow))[1] / len(flow) / flow.mean())
    even, small, large = orders
    assert even < 1e-5
    # leakage through gaps that change with the run-out is not quite linear
    assert large == pytest.approx(2.0 * small, rel=0.1)
    wanted = 20e-6 / (2.0 * FLANK.base_radius)
    assert 0.5 * wanted < large < 1.5 * wanted


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "tooth [1],roll_length [mm],left [um],right [um]\n1,5,0,0\n",
            "found teeth 1, allowed each",
        ),
        ("tooth [1],roll_length [mm]\n1,5\n", "left"),
    ],
)
def test_incomplete_files_are_refused_in_one_line(tmp_path: Path, text: str, told: str) -> None:
    file = tmp_path / "gear.csv"
    file.write_text(text)
    with pytest.raises(CaseError, match=told) as caught:
        pump(f"machine.gears.tooth_deviations={file}").check()
    assert "\n" not in str(caught.value)
