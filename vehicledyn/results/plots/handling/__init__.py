"""Figures of handling: steady cornering, yaw moments, limits, and the standards' tests."""
