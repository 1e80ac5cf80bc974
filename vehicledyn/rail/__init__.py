"""Wheel on rail: profiles, contact geometry, creep."""
