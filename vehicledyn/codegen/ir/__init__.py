"""Intermediate representation: the SX graph and the list of instructions."""
