"""Tables, grids, linear and nonlinear solvers; knows no physics."""
