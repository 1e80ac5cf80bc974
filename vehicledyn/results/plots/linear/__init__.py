"""Figures of eigenvalues, modes and frequency responses."""
