"""Handling of road vehicles: steady cornering without time simulation, and the standards' tests."""
