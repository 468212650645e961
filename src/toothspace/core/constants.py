"""Physical constants and reference states."""

from __future__ import annotations

ATMOSPHERIC_PRESSURE = 101325.0
"""Standard atmosphere, reference of free and dissolved air fractions. [Pa]"""

ZERO_CELSIUS = 273.15
"""Ice point. [K]"""

AIR_GAS_CONSTANT = 287.05
"""Specific gas constant of dry air. [J/(kg K)]"""
