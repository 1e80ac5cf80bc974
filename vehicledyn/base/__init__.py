"""Foundations that know nothing of mechanics: errors, catalogues, units, parameters."""
