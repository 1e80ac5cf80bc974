"""Numbers without mechanics: splines, interpolation keeping shapes, quaternions, quarter turns."""
