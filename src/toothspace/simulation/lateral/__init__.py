"""Lateral films of a machine coupled with its chambers.

=============  ======================================================================
module         responsibility
=============  ======================================================================
problem        films and floating bearings at given chamber pressures
loads          loads on faces and elastic bodies over the shaft angle, from a lumped run
coupling       chamber pressures and lateral films iterated until they agree
interpolation  equilibrium at chamber pressures between those of two lumped runs
torque         torque of the films in the equations of the lumped machine
heat           films whose viscosity follows the heat that they dissipate
coupled_run    a coupled operating point over one revolution, as a solution
reduction      films over axial load and moment, for tables
=============  ======================================================================
"""
