"""Invariants of external gear machines that hold for any valid gears."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.external_gear_designs import changed, egm12, gear_of, spaces_at
from toothspace.core.errors import GeometryError
from toothspace.gearing.meshing import flow_over_pitch
from toothspace.gearing.spaces import area_by_motion, section_areas
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear import MACHINE
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.spec import ExternalGearSpec, Gear


@st.composite
def gear_machines(draw: st.DrawFn) -> ExternalGearSpec:
    """Machines with involute gears of 8 to 30 teeth that can be built."""
    module = draw(st.floats(1e-3, 6e-3))
    angle = np.deg2rad(draw(st.floats(18.0, 28.0)))
    shift = draw(st.floats(0.1, 0.5))
    rounding = draw(st.sampled_from([0.0, 0.02, 0.05])) * module
    counts = draw(st.tuples(st.integers(8, 30), st.integers(8, 30)))
    drive, driven = (
        gear_of(InvoluteGear(count, module, angle, shift, tip_rounding=rounding), 5.0 * module)
        for count in counts
    )
    spec = egm12(
        draw(st.sampled_from(["pump", "motor"])),
        drive=drive,
        driven=driven,
        grooves=None,
        normal_backlash=draw(st.floats(0.0, 0.04)) * module,
    )
    bearing = replace(spec.keys.journal_bearings, diameter=3.0 * module)
    return changed(spec, journal_bearings=bearing)


def built(spec: ExternalGearSpec) -> Assembly:
    """The assembly, unless the gears drawn cannot be cut or do not mesh properly."""
    try:
        assembly = assemble(spec)
    except GeometryError:
        assume(False)
    assert assembly.pair is not None
    assume(assembly.pair.contact_ratio > 1.05)
    assume(not any(form.undercut for form in assembly.pair.forms))
    return assembly


@settings(max_examples=12, deadline=None)
@given(gear_machines(), st.floats(0.0, 6.0))
def test_chambers_are_positive_and_fill_a_constant_space(
    spec: ExternalGearSpec, shaft_angle: float
) -> None:
    assembly = built(spec)
    here, there = (
        np.concatenate([section_areas(s) for s in spaces_at(assembly, angle)])
        for angle in (0.0, shaft_angle)
    )
    assert there.min() > 0.0
    assert abs(there.sum() - here.sum()) < 1e-10 * here.sum()


@settings(max_examples=12, deadline=None)
@given(gear_machines(), st.floats(0.0, 6.0))
def test_equal_pressure_never_pushes_or_turns_a_gear(
    spec: ExternalGearSpec, shaft_angle: float
) -> None:
    assembly = built(spec)
    forces = np.vstack([area_by_motion(s) for s in spaces_at(assembly, shaft_angle)])
    # the throats between two chambers are found once for each, to a picometre or so
    assert np.all(np.abs(forces.sum(axis=0)) < 1e-7 * np.abs(forces).max(axis=0))


@settings(max_examples=8, deadline=None)
@given(gear_machines())
def test_tables_give_the_closed_form_displacement(spec: ExternalGearSpec) -> None:
    assembly = built(spec)
    closed = MACHINE.describe(spec, nodes=72).displacement
    assert abs(np.mean(flow_over_pitch(assembly)) / closed - 1.0) < 2e-3


@settings(max_examples=8, deadline=None)
@given(gear_machines(), st.floats(0.5, 2.0))
def test_tables_scale_with_size(spec: ExternalGearSpec, factor: float) -> None:
    """A machine of other size has volumes times the cube of the factor."""
    assembly = built(spec)
    larger = changed(
        spec,
        drive=_scaled(spec.drive, factor),
        driven=_scaled(spec.driven, factor),
        normal_backlash=factor * (spec.keys.gears.normal_backlash or 0.0),
    )
    small, large = (
        np.concatenate([section_areas(s) for s in spaces_at(a, 0.3)])
        for a in (assembly, assemble(larger))
    )
    assert np.allclose(large, factor**2 * small, rtol=1e-6, atol=1e-9 * small.max())


def _scaled(gear: Gear, factor: float) -> Gear:
    tooth = gear.tooth
    assert isinstance(tooth, InvoluteGear)
    scaled = replace(tooth, module=factor * tooth.module, tip_rounding=factor * tooth.tip_rounding)
    return replace(gear, tooth=scaled, face_width=factor * gear.face_width)
