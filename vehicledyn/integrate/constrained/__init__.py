"""Implicit steps on the residuals of constrained motion: index 3 and stabilised index 2."""
