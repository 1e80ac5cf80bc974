"""What MacAdam's driver expects of the car, and the gains of least squared distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


class SingleTrackNumbers(Protocol):
    """What the driver knows, see :class:`vehicledyn.road.drivers.macadam.MacAdam`."""

    @property
    def preview_time(self) -> float:
        """How far ahead the driver looks [s]."""

    @property
    def points(self) -> int:
        """Number of points ahead."""

    @property
    def speed(self) -> float:
        """Speed [m/s]."""

    @property
    def mass(self) -> float:
        """Mass [kg]."""

    @property
    def yaw_inertia(self) -> float:
        """Moment of inertia about the vertical [kg m²]."""

    @property
    def front_distance(self) -> float:
        """Front axle ahead of the centre of mass [m]."""

    @property
    def rear_distance(self) -> float:
        """Rear axle behind it [m]."""

    @property
    def front_stiffness(self) -> float:
        """Cornering stiffness of the front axle [N/rad]."""

    @property
    def rear_stiffness(self) -> float:
        """That of the rear axle [N/rad]."""


@dataclass(frozen=True)
class Prediction:
    """Times ahead [s], gains g_i/Σ g² [rad/m] and rows C e^{Aτ_i}, shape (N, 4)."""

    times: Vector
    gains: Vector
    free: Vector


def single_track(driver: SingleTrackNumbers) -> tuple[Vector, Vector]:
    """Return A and B of the single-track model with x = (y, v_y, r, ψ), input the wheel angle."""
    v, m, i = driver.speed, driver.mass, driver.yaw_inertia
    a, b = driver.front_distance, driver.rear_distance
    cf, cr = driver.front_stiffness, driver.rear_stiffness
    matrix = np.array(
        [
            [0.0, 1.0, 0.0, v],
            [0.0, -(cf + cr) / (m * v), (b * cr - a * cf) / (m * v) - v, 0.0],
            [0.0, (b * cr - a * cf) / (i * v), -(a * a * cf + b * b * cr) / (i * v), 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )
    return matrix, np.array([0.0, cf / m, a * cf / i, 0.0])


def prediction(driver: SingleTrackNumbers) -> Prediction:
    """Return what the driver expects at equally spaced times up to the preview time."""
    matrix, given = single_track(driver)
    times = driver.preview_time * np.arange(1, driver.points + 1) / driver.points
    return optimal_gains(matrix, given, times)


def optimal_gains(matrix: Vector, given: Vector, times: Vector) -> Prediction:
    """Return the gains of ẋ = A x + B u whose first state follows a path.

    Parameters
    ----------
    matrix, given
        A, shape (n, n), and B, shape (n,).
    times
        Times ahead, shape (N,) [s].
    """
    from scipy.linalg import expm

    size = len(matrix)
    whole = np.zeros((size + 1, size + 1))
    whole[:size, :size], whole[:size, size] = matrix, given
    moved = [expm(whole * float(time)) for time in times]
    forced = np.array([item[0, size] for item in moved])
    return Prediction(
        times, forced / float(forced @ forced), np.array([m[0, :size] for m in moved])
    )
