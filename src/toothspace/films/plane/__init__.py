"""Films between nearly parallel faces, those of gears and rotors among them.

============  ==========================================================================
module        responsibility
============  ==========================================================================
film          solution on a given grid, loads and rigid motions
pad           rectangular pads: inclined, stepped, with a pocket or of any shape
ring          film between a rotating and a fixed face on a polar grid, masked by given pressures
conductance   conductances and supporting areas of the films on a face over the shaft angle
============  ==========================================================================
"""
