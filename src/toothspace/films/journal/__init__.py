"""Film between a shaft and its bush.

===================  ================================================================
module               responsibility
===================  ================================================================
geometry             what is known before a film is solved; its gap, integrals over it
solution             film for a given motion of the shaft: fields, loads, stiffness, damping
equilibrium          position of the shaft under a load, and its tilt under a moment
bearing              :class:`~.bearing.JournalBearing`, which solves it
shaft_motion         stability threshold and transient orbit
mixed_lubrication    friction from boundary to full film, reduced to a formula
map                  impedance maps that the machine model reads
rim_film             film round the rim of a rotor as a ring of chambers
===================  ================================================================
"""
