"""Formulas: one phenomenon per module, one formula per function, units in every docstring.

=================== ==========================================================
module              responsibility
=================== ==========================================================
fluid_law           constants of one fluid at one temperature
density             equation of state of liquid, free gas and vapour
bulk_modulus        stiffness of the mixture
enthalpy            energy per mass, exact for the equation of state
aeration            release, absorption and volume of gas; vapour
viscosity           over temperature and pressure
orifice             openings, and the law that every flow path obeys
gap_flow            narrow gaps, drag of moving walls
bearing_lumped      journal bearing without a grid: load and friction
bearing_map         its force as a compiled map with derivatives
traction            film thickness and friction of tooth flanks
friction            breakaway, tooth tips, faces of gears
seal                shaft seals
contact_cylindrical force, pressure and damping of curved contacts
contact_rough       pressure of touching asperities
flow_factors        rough surfaces in thin films
smooth              rounded corners for time integration
=================== ==========================================================
"""
