"""Keys of ``[bearing]`` and ``[film]`` tables: each does what the solver's parameter does."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from toothspace.api import solve_bearing, solve_film
from toothspace.case import Case, JournalBearingCase
from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.films import (
    Groove,
    JournalBearing,
    Lobes,
    RoughSurfaces,
    critical_mass,
)

CASES = Path(__file__).resolve().parents[3] / "cases"
BEARING = """
schema = 1
[bearing]
diameter = "50 mm"
length = "25 mm"
radial_clearance = "30 um"
shaft_speed = "3000 rpm"
{fluid}
grid = [48, 9]
{rest}
"""
VISCOSITY = 'dynamic_viscosity = "0.02 Pa s"'
RING = """
schema = 1
[film]
kind = "ring"
inner_radius = "10 mm"
outer_radius = "30 mm"
side_gap = "10 um"
shaft_speed = "1500 rpm"
dynamic_viscosity = "0.03 Pa s"
inner_pressure = "1 bar"
outer_pressure = "51 bar"
grid = [32, 32]
"""


def bearing(rest: str, fluid: str = VISCOSITY) -> dict[str, Any]:
    return solve_bearing(Case.from_toml(BEARING.format(rest=rest, fluid=fluid)))


def test_journal_is_a_kind_of_film() -> None:
    text = BEARING.format(rest="eccentricity = [0.4, 0.1]", fluid=VISCOSITY)
    film = solve_film(Case.from_toml(text.replace("[bearing]", '[film]\nkind = "journal"')))
    same = bearing("eccentricity = [0.4, 0.1]")
    assert film["force_x_N"] == same["force_x_N"]


def test_numbers_of_a_tilted_bearing() -> None:
    """Coefficients with the tilts contain those without; the stable mass follows from them."""
    level = bearing("eccentricity = [0.4, 0.1]")
    film = bearing('eccentricity = [0.4, 0.1]\ntilt = ["0.0001 rad", "0 rad"]')
    assert "stiffness_4x4" not in level
    stiffness, damping = np.array(film["stiffness_4x4"]), np.array(film["damping_4x4"])
    assert stiffness.shape == damping.shape == (4, 4)
    assert stiffness[:2, :2] == pytest.approx(np.array(film["stiffness_N_per_m"]), rel=1e-9)
    assert damping[:2, :2] == pytest.approx(np.array(film["damping_N_s_per_m"]), rel=1e-9)
    mass, whirl = critical_mass(stiffness[:2, :2], damping[:2, :2])
    assert film["critical_mass_kg"] == pytest.approx(mass, rel=1e-9)
    assert film["whirl_frequency_ratio"] == pytest.approx(whirl / (100.0 * np.pi), rel=1e-9)
    assert sum(film["end_flow_L_per_min"]) == pytest.approx(film["side_flow_L_per_min"])


def test_walls_that_turn_against_each_other_carry_nothing() -> None:
    film = bearing('eccentricity = [0.4, 0.1]\nbush_speed = "-3000 rpm"')
    assert math.hypot(film["force_x_N"], film["force_y_N"]) < 1e-6
    assert film["friction_torque_N_m"] < 0.0 < film["bush_friction_torque_N_m"]


def test_moment_tilts_the_shaft() -> None:
    film = bearing('load = ["2000 N", "0 N"]\nmoment = ["3 N m", "-2 N m"]')
    assert film["status"] == "done"
    assert film["moment_x_N_m"] == pytest.approx(-3.0, rel=1e-6)
    assert film["moment_y_N_m"] == pytest.approx(2.0, rel=1e-6)
    with pytest.raises(CaseError, match=r"bearing\.moment"):
        bearing('eccentricity = [0.4, 0.1]\nmoment = ["3 N m", "0 N m"]')


def test_lobes_ends_and_groove_position() -> None:
    """Each changes the film in the expected sense: more film pressure, no flow, one end first."""
    at = "eccentricity = [0.1, 0.0]"
    plain = bearing(at)
    lobed = bearing(f"{at}\n[bearing.lobes]\ncount = 3\npreload = 0.6")
    closed = bearing(f'{at}\nend_condition = "no_flow"')
    assert lobed["max_pressure_bar"] > 2.0 * plain["max_pressure_bar"]
    assert closed["side_flow_L_per_min"] == 0.0
    groove = '[[bearing.grooves]]\nangle = "90 deg"\nwidth = "30 deg"\nlength = "5 mm"\n'
    aside = bearing(f'{at}\n{groove}pressure = "9 bar"\nposition = "7 mm"')
    middle = bearing(f'{at}\n{groove}pressure = "9 bar"')
    assert abs(aside["moment_x_N_m"]) > 0.1
    assert abs(middle["moment_x_N_m"]) < 1e-9


def test_table_of_asperity_contact() -> None:
    points = ((0.0, 500e6), (1.0, 100e6), (2.0, 10e6), (3.0, 1e6))
    walls = RoughSurfaces(
        moving_roughness=1e-6, resting_roughness=0.0, contact_law="table", contact_points=points
    )
    rough = JournalBearing(
        diameter=0.05,
        length=0.025,
        radial_clearance=30e-6,
        dynamic_viscosity=0.02,
        grid=(360, 4),
        surfaces=walls,
    )
    film = rough.solve(eccentricity=(29.0 / 30.0, 0.0), shaft_speed=10.0)
    closest = int(np.argmin(film.gap_height[:, 0]))
    assert film.contact_pressure[closest] == pytest.approx(np.full(4, 100e6), rel=0.02)
    assert film.contact_pressure[closest - 120].max() == 0.0
    with pytest.raises(CaseError, match="falling pressure"):
        RoughSurfaces(
            moving_roughness=1e-6,
            resting_roughness=0.0,
            contact_law="table",
            contact_points=((0.0, 1e6), (1.0, 2e6)),
        )
    text = '[bearing.surfaces]\nmoving_roughness = "1 um"\nresting_roughness = "0 um"\n'
    text += 'contact_law = "table"\ncontact_points = [[0, "500 MPa"], [3, "1 MPa"]]'
    assert bearing(f"eccentricity = [0.97, 0.0]\n{text}")["status"] == "done"


def test_viscosity_that_follows_the_pressure() -> None:
    """Barus: p = -ln(1 - a q)/a with the pressure q of constant viscosity; full film."""
    alpha, high = 20e-9, 400e5
    plain = JournalBearing(
        diameter=0.05,
        length=0.025,
        radial_clearance=20e-6,
        dynamic_viscosity=0.02,
        grid=(96, 17),
        end_pressure=-math.expm1(-alpha * high) / alpha,
        cavitation_pressure=0.0,
    )
    thick = JournalBearing(
        diameter=0.05,
        length=0.025,
        radial_clearance=20e-6,
        dynamic_viscosity=0.02,
        grid=(96, 17),
        end_pressure=high,
        cavitation_pressure=0.0,
        pressure_viscosity=alpha,
    )
    state: dict[str, Any] = {"eccentricity": (0.5, 0.0), "shaft_speed": 314.0}
    reduced, film = plain.solve(**state).pressure, thick.solve(**state).pressure
    assert reduced.min() > 0.0
    expected = -np.log1p(-alpha * reduced) / alpha
    span = float(expected.max() - high)
    assert film == pytest.approx(expected, abs=0.01 * span)
    assert film.max() - high > 1.5 * (reduced.max() - plain.end_pressure)


def test_heat_that_the_oil_carries_away() -> None:
    groove = '[[bearing.grooves]]\nangle = "90 deg"\nwidth = "20 deg"\nlength = "20 mm"\n'
    rest = f'load = ["2000 N", "0 N"]\n{groove}pressure = "3 bar"\n'
    oil = '[fluid]\nname = "iso_vg_46"\ntemperature = "50 degC"\n'
    film = bearing(f"{rest}[bearing.heat]\n{oil}", fluid="")
    cold = bearing(f"{rest}{oil}", fluid="")
    rise = film["outlet_temperature_degC"] - 50.0
    flow = film["side_flow_L_per_min"] / 6e4
    assert film["mean_temperature_degC"] == pytest.approx(50.0 + 0.5 * rise)
    assert film["power_loss_W"] / (rise * flow) == pytest.approx(1.7e6, rel=0.1)
    assert film["power_loss_W"] < cold["power_loss_W"]
    still = bearing(f"{rest}[bearing.heat]\noil_share = 0\n{oil}", fluid="")
    assert still["power_loss_W"] == pytest.approx(cold["power_loss_W"])
    with pytest.raises(CaseError, match=r"bearing\.heat: found no fluid"):
        bearing(f"{rest}[bearing.heat]\n")


@pytest.mark.parametrize("kind", ["pad", "ring", "lateral"])
def test_every_film_has_a_heat_balance(kind: str) -> None:
    oil = '[fluid]\nname = "iso_vg_46"\ntemperature = "50 degC"\n'
    heat = "[film.heat]\n"
    if kind == "ring":
        text = RING.replace('dynamic_viscosity = "0.03 Pa s"\n', "")
    else:
        name = "slider_pad" if kind == "pad" else "egm12_lateral_film"
        lines = (CASES / f"{name}.toml").read_text().splitlines()
        kept = [s for s in lines if not s.startswith(("dynamic_viscosity", "grid ="))]
        text = "\n".join(kept).replace("[film]\n", "[film]\ngrid = [64, 24]\n")
    cold, warm = (solve_film(Case.from_toml(f"{text}\n{part}{oil}")) for part in ("", heat))
    assert "mean_temperature_degC" not in cold
    rise = warm["outlet_temperature_degC"] - 50.0
    carried = rise * warm["outflow_L_per_min"] / 6e4
    assert warm["dissipated_power_W"] / carried == pytest.approx(1.7e6, rel=0.1)


@pytest.mark.parametrize("memory", ["false", "true"])
def test_orbit_comes_to_rest(memory: str) -> None:
    """A light shaft let go beside its place ends there, with and without memory of the film."""
    rest = 'load = ["2000 N", "0 N"]\nvelocity = ["0.01 m/s", "0 m/s"]\n[bearing.orbit]\n'
    rest += f'mass = "2 kg"\nduration = "0.02 s"\ntime_step = "0.0005 s"\nfilm_memory = {memory}'
    film = bearing(rest)
    assert film["status"] == "done"
    assert len(film["time_s"]) == 41
    place = np.array([film["eccentricity_x"], film["eccentricity_y"]]) * 30.0
    last = [film["orbit_x_um"][-1], film["orbit_y_um"][-1]]
    assert last == pytest.approx(place, abs=0.3)
    assert film["orbit_max_eccentricity_ratio"] > film["eccentricity_ratio"]


@pytest.mark.slow
def test_heavy_unbalance_in_an_elliptical_bore() -> None:
    """The bore is narrow in one direction: steps stay within it, not within the round one."""
    rest = 'load = ["1000 N", "0 N"]\nlobes = {count = 2, preload = 0.5}\n[bearing.orbit]\n'
    rest += 'mass = "5 kg"\nduration = "0.02 s"\ntime_step = "0.0005 s"\nunbalance = "0.03 kg m"'
    film = bearing(rest)
    assert film["status"] == "done"
    assert 0.5 < film["orbit_max_eccentricity_ratio"] < 1.0


def test_ring_has_the_closed_form() -> None:
    film = solve_film(Case.from_toml(RING))
    flow = math.pi * 10e-6**3 * 50e5 / (6.0 * 0.03 * math.log(3.0))
    torque = 0.5 * math.pi * 0.03 * 50.0 * math.pi * (0.03**4 - 0.01**4) / 10e-6
    assert film["inner_flow_L_per_min"] == pytest.approx(6e4 * flow, rel=1e-9)
    assert film["friction_torque_N_m"] == pytest.approx(-torque, rel=2e-3)
    with pytest.raises(CaseError, match=r"film\.inner_radius: found 30 mm"):
        solve_film(Case.from_toml(RING.replace("10 mm", "30 mm")))


def test_endless_pad_in_squeeze() -> None:
    """Load of parallel plates per width: mu V L^3 / h^3."""
    film = solve_film(
        Case.from_toml(
            'schema = 1\n[film]\nkind = "pad"\nlength = "20 mm"\nwidth = "10 mm"\nspeed = "0 m/s"\n'
            'inlet_height = "10 um"\noutlet_height = "10 um"\ndynamic_viscosity = "0.01 Pa s"\n'
            'side_condition = "no_flow"\nsqueeze_velocity = "-1e-4 m/s"\ngrid = [64, 8]\n'
        )
    )
    assert film["load_N"] == pytest.approx(0.01 * 1e-4 * 0.02**3 / 10e-6**3 * 0.01, rel=1e-3)


def test_fields_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "bearing.toml"
    case.write_text(BEARING.format(rest="eccentricity = [0.4, 0.1]", fluid=VISCOSITY))
    for name in ("film.nc", "film.vts"):
        assert main(["bearing", str(case), "-o", str(tmp_path / name), "--json"]) == 0
    fields = xr.load_dataset(tmp_path / "film.nc", engine="h5netcdf")
    assert fields["pressure"].shape == (48, 9)
    assert (tmp_path / "film.vts").read_text().startswith("<?xml")
    assert main(["bearing", str(case), "-o", str(tmp_path / "film.csv")]) == 2
    assert "-o: found the ending '.csv', allowed .nc, .vts" in capsys.readouterr().err


def test_bounds_hold_where_a_case_takes_an_object() -> None:
    """A solver makes itself a groove without width; a case refuses it however it comes."""
    line = Groove(0.0, 0.0, 0.02, 1e5)
    assert line.width == 0.0
    for groove in (line, {"angle": "0 deg", "width": "0 deg", "length": "20 mm", "pressure": 1e5}):
        keys = {"diameter": 0.04, "length": 0.03, "radial_clearance": 3e-5, "shaft_speed": 100.0}
        with pytest.raises(CaseError, match=r"grooves\[0\]\.width: found"):
            JournalBearingCase(**keys, eccentricity=(0.5, 0.0), grooves=(groove,))


def test_an_object_of_a_case_may_hold_texts_with_units() -> None:
    keys = {"diameter": 0.04, "length": 0.03, "radial_clearance": 3e-5, "shaft_speed": 100.0}
    groove = Groove("90 deg", "15 deg", "20 mm", "2 bar")  # type: ignore[arg-type]
    case = JournalBearingCase(**keys, eccentricity=(0.5, 0.0), grooves=(groove,))
    assert case.grooves == (Groove(0.5 * np.pi, np.pi / 12.0, 0.02, 2e5),)


def test_a_bore_of_lobes_is_narrowest_in_their_middles() -> None:
    """Preload times the cosine of the angle from the middle of the lobe, the same for each."""
    lobes = Lobes(count=3, preload=0.5, angle=0.4)
    away = np.array([0.0, np.pi / 6.0, -np.pi / 4.0, np.pi / 3.0 - 1e-9])
    expected = 0.5 * np.cos(away)
    for lobe in (-1, 0, 1, 5):
        found = lobes.narrowing(0.4 + away + lobe * 2.0 * np.pi / 3.0)
        np.testing.assert_allclose(found, expected, atol=1e-8)
    with pytest.raises(CaseError, match="preloads from 0 to below 1"):
        Lobes(count=2, preload=1.0)


def test_a_table_of_contact_of_one_point_is_told_by_its_number() -> None:
    points = ((0.0, 1e8), (1.0, 2e8))
    with pytest.raises(CaseError, match="1 points"):
        RoughSurfaces(
            moving_roughness=1e-7, resting_roughness=0.0,
            contact_law="table", contact_points=points[:1],
        )  # fmt: skip
    with pytest.raises(CaseError, match="out of order"):
        RoughSurfaces(
            moving_roughness=1e-7, resting_roughness=0.0,
            contact_law="table", contact_points=points,
        )  # fmt: skip
