"""Runs with multipliers show what the steps of index 3 have, digit by digit, or what is near it."""

from contextlib import nullcontext

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import AccuracyWarning
from vehicledyn.integrate.newmark.weights import Weights

PENDULUM = """title: A mass on a string
bodies:
  ball: {joints: [T1 x, T3 z], mass: 1 kg}
constraints:
  string: {kind: expression, zero: (ball.x**2 + ball.z**2 - 1 m * 1 m) / (2 m)}
gravity: [0, 0, -9.81 m/s^2]
constraint_method: multipliers
initial: {ball.x: 1 m}
"""
RUN = """title: It falls from the side
model: pendulum.yaml
duration: 1 s
solver: {kind: KIND, step: 20 ms, constraints: index3}
output: {interval: 20 ms}
"""
CHANNELS = ("ball.x", "ball.z", "ball.x_rate", "ball.z_rate", "string.multiplier")
PUBLISHED = {
    "generalised_alpha, spectral_radius: 0.9": (
        [-0.9858967455536, -0.16735473434243, -0.30143960080037, 1.786332726893, 4.8976507065845],
        5e-10,
    ),
    "hht, spectral_radius: 0.5": (
        [-0.98567115376425, -0.16867832296135, -0.30415657167572, 1.7913113696272, 4.9302708201895],
        1e-10,
    ),
    "newmark, beta: 0.25, gamma: 0.5": (
        [-0.98590178809022, -0.16732502574485, -0.30131463723046, 1.786169782038, 5.0843442449086],
        1e-8,
    ),
}
"""State and multiplier after 1 s by an independent program, Arnold, Brüls (2007), and how far these
multipliers are from those of arithmetic with 40 digits: gaps are rounded, over β Δt²."""


def ended(folder, kind, backend="interpreted"):
    """Return the channels at the end of a run."""
    (folder / "pendulum.yaml").write_text(PENDULUM)
    (folder / "run.yaml").write_text(RUN.replace("KIND", kind))
    run = vd.simulate(vd.load(folder / "run.yaml"), backend=backend)
    return np.array([run[name].values[-1] for name in CHANNELS])


@pytest.mark.parametrize("kind", PUBLISHED)
def test_published_digits(tmp_path, kind):
    exact, rounding = PUBLISHED[kind]
    is_undamped = kind.startswith("newmark")
    told = pytest.warns(AccuracyWarning, match="damps nothing.*weakly unstable")
    with told if is_undamped else nullcontext():
        found = ended(tmp_path, kind)
    assert found[:4] == pytest.approx(exact[:4], abs=1e-11)
    assert -found[4] == pytest.approx(exact[4], abs=rounding)


@pytest.mark.usefixtures("needs_compiler")
def test_published_digits_of_compiled_steps(tmp_path):
    exact, rounding = PUBLISHED["hht, spectral_radius: 0.5"]
    found = ended(tmp_path, "hht, spectral_radius: 0.5", "compiled")
    assert found[:4] == pytest.approx(exact[:4], abs=1e-11)
    assert -found[4] == pytest.approx(exact[4], abs=rounding)


def test_projected_velocities_lie_on_the_constraints(tmp_path):
    """The tension is that of the motion there, v² - g z."""
    kind = "generalised_alpha, spectral_radius: 0.9, velocities: projected"
    x, z, u, w, multiplier = ended(tmp_path, kind)
    exact = PUBLISHED["generalised_alpha, spectral_radius: 0.9"][0]
    assert [x, z] == pytest.approx(exact[:2], abs=1e-11)
    assert abs(u - exact[2]) > 1e-4
    assert x * u + z * w == pytest.approx(0.0, abs=1e-12)
    assert -multiplier == pytest.approx(u**2 + w**2 - 9.81 * z, abs=1e-12)


@pytest.mark.parametrize(
    ("weights", "left"),
    [
        (Weights.newmark(0.25, 0.5), 1.0),
        (Weights.newmark(0.25, 0.6), 2.1165),
        (Weights.newmark(0.3025, 0.6), 0.8182),
        (Weights.hht(0.7), 0.7),
        (Weights.generalised_alpha(0.4), 0.4),
        (Weights.generalised_alpha(1.0), 1.0),
    ],
)
def test_what_steps_leave_of_errors_across_constraints(weights, left):
    """The spectral radius, and for Newmark's weights the roots of 0.25 r² + 0.6 r + 0.15 = 0."""
    assert weights.left_across_constraints == pytest.approx(left, abs=1e-4)
