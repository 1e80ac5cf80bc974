"""Optimal manoeuvres: controls over time that make a motion quickest or cheapest."""
