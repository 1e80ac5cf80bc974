"""The equations of a system as functions that run by themselves: C, Python, MATLAB, FMU."""
