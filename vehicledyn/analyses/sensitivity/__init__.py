"""Derivatives of what analyses return, by the parameters of a model."""
