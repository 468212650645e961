"""Stand-alone thin-film bearings and pads."""
