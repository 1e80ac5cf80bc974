"""Simulation of a scenario into a result file."""
