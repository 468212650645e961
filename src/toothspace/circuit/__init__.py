"""Circuits round a machine: one file for each family of elements, with keys, law and kernel.

============= ======================================================================
module        responsibility
============= ======================================================================
network       nodes, elements and orifices as the model sees them, and their rows
history       values over time, given in a case or in a file
restrictions  orifices, valves, coolers
lines         hoses and lines with waves
pumps         supply pumps
stores        volumes, accumulators, tanks
shaft_loads   what is on the shaft: speed or torque sources, fans, inertias, couplings
elements      all kinds of elements, all laws
circuit       ``[circuit]`` and the network that it makes
============= ======================================================================

A new element is a class in the file of its family and an entry in ``elements``; with a law of its
own, a kernel beside the class and its branch in ``elements``, too.
"""

from __future__ import annotations
