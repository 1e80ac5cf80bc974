"""The rolling disk by hand: Newton and Euler about the contact, integrated independently.

Axes: e1 along the track, e2 along the axle, e3 up in the plane of the disk; lean θ, yaw ψ, spin φ.
The angular velocity has the components w1 = θ', w2 = φ' + ψ' sin θ, w3 = ψ' cos θ, the axes turn
with (w1, w3 tan θ, w3), the centre moves with r (w2 e1 - w1 e2). A and C are the moments of inertia
about a diameter and the axle:

    (A + m r²) w1' = m g r sin θ + (C + m r²) w2 w3 - A w3² tan θ
    (C + m r²) w2' = -m r² w1 w3
    A w3' = -C w1 w2 + A w1 w3 tan θ
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81


@dataclass(frozen=True)
class Disk:
    """Mass [kg], radius [m] and moments of inertia about the axle and a diameter [kg m²]."""

    mass: float
    radius: float
    share: float

    @property
    def axle(self):
        return self.share * self.mass * self.radius**2

    @property
    def diameter(self):
        return 0.5 * self.axle

    def accelerations(self, lean, rates):
        """Return θ'', ψ'', φ'' for the rates θ', ψ', φ'."""
        a, c, inertia = self.diameter, self.axle, self.mass * self.radius**2
        sine, cosine = np.sin(lean), np.cos(lean)
        w1, w3 = rates[0], rates[1] * cosine
        w2, tangent = rates[2] + rates[1] * sine, sine / cosine
        pull = self.mass * G * self.radius * sine
        d1 = (pull + (c + inertia) * w2 * w3 - a * w3**2 * tangent) / (a + inertia)
        d2 = -inertia * w1 * w3 / (c + inertia)
        d3 = -c * w1 * w2 / a + w1 * w3 * tangent
        yaw = (d3 + w1 * w3 * tangent) / cosine
        return d1, yaw, d2 - yaw * sine - rates[1] * cosine * w1

    def normal_force(self, lean, rates):
        """Return the force of the ground: the height r cos θ of the centre, twice derived."""
        lift = -self.radius * (np.cos(lean) * rates[0] ** 2)
        lift -= self.radius * np.sin(lean) * self.accelerations(lean, rates)[0]
        return self.mass * (G + lift)

    def energy(self, lean, rates):
        """Return the energy [J]."""
        w1, w3 = rates[0], rates[1] * np.cos(lean)
        w2, inertia = rates[2] + rates[1] * np.sin(lean), self.mass * self.radius**2
        turning = (self.diameter + inertia) * w1**2 + (self.axle + inertia) * w2**2
        kinetic = 0.5 * (turning + self.diameter * w3**2)
        return kinetic + self.mass * G * self.radius * np.cos(lean)

    def motion(self, start, times):
        """Return lean, yaw, spin, their rates, contact x and y, shape (8, n_times)."""

        def slope(_, state):
            lean, yaw = state[:2]
            path = self.radius * state[5]
            turned = self.accelerations(lean, state[3:6])
            return [*state[3:6], *turned, path * np.cos(yaw), path * np.sin(yaw)]

        found = solve_ivp(
            slope, (times[0], times[-1]), start, "DOP853", times, rtol=3e-14, atol=1e-14
        )
        return found.y


STRAIGHT = "initial.disk.spin_rate"
UPRIGHT = "initial.disk.yaw_rate"


def critical_rate(squares):
    """Return where λ² = α - β ω² vanishes, from {ω: λ²} of two rates."""
    (first, a), (second, b) = squares.items()
    return float(np.sqrt(first**2 + a * (second**2 - first**2) / (a - b)))
