"""Deformable bodies from finite elements: their matrices, reduction and inertia integrals."""
