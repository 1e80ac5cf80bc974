"""Expressions of files: arithmetic with units, parameters, fields that hold them."""
