"""Closure relations: one phenomenon per module, one formula per function."""
