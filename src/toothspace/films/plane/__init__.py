"""Films between nearly parallel faces.

======  ==========================================================================
module  responsibility
======  ==========================================================================
film    solution on a given grid, loads and rigid motions
pad     rectangular pads: inclined, stepped, with a pocket or of any shape
ring    film between a rotating and a fixed face on a polar grid, masked by given pressures
======  ==========================================================================
"""
