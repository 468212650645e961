"""First design of an internal gear pump with crescent for a displacement, pressure and speed."""

from __future__ import annotations

from toothspace.advice.gear_rules import TOOL_MODULES
from toothspace.machines.shared_tables import PROPOSED_CONDITION, PROPOSED_RUN

_VOLUME = 0.081608
"""Displacement of a turn over module^2 and face width, of the teeth below. [cm3/mm3]"""
_WIDTH = 9.85
"""Face width of the first proposal, in modules."""

_CASE = """# First design of an internal gear pump with crescent: {volume:.4g} cm3/rev,
# {pressure:.4g} bar, {speed:.4g} rpm.
# Thirteen and nineteen teeth, shifted so that they do not interfere. Every number is a proposal by
# the design rules: 'toothspace geometry' holds it against them, the page draws it and answers.
schema = 1
title = "Crescent pump, {volume:.4g} cm3/rev"

[machine]
type = "crescent"
mode = "pump"                    # or "motor"

[machine.pinion]
tooth_count = 13
module = "{module:g} mm"
pressure_angle = "27.5 deg"
profile_shift = 0.50
dedendum = 1.15
tip_diameter = "{pinion_tip:.3f} mm"    # addendum of 0.9 modules beyond the shift
tip_rounding = "{rounding:.2f} mm"
face_width = "{width:.2f} mm"    # for the displacement
normal_backlash = "{backlash:.3f} mm"    # trapped fluid passes the coast flank to the grooves
material = "steel_16CrNi4"
roughness = "0.25 um"

[machine.ring]
tooth_count = 19
profile_shift = 0.70
tip_diameter = "{ring_tip:.3f} mm"    # contact stays on the involute of the pinion
root_diameter = "{ring_root:.3f} mm"
root_fillet = "{rounding:.2f} mm"
outer_diameter = "{ring_outer:.2f} mm"
radial_clearance = "{ring_gap:.0f} um"
material = "steel_16CrNi4"
roughness = "0.25 um"

[machine.filler]
inlet_angle = "100 deg"
outlet_angle = "100 deg"
pinion_clearance = "{filler_gap:.0f} um"
ring_clearance = "{filler_gap:.0f} um"
compensation = "radial"          # the outlet presses its halves on the tips

[machine.filler.notch]           # precompression over one pitch before a space opens
length = "{notch:.2f} mm"
width = "{narrow:.2f} mm"
depth = "{narrow:.2f} mm"

[machine.ports]
inlet_start = "12 deg"           # beyond the edge of the groove at every radius
outlet_start = "12 deg"
depth = "{port_depth:.1f} mm"

[machine.relief_grooves]
closing_side_offset = "{closing:.2f} mm"    # open still where the trapped volume is smallest
opening_side_offset = "{opening:.2f} mm"    # as far as the mesh needs to part the ports
width = "{groove_width:.2f} mm"
radial_extent = "{extent:.2f} mm"
depth = "{groove_depth:.2f} mm"

[machine.journal_bearings]
diameter = "{journal:.1f} mm"
length = "{length:.1f} mm"
radial_clearance = "{journal_gap:.1f} um"    # a thousandth of the radius

[machine.lateral]
side_gap = "{side:.0f} um"    # decides the volumetric efficiency

[machine.seals]
shaft_seal_torque = "{seal:.2f} N m"

"""


def new_case(
    volume: float, pressure: float, speed: float, share: float = 1.0, step: int = 0
) -> str:
    """First design as a case file.

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
        Number of the proposal: the module is the next larger one with each.

    Returns
    -------
    str
        TOML with the reason for each number.

    Notes
    -----
    With displacement :math:`V = k m^2 b` and a face width of ten modules the module is the next
    one of which there are tools. Other lengths in the section follow it, clearances its square
    root or the diameter of the bearings.
    """
    wanted = (volume / (_VOLUME * _WIDTH)) ** (1.0 / 3.0)
    above = [module for module in TOOL_MODULES if module >= 0.97 * wanted] or [TOOL_MODULES[-1]]
    module = above[min(step, len(above) - 1)]
    size = module / 5.0
    journal = round(38.0 * size, 1)
    return (_CASE + PROPOSED_CONDITION + PROPOSED_RUN).format(
        volume=volume,
        pressure=pressure,
        speed=speed,
        module=module,
        pinion_tip=15.8 * module,
        rounding=0.04 * module,
        width=share * volume / (_VOLUME * module**2),
        backlash=max(0.1 * size**0.5, 0.04),
        ring_tip=18.4 * module,
        ring_root=22.4 * module,
        ring_outer=26.8 * module,
        ring_gap=max(80.0 * size, 15.0),
        filler_gap=max(20.0 * size**0.5, 8.0),
        notch=4.0 * module,
        narrow=0.2 * module,
        port_depth=2.0 * module,
        closing=1.04 * module,
        opening=1.168 * module,
        groove_width=2.4 * module,
        extent=2.8 * module,
        groove_depth=0.6 * module,
        journal=journal,
        length=40.0 * size,
        journal_gap=max(0.5 * journal, 4.0),
        side=max(33.0 * size**0.5, 8.0),
        seal=0.5 * size,
        port=4.0 * volume,
    )
