"""Pure liquids of CoolProp as tables that a case reads."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.lazy import package_of_extra
from toothspace.core.units import ATMOSPHERIC_PRESSURE, ZERO_CELSIUS

PREFIX = "coolprop:"
"""What stands before the name of a fluid of CoolProp."""

_COLUMNS = {
    "D": "density [kg/m3]",
    "V": "dynamic_viscosity [Pa s]",
    "C": "specific_heat_capacity [J/(kg K)]",
}
_PRESSURES = (0.0, 1e7, 2e7, 3e7, 4e7, 5e7)
_STEP = 5.0
_COLDEST, _HOTTEST = -40.0, 150.0
"""Pressures [Pa], step and ends of the temperatures of the table. [K], [degC]"""


def coolprop_table(name: str) -> str:
    """Table of a pure liquid between freezing and 10 K below its boiling at one atmosphere.

    Raises CaseError if CoolProp is missing, or has no such liquid with a viscosity.

    Parameters
    ----------
    name : str
        Name in CoolProp, such as ``n-Dodecane``. [-]

    References
    ----------
    .. [1] I. H. Bell, J. Wronski, S. Quoilin, V. Lemort, "Pure and pseudo-pure fluid
       thermophysical property evaluation and the open-source thermophysical property library
       CoolProp", Ind. Eng. Chem. Res. 53, 2014, 2498-2508.
    """
    asks = f"{PREFIX}{name} asks for CoolProp"
    package = package_of_extra("CoolProp.CoolProp", "fluids", asks)

    def value(wanted: str, *state: Any) -> float:
        return float(package.PropsSI(wanted, *state, name))

    def row(celsius: float, pressure: float) -> list[str]:
        kelvin = celsius + ZERO_CELSIUS
        vapour = value("P", "T", kelvin, "Q", 0)
        # a table begins at zero, the liquid where it boils
        state = "T", kelvin, "P", max(pressure, 1.001 * vapour)
        numbers = [value(wanted, *state) for wanted in _COLUMNS]
        texts = [f"{number:.9g}" for number in [*numbers, vapour]]
        return [f"{celsius:g}", f"{1e-5 * pressure:g}", *texts]

    try:
        low = max(value("Ttriple") - ZERO_CELSIUS + 0.5, _COLDEST)
        high = min(value("T", "P", ATMOSPHERIC_PRESSURE, "Q", 0) - ZERO_CELSIUS - 10.0, _HOTTEST)
        top = value("pmax")
        levels = np.arange(np.ceil(low / _STEP) * _STEP, high + 1e-9, _STEP)
        rows = [row(float(t), p) for t in levels for p in _PRESSURES if p <= top]
    except ValueError as error:
        allowed = "a pure liquid of CoolProp with a viscosity, such as n-Dodecane or Water"
        raise CaseError(f"{PREFIX}{name}", repr(name), allowed) from error
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(
        ["temperature [degC]", "pressure [bar]", *_COLUMNS.values(), "vapour_pressure [Pa]"]
    )
    writer.writerows(rows)
    return stream.getvalue()
