"""Kinematic evaluation of many external gear machines at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from toothspace.advice.gear_designs import GearDesigns, distance_of_backlash
from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.gearing.design_values import DesignValues
from toothspace.geometry.evaluated_designs import DesignReason, EvaluatedDesigns, joined, marked
from toothspace.machines.external_gear.spec import ExternalGearTables


def evaluate_designs(
    machine: ExternalGearTables,
    varied: Mapping[str, Array],
    addendum: float | None = None,
    displacement: float | None = None,
) -> EvaluatedDesigns:
    """Kinematics of a machine with other gears, as :func:`toothspace.api.evaluate_designs`.

    Key paths of ``varied`` begin below ``machine``.

    Raises
    ------
    CaseError
        If the teeth come from files, or a key does not act on the kinematics.
    """
    own = machine.driven_gear
    if machine.gears.profile is not None or (own is not None and own.profile is not None):
        raise CaseError("gears.profile", "a file", "gears given by parameters")
    values = DesignValues(machine, varied)
    in_range = values.in_range("gears", "driven_gear")
    with np.errstate(all="ignore"):
        parts = [_evaluated(part, addendum, displacement, machine.mode) for part in values.parts()]
    outside = marked(in_range.shape, {DesignReason.OUT_OF_RANGE: ~in_range})
    return joined(parts).refused(outside)


def _evaluated(
    values: DesignValues, addendum: float | None, displacement: float | None, mode: str
) -> EvaluatedDesigns:
    drive = values.gears("gears")
    driven = values.gears("driven_gear", drive)
    if addendum is not None:
        same = driven is drive
        drive = drive.with_addendum(addendum)
        driven = drive if same else driven.with_addendum(addendum)
    if values.given("gears.center_distance") and "gears.normal_backlash" not in values.varied:
        distance = values["gears.center_distance"]
    else:
        distance = distance_of_backlash(drive, driven, values["gears.normal_backlash"])
    width = values["gears.face_width"]
    designs = GearDesigns(drive, driven, distance, width, mode == "pump")
    if displacement is not None:
        width = displacement / designs.displacement_per_radian(1.0)
        designs = replace(designs, face_width=width)
    return designs.evaluated()
