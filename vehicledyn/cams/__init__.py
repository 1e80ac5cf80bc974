"""Cams: motion laws, followers and outlines, their geometry and the gap of a contact."""
