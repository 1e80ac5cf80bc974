"""From a scenario to a compiled model at its start."""
