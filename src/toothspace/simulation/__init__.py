"""Simulation of a case: one module for each fidelity preset, and what they share.

===============  ====================================================================
module           responsibility
===============  ====================================================================
presets          the named sets of models and what each interface of a machine uses
setup            a case with its machine and fluid; operating conditions; provenance
ideal            kinematic flow and torque
run              which module simulates a case
lumped           chamber pressures until the run is cyclic, with closed-form or solved films
films            journal and lateral films of a machine solved on grids
elastic          lateral films coupled with chambers, floating bearings in balance
circuit          runs over time with a free shaft in a hydraulic circuit
running_in       how deep the gears cut into the casing, computed once and kept
film_tables      tables of reduced films in place of closed forms
shared_covers    solved films of bodies that share covers
stand_alone      the tables ``[bearing]`` and ``[film]`` of a case
:mod:`.lateral`  lateral films coupled with chambers
===============  ====================================================================
"""
