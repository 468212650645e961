"""Floating bearing of an external gear machine: its keys, its areas and the bodies that bend.

===================  ======================================================================
module               responsibility
===================  ======================================================================
floating_parameters  keys of ``[machine.floating_bearing]`` and ``[machine.elastic_bodies]``
balance              areas and forces of the bearing, films beside the gears, and all bodies
                     that bend with what acts on them in a run
elastic_bodies       gears, bearing blocks and plates as elastic bodies, loads on gear flanks
===================  ======================================================================
"""
