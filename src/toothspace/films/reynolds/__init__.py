"""Average-flow Reynolds equation on structured grids.

==============  =====================================================================
module          responsibility
==============  =====================================================================
equation        from gap heights to cell balances, and their variation with the gap
state           pressure, film fraction and liquid of a film of given gap
fluid           viscosity and density that follow the pressure
cavitation      names of the cavitation models
rough_surfaces  average flow, asperity contact and boundary friction of rough walls
linearised      change of a solved pressure with flows added to its balance
active_set      balance of a film between deformable walls, linearised on its active set
==============  =====================================================================
"""
