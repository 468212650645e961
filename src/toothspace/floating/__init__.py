"""Floating (pressure-compensated) bearings: faces, films, bodies, balance and motion.

A bearing block or plate is pressed towards the gears by pressure on its back and held off by the
films before it. Nothing here is loaded by a run of a machine whose bearings do not float.

===================  ======================================================================
module               responsibility
===================  ======================================================================
Films between faces  ..
face_grid            polar grids on the faces, masked at every shaft angle
local_deformation    gap of faces that deform locally under film and asperity pressure
compliant_film       Newton's method for pressure, cavity and gap of such a film
face_film            one film of the stack: solution, forces and their variation
Bodies               ..
stack                positions of bearings and gears, films between them, forces on them
basis_functions      smooth functions of radius and angle for slow parts of the deformation
elastic_faces        deformation of elastic bearings and gears under all films
deformation          deformation by distant pressures within a step
body_loads           loads on faces and elastic bodies over the shaft angle, from a lumped run
Balance and motion   ..
stops                covers, walls and journals that limit lift and tilt
housing_friction     friction of a floating bearing in its housing
motion               one implicit step of bearings and gears
equilibrium          equilibrium of bearings and gears, whether it is stable, and a revolution
between_covers       bodies that float between covers that rest
Films and chambers   ..
problem              films and floating bearings at given chamber pressures
heat                 films whose viscosity follows the heat that they dissipate
torque               torque of the films in the equations of the lumped machine
interpolation        equilibrium at chamber pressures between those of two lumped runs
coupling             chamber pressures and films iterated until they agree
coupled_run          a coupled operating point over one revolution, as a solution
reduction            films over axial load and moment, for tables
===================  ======================================================================
"""
