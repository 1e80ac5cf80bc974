"""The only door to CasADi for mechanics: operations, rotations, parameters, Equations."""
