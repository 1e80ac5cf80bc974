"""Recursions along the tree: composite and articulated bodies, inverse dynamics, substructures."""
