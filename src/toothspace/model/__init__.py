"""The contract between machine types and solver, and the right-hand side built from it."""
