"""Gerotor pumps and motors."""

from toothspace.machines.gerotor.describe import MACHINE

__all__ = ["MACHINE"]
