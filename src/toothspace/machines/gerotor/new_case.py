"""First design of a gerotor pump for a displacement, a pressure and a speed."""

from __future__ import annotations

from toothspace.machines.shared_tables import FREE_RIPPLE, PROPOSED_CONDITION, PROPOSED_RUN

_VOLUME = 6.16
"""Displacement of a turn of the rotors below at a size of one. [cm3]"""
_SLIMMER = 0.06
"""By which the rotors become larger and shorter from one proposal to the next. [-]"""

_CASE = """# First design of a gerotor pump: {volume:.4g} cm3/rev, {pressure:.4g} bar,
# {speed:.4g} rpm.
# Six and seven teeth of trochoidal profile, lobes below the radius at which they undercut. Every
# number is a proposal by the design rules: 'toothspace geometry' holds it against them, the page
# draws it and answers.
schema = 1
title = "Gerotor pump, {volume:.4g} cm3/rev"

[machine]
type = "gerotor"
mode = "pump"                    # or "motor"

[machine.rotors]
kind = "trochoidal"
inner_tooth_count = 6            # more teeth: less ripple, more diameter
eccentricity = "{eccentricity:.3f} mm"    # half the height of a tooth
generating_radius = "{generating:.3f} mm"    # of the lobe centres
lobe_radius = "{lobe:.3f} mm"    # undercut begins at 1.2 times this
face_width = "{width:.2f} mm"    # for the displacement
tip_clearance = "{tip:.0f} um"    # wider: more leakage; closer: lobes jam when warm
material = "sintered_steel"
roughness = "0.6 um"

[machine.housing]
outer_rotor_diameter = "{outer:.2f} mm"
radial_clearance = "{bearing:.0f} um"    # two thousandths of the radius
end_condition = "no_flow"

[machine.ports]
timing = "kinematic"             # lands where the volume is largest and smallest
inner_radius = "{inside:.2f} mm"
outer_radius = "{outside:.2f} mm"

[machine.lateral]
side_gap = "{side:.0f} um"    # on each side: most of the leakage

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
        Number of the proposal: rotors are larger and shorter with each.

    Returns
    -------
    str
        TOML with the reason for each number.

    Notes
    -----
    Rotors are those of 25.2 mm generating radius in another size: lengths in the section follow
    the cube root of the displacement, clearances their square root.
    """
    size = (volume / _VOLUME) ** (1.0 / 3.0) * (1.0 + _SLIMMER * step)
    return (_CASE + PROPOSED_CONDITION + FREE_RIPPLE + PROPOSED_RUN).format(
        volume=volume,
        pressure=pressure,
        speed=speed,
        eccentricity=2.5 * size,
        generating=25.2 * size,
        lobe=8.5 * size,
        width=share * 12.0 * volume / (_VOLUME * size**2),
        tip=max(30.0 * size**0.5, 8.0),
        outer=52.0 * size,
        bearing=max(50.0 * size, 10.0),
        inside=14.2 * size,
        outside=21.7 * size,
        side=max(25.0 * size**0.5, 8.0),
        port=10.0 * volume,
    )
