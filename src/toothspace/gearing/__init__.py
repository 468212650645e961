"""Teeth, mesh and tooth spaces of gear pairs, shared by all machines with such pairs."""
