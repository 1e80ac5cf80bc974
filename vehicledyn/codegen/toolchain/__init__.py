"""Compiler, cache of compiled kernels, and the fingerprints by which they are found."""
