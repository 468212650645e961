"""Quantities written as text with a unit, converted to SI base units.

The registry holds the units of machine drawings and fluid power only, and treats the angle
as a dimension of its own: ``"25 Hz"`` is no shaft speed and ``"1 1/s"`` is no rad/s.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache
from numbers import Real
from typing import Any, NamedTuple, final

from toothspace.core.common_units import COMMON_UNITS
from toothspace.core.errors import CaseError

ATMOSPHERIC_PRESSURE = 101325.0
"""Standard atmosphere, reference of free and dissolved air fractions. [Pa]"""

ZERO_CELSIUS = 273.15
"""Ice point. [K]"""

AIR_GAS_CONSTANT = 287.05
"""Specific gas constant of dry air. [J/(kg K)]"""


_DEFINITIONS = """\
milli- = 1e-3 = m-
micro- = 1e-6 = u- = µ- = μ-
nano- = 1e-9 = n-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
metre = [length] = m = meter
second = [time] = s
kilogram = [mass] = kg
kelvin = [temperature] = K
radian = [angle] = rad
gram = 1e-3 kilogram = g
tonne = 1000 kilogram = t
inch = 0.0254 metre = in
minute = 60 second = min
hour = 3600 second = h
hertz = 1 / second = Hz
degree = 0.017453292519943295 radian = deg = °
revolution = 6.283185307179586 radian = rev
rpm = revolution / minute
degree_Celsius = kelvin; offset: 273.15 = degC
degree_Fahrenheit = 5 / 9 * kelvin; offset: 255.3722222222222 = degF
newton = kilogram * metre / second ** 2 = N
pascal = newton / metre ** 2 = Pa
bar = 1e5 pascal
psi = 6894.757293168361 pascal
atmosphere = 101325 pascal = atm
joule = newton * metre = J
watt = joule / second = W
litre = 1e-3 metre ** 3 = L = l = liter
stokes = 1e-4 metre ** 2 / second = St
poise = 0.1 pascal * second = P
"""

_NUMBER = re.compile(
    r"\s*([+-]?(?:(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|nan|inf(?:inity)?))\s*(.*?)\s*",
    re.IGNORECASE | re.DOTALL,
)
_A_UNIT = "one such as mm, bar, rpm, L/min, degC"
_LONGEST_TEXT = 100
"""Longer texts are no quantity: reading a product takes time with the number of its factors."""

_EXPONENT = r"(?:\s*(?:\^|\*\*)\s*-?\d(?!\s*[\d.^]|\s*\*\*))"
_FACTOR = rf"(?:[A-Za-zµμ°]+[²³]?{_EXPONENT}?|1(?![\d.]))"
_UNIT_TEXT = re.compile(rf"(?:{_FACTOR}|\){_EXPONENT}?|[·*/(\s])*")
"""Names, the number 1 and groups, each with at most one exponent of one digit."""
_NAMES = {
    "m": "a length",
    "m ** 2": "an area",
    "m ** 3": "a volume",
    "rad": "an angle",
    "rad / s": "an angular speed",
    "m / s": "a speed",
    "s": "a time",
    "K": "a temperature",
    "kg": "a mass",
    "kg * m ** 2": "a moment of inertia",
    "kg / m / s ** 2": "a pressure",
    "kg / m / s": "a dynamic viscosity",
    "m * s ** 2 / kg": "an inverse pressure",
    "kg * m / s ** 2": "a force",
    "kg * m ** 2 / s ** 2": "a torque",
    "m ** 3 / rad": "a displacement",
    "m ** 3 / s": "a flow",
    "kg * m / K / s ** 3": "a thermal conductivity",
    "kg * m ** 2 / K / s ** 3": "a heat flow per temperature difference",
    "kg * m ** 2 / K / s ** 2": "a heat capacity",
}


@cache
def _registry() -> Any:
    import pint

    registry = pint.UnitRegistry(None, autoconvert_offset_to_baseunit=True)
    registry.load_definitions(_DEFINITIONS.splitlines())
    return registry


@cache
def _unit(text: str) -> Any:
    if len(text) > _LONGEST_TEXT or not _UNIT_TEXT.fullmatch(text):
        if text.startswith(","):
            raise CaseError("", f"a comma, for a decimal point, before the unit {text!r}", _A_UNIT)
        raise CaseError("", f"an unknown unit {_short(text)!r}", _A_UNIT)
    try:
        # alone, the sign is that of an angle
        plain = text.replace("·", "*").replace("°C", "degC").replace("°F", "degF")
        return _registry().Unit(plain)
    except Exception as error:
        raise CaseError("", f"an unknown unit {text!r}", _A_UNIT) from error


class UnitFacts(NamedTuple):
    """What conversions need to know of a unit."""

    factor: float
    offset: float
    """To SI base units: value times factor plus offset."""
    dimension: str
    """Exponents of the dimensions, such as ``length1 time-1``."""
    base: str
    """SI base unit of what it measures, such as ``kg/m/s**2``."""


def registry_facts(unit: str) -> UnitFacts:
    """Facts of a unit as the registry of Pint finds them."""
    found, registry = _unit(unit), _registry()
    try:
        zero = registry.Quantity(0.0, found).to_root_units().magnitude
        one = registry.Quantity(1.0, found).to_root_units().magnitude
    except ArithmeticError as error:
        raise CaseError("", f"an unknown unit {unit!r}", _A_UNIT) from error
    powers = sorted(found.dimensionality.items())
    dimension = " ".join(f"{name.strip('[]')}{power:g}" for name, power in powers)
    base = f"{registry.get_base_units(found)[1]:~C}"
    return UnitFacts(float(one - zero), float(zero), dimension, base)


@cache
def _facts(unit: str) -> UnitFacts:
    known = COMMON_UNITS.get(unit)
    return registry_facts(unit) if known is None else UnitFacts(*known)


@cache
def dimension_name(unit: str) -> str:
    """Return the name of what a unit measures, with its article, for messages."""
    for known, name in _NAMES.items():
        if compatible(known, unit):
            return name
    return f"a value in {unit}"


def to_si(value: float, unit: str) -> float:
    """Convert a number in a unit to SI base units (angles in rad).

    The same quantity. [SI unit]

    Parameters
    ----------
    value : float
        Number. [unit]
    unit : str
        Unit as written in a case file, for example ``"cm^3/rev"``.

    Examples
    --------
    >>> to_si(200.0, "bar")
    20000000.0
    """
    factor, offset, *_ = _facts(unit)
    return value * factor + offset


def from_si(value: float, unit: str) -> float:
    """Convert an SI number to a unit; the inverse of :func:`to_si`. [unit]."""
    factor, offset, *_ = _facts(unit)
    return (value - offset) / factor


def format_si(value: float, unit: str) -> str:
    """Write an SI number as text in a unit, short enough for a message."""
    return f"{from_si(value, unit):.10g} {unit}"


def exact_text(value: float, unit: str) -> str:
    """Write an SI number as the shortest text in a unit that reads back to the same number."""
    shown = from_si(value, unit)
    for digits in range(6, 18):
        text = f"{shown:.{digits}g}"
        if to_si(float(text), unit) == value:
            return f"{text} {unit}"
    for number in (math.nextafter(shown, -math.inf), math.nextafter(shown, math.inf)):
        if to_si(number, unit) == value:
            return f"{number!r} {unit}"
    return f"{value!r} {si_unit(unit)}"


def si_unit(unit: str) -> str:
    """Return the SI base unit of what a unit measures, such as ``kg/m/s**2``."""
    return _facts(unit).base


@final
@dataclass(frozen=True)
class Quantity:
    """A number with its unit, for keys of a case in Python.

    Parameters
    ----------
    value : float
        Number. [unit]
    unit : str
        Unit as in a case file, such as ``"mm"`` or ``"rpm"``.

    Raises
    ------
    CaseError
        If the unit is unknown or the number not finite.

    Examples
    --------
    >>> Quantity(3.0, "mm").si
    0.003
    >>> Quantity(0.2, "MPa").to("bar")
    2.0
    """

    value: float
    unit: str

    def __post_init__(self) -> None:
        if not isinstance(self.value, Real) or not isinstance(self.unit, str):
            found = f"{self.value!r}, {self.unit!r}"
            raise CaseError("", found, "a number and the text of a unit")
        split_quantity(str(self))

    def __str__(self) -> str:
        return f"{float(self.value)!r} {self.unit}"

    @property
    def si(self) -> float:
        """The quantity in SI base units, angles in rad. [SI unit]."""
        return to_si(self.value, self.unit)

    def to(self, unit: str) -> float:
        """Return the number in another unit of the same dimension. [unit].

        Raises
        ------
        CaseError
            If the unit measures something else.
        """
        return from_si(parse_quantity(str(self), unit), unit)


def as_text(raw: Any) -> Any:
    """Return quantities as text with their unit, anything else as it is.

    Quantities are :class:`Quantity` and what else has a magnitude and units, such as those of
    Pint; numbers of NumPy become those of Python.
    """
    if isinstance(raw, Quantity):
        return str(raw)
    if hasattr(raw, "magnitude") and hasattr(raw, "units"):
        return f"{float(raw.magnitude)!r} {raw.units:~C}"
    return raw.item() if hasattr(raw, "item") and getattr(raw, "ndim", 1) == 0 else raw


def split_quantity(text: str) -> tuple[float, str]:
    """Split a text such as ``"2.75 mm"`` into its number and its unit.

    Raises CaseError if it is no finite number with a known unit.
    """
    match = _matched(text)
    if match is None or not match[2] or not math.isfinite(float(match[1])):
        raise CaseError("", repr(text), "a number with its unit, such as '1 mm'")
    _facts(match[2])
    return float(match[1]), match[2]


def _matched(text: str) -> re.Match[str] | None:
    return _NUMBER.fullmatch(text) if len(text) <= _LONGEST_TEXT else None


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST_TEXT else f"{text[:_LONGEST_TEXT]}..."


def compatible(unit: str, other: str) -> bool:
    """Tell whether two units measure the same thing."""
    return _facts(unit).dimension == _facts(other).dimension


def is_quantity(value: object) -> bool:
    """Tell whether a value is a text of a number with a unit."""
    try:
        return isinstance(value, str) and bool(split_quantity(value))
    except CaseError:
        return False


def parse_quantity(text: str, unit: str, allowed: str = "") -> float:
    """Read a number with a unit, such as ``"2.75 mm"``.

    The quantity. [SI unit]

    Raises CaseError if the text is no finite number with a unit of that dimension.

    Parameters
    ----------
    text : str
        Number, space, unit.
    unit : str
        A unit of the wanted dimension. A displacement (``cm^3/rev``) may also be written as
        a volume, then per revolution.
    allowed : str
        What the message says is allowed; by default the dimension and an example.
    """
    example = allowed or f"{dimension_name(unit)} with its unit, such as '1 {unit}'"
    match = _matched(text)
    if match is None:
        raise CaseError("", repr(_short(text)), example)
    number, found = float(match[1]), match[2]
    if not math.isfinite(number):
        raise CaseError("", f"{text!r}, which is not a finite number", example)
    if not found:
        raise CaseError("", f"{text!r} without a unit", example)
    try:
        if dimension_name(unit) == "a displacement" and dimension_name(found) == "a volume":
            found = f"({found})/rev"
        fits = compatible(found, unit)
    except CaseError as error:
        found = f"{error.problems[0].found} in {text!r}"
        raise CaseError("", found, example) from error
    if not fits:
        raise CaseError("", f"{text!r}, {dimension_name(found)}", example)
    value = to_si(number, found)
    if not math.isfinite(value):
        raise CaseError("", f"{text!r}, which is too large", example)
    return value
