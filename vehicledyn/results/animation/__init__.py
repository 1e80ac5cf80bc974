"""Animations of results: page, still picture, film."""
