"""Internal gear pumps and motors with crescent."""

from toothspace.machines.crescent.describe import MACHINE

__all__ = ["MACHINE"]
