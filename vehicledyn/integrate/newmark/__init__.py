"""Newmark, HHT and generalised-alpha: on rates along closed loops and on constrained residuals."""
