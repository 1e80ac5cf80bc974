"""Cams: their tables, key figures, pictures and profiles."""
