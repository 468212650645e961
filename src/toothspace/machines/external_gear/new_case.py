"""First design of an external gear pump for a displacement, a pressure and a speed."""

from __future__ import annotations

import math

from toothspace.advice.gear_rules import (
    MAX_BEARING_PRESSURE,
    RADIAL_LOAD_COEFFICIENT,
    TOOL_MODULES,
    least_normal_backlash,
)
from toothspace.machines.shared_tables import FREE_RIPPLE, PROPOSED_CONDITION, PROPOSED_RUN

_VOLUME = 85.8
"""Displacement of a turn over module^2 and face width, of the teeth below. [-]"""
_TIP, _CENTER, _JOURNAL, _LENGTH = 14.68, 12.57, 6.55, 6.9
"""Tip diameter, centre distance, diameter and length of the bearings, in modules."""
_WIDEST, _NARROWEST = 5.0, 1.5
"""Face width in modules."""
_RUN_IN = 1.25
"""Pressure of running-in over that of the design. [-]"""
_BEARING_SHARE = 0.8
"""Of the largest specific load of the bearings, at the pressure of running-in. [-]"""

_APART = 0.02
"""By which the opening-side groove moves away from one proposal to the next, in modules."""

_CASE = """# First design of an external gear pump: {volume:.4g} cm3/rev, {pressure:.4g} bar,
# {speed:.4g} rpm.
# Twelve teeth with a profile shift that just avoids undercut. Every number is a proposal by the
# design rules: 'toothspace geometry' holds it against them, the page draws it and answers.
schema = 1
title = "External gear pump, {volume:.4g} cm3/rev"

[machine]
type = "external_gear"
mode = "pump"                    # or "motor"

[machine.gears]
tooth_count = 12                 # fewer teeth: smaller and louder
module = "{module:g} mm"{module_note}
pressure_angle = "20 deg"
profile_shift = 0.30             # undercut ends at 0.298
dedendum = 1.25                  # deep enough for play in the bearings
tool_tip_radius = 0.38
tip_diameter = "{tip:.3f} mm"    # leaves a tip land of a third of the module
tip_rounding = "0.1 mm"
face_width = "{width:.2f} mm"        # for the displacement; bearings carry up to {widest:.3g} mm
normal_backlash = "{backlash:.3f} mm"    # ISO/TR 10064-2 asks for {least:.3f} mm
material = "steel_16CrNi4"

[machine.casing]
radial_clearance = "{tip_gap:.0f} um"       # the gears lie against the low-pressure side
inlet_angle = "70 deg"           # a wide inlet fills the tooth spaces
outlet_angle = "205 deg"         # high pressure is led round: light on the bearings

[machine.casing.wear_in]         # the gears cut their track once, before delivery
pressure = "{run_in:.0f} bar"
shaft_speed = "{speed:g} rpm"
temperature = "50 degC"

[machine.bearing_blocks]
radial_clearance = "{block_gap:.0f} um"

[machine.journal_bearings]
diameter = "{journal:.1f} mm"
length = "{length:.1f} mm"           # specific load {load:.3g} MPa of {most_load:.3g} MPa
radial_clearance = "{journal_gap:.1f} um"      # a thousandth of the radius
material = "ptfe_lined_bush"

[machine.relief_grooves]         # nearer: lower peaks, more leakage; wider apart: the other way
closing_side_offset = "{groove:.2f} mm"
opening_side_offset = "{opening:.2f} mm"    # as far as the mesh needs to part the ports
width = "{reach:.1f} mm"
radial_extent = "{reach:.1f} mm"
depth = "{depth:.2f} mm"

[machine.lateral]
side_gap = "{side_gap:.1f} um"           # of pressure-balanced bushings

[machine.floating_bearing]       # used by fidelity "elastic"
material = "AlSi"
length = "{length:.1f} mm"
high_pressure_area = {{area = "{area:.0f} mm^2", center = ["{area_x:.2f} mm", "{area_y:.2f} mm"]}}
seal_preload = "100 N"

[machine.seals]
shaft_seal_torque = "{seal:.2f} N m"

"""


def new_case(
    volume: float, pressure: float, speed: float, share: float = 1.0, step: int = 0
) -> str:
    r"""First design as a case file.

    Parameters
    ----------
    volume : float
        Displacement of a turn. [cm3]
    pressure : float
        Outlet pressure. [bar]
    speed : float
        Shaft speed. [rpm]
    share : float
        Face width over that of the estimate. [-]
    step : int
        Number of the proposal: the ports are parted more with each.

    Returns
    -------
    str
        TOML with the reason for each number.

    Notes
    -----
    With displacement :math:`V = k m^2 b`, the face width :math:`b = \lambda m` is as wide as the
    bearings carry, :math:`0.85\,p\,b\,d_a = 2 d l\,p_m` at the pressure of running-in, within 1.5
    to 5 modules; the module is the next one of which there are tools. Other lengths in the section
    follow the module, clearances its square root or the diameter of the bearings. What squeezing
    raises over the outlet pressure grows as the square of speed and module: where it is more than
    at 1500 rpm, 2.75 mm and 200 bar, grooves are nearer and deeper and the backlash is wider.
    """
    run_in = _RUN_IN * pressure
    carried = _BEARING_SHARE * MAX_BEARING_PRESSURE / (run_in * 1e5)
    widest = 2.0 * _JOURNAL * _LENGTH / (RADIAL_LOAD_COEFFICIENT * _TIP) * carried
    ratio = min(max(widest, _NARROWEST), _WIDEST)
    wanted = (1e3 * volume / (_VOLUME * ratio)) ** (1.0 / 3.0)
    above = [module for module in TOOL_MODULES if module >= 0.999 * wanted]
    module = above[0] if above else TOOL_MODULES[-1]
    width = share * 1e3 * volume / (_VOLUME * module**2)
    least = 1e3 * least_normal_backlash(1e-3 * module, 1e-3 * _CENTER * module)
    journal, length, size = round(_JOURNAL * module, 1), round(_LENGTH * module, 1), module / 2.75
    journal_gap, block_gap = max(0.5 * journal, 2.0), max(25.0 * size**0.5, 8.0)
    squeezed = (speed * module / (1500.0 * 2.75)) ** 2 * 200.0 / pressure
    harder = min(max(squeezed, 1.0), 30.0)
    groove = (1.2 - 0.04 * math.log2(harder)) * module
    load = RADIAL_LOAD_COEFFICIENT * 0.1 * run_in * width * _TIP * module / (2.0 * journal * length)
    return (_CASE + PROPOSED_CONDITION + FREE_RIPPLE + PROPOSED_RUN).format(
        volume=volume,
        pressure=pressure,
        speed=speed,
        module=module,
        module_note="" if above else "            # the largest tool: the gears become wide",
        tip=_TIP * module,
        width=width,
        widest=min(widest, _WIDEST) * module,
        backlash=min((least + 0.003) * harder**0.15, 0.095 * module),
        least=least,
        tip_gap=journal_gap + block_gap + 1.0,
        run_in=run_in,
        block_gap=block_gap,
        journal=journal,
        length=length,
        journal_gap=journal_gap,
        load=load,
        most_load=1e-6 * MAX_BEARING_PRESSURE,
        groove=groove,
        opening=groove + _APART * step * module,
        reach=3.64 * module,
        depth=0.545 * module * harder**0.25,
        side_gap=max(5.2 * size**0.5, 3.0),
        area=1150.0 * size**2,
        area_x=2.4 * size,
        area_y=17.2 * size,
        seal=0.15 * journal / 18.0,
        port=max(volume, 1.0),
    )
