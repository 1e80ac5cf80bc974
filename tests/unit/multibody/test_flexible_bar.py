"""Flexible bars against closed forms: frequencies, stiffening by rotation, deflections, frames."""

import numpy as np
import pytest
from scipy.optimize import brentq

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, TimeLaw, derive
from vehicledyn.multibody.elements.flexible.flexible_bar import FlexibleBar

LENGTH, MASS, STIFFNESS = 1.5, 2.0, 50.0
PACE = np.sqrt(STIFFNESS / MASS / LENGTH**4)
"""Frequencies are multiples of this [rad/s]."""


def kernel_of(*bodies, speed=0.0, gravity=(0.0, 0.0, 0.0), **changes):
    """A bar on a hub that turns about the vertical at a speed [rad/s]."""
    hub = Body("hub", GROUND, joints=(Joint("R3", "turn", role="driven"),))
    settings = {"length": LENGTH, "mass_per_length": MASS, "bending_stiffness": STIFFNESS}
    parts = (
        FlexibleBar("bar", body="hub", **settings | changes),
        TimeLaw("spin", "turn", lambda t: speed * t),
    )
    made = System("bar", ParameterTable(), (hub, *bodies), parts=parts, gravity=gravity)
    return compile_kernel(derive(made), backend="interpreted")


def frequencies(kernel):
    """Return the frequencies about the state of zero [rad/s], ascending."""
    states = [s.name for s in kernel.equations.states]
    guess = np.array([u.start for u in kernel.equations.unknowns])

    def rates(x):
        return kernel.rates(0.0, x, assemble(kernel, 0.0, x, guess))

    columns = [(rates(1e-5 * e) - rates(-1e-5 * e)) / 2e-5 for e in np.eye(len(states))]
    return np.sort(np.abs(np.linalg.eigvals(np.array(columns).T).imag))[::2]


@pytest.mark.parametrize("axis", ["y", "z"])
def test_a_clamped_bar_has_the_frequencies_of_the_closed_form(axis):
    found = frequencies(kernel_of(bends_along=axis)) / PACE
    assert found == pytest.approx([1.875104068711961**2, 4.694091132974174**2], rel=1e-4)


@pytest.mark.parametrize(
    ("speed", "flap", "tolerance"), [(2.0, 4.137320, 2e-4), (6.0, 7.360373, 5e-4)]
)
def test_rotation_stiffens_it(speed, flap, tolerance):
    """Wright, Smith, Thresher, Wang (1982), J. Appl. Mech. 49, 197-202: hub of no radius."""
    found = frequencies(kernel_of(speed=speed * PACE, modes=3))[0] / PACE
    assert found == pytest.approx(flap, rel=tolerance)
    chord = frequencies(kernel_of(speed=speed * PACE, modes=3, bends_along="y"))[0] / PACE
    assert chord == pytest.approx(np.sqrt(flap**2 - speed**2), rel=3.0 * tolerance)


def test_a_body_hangs_on_its_end():
    """Tip mass m = μ L / 2: 1 + cos β cosh β = ½ β (sin β cosh β - cos β sinh β)."""
    tip = Body("tip", "bar.frame_2", mass=0.5 * MASS * LENGTH)
    found = frequencies(kernel_of(tip, frames=(0.5, 1.0), modes=3))[0] / PACE

    def zero(b):
        whole = np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b)
        return 1.0 + np.cos(b) * np.cosh(b) - 0.5 * b * whole

    assert found == pytest.approx(brentq(zero, 1.0, 1.8) ** 2, rel=1e-3)


def test_it_sags_under_its_weight_and_its_frames_turn():
    g, sag = 1e-3, -MASS * 1e-3 * LENGTH**4 / (8.0 * STIFFNESS)
    kernel = kernel_of(gravity=(0.0, 0.0, -g), frames=(1.0,), modes=3)
    e = kernel.equations
    stiffness = STIFFNESS / LENGTH**3 * np.array([1.8751040687, 4.6940911330, 7.8547574382]) ** 4
    held = -MASS * LENGTH * g * np.array([0.7829918, 0.4339359, 0.2544253]) / stiffness
    x = np.array([*held, 0.0, 0.0, 0.0])
    z = assemble(kernel, 0.0, x, np.array([u.start for u in e.unknowns]))
    rates = kernel.rates(0.0, x, z)
    assert np.abs(rates).max() < 1e-6 * g
    seen = dict(zip([c.name for c in e.channels], kernel.outputs(0.0, x, z), strict=True))
    assert seen["bar.tip"] == pytest.approx(sag, rel=2e-3)
    assert seen["bar.frame_1.across"] == pytest.approx(seen["bar.tip"], rel=1e-12)
    assert seen["bar.frame_1.slope"] == pytest.approx(-sag * 4.0 / 3.0 / LENGTH, rel=1e-2)
