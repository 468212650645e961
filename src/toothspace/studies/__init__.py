"""Named studies."""
