"""A run: machine, fluid and condition of a case, through its preset to a solution.

===============  ====================================================================
module           responsibility
===============  ====================================================================
run              a machine with a fluid at a condition, its stages, its march; presets
                 ``lumped`` and ``films``: chambers until cyclic, or over time
condition        fluid and operating condition of a case
ideal            preset: kinematic flow and torque
elastic          preset: lateral films coupled with chambers, floating bearings in balance
running_in       how deep the gears cut into the casing, computed once and kept
film_tables      tables of reduced films in place of closed forms
load_orifice     the orifice at the outlet with which the mean pressure is the asked one
solved_films     films of a machine solved on grids: journals, faces, shared covers
heating          heat network, and temperatures that the films feel where asked
stand_alone      the tables ``[bearing]`` and ``[film]`` of a case
===============  ====================================================================
"""
