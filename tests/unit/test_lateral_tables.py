"""Tables of lateral films over axial loads: load, lookup, and the machine that reads them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace import api
from toothspace.case import Case, load_case
from toothspace.core.errors import CaseError
from toothspace.model.description import MachineDescription
from toothspace.model.films import lateral_torque_coefficient
from toothspace.model.lateral_load import axial_load, chamber_pressures, with_lateral_table
from toothspace.model.lateral_table import LateralTable
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.simulation.film_tables import lateral_sizes, with_film_tables
from toothspace.simulation.setup import condition_of

CASE = Path(__file__).resolve().parents[2] / "cases" / "egm12_motor_reduced.toml"
FORCES, MOMENTS = np.array([-8000.0, -2000.0, 1000.0]), np.array([-20.0, 0.0, 20.0])


@pytest.fixture(scope="module")
def motor() -> tuple[Case, MachineDescription]:
    case = load_case(CASE)
    return case, api.describe(case)


def test_equal_pressure_everywhere_leaves_the_preload(
    motor: tuple[Case, MachineDescription],
) -> None:
    balance = motor[1].lateral_balance
    assert balance is not None
    force, moment = axial_load(balance, lambda _: np.full(motor[1].chamber_count + 3, 7e5))
    bearing = balance.floating
    assert force == pytest.approx(-bearing.preload.size, abs=1e-6)
    arm = bearing.preload.place[1] - bearing.face.center[1]
    assert moment == pytest.approx(-bearing.preload.size * arm, abs=1e-6)


def test_load_grows_with_the_pressure_difference(motor: tuple[Case, MachineDescription]) -> None:
    case, machine = motor
    balance = machine.lateral_balance
    assert balance is not None
    condition = condition_of(case, machine)
    half = replace(condition, inlet_pressure=0.5 * (condition.inlet_pressure + 1e5))
    loads = [
        axial_load(balance, chamber_pressures(machine, c))[0] + balance.floating.preload.size
        for c in (condition, half)
    ]
    assert loads[0] == pytest.approx(2.0 * loads[1], rel=1e-6)


def _table() -> LateralTable:
    """Drag that falls and leakage that rises with the force, from 1 at -8000 N to 16 at 1000 N."""
    drag = -0.25e-3 * FORCES[:, None] + 0.0 * MOMENTS
    leakage = np.array([1.0, 4.0, 16.0])[:, None] * np.ones(MOMENTS.size)
    return LateralTable(
        force=FORCES,
        moment=MOMENTS,
        extra_share=drag,
        pressure_share=np.full_like(drag, -0.5),
        leakage_factor=leakage,
        condition_load=(-7000.0, 0.0),
        condition_slide=4.0,
    )


def test_lookup_between_nodes_ends_at_the_edges() -> None:
    table = _table()
    # half way between two nodes the leakage is the geometric mean of both
    assert table(-5000.0, 3.0) == pytest.approx((1.25, 2.0))
    assert table(1500.0, 0.0) == pytest.approx((-0.25, 16.0))
    # at twice the speed the closed form has grown, the part of the pressure has not
    assert table(-5000.0, 3.0, slide=8.0) == pytest.approx((1.5, 2.0))
    assert table.force_of(2.0, 3.0) == pytest.approx(-5000.0)
    table.check(1500.0, 0.0)
    with pytest.raises(CaseError, match="F_z = 9000 N"):
        table.check(9000.0, 0.0)


def test_machine_takes_drag_and_leakage(motor: tuple[Case, MachineDescription]) -> None:
    case, machine = motor
    condition = condition_of(case, machine)
    plain = lateral_torque_coefficient(machine)
    wide = (np.array([-1e6, 1e6]), np.array([-1e5, 1e5]))
    table = replace(
        _table(),
        force=wide[0],
        moment=wide[1],
        extra_share=np.full((2, 2), 0.5),
        pressure_share=np.zeros((2, 2)),
        leakage_factor=np.full((2, 2), 8.0),
    )
    changed = with_lateral_table(replace(machine, lateral_table=table), condition)
    assert lateral_torque_coefficient(changed) == pytest.approx(1.5 * plain)
    for before, after in zip(machine.paths, changed.paths, strict=True):
        share = 2.0 if before.category in LATERAL_PATHS else 1.0
        assert after.geometry.values[:, 0] == pytest.approx(share * before.geometry.values[:, 0])
    assert with_lateral_table(machine, condition) is machine


def _file(machine: MachineDescription, path: Path, **changed: float) -> Path:
    values = {f"lateral_{k}": v for k, v in lateral_sizes(machine).items()}
    values |= {"lateral_closed_torque": 0.8, "lateral_condition_force": -3000.0}
    values |= {"lateral_condition_moment": 1.0, "lateral_viscosity": 0.02}
    values |= {"lateral_shaft_speed": 150.0} | changed
    over = ("lateral_force", "lateral_moment")
    shape = (FORCES.size, MOMENTS.size)
    data = xr.Dataset(
        {
            **values,
            "lateral_extra_torque": (over, np.full(shape, 0.2)),
            "lateral_pressure_torque": (over, np.full(shape, -0.4)),
            "lateral_leakage_factor": (over, np.ones(shape)),
            "lateral_converged": (over, np.ones(shape, dtype=bool)),
        },
        {"lateral_force": FORCES, "lateral_moment": MOMENTS},
        {"film_kinds": "lateral"},
    )
    data.to_netcdf(path, engine="h5netcdf")
    return path


def test_file_is_read(motor: tuple[Case, MachineDescription], tmp_path: Path) -> None:
    machine, _ = with_film_tables(motor[1], _file(motor[1], tmp_path / "a.nc"))
    assert machine.lateral_table is not None
    assert machine.lateral_table.extra_share == pytest.approx(0.25)
    assert machine.lateral_table.pressure_share == pytest.approx(-0.5)
    assert machine.lateral_table.condition_load == (-3000.0, 1.0)
    assert machine.lateral_table.condition_slide == pytest.approx(3.0)


def test_files_of_other_machines_are_refused(
    motor: tuple[Case, MachineDescription], tmp_path: Path
) -> None:
    machine = motor[1]
    other = _file(machine, tmp_path / "b.nc", lateral_height=5e-6)
    with pytest.raises(CaseError, match="lateral films with height"):
        with_film_tables(machine, other)
    good = _file(machine, tmp_path / "c.nc")
    old = xr.load_dataset(good, engine="h5netcdf").drop_vars("lateral_pressure_torque")
    old.to_netcdf(tmp_path / "d.nc", engine="h5netcdf")
    with pytest.raises(CaseError, match="without lateral_pressure_torque, allowed a file"):
        with_film_tables(machine, tmp_path / "d.nc")
    with pytest.raises(CaseError, match="floating part in balance"):
        with_film_tables(replace(machine, lateral_balance=None), good)
