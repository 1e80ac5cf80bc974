"""Runs whose dependent coordinates change: where, when, and what is derived anew."""
