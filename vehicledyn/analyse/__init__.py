"""Numerical analyses of equations: equilibrium, modes, continuation, limit cycles."""
