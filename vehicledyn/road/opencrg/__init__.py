"""OpenCRG roads (curved regular grids): reading files, modifiers, evaluation."""
