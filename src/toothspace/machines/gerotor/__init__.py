"""Gerotor pumps and motors."""
