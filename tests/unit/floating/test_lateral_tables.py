"""Tables of lateral films: the axial load, what is solved, and the machine that reads them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from toothspace import api
from toothspace.case import Case, load_case
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.core.types import Array
from toothspace.floating.reduction import (
    COLUMNS,
    LateralReduction,
    LoadedCondition,
    load_shares,
)
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_load import axial_load, chamber_pressures
from toothspace.model.operating_point import OperatingCondition
from toothspace.run.condition import condition_of
from toothspace.run.film_tables import lateral_sizes, with_film_tables
from toothspace.run.run import Run
from toothspace.studies import reduce

CASE = Path(__file__).resolve().parents[3] / "cases" / "egm12_motor_reduced.toml"
AXES = [-0.3, -0.1, 0.0, 0.1], [0.0], [5e6, 20e6], [50.0, 100.0, 150.0]


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


def _file(machine: MachineDescription, path: Path, **changed: float) -> Path:
    over = (
        "lateral_force_share",
        "lateral_moment_share",
        "lateral_pressure_difference",
        "lateral_shaft_speed",
    )
    shape = tuple(map(len, AXES))
    values: dict[str, Any] = {f"lateral_{k}": v for k, v in lateral_sizes(machine).items()}
    values |= {"lateral_viscosity": 0.02} | changed
    # stored in another order, as a file may be
    columns = {
        "torque": 1.4,
        "pressure_torque": -0.4,
        "asperity_torque": 0.2,
        "leakage_factor": 3.0,
        "lag": 0.01,
        "converged": True,
    }
    values |= {
        f"lateral_{name}": (over[::-1], np.full(shape[::-1], value))
        for name, value in columns.items()
    }
    # twice the pressure gives twice the torque of share one
    values["lateral_torque_unit"] = (over[2:], np.outer([100.0, 200.0], np.ones(3)))
    values["lateral_closed_torque"] = (over[2:], np.outer(np.ones(2), [0.5, 1.0, 1.5]))
    data = xr.Dataset(values, dict(zip(over, AXES, strict=True)), {"film_kinds": "lateral"})
    data.to_netcdf(path, engine="h5netcdf")
    return path


def test_file_is_read(motor: tuple[Case, MachineDescription], tmp_path: Path) -> None:
    table = with_film_tables(motor[1], _file(motor[1], tmp_path / "a.nc"))[0].lateral_table
    assert table is not None
    assert [axis.size for axis in table.axes] == [4, 1, 2, 3]
    assert table.slide == pytest.approx([1.0, 2.0, 3.0])
    # 1.8 N m by viscosity over closed forms, -0.6 N m by pressure and 0.2 N m by asperities
    assert table.shear_share[0, 0, 1] == pytest.approx([3.6, 1.8, 1.2])
    assert table.drag_share[0, 0, :, 0] == pytest.approx([-6e-3, -3e-3])
    assert table.asperity_share[3, 0, :, 2] == pytest.approx([2e-3, 1e-3])
    assert table.lag_number[0, 0, :, 0] == pytest.approx([2.5e6, 1e7])
    assert table.packed().shape == (4, 1, 2, 3, 5)


@pytest.mark.slow
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
    lost = xr.load_dataset(good, engine="h5netcdf")
    lost["lateral_converged"][0, 0, 0, 0] = False
    lost.to_netcdf(tmp_path / "e.nc", engine="h5netcdf")
    with pytest.raises(CaseError, match="loads without an equilibrium"):
        with_film_tables(machine, tmp_path / "e.nc")
    with pytest.raises(CaseError, match="floating part in balance"):
        with_film_tables(replace(machine, floating=None), good)


class _Solved:
    """Stands for solved films: torque and leakage tell the condition that they were asked at."""

    def __init__(self) -> None:
        self.shares: list[Any] = []

    def __call__(
        self,
        condition: OperatingCondition,
        description: MachineDescription,
        fluid: FluidLaw,
        shares: tuple[Array, Array],
        progress: Progress | None,
    ) -> LateralReduction:
        self.shares.append(shares)
        rise = condition.inlet_pressure - condition.outlet_pressure
        force, point = shares[0], cast(Any, None)
        told = rise + condition.shaft_speed + force[:, None]
        # the lower pressure lifts the bearing at the last two forces, the higher at the last
        lifted = force[:, None] > (0.15 if rise > 1e7 else 0.05)
        return LateralReduction(
            LoadedCondition(point, (-0.1 * rise, 0.0), rise, 0.02),
            condition.shaft_speed,
            dict.fromkeys(COLUMNS, told)
            | {"converged": np.ones(told.shape, dtype=bool), "lifted": lifted},
        )


def test_reduction_goes_over_pressures_and_speeds(
    motor: tuple[Case, MachineDescription], monkeypatch: pytest.MonkeyPatch
) -> None:
    solved = _Solved()

    seen: list[OperatingCondition] = []

    def agreed(_: object, __: object, run: Callable[..., OperatingCondition], *___: object) -> Any:
        seen.append(run(motor[1]))
        return seen[-1]

    def spanned(conditions: list[OperatingCondition]) -> tuple[Array, Array]:
        assert conditions == seen
        return np.array([-0.2, -0.1, 0.0, 0.1, 0.2]), np.zeros(1)

    monkeypatch.setattr(reduce, "loaded_condition", agreed)
    monkeypatch.setattr(reduce, "load_shares", spanned)
    monkeypatch.setattr(reduce, "reduce_lateral", solved)
    monkeypatch.setattr(Run, "worn", lambda run, _: replace(run, machine=motor[1]))
    monkeypatch.setattr(reduce, "Marches", lambda run: lambda _: run.condition)
    prepared = api.prepare(motor[0])
    tables = reduce.reduce_lateral_films(prepared, None, ([2e7, 5e6], [150.0, 10.0]))
    at = {"lateral_pressure_difference": 5e6, "lateral_shaft_speed": 150.0}
    one = tables.sel(at)
    force = tables["lateral_force_share"].values
    # what lifts the bearing everywhere is left out, what lifts it somewhere is kept
    assert force == pytest.approx([-0.2, -0.1, 0.0, 0.1])
    assert one["lateral_torque"].values[:, 0] == pytest.approx(5e6 + 150.0 + force, rel=1e-12)
    assert float(one["lateral_force_unit"]) == pytest.approx(5e6)
    assert float(one["lateral_closed_torque"]) == 150.0
    # all are solved at the same loads, which come from all conditions
    assert len(seen) == 4
    assert all(shares is solved.shares[0] for shares in solved.shares[1:])
    seen.clear()
    alone = reduce.reduce_lateral_films(prepared)
    assert alone["lateral_torque"].shape == (4, 1, 1, 1)
    assert alone["lateral_pressure_difference"].values == pytest.approx(199e5)


def test_loads_of_a_table_span_those_of_all_conditions(
    motor: tuple[Case, MachineDescription],
) -> None:
    point: Any = SimpleNamespace(description=motor[1])
    conditions = [
        LoadedCondition(point, (share * unit, 0.0), unit, 0.02)
        for share, unit in ((-0.13, 2e4), (-0.09, 2e3), (-0.115, 1e4))
    ]
    force, moment = load_shares(conditions)
    assert moment.size == 1
    assert np.all(np.diff(force) > 0.0)
    assert force[0] < -0.13 - 0.2
    assert force[-1] == pytest.approx(-0.09 + 0.02)
    inside = force[(force > -0.1301) & (force < -0.0899)]
    assert inside[0] == pytest.approx(-0.13)
    assert inside[-1] == pytest.approx(-0.09)
    assert np.diff(inside).max() < 0.0101
    alone, _ = load_shares(conditions[:1])
    assert -0.13 in alone
    assert alone.size == 14
