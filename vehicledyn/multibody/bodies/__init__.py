"""Deformable bodies: shapes, sections and how the recursions see them."""
