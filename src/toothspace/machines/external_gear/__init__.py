"""External gear pumps and motors."""

from toothspace.machines.external_gear.describe import MACHINE

__all__ = ["MACHINE"]
