"""Figures of scenarios that studies ask for, at any values of parameters."""
