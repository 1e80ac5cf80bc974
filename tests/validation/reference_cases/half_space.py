"""Normal contact of half-spaces without any further assumption, by boundary elements.

Pressures are constant on the rectangles of a grid; displacements are their convolution with the
closed form of one rectangle (Love 1929), taken by fast Fourier transforms. The pressures are those
which make the displacement the given overlap where they are above zero, found by conjugate
gradients that let go and take up rectangles (Polonsky, Keer 1999, Wear 231, 206-219).
"""

from __future__ import annotations

import numpy as np
from scipy.fft import irfft2, rfft2

_MOST_STEPS = 400
_FEWEST_STEPS = 20
_ACCURACY = 1e-9  # m


def pressures(overlap, width, length, modulus):
    """Return pressures under an overlap of undeformed bodies on a grid, shape (n, m) [Pa].

    Parameters
    ----------
    overlap
        Overlap of the undeformed surfaces, negative where they are apart, shape (n, m) [m].
    width, length
        Sides of a rectangle along both directions of the grid [m].
    modulus
        E* of both bodies [N/m²].
    """
    n, m = overlap.shape
    transform = rfft2(_influence(n, m, width, length) / (np.pi * modulus))

    def displacement(pressure):
        return irfft2(rfft2(pressure, s=(2 * n, 2 * m)) * transform, s=(2 * n, 2 * m))[:n, :m]

    pressure = np.maximum(overlap, 0.0) * modulus / 1e-2
    direction, previous, conjugate = np.zeros_like(pressure), 1.0, 0.0
    for step in range(_MOST_STEPS):
        rest = displacement(pressure) - overlap
        held = pressure > 0.0
        size = float(np.sum(rest[held] ** 2))
        direction = np.where(held, rest + conjugate * size / previous * direction, 0.0)
        previous = size
        moved = displacement(direction)[held]
        length_of_step = float(rest[held] @ direction[held]) / float(moved @ direction[held])
        pressure = np.maximum(pressure - length_of_step * direction, 0.0)
        missed = (pressure == 0.0) & (displacement(pressure) < overlap)
        conjugate = 0.0 if missed.any() else 1.0
        pressure[missed] -= length_of_step * rest[missed]
        pressure = np.maximum(pressure, 0.0)
        if step > _FEWEST_STEPS and not missed.any() and np.abs(rest[held]).max() < _ACCURACY:
            return pressure
    raise AssertionError("boundary elements: the pressures are not found")


def _influence(n, m, width, length):
    """Return the displacement beside a rectangle under a unit pressure, times π E*."""
    x = width * np.fft.fftfreq(2 * n, 0.5 / n)[:, None]
    y = length * np.fft.fftfreq(2 * m, 0.5 / m)[None, :]

    def corner(x, y):
        return x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))

    a, b = 0.5 * width, 0.5 * length
    return corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b)
