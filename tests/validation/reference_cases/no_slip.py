"""Kalker's coefficients by another way: rolling without slip on elliptic half-spaces.

Tractions p = (l(y) - x)/√(1 - x² - y²) times polynomials vanish at the leading edge x = l(y) as
they must. Their displacements follow by Gauss and Chebyshev's rule along each chord of the
ellipse through a point and a trapezoidal sum over the chords' directions; the coefficients of the
polynomials from u_x = ξ x - φ x y + f(y), u_y = η x + φ x²/2 + g(y) by least squares. Everything
is in units of c = √(a b) and the shear modulus.
"""

from __future__ import annotations

import numpy as np

CHORD, DIRECTIONS, RADII, ANGLES = 32, 48, 9, 18


def no_slip_coefficients(axis_ratio, poissons_ratio, degree=8):
    """Return C11, C22, C23 and C33 of a contact."""
    a, b = axis_ratio**0.5, axis_ratio**-0.5
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    x, y, weight = _points()
    kernels = _kernels(a, b, poissons_ratio, powers, x, y)
    moments = _moments(a, b, powers)
    found = {}
    for odd in (0, 1):
        px = [k for k, p in enumerate(powers) if p[1] % 2 == odd]
        py = [k for k, p in enumerate(powers) if p[1] % 2 != odd]
        free = [y**j for j in range(degree + 2)]
        fx, fy = free[odd::2], free[1 - odd :: 2]
        nothing = 0.0 * y
        columns = [np.concatenate([kernels[k, 0], kernels[k, 1]]) for k in px]
        columns += [np.concatenate([kernels[k, 1], kernels[k, 2]]) for k in py]
        columns += [np.concatenate([f, nothing]) for f in fx]
        columns += [np.concatenate([nothing, f]) for f in fy]
        root = np.sqrt(np.concatenate([weight, weight]))
        matrix = np.array(columns).T * root[:, None]
        cases = {"spin": (-a * b * x * y, 0.5 * (a * x) ** 2), "lateral": (nothing, a * x)}
        if odd == 0:
            cases = {"longitudinal": (a * x, nothing)}
        for name, sides in cases.items():
            solved = np.linalg.lstsq(matrix, np.concatenate(sides) * root, rcond=1e-12)[0]
            u, v = solved[: len(px)], solved[len(px) : len(px) + len(py)]
            force_x, force_y = u @ moments[px, 0], v @ moments[py, 0]
            found[name] = force_x, force_y, v @ moments[py, 1] - u @ moments[px, 2]
    return -np.array(
        [found["longitudinal"][0], found["lateral"][1], found["spin"][1], found["spin"][2]]
    )


def _points():
    """Return points of the half disc and their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(RADII)
    radius = np.repeat(0.5 * (nodes + 1.0), ANGLES)
    angle = np.tile((np.arange(ANGLES) + 0.5) / ANGLES * np.pi, RADII)
    return radius * np.cos(angle), radius * np.sin(angle), np.repeat(weights, ANGLES) * radius


def _kernels(a, b, nu, powers, x, y):
    """Return A_xx, A_xy, A_yy of every power at every point, shape (n_powers, 3, n_points)."""
    angle = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS * np.pi
    ux, uy = np.cos(angle), np.sin(angle)
    length = np.hypot(a * ux, b * uy)
    cx, cy = a * ux / length, b * uy / length
    measure = a * b / length / DIRECTIONS
    middle = -(x[:, None] * ux + y[:, None] * uy)
    half = np.sqrt(middle**2 - (x**2 + y**2 - 1.0)[:, None])
    steps = np.cos((np.arange(CHORD) + 0.5) / CHORD * np.pi)
    along = middle[..., None] + half[..., None] * steps
    xs = x[:, None, None] + along * ux[:, None]
    ys = y[:, None, None] + along * uy[:, None]
    base = np.pi / CHORD * (np.sqrt(np.maximum(1.0 - ys**2, 0.0)) - xs)
    stiffness = np.array([1.0 - nu + nu * cx**2, nu * cx * cy, 1.0 - nu + nu * cy**2]) * measure
    return np.array(
        [(base * xs**i * ys**j).sum(axis=-1) @ stiffness.T for i, j in powers]
    ).swapaxes(1, 2)


def _moments(a, b, powers, count=100):
    """Return force, moment x p and moment y p of every power."""
    angle = (np.arange(count) + 0.5) / count * np.pi
    y = np.sin(angle - 0.5 * np.pi)[:, None]
    half = np.sqrt(1.0 - y**2)
    x = half * np.cos(angle)
    weight = half * (np.pi / count) ** 2 * (half - x)
    parts = [weight * x**i * y**j for i, j in powers]
    return np.array([[p.sum(), (a * x * p).sum(), (b * y * p).sum()] for p in parts])
