"""Bulk temperature of a film: friction heats the oil, which lowers its viscosity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar, final

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.units import ZERO_CELSIUS
from toothspace.numerics.roots import root_between

_HIGHEST_RISE = 400.0
"""Largest rise of the mean temperature that is searched. [K]"""
_FIRST_RISE = 12.5
"""Rise that is tried first, so that no temperature far beyond the answer is asked for. [K]"""


class HeatedBody(Protocol):
    """What a heat balance needs of a solved film: a journal, pad or ring, or faces together."""

    @property
    def dissipated_power(self) -> float:
        """Power that becomes heat in the film. [W]."""

    @property
    def outflow(self) -> float:
        """Flow that carries it away. [m3/s]."""

    @property
    def status(self) -> Status:
        """Whether the film was found."""


Film = TypeVar("Film", bound=HeatedBody)


@final
@dataclass(frozen=True, kw_only=True)
class HeatBalance:
    r"""How the power that a film dissipates heats the oil that flows through it.

    Parameters
    ----------
    supply_temperature : float
        Absolute temperature of the oil that enters. [K]
    density : float
        Density of the oil. [kg/m3]
    heat_capacity : float
        Specific heat capacity of the oil. [J/(kg K)]
    oil_share : float
        Part of the dissipated power that the oil carries away: 1 adiabatic walls, 0 isothermal
        film. [-]
    highest_temperature : float
        Temperature up to which the viscosity is known. [K]

    Notes
    -----
    The oil leaves at :math:`T_{out} = T_{in} + \lambda P / (\rho c Q)`; the viscosity is that of
    the mean temperature :math:`(T_{in} + T_{out}) / 2`. P is the work of the moving walls and of
    the pressures at the edges, so oil that is throttled warms by :math:`\Delta p / (\rho c)`.
    Validity: one temperature for the whole film, steady state, thermal expansion without work.

    References
    ----------
    .. [1] DIN 31652-1, Hydrodynamic plain journal bearings under steady-state conditions
       (effective temperature as mean of supply and outlet).
    """

    supply_temperature: float
    density: float
    heat_capacity: float
    oil_share: float = 1.0
    highest_temperature: float = float("inf")

    def outlet_temperature(self, film: HeatedBody) -> float:
        """Temperature of the oil that leaves. [K]."""
        if self.oil_share == 0.0:
            return self.supply_temperature
        if film.outflow <= 0.0:
            raise CaseError(
                "heat",
                f"an outflow of {film.outflow:.3g} m3/s",
                "are films that oil flows out of (side flow of a bearing)",
            )
        capacity = self.density * self.heat_capacity * film.outflow
        return self.supply_temperature + self.oil_share * film.dissipated_power / capacity


@final
@dataclass(frozen=True, eq=False)
class FilmHeating:
    """Oil of films that are heated by what they dissipate."""

    balance: HeatBalance
    """Properties of the oil and share of the heat."""
    viscosity: Callable[[float], float]
    """Dynamic viscosity at an absolute temperature, falling with it. [K to Pa s]"""


@final
@dataclass(frozen=True)
class HeatedFilm(Generic[Film]):
    """Film at the viscosity of its own temperature."""

    film: Film
    """Film at the mean temperature."""
    dynamic_viscosity: float
    """Viscosity at the mean temperature. [Pa s]"""
    mean_temperature: float
    """Temperature that sets the viscosity. [K]"""
    outlet_temperature: float
    """Temperature of the oil that leaves. [K]"""
    status: Status
    """Status of the film."""


def solve_heated(
    solve: Callable[[float], Film], viscosity: Callable[[float], float], balance: HeatBalance
) -> HeatedFilm[Film]:
    """Find the mean temperature at which dissipated power and heat flow of the oil agree.

    Parameters
    ----------
    solve : callable
        Film at a dynamic viscosity. [Pa s]
    viscosity : callable
        Dynamic viscosity at an absolute temperature, falling with it. [K to Pa s]
    balance : HeatBalance
        Properties of the oil and share of the heat.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from toothspace.films import JournalBearing
    >>> bearing = JournalBearing(
    ...     diameter=0.1, length=0.08, radial_clearance=1e-4, dynamic_viscosity=0.03, grid=(48, 9)
    ... )
    >>> heated = solve_heated(
    ...     lambda mu: replace(bearing, dynamic_viscosity=mu).solve(
    ...         eccentricity=(0.6, 0.0), shaft_speed=150.0
    ...     ),
    ...     lambda temperature: 0.03 * 2.718 ** (-0.035 * (temperature - 313.0)),
    ...     HeatBalance(supply_temperature=313.0, density=870.0, heat_capacity=1900.0),
    ... )
    >>> 315.0 < heated.mean_temperature < 330.0
    True
    """
    first = balance.supply_temperature

    def mismatch(temperature: float) -> float:
        outlet = balance.outlet_temperature(solve(viscosity(temperature)))
        return 0.5 * (first + outlet) - temperature

    if mismatch(first) <= 0.0:
        mean = first
    else:
        # rise of the mean temperature that is more than the film asks for. [K]
        most = min(_HIGHEST_RISE, balance.highest_temperature - first)
        rise = min(_FIRST_RISE, most)
        while mismatch(first + rise) > 0.0:
            if rise >= most:
                raise CaseError(
                    "heat",
                    f"a mean temperature beyond {first + most - ZERO_CELSIUS:.0f} degC",
                    "are films within the range of the fluid: take more flow, less speed or a "
                    "smaller oil_share",
                )
            rise = min(2.0 * rise, most)
        mean = root_between(mismatch, first, first + rise, 1e-6)
    film = solve(viscosity(mean))
    outlet = balance.outlet_temperature(film)
    return HeatedFilm(film, viscosity(mean), mean, outlet, film.status)
