"""Mechanisms: kinematics along driven paths, inverse dynamics."""
