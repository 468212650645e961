"""Floating (pressure-compensated) bearings: faces, films, bodies, balance and motion.

A bearing block or plate is pressed towards the gears by pressure on its back and held off by the
films before it. Nothing here is loaded by a run of a machine whose bearings do not float.

===================  ======================================================================
module               responsibility
===================  ======================================================================
Films between faces  ..
face_grid            polar grids on the faces, masked at every shaft angle; smooth functions there
compliant_film       film between faces that deform locally: Newton's method for pressure and gap
face_film            one film of the stack: solution, forces and their variation
Bodies               ..
stack                positions of bearings and gears, films, forces and stops on them
elastic_faces        loads on faces and elastic bodies, and their deformation under all films
deformation          deformation by distant pressures within a step
Balance and motion   ..
housing_friction     friction of a floating bearing in its housing
motion               one implicit step of bearings and gears
equilibrium          equilibrium of bearings and gears, whether it is stable, and a revolution
between_covers       bodies that float between covers that rest
Films and chambers   ..
problem              films and floating bearings at given chamber pressures
heat                 films whose viscosity follows the heat that they dissipate
torque               torque of the films in the equations of the lumped machine
coupling             chamber pressures and films iterated until they agree, over one revolution
reduction            films over axial load and moment, for tables
===================  ======================================================================
"""
