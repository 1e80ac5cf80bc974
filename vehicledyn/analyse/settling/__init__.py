"""Motions that settle: cycles found by simulation, and a parameter that changes slowly."""
