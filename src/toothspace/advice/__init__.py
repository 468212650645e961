"""Design rules, limits, strength and findings, computed on request."""
