"""Checks of a system file as a whole: names and units, structure, inertias."""
