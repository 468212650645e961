"""Heat balance of films whose viscosity follows the temperature of the fluid of a case."""

from __future__ import annotations

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.films.thermal import HIGHEST_RISE, FilmHeating, HeatBalance
from toothspace.model.fluid import LiquidState, library_liquid, table_liquid

_FIFTIETH = 0.02
"""Accuracy of the highest temperature that a liquid is known at. [K]"""


def lateral_heating(case: Case) -> FilmHeating | None:
    """How lateral films of a machine warm up, None where they keep the temperature of the fluid.

    Parameters
    ----------
    case : Case
        Case with a fluid and ``run.film_oil_share``.
    """
    share = case.run.film_oil_share
    return film_heating(case, share) if share > 0.0 else None


def film_heating(case: Case, oil_share: float) -> FilmHeating:
    """Heat balance of a film in the fluid of a case.

    Parameters
    ----------
    case : Case
        Case with a fluid.
    oil_share : float
        Part of the dissipated power that the oil carries away. [-]
    """
    assert case.fluid is not None
    liquid = liquid_of(case)
    balance = HeatBalance(
        supply_temperature=case.fluid.temperature,
        density=liquid.density,
        heat_capacity=liquid.specific_heat_capacity,
        oil_share=oil_share,
        highest_temperature=_highest_temperature(case, case.fluid.temperature),
    )
    return FilmHeating(balance, lambda temperature: liquid_of(case, temperature).dynamic_viscosity)


def _highest_temperature(case: Case, supply: float) -> float:
    """Highest temperature that the liquid of a case is known at, by bisection. [K]."""
    known, beyond = supply, supply + HIGHEST_RISE
    while beyond - known > _FIFTIETH:
        middle = 0.5 * (known + beyond)
        try:
            liquid_of(case, middle)
        except CaseError:
            beyond = middle
        else:
            known = middle
    return float(known)


def liquid_of(case: Case, temperature: float | None = None) -> LiquidState:
    """Liquid of a case at a temperature [K], that of the case if not given."""
    assert case.fluid is not None
    given = case.fluid.temperature if temperature is None else temperature
    if case.fluid.table is not None:
        return table_liquid(case.fluid.table, given)
    return library_liquid(case.fluid.name or "", given)
