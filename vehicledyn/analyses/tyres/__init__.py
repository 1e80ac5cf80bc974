"""Tyres by themselves: their curves, and fits of the Magic Formula to measured data."""
