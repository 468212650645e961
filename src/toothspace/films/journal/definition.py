"""Definition of a journal bearing: size, ends, grooves, walls, liquid and grid."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.films.definitions import Groove, Lobes, RoughSurfaces
from toothspace.films.reynolds.cavitation import CAVITATION
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.numerics.banded import check_grid

_CHOICES = {
    "cavitation": set(CAVITATION),
    "end_condition": {"pressure", "no_flow"},
    "supply": {"auto", "none", "widest_gap"},
}


@dataclass(frozen=True, kw_only=True)
class JournalDefinition:
    """What is known of a journal bearing before its film is solved.

    The fields are the parameters of :class:`~toothspace.films.journal.bearing.JournalBearing`.
    """

    diameter: float
    length: float
    radial_clearance: float
    dynamic_viscosity: float
    grid: tuple[int, int] = (200, 53)
    cavitation: str = "jfo"
    grooves: tuple[Groove, ...] = ()
    end_pressure: float = ATMOSPHERIC_PRESSURE
    cavitation_pressure: float = ATMOSPHERIC_PRESSURE
    end_condition: str = "pressure"
    surfaces: RoughSurfaces | None = None
    lobes: Lobes | None = None
    supply: str = "auto"
    pressure_viscosity: float = 0.0
    compressible: bool = False

    def __post_init__(self) -> None:
        for key in ("diameter", "length", "radial_clearance", "dynamic_viscosity"):
            value = getattr(self, key)
            if not (isinstance(value, Real) and float(value) > 0.0):
                raise CaseError(f"bearing.{key}", f"{value!r}", "are positive SI numbers")
        for key, allowed in _CHOICES.items():
            value = getattr(self, key)
            if value not in allowed:
                raise CaseError(f"bearing.{key}", f"{value!r}", f"are {sorted(allowed)}")
        for groove in self.grooves:
            if abs(groove.position) >= 0.5 * (self.length + groove.length):
                raise CaseError(
                    "bearing.grooves.position",
                    f"{1000.0 * groove.position:g} mm",
                    f"are grooves on the bearing of {1000.0 * self.length:g} mm",
                )
        if np.shape(self.grid) != (2,) or min(self.grid) < 4:
            raise CaseError("bearing.grid", f"{self.grid!r}", "are 4 cells or more")
        check_grid("bearing.grid", self.grid)
        object.__setattr__(self, "grooves", tuple(self.grooves))

    @property
    def fluid(self) -> FilmFluid:
        """Liquid of the film."""
        return FilmFluid(self.dynamic_viscosity, self.pressure_viscosity, self.compressible)
