"""Exact derivatives of what analyses compute, by parameters and start values."""
