"""Studies that seek the best values of parameters."""
