"""Keys of ``[machine]`` for gerotors, read to SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from toothspace.core.frozen import Points
from toothspace.core.keys import (
    KeyRuleError,
    KeyTable,
    Problem,
    choice,
    file_path,
    forbid,
    instead_of,
    integer,
    number,
    quantity,
    require,
    table,
    text,
)
from toothspace.gearing.gear_tables import CONTOUR_SUFFIXES, PROFILE_SUFFIXES
from toothspace.machines.shared_tables import (
    MachineTables,
    PortParameters,
    ShaftBearingParameters,
    ShaftSealParameters,
)

FILE_UNITS = {"mm": 1e-3, "m": 1.0, "um": 1e-6, "in": 25.4e-3}
"""Length units of profiles. [m]"""
_LEAST_OF_RIM = 0.5
"""Of the outside diameter of an outer rotor: the width across its lobes is more. [-]"""


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
        "mm",
        "Radius of the lobe centres of a trochoidal pair.",
        above=0,
        high=500,
        default=None,
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
        "um", "Root mean square roughness of flanks and faces.", low=0, high=10, default=0.6e-6
    )

    def __post_init__(self) -> None:
        instead_of(self, "kind", "inner_profile", "outer_profile")
        if self.kind is not None:
            missing = [n for n in ("inner_tooth_count", "eccentricity", "face_width")
                       if not getattr(self, n)]  # fmt: skip
            if missing:
                raise KeyRuleError.of(
                    Problem(name, "nothing", "compulsory with kind") for name in missing
                )
        if self.kind == "trochoidal":
            require(self, 'with kind = "trochoidal"', "generating_radius", "lobe_radius")

    def profiles(self) -> tuple[Path | Points, Path | Points]:
        """Return the profiles of both rotors, where they are given."""
        assert self.inner_profile is not None
        assert self.outer_profile is not None
        return self.inner_profile, self.outer_profile

    def completed(self, outer_diameter: float) -> RotorParameters:
        """Keys with the tooth count, eccentricity and width that the profiles' files hold.

        Parameters
        ----------
        outer_diameter : float
            Outside diameter of the outer rotor, to check the unit of the files. [m]

        Raises
        ------
        KeyRuleError
            For another tooth count than given, files without distance or width, or a wrong unit.
        """
        # with what reads CAD files
        from toothspace.machines.gerotor.rotor_files import drawn_eccentricity, rotor_pair

        inner, outer = rotor_pair(*self.profiles(), FILE_UNITS[self.profile_unit])
        if self.inner_tooth_count not in (0, inner.tooth_count):
            found = f"{self.inner_tooth_count}, but {inner.tooth_count} teeth in the profile"
            raise KeyRuleError("rotors.inner_tooth_count", found, "that of the profile, or none")
        self._check_unit(outer.width, outer_diameter)
        eccentricity = self.eccentricity or drawn_eccentricity(inner, outer)
        if not eccentricity:
            reason = "compulsory unless the rotors are drawn apart on parallel axes"
            raise KeyRuleError("rotors.eccentricity", "nothing", reason)
        width = self.face_width or inner.face_width
        if not width:
            reason = "compulsory unless the rotors are solids"
            raise KeyRuleError("rotors.face_width", "nothing", reason)
        return replace(
            self,
            inner_tooth_count=inner.tooth_count,
            eccentricity=eccentricity,
            face_width=width,
        )

    def _check_unit(self, size: float, diameter: float) -> None:
        # width across the lobes of the outer rotor against its outside diameter
        sizes = {n: size * scale / FILE_UNITS[self.profile_unit] for n, scale in FILE_UNITS.items()}
        fits = [n for n, width in sizes.items() if _LEAST_OF_RIM * diameter < width < diameter]
        if len(fits) == 1 and fits[0] != self.profile_unit:
            raise KeyRuleError(
                "rotors.profile_unit",
                f"{self.profile_unit!r}, with which the outer rotor's lobes span "
                f"{1e3 * size:.5g} mm",
                f"{fits[0]!r}, with which it is {1e3 * sizes[fits[0]]:.5g} mm and fits the rim",
            )


@final
@dataclass(frozen=True, kw_only=True)
class HousingParameters(KeyTable):
    """``[machine.housing]``: radial film round the outer rotor."""

    outer_rotor_diameter: float = quantity(
        "mm", "Outside diameter of the outer rotor.", above=0, high=1000
    )
    radial_clearance: float = quantity(
        "um", "Housing bore radius minus rotor radius.", low=1, high=1000
    )
    end_condition: str = choice(
        "Axial ends of the film: walls beside which the faces lead pressure into it, the drain, "
        "or walls through which nothing passes.",
        "no_flow",
        "pressure",
        "wall",
        default="no_flow",
    )
    roughness: float = quantity(
        "um", "Root mean square roughness of the bore.", low=0, high=10, default=0.4e-6
    )


@final
@dataclass(frozen=True, kw_only=True)
class PortContourParameters(KeyTable):
    """``[machine.ports]``: kidneys about the centre of the outer rotor."""

    timing: str | None = choice(
        "Ports change over exactly at the largest and smallest volume.", "kinematic", default=None
    )
    land_max_half_angle: float | None = quantity(
        "deg", "Half of the land at the largest volume.", above=0, high=90, default=None
    )
    land_min_half_angle: float | None = quantity(
        "deg", "Half of the land at the smallest volume.", above=0, high=90, default=None
    )
    inner_radius: float | None = quantity(
        "mm", "Inner radius of the kidneys.", above=0, high=500, default=None
    )
    outer_radius: float | None = quantity(
        "mm", "Outer radius of the kidneys.", above=0, high=500, default=None
    )
    depth: float = quantity(
        "mm",
        "Depth of the kidneys, for records: they count as deep.",
        above=0,
        high=200,
        default=10e-3,
    )
    covers: str = choice(
        "Covers with kidneys; in both, those opposite the ports are recesses at port pressure.",
        "one",
        "both",
        default="one",
    )
    contour: Path | None = file_path("Closed port polygons.", *CONTOUR_SUFFIXES)
    radial_slot_width: float | None = quantity(
        "mm",
        "Width, round the rim, of a slot from each cavity to windows in the bore, as long as the "
        "kidneys: radial porting.",
        above=0,
        high=200,
        default=None,
    )
    radial_slot_length: float | None = quantity(
        "mm", "Axial length of those slots.", above=0, high=500, default=None
    )

    def __post_init__(self) -> None:
        slot = ("radial_slot_width", "radial_slot_length")
        if any(getattr(self, name) is not None for name in slot):
            require(self, "with the other size of radial slots", *slot)
        names = ("land_max_half_angle", "land_min_half_angle")
        if self.timing is not None or self.contour is not None:
            forbid(self, "because timing or contour is given", *names)
        elif any(getattr(self, name) is not None for name in names):
            require(self, "with the other land angle", *names)


@final
@dataclass(frozen=True, kw_only=True)
class FaceGapParameters(KeyTable):
    """``[machine.lateral]``: films between rotor faces and covers."""

    side_gap: float | None = quantity(
        "um", "Film height of both faces.", low=0.1, high=500, default=None
    )
    side_gap_a: float | None = quantity(
        "um", "Film height at the face with the lower z.", low=0.1, high=500, default=None
    )
    side_gap_b: float | None = quantity(
        "um", "Film height at the face with the higher z.", low=0.1, high=500, default=None
    )
    position: str = choice(
        "Rotors stand as the gaps say, or free between the covers, which 'films' solves.",
        "given",
        "free",
        default="given",
    )

    def __post_init__(self) -> None:
        instead_of(self, "side_gap", "side_gap_a", "side_gap_b")


@final
@dataclass(frozen=True, kw_only=True)
class ContactParameters(KeyTable):
    """``[machine.contact]``: mechanics of the lobe pairs."""

    law: str = choice("Force over penetration.", "hertz", "johnson", "pereira", default="hertz")
    theory: str = choice(
        "Every pair may carry, or one only.", "multiple", "single", default="multiple"
    )
    restitution: float = number(
        "Restitution of an impact (Lankarani and Nikravesh); 1: none is lost.",
        above=0,
        high=1,
        default=0.8,
    )
    impact: str = choice(
        "Damping by the speed of each impact, or of one impact speed for all.",
        "own",
        "given",
        default="given",
    )
    impact_speed: float = quantity(
        "m/s",
        "Speed of that impact with ``given``; lobes meet slowly.",
        above=0,
        high=10,
        default=0.01,
    )
    boundary_friction: float = number(
        "Friction coefficient of touching asperities.", low=0, high=1, default=0.10
    )
    squeeze_film: str = choice(
        "Film between lobes, which resists their approach.", "on", "off", default="on"
    )


@final
@dataclass(frozen=True, kw_only=True)
class GerotorParameters(MachineTables):
    """``[machine]`` with ``type = "gerotor"``."""

    rotors: RotorParameters = table(RotorParameters, "Inner and outer rotor.")
    housing: HousingParameters = table(HousingParameters, "Radial film of the outer rotor.")
    ports: PortContourParameters = table(
        PortContourParameters,
        "Kidney ports; default kinematic timing.",
        default=PortContourParameters(timing="kinematic"),
    )
    lateral: FaceGapParameters = table(FaceGapParameters, "Lateral films.")
    contact: ContactParameters = table(
        ContactParameters, "Contacts of the lobes.", default=ContactParameters()
    )
    journal_bearings: ShaftBearingParameters | None = table(
        ShaftBearingParameters, "Bearings of the inner rotor; leave out for a fixed shaft.",
        default=None,
    )  # fmt: skip
    seals: ShaftSealParameters | None = table(ShaftSealParameters, "Shaft seal.", default=None)
    inlet: PortParameters = table(PortParameters, "Inlet volume.", default=PortParameters())
    outlet: PortParameters = table(PortParameters, "Outlet volume.", default=PortParameters())

    def assemble(self) -> GerotorParameters:
        """Return these keys with what profiles from files tell of the rotors."""
        if self.rotors.kind is not None:
            return self
        return replace(self, rotors=self.rotors.completed(self.housing.outer_rotor_diameter))


PARAMETERS = GerotorParameters
"""Found by the case reader under this name, in the module next to the machine's entry point."""
