"""Keys of ``[machine.rotors]`` of gerotors, read to SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

from toothspace.core.errors import CaseError, Problem
from toothspace.core.frozen import Points
from toothspace.core.keys import (
    KeyTable,
    choice,
    file_path,
    forbid,
    instead_of,
    integer,
    quantity,
    require,
    text,
)
from toothspace.gearing.gear_tables import PROFILE_SUFFIXES


@final
@dataclass(frozen=True, kw_only=True)
class RotorParameters(KeyTable):
    """``[machine.rotors]``: a generated pair, or two profiles from files."""

    kind: str | None = choice("Family of the profiles.", "trochoidal", "cycloidal", default=None)
    inner_tooth_count: int = integer(
        "Teeth of the inner rotor; the outer one has one more. Default that of the profiles.",
        low=3,
        high=60,
        default=0,
    )
    eccentricity: float = quantity(
        "mm",
        "Distance of the rotor centres. Default that of the profiles, drawn in one frame.",
        above=0,
        high=50,
        default=0.0,
    )
    generating_radius: float | None = quantity(
        "mm", "Radius of the lobe centres of a trochoidal pair.", above=0, high=500, default=None
    )
    lobe_radius: float | None = quantity(
        "mm", "Radius of the outer rotor's lobes of a trochoidal pair.", above=0, high=200,
        default=None,
    )  # fmt: skip
    inner_profile: Path | Points | None = file_path(
        "Closed profile of the inner rotor.", *PROFILE_SUFFIXES, points=True
    )
    outer_profile: Path | Points | None = file_path(
        "Closed profile of the outer rotor.", *PROFILE_SUFFIXES, points=True
    )
    profile_unit: str = choice("Length unit of the profiles.", "mm", "m", "um", "in", default="mm")
    face_width: float = quantity(
        "mm", "Axial width of the rotors. Default that of solids.", above=0, high=500, default=0.0
    )
    tip_clearance: float = quantity(
        "um", "Normal gap between the centred rotors at a tip pair.", low=0, high=500
    )
    tip_gap_law: str = choice(
        "Flow through the gap at a tip: between parabolic walls, or the published fit.",
        "parabolic",
        "fitted",
        default="parabolic",
    )
    shaft_diameter: float | None = quantity(
        "mm", "Bore of the inner rotor.", above=0, high=500, default=None
    )
    material: str = text("Material from the library.", default="sintered_steel")
    roughness: float = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0.01, high=10, default=0.6e-6
    )

    def __post_init__(self) -> None:
        instead_of(self, "kind", "inner_profile", "outer_profile")
        if self.kind is not None:
            missing = [n for n in ("inner_tooth_count", "eccentricity", "face_width")
                       if not getattr(self, n)]  # fmt: skip
            if missing:
                raise CaseError.of(
                    Problem(name, "nothing", "compulsory with kind") for name in missing
                )
        if self.kind == "trochoidal":
            require(self, 'with kind = "trochoidal"', "generating_radius", "lobe_radius")
        else:
            forbid(self, 'unless kind = "trochoidal"', "generating_radius", "lobe_radius")
