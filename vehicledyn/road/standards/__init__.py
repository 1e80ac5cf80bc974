"""Quantities of the standards of road-vehicle dynamics, computed from signals of a run."""
