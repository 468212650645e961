"""Films on the faces of gears and rotors, and the bearings that float on them.

=================  ======================================================================
module             responsibility
=================  ======================================================================
rigid_faces        films on one face of every body of a machine, at one shaft angle
conductance        conductances and supporting areas of the films on a face over the shaft angle
shared_paths       flow paths from those of covers that several bodies share
resting_covers     bodies that float between two covers: the stack of their films
face_grid          polar grids on the faces, masked at every shaft angle
face_film          one film of the stack: solution, forces and their variation
local_deformation  gap of faces that deform locally under film and asperity pressure
compliant_film     Newton's method for pressure, cavity and gap of such a film
basis_functions    smooth functions of radius and angle for slow parts of the deformation
elastic_faces      deformation of elastic bearings and gears under all lateral films
deformation        deformation by distant pressures within a step
stack              positions of bearings and gears, films between them, forces on them
stops              covers, walls and journals that limit lift and tilt
housing_friction   friction of a floating bearing in its housing
motion             one implicit step of bearings and gears
relaxation         way to the equilibrium of bodies that tilt
equilibrium        equilibrium of bearings and gears, whether it is stable, and a revolution
=================  ======================================================================
"""
