"""A run: machine, fluid and condition of a case, through its preset to a solution.

===============  ====================================================================
module           responsibility
===============  ====================================================================
run              a machine with a fluid at a condition, its stages, and its march
condition        fluid and operating condition of a case
interfaces       which model each interface of a machine has, what a run leaves unused
ideal            preset: kinematic flow and torque
lumped           presets ``lumped`` and ``films``: chambers until cyclic, or over time
elastic          preset: lateral films coupled with chambers, floating bearings in balance
running_in       how deep the gears cut into the casing, computed once and kept
seats            position of bearing blocks under the pressure forces on them
film_tables      tables of reduced films in place of closed forms
solved_films     journal and lateral films of a machine solved on grids
shared_covers    solved films of bodies that share covers
heating          temperatures of oil, bodies and films, felt by the films where asked
heat_network     conductances and capacities between them
stand_alone      the tables ``[bearing]`` and ``[film]`` of a case
===============  ====================================================================
"""
