"""Identification: parameters from measured channels, of one experiment or of several."""
