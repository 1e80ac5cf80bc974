"""How large a number may be that a motion starts from."""

COARSEST_START = 2.0**-27
"""Largest distance between neighbouring numbers at a start, in SI units: about a hundredth of a
micrometre, and a hundred times the finest tolerance that makes sense."""
LARGEST_START = 2.0**26
"""Largest number whose neighbours are that close [SI]."""
