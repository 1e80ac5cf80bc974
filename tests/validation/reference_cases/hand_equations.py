"""Equations of the mechanisms of chapter 2 and of the tutorial, written by hand after Lagrange.

Each function returns M, c, J and γ of M q̈ + c = Jᵀ λ, J q̈ + γ = 0 in coordinates of its own,
angles and places against the world where the book has them so, and T of the relation q = T p to
the coordinates p of the system file. All bodies turn about y, with z up: a place at the distance s
on a bar at the angle a is (s cos a, 0, -s sin a), a mass hanging at the angle a is at
(-s sin a, 0, -s cos a).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
G = 9.81


@dataclass(frozen=True)
class HandEquations:
    """M, c, J and γ in coordinates q = T p."""

    mass: Array
    bias: Array
    jacobian: Array
    quadratic: Array
    transform: Array

    def in_file_coordinates(self):
        """Return the four in the coordinates p."""
        t = self.transform
        return t.T @ self.mass @ t, t.T @ self.bias, self.jacobian @ t, self.quadratic

    def solution(self):
        """Return accelerations of the coordinates p and multipliers."""
        mass, bias, jacobian, quadratic = self.in_file_coordinates()
        n, m = len(mass), len(jacobian)
        matrix = np.block([[mass, -jacobian.T], [jacobian, np.zeros((m, m))]])
        found = np.linalg.solve(matrix, -np.concatenate([bias, quadratic]))
        return found[:n], found[n:]


def _equations(mass, bias, jacobian=None, quadratic=(), transform=None):
    n = len(bias)
    return HandEquations(
        np.array(mass, dtype=float),
        np.array(bias, dtype=float),
        np.zeros((0, n)) if jacobian is None else np.array(jacobian, dtype=float),
        np.array(quadratic, dtype=float),
        np.eye(n) if transform is None else np.array(transform, dtype=float),
    )


def slider_crank_two_angles(p, time, x, v):
    """Two angles and the height of the slider, equation 2.12 with the slider's height upwards."""
    t = np.array([[1.0, 0.0], [1.0, 1.0]])
    (a, b), (u, w) = t @ x, t @ v
    r, rod, m1, m2, m3 = (
        p[k] for k in ("radius", "rod", "crank.mass", "coupler.mass", "slider.mass")
    )
    pull = (0.5 * m2 + m3) * r * rod
    mass = [
        [(m1 / 3.0 + m2 + m3) * r**2, pull * np.cos(a - b)],
        [pull * np.cos(a - b), (m2 / 3.0 + m3) * rod**2],
    ]
    bias = [
        pull * np.sin(a - b) * w**2 - (0.5 * m1 + m2 + m3) * G * r * np.cos(a) - p["torque"],
        -pull * np.sin(a - b) * u**2 - (0.5 * m2 + m3) * G * rod * np.cos(b),
    ]
    jacobian = [[-r * np.cos(a), -rod * np.cos(b)]]
    return _equations(mass, bias, jacobian, [r * np.sin(a) * u**2 + rod * np.sin(b) * w**2], t)


def ball_in_tube_dependent(p, time, x, v):
    """Two coordinates of the world and the rheonomic constraint 2.60."""
    w, m = p["rate"], p["mass"]
    s, c = np.sin(w * time), np.cos(w * time)
    quadratic = -2.0 * w * (v[0] * c + v[1] * s) + w**2 * (x[0] * s - x[1] * c)
    return _equations(m * np.eye(2), p["stiffness"] * x, [[-s, c]], [quadratic])


def upright_disk(p, time, x, v):
    """Place, heading and spin with the non-holonomic constraints 2.18 and 2.19."""
    m, r = p["mass"], p["radius"]
    s, c = np.sin(x[2]), np.cos(x[2])
    mass = np.diag([m, m, 0.25 * m * r**2, 0.5 * m * r**2])
    bias = [0.0, 0.0, -p["steer"] * np.sin(2.0 * time), p["pedal"] * np.exp(-time)]
    jacobian = [[c, s, 0.0, 0.0], [-s, c, 0.0, r]]
    quadratic = [v[2] * (-v[0] * s + v[1] * c), v[2] * (-v[0] * c - v[1] * s)]
    return _equations(mass, bias, jacobian, quadratic)


def parallelogram(p, time, x, v):
    """Angles of crank, coupler and second crank; the gap in C, from the first way to the second.

    The book's gap, figure 2.5, is the other way along x, and its second axis points downwards.
    """
    t = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    a, u = t @ x, t @ v
    d, rod, m, n = (p[k] for k in ("crank.length", "coupler.length", "crank.mass", "coupler.mass"))
    pull, difference = 0.5 * n * d * rod, a[0] - a[1]
    mass = [
        [(m / 3.0 + n) * d**2, pull * np.cos(difference), 0.0],
        [pull * np.cos(difference), n * rod**2 / 3.0, 0.0],
        [0.0, 0.0, m * d**2 / 3.0],
    ]
    bias = [
        pull * np.sin(difference) * u[1] ** 2 - (0.5 * m + n) * G * d * np.cos(a[0]),
        -pull * np.sin(difference) * u[0] ** 2 - 0.5 * n * G * rod * np.cos(a[1]),
        -0.5 * m * G * d * np.cos(a[2]),
    ]
    lengths = np.array([d, rod, -d])
    jacobian = [lengths * np.sin(a), lengths * np.cos(a)]
    quadratic = [(lengths * np.cos(a)) @ u**2, -(lengths * np.sin(a)) @ u**2]
    return _equations(mass, bias, jacobian, quadratic, t)


def roller_pendulum(p, time, x, v):
    """Angles of the pendulum and of both rollers, equation 2.92."""
    t = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
    big, rod, m = p["pendulum.mass"], p["pendulum.length"], p["roller.mass"]
    a, b, alpha = p["roller.radius"], p["roller.arm"], p["roller.angle"]
    spin = 0.5 * m * a**2
    mass = np.diag([big * rod**2 + 2.0 * m * b**2, spin, spin])
    pull = (big * rod + 2.0 * m * b * np.cos(alpha)) * G * np.sin(x[0])
    return _equations(mass, [pull, 0.0, 0.0], [[b, a, 0.0], [b, 0.0, a]], [0.0, 0.0], t)


def double_spring_mass(p, time, x, v):
    """Heights of both masses against the unloaded springs, of the world."""
    t = np.array([[1.0, 0.0], [1.0, 1.0]])
    mass = np.diag([p["upper.mass"], p["lower.mass"]])
    first = p["upper.stiffness"] * x[0] + p["upper.damping"] * v[0]
    second = p["lower.stiffness"] * x[1] + p["lower.damping"] * v[1]
    return _equations(mass, np.diag(mass) * G + [first - second, second], transform=t)


def small_cart(p, time, x, v):
    """Cart and pendulum."""
    m, length = p["pendulum.mass"], p["pendulum.length"]
    s, c = np.sin(x[1]), np.cos(x[1])
    mass = [
        [p["cart.mass"] + m, -m * length * c],
        [-m * length * c, m * length**2 + p["pendulum.inertia"]],
    ]
    buffer = p["cart.stiffness"] * x[0] + p["cart.damping"] * v[0]
    return _equations(mass, [m * length * s * v[1] ** 2 + buffer, m * G * length * s])


def small_cart_2(p, time, x, v):
    """Places of cart and load along the slope, angles of both axles that roll."""
    m, r, load = p["axle.mass"], p["axle.radius"], p["load.mass"]
    t = np.array([[1.0, 0, 0, 0], [1.0, 1.0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]])
    down, spin = G * np.sin(p["slope"]), 0.5 * m * r**2
    holder = p["load.stiffness"] * x[1] + p["load.damping"] * v[1]
    carried = p["cart.mass"] + 2.0 * m
    mass = np.diag([carried, load, spin, spin])
    bias = [-carried * down - holder, -load * down + holder, 0.0, 0.0]
    jacobian = [[1.0, 0.0, -r, 0.0], [1.0, 0.0, 0.0, -r]]
    return _equations(mass, bias, jacobian, [0.0, 0.0], t)


EQUATIONS = {
    entry.__name__: entry
    for entry in (
        slider_crank_two_angles,
        ball_in_tube_dependent,
        upright_disk,
        parallelogram,
        roller_pendulum,
        double_spring_mass,
        small_cart,
        small_cart_2,
    )
}
