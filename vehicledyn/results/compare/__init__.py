"""Comparison of results and studies with a reference."""
