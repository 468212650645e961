"""Gerotor reference designs for tests."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from toothspace.machines.gerotor.parameters import (
    FaceGapParameters,
    GerotorParameters,
    HousingParameters,
    RotorParameters,
)

TROCHOIDAL = RotorParameters(
    kind="trochoidal",
    inner_tooth_count=6,
    eccentricity=2.5e-3,
    generating_radius=25.2e-3,
    lobe_radius=8.5e-3,
    face_width=12e-3,
    tip_clearance=30e-6,
)
"""6/7 teeth, 85.55 mm2 displaced area, 6.160 cm3/rev."""

CYCLOIDAL = RotorParameters(
    kind="cycloidal",
    inner_tooth_count=6,
    eccentricity=2.5e-3,
    face_width=12e-3,
    tip_clearance=40e-6,
)
"""6/7 teeth, 77.18 mm2 displaced area, 5.557 cm3/rev."""


def machine(rotors: RotorParameters, **changes: Any) -> GerotorParameters:
    """Return a pump with these rotors and the housing of the reference designs."""
    parameters = GerotorParameters(
        mode="pump",
        rotors=rotors,
        housing=HousingParameters(outer_rotor_diameter=52e-3, radial_clearance=50e-6),
        lateral=FaceGapParameters(side_gap=20e-6),
    )
    return replace(parameters, **changes)
