"""Equilibrium, eigenmodes and frequency responses of models."""
