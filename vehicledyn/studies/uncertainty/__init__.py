"""Studies of how figures scatter whose parameters have distributions."""
