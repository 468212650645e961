"""Lumped runs with lateral tables: films and run have to agree about the load on the bearing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace import api
from toothspace.case import load_case
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.model.description import MachineDescription
from toothspace.model.films import lateral_torque_coefficient
from toothspace.model.lateral_load import axial_load, chamber_pressures
from toothspace.model.lateral_table import LateralTable
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.results.ledger import Ledger
from toothspace.results.solution import Solution
from toothspace.simulation.lateral.table_lookup import load_of_run, run_with_table, with_table_load

CASES = Path(__file__).resolve().parents[2] / "cases"
FORCES = np.array([-12000.0, -6000.0, 0.0, 6000.0])
LEAKAGES = np.array([0.1, 1.0, 10.0, 100.0])
DRAGS = np.array([3.0, 1.0, 0.0, -0.5])
SLIDE = 3.0


@pytest.fixture(scope="module")
def motor() -> MachineDescription:
    return api.describe(load_case(CASES / "egm12_motor_reduced.toml"))


def _with_table(machine: MachineDescription, begin: float) -> MachineDescription:
    table = LateralTable(
        force=FORCES,
        moment=np.zeros(1),
        extra_share=DRAGS[:, None],
        pressure_share=np.full((FORCES.size, 1), -0.2),
        leakage_factor=LEAKAGES[:, None],
        condition_load=(begin, 0.0),
        condition_slide=SLIDE,
    )
    return replace(machine, lateral_table=table)


class _Carrying:
    """Stands for lumped runs: the more the faces leak the less pressure the tooth spaces keep."""

    def __init__(self, machine: MachineDescription, at_once: bool = False) -> None:
        self.machine, self.at_once = machine, at_once
        self.runs: list[MachineDescription] = []

    def __call__(self, changed: MachineDescription) -> Solution:
        self.runs.append(changed)
        wide, plain = (
            next(p for p in m.paths if p.category in LATERAL_PATHS).geometry.values[:, 0].max()
            for m in (changed, self.machine)
        )
        return self.at(float(wide / plain) ** 3)

    def at(self, factor: float) -> Solution:
        kept = float(factor < 4.0) if self.at_once else 1.0 / (1.0 + factor / 4.0)
        over, angle = ("path", "shaft_angle"), np.linspace(0.0, 2.0 * np.pi, 5)
        chambers = np.full((5, self.machine.chamber_count), 1e5 + kept * 199e5)
        data = xr.Dataset(
            {
                "chamber_pressure": (("shaft_angle", "chamber"), chambers),
                "inlet_pressure": ("shaft_angle", np.full(5, 200e5)),
                "outlet_pressure": ("shaft_angle", np.full(5, 1e5)),
                "shaft_speed": ("shaft_angle", np.full(5, 157.0)),
                "equivalent_leakage": (over, np.full((2, 5), 4e-7 * factor)),
            },
            {"shaft_angle": angle, "path": [c.name for c in LATERAL_PATHS]},
        )
        return Solution(Status.DONE, data, Ledger(1.0, 1.0, {}, {}))


@pytest.mark.parametrize("begin", [-11000.0, -3000.0, 5000.0])
def test_films_and_run_agree_from_any_begin(motor: MachineDescription, begin: float) -> None:
    run = _Carrying(motor)
    solution = run_with_table(_with_table(motor, begin), run, 2.0 * SLIDE)
    assert solution.status is Status.DONE
    # where both curves cross: the load is linear in the pressure kept, 1/2 at a factor of 4
    factors = np.geomspace(0.1, 100.0, 4001)
    low, half = (load_of_run(motor, run.at(f))[0] for f in (1e9, 4.0))
    forces = low + 2.0 * (half - low) / (1.0 + factors / 4.0)
    error = np.log(factors) - np.interp(forces, FORCES, np.log(LEAKAGES))
    force = float(np.interp(0.0, error, forces))
    assert solution.statistics["lateral_axial_force"] == pytest.approx(force, abs=120.0)
    drag = lateral_torque_coefficient(run.runs[-1]) / lateral_torque_coefficient(motor)
    # at twice the speed half of the torque that pressure gives counts
    assert drag == pytest.approx(1.1 + float(np.interp(force, FORCES, DRAGS)), abs=0.03)
    assert run.runs[-1].lateral_table is None


def test_run_that_never_agrees_is_not_converged(motor: MachineDescription) -> None:
    # spaces that empty at once: no leakage gives the load that belongs to it
    solution = run_with_table(_with_table(motor, -3000.0), _Carrying(motor, at_once=True), SLIDE)
    assert solution.status is Status.NOT_CONVERGED
    assert "differs from that of the run" in solution.provenance["warnings"]


def test_run_over_time_reports_its_one_load(motor: MachineDescription) -> None:
    done = Solution(Status.DONE, xr.Dataset(), Ledger(1.0, 1.0, {}, {}))
    condition = OperatingCondition(shaft_speed=157.0, inlet_pressure=200e5, outlet_pressure=1e5)
    plain = replace(motor, lateral_table=None)
    reported = with_table_load(_with_table(motor, -3000.0), condition, done)
    force = reported.statistics["lateral_axial_force"]
    balance = plain.lateral_balance
    assert balance is not None
    assert force == axial_load(balance, chamber_pressures(plain, condition))[0]
    assert f"at one load, {force:.4g} N" in reported.provenance["warnings"]
    assert "199 bar" in reported.provenance["warnings"]


def test_load_beyond_the_table_is_refused(motor: MachineDescription) -> None:
    machine = _with_table(motor, -3000.0)
    assert machine.lateral_table is not None
    # films that leak little at any load leave the spaces full: some 9 kN open the gap
    small = replace(machine.lateral_table, leakage_factor=1e-3 * LEAKAGES[:, None])
    with pytest.raises(CaseError, match="F_z"):
        run_with_table(replace(machine, lateral_table=small), _Carrying(motor), SLIDE)
