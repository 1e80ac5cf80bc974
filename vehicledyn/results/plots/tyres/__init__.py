"""Figures of tyres."""
