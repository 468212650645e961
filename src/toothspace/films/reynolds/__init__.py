"""Average-flow Reynolds equation on structured grids.

==============  =====================================================================
module          responsibility
==============  =====================================================================
equation        from gap heights to cell balances, and their variation with the gap
state           pressure, film fraction and liquid of a film of given gap, and their change
fluid           viscosity and density that follow the pressure, models of cavitation
rough_surfaces  average flow, asperity contact and boundary friction of rough walls
active_set      balance of a film between deformable walls, linearised on its active set
==============  =====================================================================
"""
