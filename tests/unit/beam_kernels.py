"""Equations of a beam on a hub, and what tests ask of them."""

import numpy as np

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, TimeLaw, derive
from vehicledyn.multibody.bodies.beam_properties import Stiffness
from vehicledyn.multibody.elements.flexible.beam import Beam

LENGTH, MASS, BENDING, TWIST, STRETCH, POLAR = 1.5, 2.0, 50.0, 20.0, 5e4, 0.01
GIVEN = Stiffness(
    mass_per_length=MASS, y=BENDING, z=BENDING, twist=TWIST, stretch=STRETCH, polar=POLAR
)
PACE = np.sqrt(BENDING / MASS / LENGTH**4)
"""Bending frequencies are multiples of this [rad/s]."""


def kernel_of(
    *bodies, cuts=(), parts=(), hub=(), speed=0.0, at=(0.0, 0.0, 0.0), gravity=(0.0, 0.0, 0.0),
    **settings,
):  # fmt: skip
    """A beam on a hub that turns about the vertical at a speed [rad/s]."""
    joints = (*hub, Joint("R3", "turn", role="driven"))
    settings = {"length": LENGTH, "stiffness": GIVEN} | settings
    beam = Beam("beam", body="hub", at=at, **settings)
    spin = TimeLaw("spin", "turn", lambda t: speed * t)
    root = Body("hub", GROUND, joints=joints)
    made = System(
        "beam", ParameterTable(), (root, *bodies), parts=(beam, spin, *parts), cuts=cuts,
        gravity=gravity,
    )  # fmt: skip
    return compile_kernel(derive(made), backend="interpreted")


def matrix_of(kernel, size=1e-6):
    """Return ∂ẋ/∂x about the start."""
    x0 = np.array([s.start for s in kernel.equations.states])
    guess = np.array([u.start for u in kernel.equations.unknowns])

    def rates(step):
        return kernel.rates(0.0, x0 + step, assemble(kernel, 0.0, x0 + step, guess))

    return np.array([(rates(size * e) - rates(-size * e)) / (2 * size) for e in np.eye(len(x0))]).T


def frequencies(kernel):
    """Return the frequencies about the start [rad/s], ascending."""
    return np.sort(np.abs(np.linalg.eigvals(matrix_of(kernel)).imag))[::2]


def at_rest(kernel, steps=4):
    """Return the channels where loads hold the beam in balance, by name."""
    e = kernel.equations
    n, x = len(e.states) // 2, np.zeros(len(e.states))
    matrix = matrix_of(kernel)[n:, :n]
    for _ in range(steps):
        x[:n] -= np.linalg.solve(matrix, kernel.rates(0.0, x, np.zeros(0))[n:])
    values = kernel.outputs(0.0, x, np.zeros(0))
    return dict(zip([c.name for c in e.channels], values, strict=True))
