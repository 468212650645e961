"""The package agrees with the one-file pump of ``examples``, variable by variable, within 0.2 %.

The oracle shares no code with the package: own tooth form, chamber polygons, network and
integrator. Here the package's machine is reduced to the same case: gears held at their centres,
one viscosity, liquid without gas, no friction outside the chambers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from examples import minimal_external_gear as oracle
from tests.external_gear_designs import gear_of, machine_of
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.types import Array
from toothspace.geometry.involute_gear import InvoluteGear
from toothspace.machines.external_gear import spec as keys
from toothspace.machines.external_gear.describe import describe
from toothspace.model.arrays import CATEGORY
from toothspace.model.assembly import System, assemble
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.ledger import LEDGER_NAMES
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.periodic_table import PeriodicTable
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.cyclic import History, RunPlan, march_revolutions

pytestmark = pytest.mark.slow
NODES = 2880
SAMPLES = 360  # of one pitch
AGREEMENT = 2e-3  # of the largest value of each variable


@dataclass(frozen=True)
class Comparison:
    """One pitch of both models: waveforms (package, oracle) and means (package, oracle)."""

    waveforms: dict[str, tuple[Array, Array]]
    means: dict[str, tuple[float, float]]


def simplified_machine() -> MachineDescription:
    tooth = InvoluteGear(
        tooth_count=oracle.TEETH,
        module=oracle.MODULE,
        pressure_angle=oracle.PRESSURE_ANGLE,
        profile_shift=oracle.PROFILE_SHIFT,
        dedendum=oracle.DEDENDUM / oracle.MODULE,
        tool_tip_radius=oracle.TOOL_RADIUS / oracle.MODULE,
        tip_diameter=2.0 * oracle.TIP_RADIUS,
    )
    gear = gear_of(tooth, oracle.WIDTH, tip_rounding=0.0)
    machine = machine_of(
        tooth,
        oracle.WIDTH,
        mode="pump",
        normal_backlash=oracle.BACKLASH,
        casing=keys.CasingParameters(
            radial_clearance=oracle.TIP_GAP,
            inlet_angle=oracle.INLET_EDGE,
            outlet_angle=oracle.OUTLET_EDGE,
        ),
        journal_bearings=keys.JournalBearingParameters(
            diameter=2.0 * oracle.SHAFT_RADIUS, length=19e-3, radial_clearance=8e-6
        ),
        lateral=keys.LateralParameters(side_gap=oracle.SIDE_GAP),
        relief_grooves=keys.BlockGrooveParameters(
            closing_side_offset=oracle.GROOVE_EDGE,
            opening_side_offset=oracle.GROOVE_EDGE,
            width=oracle.GROOVE_WIDTH,
            radial_extent=2.0 * oracle.GROOVE_HALF_HEIGHT,
            depth=oracle.GROOVE_DEPTH,
        ),
    )
    return without_motion(describe(replace(machine, drive=gear, driven=gear), NODES))


def without_motion(machine: MachineDescription) -> MachineDescription:
    def no_channels(table: PeriodicTable) -> PeriodicTable:
        return replace(table, values=table.values[:, :0], slopes=table.slopes[:, :0])

    return replace(
        machine,
        motions=(),
        journals=(),
        laterals=(),
        contacts=(),
        mesh=None,
        paths=tuple(replace(path, height_by_motion=None) for path in machine.paths),
        families=tuple(
            replace(family, volume_by_motion=no_channels(family.volume_by_motion))
            for family in machine.families
        ),
    )


def plain_liquid() -> FluidLaw:
    law = fluid_law(
        "iso_vg_46", 323.15, GasModel(law="none", free_air_fraction=0.0, dissolved_air_fraction=0.0)
    )
    return law._replace(
        reference_density=oracle.DENSITY,
        compliance=oracle.COMPLIANCE,
        stiffening=oracle.STIFFENING,
        dynamic_viscosity=oracle.VISCOSITY,
        pressure_viscosity=0.0,
        viscosity_temperature=0.0,
        nuclei_mass_fraction=1e-3 * law.nuclei_mass_fraction,
    )


def package_run() -> History:
    """Three revolutions from rest; the tolerance is that of flows through wide open ports."""
    condition = OperatingCondition(
        shaft_speed=oracle.SPEED,
        inlet_pressure=oracle.INLET_PRESSURE,
        outlet_pressure=oracle.OUTLET_PRESSURE,
        radial_motion=False,
        relative_tolerance=1e-8,
    )
    system = assemble(simplified_machine(), plain_liquid(), condition)
    return march_revolutions(
        system, RunPlan(revolutions=3, samples_per_revolution=oracle.TEETH * SAMPLES)
    )


def total_flow(system: System, seen: Observation, *categories: str) -> Array:
    kinds = np.array([c.name for c in system.categories])[system.arrays.path_index[:, CATEGORY]]
    return np.asarray(seen.path_flow[:, np.isin(kinds, categories)].sum(axis=1))


def ledger_rates(history: History) -> dict[str, float]:
    """Powers by account, and mass flows into the ports."""
    arrays, description = history.system.arrays, history.system.description
    rates = (history.states[SAMPLES] - history.states[0]) * oracle.SPEED / oracle.PITCH
    nodes = {"inlet": description.inlet_node, "outlet": description.outlet_node}
    return {
        **dict(zip(LEDGER_NAMES, rates[arrays.size.core :], strict=False)),
        **{name: float(rates[arrays.balance[node, 0]]) for name, node in nodes.items()},
    }


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    history = package_run()
    system, seen = history.system, observe(history.system.arrays, history.states[: SAMPLES + 1])
    pump = oracle.Pump()
    angles, pressures = pump.cyclic_pitch(SAMPLES)
    rows: list[dict[str, Any]] = [pump.flows(a, p) for a, p in zip(angles, pressures, strict=True)]
    chambers = 2 * oracle.TEETH
    waveforms = {
        "chamber_pressure": (seen.pressure[:, :chambers], pressures.reshape(-1, chambers)),
        "chamber_volume": (
            seen.volume[:, :chambers],
            np.array([row["volume"].ravel() for row in rows]),
        ),
        "torque": (seen.torque[:, -1], np.array([row["torque"] for row in rows])),
    }
    for name, categories in {
        "inlet": ("inlet_port", "inlet_groove"),
        "outlet": ("outlet_port", "outlet_groove"),
        "tip": ("tooth_tip",),
        "lateral": ("lateral",),
        "drain": ("drain",),
    }.items():
        expected = np.array([row[name].sum() for row in rows])
        waveforms[name] = (total_flow(system, seen, *categories), expected)
    rates, expected_means = ledger_rates(history), oracle.summary(pump, angles, pressures)
    means = {
        "outlet": (rates["outlet"], expected_means["outlet_mass_flow_kg_per_s"]),
        "inlet": (-rates["inlet"], expected_means["inlet_mass_flow_kg_per_s"]),
        "torque": (rates["shaft"] / oracle.SPEED, expected_means["mean_torque_N_m"]),
        "displacement": (
            system.description.displacement,
            expected_means["displacement_cm3_per_rev"] * 1e-6 / (2.0 * np.pi),
        ),
    }
    return Comparison(waveforms, means)


SHARES = {
    "chamber_volume": 1.0,
    "tip": 1.0,
    "lateral": 1.0,
    "drain": 1.0,
    # where a port begins to open, pressure rises by 12 bar per sample: one node of the tables
    "chamber_pressure": 0.999,
    # where a throat's ends turn at a tip corner, dV/dphi jumps: one node of the tables
    "torque": 0.95,
    "inlet": 0.95,
    "outlet": 0.95,
}
"""Part of the samples that agree, by variable."""


def test_waveforms_agree(comparison: Comparison) -> None:
    for name, share_of_samples in SHARES.items():
        found, expected = comparison.waveforms[name]
        error = np.abs(found - expected) / np.max(np.abs(expected))
        assert np.quantile(error, share_of_samples) < AGREEMENT, name
        assert np.sqrt(np.mean(error**2)) < AGREEMENT, name


def test_means_agree(comparison: Comparison) -> None:
    """Means are ten times closer: errors of table interpolation cancel over a pitch."""
    for name in ("outlet", "inlet", "torque", "displacement"):
        found, expected = comparison.means[name]
        assert found == pytest.approx(expected, rel=0.1 * AGREEMENT), name


def test_the_case_stays_clear_of_cavitation(comparison: Comparison) -> None:
    """The oracle's liquid knows no vapour, so it may not be asked for tension."""
    assert np.min(comparison.waveforms["chamber_pressure"][1]) > 2e5
