"""Tyre property files (.tir): reading, units, names and defaults of coefficients, ranges."""
