"""Curves, tooth profiles, CAD files and areas."""
