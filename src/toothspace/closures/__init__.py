"""Formulas: one phenomenon per module, one formula per function, units in every docstring.

Every function has its equation, units, validity and source, and is what the simulator runs.

==================== ==========================================================
module               responsibility
==================== ==========================================================
fluid_law            constants of one fluid at one temperature
density              equation of state of liquid, free gas and vapour; stiffness, vapour pressure
enthalpy             energy per mass, exact for the equation of state
aeration             release, absorption and volume of gas; vapour
viscosity            over temperature and pressure
orifice              openings, and the law that every flow path obeys
gap_flow             narrow gaps, drag and shear of moving walls and faces
hydraulic_resistance throttles, coolers and valves of a circuit
accumulator          gas charge
line_friction        unsteady and turbulent friction in lines
bearing_map          journal bearing without a grid: force with derivatives
journal_friction     its torque, and friction over the Sommerfeld number
friction             start, its fading into that of running, a true state of rest
wear                 depth over load, speed and time; break-in
traction             film thickness and friction of tooth flanks
contact_cylindrical  pressure and force of curved contacts
contact_law          elastic laws with energy, damping of impacts, squeezed films
contact_rough        pressure and real area of touching asperities, also by statistics of summits
flow_factors         rough surfaces in thin films
heat_transfer        heat between oil and walls
smooth               rounded corners for time integration
==================== ==========================================================
"""
