"""The toy machine with a ring that three lobes hold: compliant contacts in closed form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tests.toy_machine import TURN, toy_machine
from toothspace.model.contact_pair import ContactPair
from toothspace.model.description import (
    Body,
    LumpedJournalBearing,
    LumpedLateralFilm,
    MachineDescription,
    Motion,
)
from toothspace.numerics.periodic_table import smooth_table, table_from_exact_slopes

NODES = 720
RATIO = 0.8
INERTIA = 6e-5
MASS = 0.2


def contact_machine(**pair: Any) -> MachineDescription:
    """A ring in a short journal closed by walls, turned against three lobes by the pressures."""
    toy = toy_machine(NODES)
    angle = np.arange(NODES) * TURN / NODES
    family = toy.families[0]
    volume_by_motion = np.column_stack(
        [2e-6 * np.cos(angle), 2e-6 * np.sin(angle), -1e-7 * (1.0 + np.sin(angle))]
    )
    paths = tuple(
        replace(path, height_by_motion=_no_motion())
        if path.kind == "orifice"
        else replace(path, height_by_motion=_tilted(angle))
        for path in toy.paths
    )
    return replace(
        toy,
        bodies=(*toy.bodies, Body("ring", (0.0, 0.0), RATIO, MASS, INERTIA, "driven")),
        motions=(Motion("ring", "x"), Motion("ring", "y"), Motion("ring", "rotation")),
        families=(replace(family, volume_by_motion=smooth_table(TURN, volume_by_motion)),),
        paths=paths,
        journals=(
            LumpedJournalBearing(
                body="ring",
                count=1,
                diameter=60e-3,
                length=10e-3,
                radial_clearance=60e-6,
                roughness=3e-7,
                correlation_length=1e-5,
                effective_modulus=2e11,
                hardness=1e9,
                boundary_friction=0.05,
                end_condition="no_flow",
            ),
        ),
        laterals=(LumpedLateralFilm("ring", 2, 20e-6, 15e-3, 25e-3, 30e-3, 1.0),),
        contacts=(lobes(angle, **pair),),
    )


def lobes(angle: np.ndarray, **changes: Any) -> ContactPair:
    """Three contacts whose gap, direction, lever and curvature vary over the angle."""
    gap = 4e-6 - 8e-6 * np.cos(2.0 * angle)
    ones = np.ones_like(angle)
    radius = 8e-3 + 2e-3 * np.cos(angle)
    geometry = np.column_stack(
        [gap, ones, radius, -15.9e-3 * ones, 4e-3 * np.sin(angle) + 6e-3, 30e-3 * ones]
    )
    lever = 22e-3 + 2e-3 * np.cos(angle)
    direction = [np.cos(angle), np.sin(angle)]
    along = [-np.sin(angle), np.cos(angle)]
    settings: dict[str, Any] = {
        "name": "lobe",
        "body_a": "rotor",
        "body_b": "ring",
        "angle_ratio": 1.0,
        "phases": np.arange(3) * TURN / 3.0,
        "geometry": smooth_table(TURN, geometry),
        "gap_by_motion": smooth_table(TURN, np.column_stack([*direction, lever])),
        "slip_by_motion": smooth_table(TURN, np.column_stack([*along, 8e-3 * ones])),
        "gap_by_shift_and_turn": smooth_table(TURN, _curvatures(angle)),
        "width": 12e-3,
        "effective_modulus": 2.26e11,
        "roughness": 4e-7,
    }
    return ContactPair(**{**settings, **changes})


def _curvatures(angle: np.ndarray) -> np.ndarray:
    """Circles of 8 mm in hollows of 10 mm, hollows a little farther round at some angles."""
    flatness = 40e-3 + 8e-3 * np.sin(angle)
    inner = 120.0
    columns = [inner - inner**2 * flatness, inner * flatness, -flatness - 8e-3]
    return np.column_stack(columns)


def _no_motion() -> Any:
    return table_from_exact_slopes(TURN, np.zeros((NODES, 3)), np.zeros((NODES, 3)))


def _tilted(angle: np.ndarray) -> Any:
    zero = np.zeros_like(angle)
    return smooth_table(TURN, np.column_stack([0.1 * np.cos(angle), 0.1 * np.sin(angle), zero]))
