"""Paths of any shape over their own length, and the driver who follows them."""
