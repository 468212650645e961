"""Liquid of a film, whose viscosity and density follow the pressure, and models of cavitation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from toothspace.closures.density import dowson_higginson_density
from toothspace.closures.viscosity import barus_viscosity
from toothspace.core.compiled import inlined
from toothspace.core.types import Array
from toothspace.films.reynolds.equation import FilmGrid, FluidField
from toothspace.numerics.complementarity import Constraint

HIGHEST_EXPONENT = 20.0
"""Logarithm of the viscosity ratio beyond which Barus' law is not followed. [-]"""


class ReducedLaw(NamedTuple):
    """Pressure over the reduced pressure, for compiled code."""

    coefficient: float  # pressure-viscosity coefficient, 0 if they are the same [1/Pa]
    limit: float  # reduced pressure up to which the viscosity grows [Pa]
    beyond: float  # change of the pressure over that of the reduced one beyond it [-]
    floor: float  # reduced cavitation pressure [Pa]
    lowest: float  # cavitation pressure [Pa]


@inlined
def pressure_above(potential: float, law: ReducedLaw) -> tuple[float, float]:
    """Pressure above the lowest one from a potential, and its change with it. [Pa, -]."""
    if law.coefficient == 0.0:
        return potential, 1.0
    reduced = potential + law.floor
    over = max(reduced - law.limit, 0.0)
    left = -law.coefficient * (reduced - over)
    pressure = -math.log1p(left) / law.coefficient + over * law.beyond
    return pressure - law.lowest, 1.0 / (1.0 + left)


@final
@dataclass(frozen=True)
class FilmFluid:
    r"""Liquid whose viscosity and density may follow the pressure.

    Parameters
    ----------
    dynamic_viscosity : float
        Dynamic viscosity at zero pressure. [Pa s]
    pressure_viscosity : float
        Coefficient :math:`\alpha` of :func:`~toothspace.closures.viscosity.barus_viscosity`. [1/Pa]
    compressible : bool
        Whether the density follows
        :func:`~toothspace.closures.density.dowson_higginson_density`.
    limit_pressure : float
        Pressure beyond which the viscosity grows no further. [Pa]

    Notes
    -----
    Films are solved for the reduced pressure :math:`q = \int_0^p \mu_0/\mu \, dp =
    (1 - e^{-\alpha p}) / \alpha`, for which the viscosity is constant: one linear problem
    instead of an iteration. Without a limit pressure it cannot exceed :math:`1 / \alpha`; a film
    that asks for more has no solution, its pressure would grow without bound.

    References
    ----------
    .. [1] C. Barus, Isothermals, isopiestics and isometrics relative to viscosity, Am. J. Sci.
       45 (1893) 87-96.
    .. [2] D. Dowson, G. R. Higginson, Elasto-hydrodynamic Lubrication, Pergamon, 1966.
    """

    dynamic_viscosity: float
    pressure_viscosity: float = 0.0
    compressible: bool = False
    limit_pressure: float = np.inf

    def viscosity(self, pressure: Array) -> Array:
        """Dynamic viscosity at absolute pressures. [Pa s]."""
        if self.pressure_viscosity == 0.0:
            return np.full_like(pressure, self.dynamic_viscosity)
        return np.asarray(
            barus_viscosity(
                pressure, self.dynamic_viscosity, self.pressure_viscosity, self._highest_exponent
            )
        )

    @property
    def _highest_exponent(self) -> float:
        return min(self.pressure_viscosity * self.limit_pressure, HIGHEST_EXPONENT)

    def density(self, pressure: Array) -> Array:
        """Density over that of zero pressure at absolute pressures. [-]."""
        if not self.compressible:
            return np.ones_like(pressure)
        return np.asarray(dowson_higginson_density(pressure, 1.0))

    def fields(self, pressure: Array) -> FluidField:
        """Fluid state of every cell at absolute pressures."""
        return FluidField(1.0 / self.viscosity(pressure), self.density(pressure))

    def carrier(self, density: Array) -> FluidField:
        """Fluid state of a film that is solved for the reduced pressure."""
        return FluidField(np.full_like(density, 1.0 / self.dynamic_viscosity), density)

    @property
    def highest_reduced(self) -> float:
        """Reduced pressure that no pressure exceeds, infinite with a limit pressure. [Pa]."""
        bounded = self.pressure_viscosity > 0.0 and self._highest_exponent == HIGHEST_EXPONENT
        return self._reduced_limit if bounded else np.inf

    @property
    def _reduced_limit(self) -> float:
        """Reduced pressure up to which the viscosity follows the pressure. [Pa]."""
        return float(-np.expm1(-self._highest_exponent) / self.pressure_viscosity)

    def reduced(self, pressure: Array) -> Array:
        """Reduced pressure of absolute pressures. [Pa]."""
        alpha, highest = self.pressure_viscosity, self._highest_exponent
        if alpha == 0.0:
            return pressure
        below = -np.expm1(-np.minimum(alpha * pressure, highest)) / alpha
        if highest == HIGHEST_EXPONENT:
            return np.asarray(below)
        beyond = np.maximum(pressure - self.limit_pressure, 0.0)
        return np.asarray(below + beyond * np.exp(-highest))

    def pressure(self, reduced: Array) -> Array:
        """Absolute pressure of reduced pressures; unlimited ones up to the highest. [Pa]."""
        alpha, highest = self.pressure_viscosity, self._highest_exponent
        if alpha == 0.0:
            return reduced
        limit = self._reduced_limit
        below = -np.log1p(-alpha * np.minimum(reduced, limit)) / alpha
        if highest == HIGHEST_EXPONENT:
            return np.asarray(below)
        return np.asarray(below + np.maximum(reduced - limit, 0.0) * np.exp(highest))

    def gauge(self, potential: Array, lowest: float) -> Array:
        """Pressure above a lowest one from the reduced pressure above that of the lowest. [Pa]."""
        if self.pressure_viscosity == 0.0:
            return potential
        return self.pressure(potential + self.reduced_of(lowest)) - lowest

    def reduced_of(self, pressure: float) -> float:
        """Reduced pressure of one absolute pressure. [Pa]."""
        return float(self.reduced(np.array([pressure]))[0])

    def reduced_law(self, lowest: float) -> ReducedLaw:
        """Law from potentials above a lowest pressure [Pa] to pressures above it."""
        alpha, highest = self.pressure_viscosity, self._highest_exponent
        if alpha == 0.0:
            return ReducedLaw(0.0, np.inf, 0.0, lowest, lowest)
        beyond = 0.0 if highest == HIGHEST_EXPONENT else float(np.exp(highest))
        return ReducedLaw(alpha, self._reduced_limit, beyond, self.reduced_of(lowest), lowest)

    def stretch(self, pressure: Array) -> Array:
        """Change of the pressure over that of the reduced pressure. [-]."""
        return self.viscosity(pressure) / self.dynamic_viscosity

    def reduced_grid(self, grid: FilmGrid) -> FilmGrid:
        """Grid whose given pressures are reduced ones."""
        if self.pressure_viscosity == 0.0:
            return grid
        return grid._replace(
            prescribed=self.reduced(grid.prescribed),
            west=self.reduced(grid.west),
            east=self.reduced(grid.east),
            south=self.reduced(grid.south),
            north=self.reduced(grid.north),
        )


CAVITATION = {
    "guembel": Constraint.NONE,
    "reynolds": Constraint.OBSTACLE,
    "jfo": Constraint.CONSERVING,
}
"""Cavitation models by name."""
