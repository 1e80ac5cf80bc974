"""Figures of cams."""
