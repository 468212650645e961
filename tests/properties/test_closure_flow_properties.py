"""What must hold of every flow and friction law: odd, monotone, never a source of energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from toothspace.closures.contact_cylindrical import pereira_force
from toothspace.closures.contact_law import logarithmic_law
from toothspace.closures.friction import stribeck_friction
from toothspace.closures.hydraulic_resistance import resistance_flow, throttle_flow
from toothspace.closures.orifice import inertial_laminar_flow
from toothspace.closures.traction import FlankSurface, mesh_friction
from toothspace.model.fluid import fluid_law

OIL = fluid_law("iso_vg_46", 333.15)
SURFACE = FlankSurface(2.26e11, 0.4e-6, 0.10, 0.05)
drops = st.floats(-4e7, 4e7)


@pytest.mark.parametrize("law", [throttle_flow, resistance_flow, inertial_laminar_flow])
@given(drops, drops)
def test_flow_laws_are_odd_and_monotone(law, one: float, other: float) -> None:
    constants = {
        throttle_flow: (3e-6, 842.0),
        resistance_flow: (3e9, 2e13),
        inertial_laminar_flow: (3e-10, 3e-6, 842.0),
    }[law]
    low, high = sorted((one, other))
    assert law(-one, *constants)[0] == -law(one, *constants)[0]
    assert law(low, *constants)[0] <= law(high, *constants)[0]
    assert law(one, *constants)[1] >= 0.0


@given(drops, st.floats(-15.0, -8.0), st.floats(-8.0, -3.0), st.floats(1.0, 1000.0))
def test_path_law_solves_its_equation(drop: float, lg: float, la: float, density: float) -> None:
    conductance, area = 10.0**lg, 10.0**la
    flow, by_pressure, by_conductance = inertial_laminar_flow(drop, conductance, area, density)
    loss = flow / conductance + density / (2.0 * area**2) * flow * abs(flow)
    assert np.isclose(loss, drop, rtol=1e-9, atol=1e-12)
    assert 0.0 < by_pressure <= conductance
    assert flow * drop >= 0.0
    assert by_conductance * drop >= 0.0


@given(st.floats(-10.0, 10.0), st.floats(1e-3, 1.0))
def test_stribeck_friction_is_odd_bounded_and_opposes(speed: float, brk: float) -> None:
    force, _ = stribeck_friction(speed, 250.0, 100.0, brk)
    assert stribeck_friction(-speed, 250.0, 100.0, brk)[0] == -force
    assert force * speed >= 0.0
    assert abs(force) <= 250.0 * (1.0 + 2e-3)


@given(st.floats(-20.0, 20.0), st.floats(0.0, 40.0), st.floats(0.0, 1e6))
def test_mesh_friction_is_odd_and_bounded(speed: float, rolling: float, load: float) -> None:
    friction, _, _ = mesh_friction(load, 2.4e-3, speed, rolling, OIL, SURFACE)
    assert np.isfinite(friction)
    assert friction * speed >= 0.0
    assert abs(friction) <= 0.10 + 1e-12
    assert mesh_friction(load, 2.4e-3, -speed, rolling, OIL, SURFACE)[0] == -friction


@given(st.floats(1e-12, 20e-6), st.floats(1e-12, 20e-6), st.sampled_from([1e-3, 5e-3]))
def test_contact_forces_grow_with_indentation(one: float, other: float, radius: float) -> None:
    low, high = sorted((one, other))
    modulus, level = 113e9, float(np.log(radius))
    shallow = logarithmic_law(low, level, modulus)[0]
    assert shallow <= logarithmic_law(high, level, modulus)[0] * (1.0 + 1e-12)
    shallow = pereira_force(low, radius, 1.0, modulus, False)
    assert shallow <= pereira_force(high, radius, 1.0, modulus, False)
