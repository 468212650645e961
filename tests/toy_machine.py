"""A tiny machine with closed-form tables: cylinders with sinusoidal volumes and two ports."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from toothspace.model.assembly import System, assemble
from toothspace.model.description import (
    Body,
    ChamberFamily,
    FlowPath,
    MachineDescription,
)
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import INLET_PORT, LATERAL, OUTLET_PORT, PathCategory
from toothspace.numerics.periodic_table import (
    PeriodicTable,
    monotone_table,
    table_from_exact_slopes,
)

TURN = 2.0 * np.pi
COUNT = 6
MEAN_VOLUME = 1.2e-6
AMPLITUDE = 0.5e-6
GAP = 15e-6
OIL = fluid_law("iso_vg_46", 323.15, GasModel(law="none", dissolved_air_fraction=0.08))
"""Oil that neither takes up nor gives off its air."""
CONDITION = OperatingCondition(
    shaft_speed=150.0, inlet_pressure=1e5, outlet_pressure=50e5, drain_pressure=1e5
)


def toy_system(machine: MachineDescription | None = None, **condition: Any) -> System:
    """The cylinders, or another machine, between 1 and 50 bar, but for what is said otherwise."""
    return assemble(machine or toy_machine(), OIL, replace(CONDITION, **condition))


def toy_machine(nodes: int = 720) -> MachineDescription:
    """Six cylinders; each fills while its volume grows and empties while it shrinks."""
    angle = np.arange(nodes) * TURN / nodes
    phases = np.arange(COUNT) * TURN / COUNT
    no_motion = np.zeros((nodes, 0))
    family = ChamberFamily(
        name="cylinder",
        angle_ratio=1.0,
        phases=phases,
        volume=table_from_exact_slopes(
            TURN, MEAN_VOLUME - AMPLITUDE * np.cos(angle), AMPLITUDE * np.sin(angle)
        ),
        volume_by_motion=PeriodicTable(TURN, no_motion, no_motion),
    )
    chambers = np.arange(COUNT)
    return MachineDescription(
        name="toy",
        mode="pump",
        displacement=2.0 * AMPLITUDE * COUNT / TURN,
        bodies=(Body("rotor", (0.0, 0.0), 1.0, 0.1, 1e-5, "shaft"),),
        motions=(),
        families=(family,),
        paths=(
            _port(INLET_PORT, COUNT, phases, angle, np.sin(angle)),
            _port(OUTLET_PORT, COUNT + 1, phases, angle, -np.sin(angle)),
            FlowPath(
                name="leak",
                category=LATERAL,
                kind="parallel_gap",
                nodes_a=chambers,
                nodes_b=np.roll(chambers, -1),
                angle_ratio=1.0,
                phases=phases,
                geometry=PeriodicTable(
                    TURN,
                    np.tile([GAP, 10e-3, 2e-3], (nodes, 1)),
                    np.zeros((nodes, 3)),
                ),
            ),
        ),
    )


def _port(
    category: PathCategory, node: int, phases: np.ndarray, angle: np.ndarray, opening: np.ndarray
) -> FlowPath:
    area = 4e-5 * np.maximum(opening, 0.0)
    geometry = np.stack([area, np.sqrt(area) + 1e-5], axis=1)
    return FlowPath(
        name=category.name,
        category=category,
        kind="orifice",
        nodes_a=np.arange(COUNT),
        nodes_b=np.full(COUNT, node),
        angle_ratio=1.0,
        phases=phases,
        geometry=monotone_table(TURN, geometry),
    )
