"""Limit cycles: periodic orbits by collocation, followed along a parameter, with their stability.

From an equilibrium that begins to oscillate (:mod:`.critical`) or from a simulated motion
(:mod:`.settled`) an orbit is found (:mod:`.collocation`) and followed by pseudo-arclength
continuation (:mod:`.branch`); :mod:`.floquet` determines its stability.
"""
