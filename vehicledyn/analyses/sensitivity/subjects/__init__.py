"""Derivatives of analyses that are neither runs nor linear models nor limit cycles."""
