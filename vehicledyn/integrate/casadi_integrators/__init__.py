"""Integrators that come with CasADi, on the compiled rates, with events between their steps."""
