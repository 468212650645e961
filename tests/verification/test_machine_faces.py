"""Film on one face of a machine, from the case file to named numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from toothspace import api
from toothspace.api import solve_film
from toothspace.films.plane.conductance import FaceResolution, face_conductance
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.quasi_static import quasi_static_pressures

CASE = Path(__file__).parents[2] / "cases" / "egm12_lateral_film.toml"
PLAIN = (
    "film.tilt=['0 rad', '0 rad']",
    "film.shaft_angle=0 deg",
    "film.pressure_viscosity=0 1/GPa",
    "film.density=constant",
    "film.grid=[360, 24]",
)


def solved(*overrides: str) -> dict[str, Any]:
    return solve_film(api.load_case(CASE, (*PLAIN, *overrides)))


def test_rigid_parallel_face_leaks_by_its_conductances() -> None:
    """Shaft leakage against the eliminated conductance matrix at the same chamber pressures.

    One resolves the edge of a cell at its centre, the other half a cell off: 5 % on this grid.
    """
    numbers = solved()
    case = api.load_case(CASE, PLAIN)
    description = api.describe(case)
    condition = OperatingCondition(
        shaft_speed=157.0, inlet_pressure=1e5, outlet_pressure=200e5, drain_pressure=1e5
    )
    pressure = np.append(quasi_static_pressures(description, condition, 0.0), [1e5, 200e5, 1e5])
    flow = 0.0
    assert len(description.known_faces) == len(description.laterals)
    for face in description.known_faces.values():
        nodes = [*face.chambers.nodes, *face.recesses, face.inner_node]
        matrix = face_conductance(face, FaceResolution(30, 24, 1)).matrix[0]
        flow -= (8e-6) ** 3 / (12.0 * 0.03) * float(matrix[-1] @ pressure[nodes])
    assert numbers["drain_flow_L_per_min"] == pytest.approx(flow * 6e4, rel=0.05)
    assert numbers["mass_balance_error"] < 1e-8
    assert numbers["status"] == "done"


def test_thicker_oil_leaks_less_and_a_close_face_touches() -> None:
    plain, barus = solved(), solved("film.pressure_viscosity=20 1/GPa")
    assert 0.6 < barus["drain_flow_L_per_min"] / plain["drain_flow_L_per_min"] < 0.95
    close = solved("film.side_gap=1 um")
    assert plain["contact_load_N"] == 0.0
    assert close["contact_load_N"] > 1.0
    torque = close["friction_torque_N_m"]
    assert torque["drive_gear"] < plain["friction_torque_N_m"]["drive_gear"] < 0.0
