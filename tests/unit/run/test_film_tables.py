"""Films reduced to tables, and the machine that reads them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from tests.contact_machine import contact_machine
from toothspace.case import Case, load_case
from toothspace.cli import main
from toothspace.closures.journal_friction import PUBLISHED_CURVE, FrictionCurves
from toothspace.core.errors import CaseError
from toothspace.model.arrays import FILM_FORCE, FILM_X, FILM_Y
from toothspace.model.assembly import System, assemble
from toothspace.model.bodies import journal_torques
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.run.film_tables import with_film_tables
from toothspace.solver.compiled_model import evaluate_state
from toothspace.solver.initial import start_state
from toothspace.studies import reduce

MOTOR = Path(__file__).resolve().parents[3] / "cases" / "egm12_motor.toml"
FEW = (0.002, 0.005, 0.01, 0.03, 0.1, 0.2, 2.0)


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("tables") / "films.nc"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reduce, "SOMMERFELD_NUMBERS", FEW)
        patch.setattr(reduce, "LOAD_LEVELS", (0.3, 1.0))
        assert main(["reduce", str(MOTOR), "-o", str(path), "--film", "journal"]) == 0
    return path


def motor() -> tuple[Case, MachineDescription]:
    from toothspace.api import describe

    case = load_case(MOTOR)
    return case, describe(case)


def load_by_hand(drop: float) -> float:
    """Half the pressure force on a gear whose spaces lose equal parts of the drop. [N].

    Tip circle 40.372 mm, pitch circle 34.567 mm, width 7.63 mm: high pressure from the pitch
    point to 205 degrees, falling linearly to 290 degrees. Where it is even, only the chord counts.
    """
    tip, pitch, width = 20.186e-3, 17.2835e-3, 7.63e-3
    first, last = np.radians([205.0, 290.0])
    chord = tip * np.array([np.cos(first), np.sin(first)]) - (pitch, 0.0)
    angle = np.linspace(first, last, 2001)
    pressure = drop * (last - angle) / (last - first)
    normal = np.array([np.cos(angle), np.sin(angle)])
    force = drop * width * np.array([-chord[1], chord[0]])
    force -= width * tip * np.trapezoid(pressure * normal, angle)
    return 0.5 * float(np.hypot(*force))


def test_curve_goes_through_the_sweep(tables: Path) -> None:
    """Within the error of the five-term fit to a mixed film: 15 % at the load of the case."""
    _, machine = motor()
    machine, _ = with_film_tables(machine, tables)
    found = xr.load_dataset(tables, engine="h5netcdf")
    for journal in machine.journals:
        row = found.sel(journal=journal.body)
        assert journal.friction is not None
        petroff = 2.0 * np.pi**2 * journal.radial_clearance / (0.5 * journal.diameter)
        for k, curve in enumerate(journal.friction.curves):
            level = row.isel(journal_load_level=k)
            ratio = curve(level["journal_sommerfeld_number"].values)
            ratio = ratio / level["journal_friction_coefficient"].values
            assert np.abs(np.log(ratio)).max() < (0.25, 0.15)[k]
            assert curve.line == pytest.approx(petroff, rel=0.05)
        wanted = load_by_hand(199e5)
        assert journal.friction.loads == pytest.approx((0.3 * wanted, wanted), rel=0.04)
        rough = [curve.boundary_level for curve in journal.friction.curves]
        assert rough[0] > 1.02 * rough[1]


SLIPPERY = replace(PUBLISHED_CURVE, boundary=0.02, rise=0.015)
CURVES = FrictionCurves((1.0, 30.0, 1e4), (SLIPPERY, PUBLISHED_CURVE, SLIPPERY))


def curved(curves: FrictionCurves = CURVES) -> System:
    machine = contact_machine()
    journals = tuple(replace(j, friction=curves) for j in machine.journals)
    condition = OperatingCondition(
        shaft_speed=157.0, inlet_pressure=1e5, outlet_pressure=150e5, relative_tolerance=1e-6
    )
    fluid = fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08))
    return assemble(replace(machine, journals=journals), fluid, condition)


@pytest.mark.parametrize(
    ("loads", "curve"),
    [
        ((1e-3, 3e-3), lambda S, load: PUBLISHED_CURVE(S)),  # beyond the last load
        ((1e7, 3e7), lambda S, load: SLIPPERY(S)),  # below the first
        ((1e-3, 1e7), FrictionCurves((1e-3, 1e7), (SLIPPERY, PUBLISHED_CURVE))),
    ],
)
def test_torque_is_friction_times_load_and_radius(
    loads: tuple[float, float], curve: Callable[[float, float], float]
) -> None:
    """By hand from the definitions of S and of the friction coefficient."""
    system = curved(FrictionCurves(loads, (SLIPPERY, PUBLISHED_CURVE)))
    arrays = system.arrays
    state = start_state(system)
    state[arrays.size.position] += 5e-6
    evaluate_state(arrays, state)
    journal = system.description.journals[0]
    body = next(b for b in system.description.bodies if b.name == journal.body)
    force = float(np.hypot(arrays.journal[0, FILM_X], arrays.journal[0, FILM_Y]))
    radius, revolutions = 0.5 * journal.diameter, abs(body.speed_ratio) * 157.0 / (2.0 * np.pi)
    pressure = force / (journal.count * journal.diameter * journal.length)
    number = arrays.fluid.dynamic_viscosity * revolutions / pressure
    number *= (radius / journal.radial_clearance) ** 2
    expected = float(curve(number, force / journal.count)) * force * radius
    assert sum(journal_torques(arrays, state, 0)) == pytest.approx(expected, rel=1e-12)


def test_slopes_of_the_torque_of_a_turning_body() -> None:
    """Central differences by position and velocity of a rotor that turns on its own."""
    system = curved()
    arrays, size = system.arrays, system.arrays.size
    state = start_state(system)
    state[size.position] += 5e-6
    state[size.velocity] += 1e-3
    evaluate_state(arrays, state)
    slopes = arrays.film_slopes.copy()
    rotation = int(arrays.journal[0, 10])
    assert rotation >= 0
    for order, start, step in ((0, size.position, 1e-11), (1, size.velocity, 1e-8)):
        for k in (int(arrays.journal[0, 0]), int(arrays.journal[0, 1])):
            values = []
            for sign in (1.0, -1.0):
                moved = state.copy()
                moved[start + k] += sign * step
                evaluate_state(arrays, moved)
                values.append(arrays.motion[rotation, FILM_FORCE])
            expected = (values[0] - values[1]) / (2.0 * step)
            assert slopes[order, rotation, k] == pytest.approx(expected, rel=1e-3)


def test_run_with_tables(tables: Path) -> None:
    """Full film at S of 0.1 to 0.2: friction between the minimum and Petroff's of S = 0.2."""
    from toothspace import api

    overrides = [f"run.film_tables={tables}", "run.revolutions=1", "heat.model=network"]
    case = load_case(MOTOR, [*overrides, "run.samples_per_revolution=72"])
    solution = api.simulate(case)
    lost = solution.data["torque_loss"].sel(mechanism="journal_viscous").values
    force = solution.data["journal_force"]
    machine, _ = with_film_tables(motor()[1], tables)
    radius = 0.5 * machine.journals[0].diameter
    load = sum(np.hypot(force[..., k, 0], force[..., k, 1]) for k in range(2)).values
    friction = lost / (load * radius)
    assert np.median(friction) == pytest.approx(0.0025, rel=0.1)
    assert friction.max() < 6e-3


def test_wrong_files_are_refused(tables: Path, tmp_path: Path) -> None:
    _, machine = motor()
    other = tuple(replace(j, radial_clearance=8e-6) for j in machine.journals)
    with pytest.raises(CaseError, match="found a bearing with radial_clearance 9e-06 m"):
        with_film_tables(replace(machine, journals=other), tables)
    bare = tmp_path / "bare.nc"
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(bare, engine="h5netcdf")
    with pytest.raises(CaseError, match="no films"):
        with_film_tables(machine, bare)
    bare.write_bytes(b"text")
    with pytest.raises(CaseError, match="allowed a NetCDF file of 'toothspace reduce'"):
        with_film_tables(machine, bare)


def test_tables_go_with_the_lumped_preset_only(tables: Path) -> None:
    with pytest.raises(CaseError, match=r"run\.film_tables: found tables with 'ideal'"):
        load_case(MOTOR, [f"run.film_tables={tables}", "run.fidelity=ideal"])


def test_unknown_film_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "films.nc"
    assert main(["reduce", str(MOTOR), "-o", str(path), "--film", "cheese"]) == 2
    assert "--film: found 'cheese', allowed journal" in capsys.readouterr().err


def test_conditions_of_lateral_films_are_above_zero(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    told = ["reduce", str(MOTOR), "-o", str(tmp_path / "films.nc"), "--pressure", "0 bar"]
    assert main(told) == 2
    assert "--pressure: found '0 bar', allowed above zero" in capsys.readouterr().err
    assert main([*told[:-2], "--speed", "3 bar"]) == 2
    assert "--speed: " in capsys.readouterr().err


def test_lateral_films_need_an_operating_point(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "start.toml"
    case.write_text(
        f"""base = "{MOTOR.parent / "startup_fan_drive.toml"}"
[machine.floating_bearing]
material = "AlSi"
length = "19 mm"
high_pressure_area = {{area = "1350 mm^2", center = ["-8.16 mm", "17.34 mm"]}}
motion = "axial"
"""
    )
    told = ["reduce", str(case), "--film", "lateral", "-o", str(tmp_path / "a.nc")]
    assert main(told) == 2
    assert "allowed with an [operating_point]" in capsys.readouterr().err
