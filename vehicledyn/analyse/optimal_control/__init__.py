"""Optimal control by direct collocation on a model's own equations."""
