"""Hysteresis of Bouc and Wen along a prescribed stretch, against closed forms."""

import numpy as np
import pytest

import vehicledyn as vd

TEXT = """\
title: A damper pulled to and fro
parameters: {stretch: 20 mm}
bodies: {b: {joints: [{kind: T1, name: x, role: driven}], mass: 1 kg}}
drives: {pull: {coordinate: b.x, law: {kind: sine, amplitude: stretch, frequency: 0.25 Hz}}}
elements:
  d: {kind: bouc_wen, a: {body: ground, point: [-1 m, 0, 0]}, b: b, yield_force: 1 kN,
      yield_length: 10 mm, exponent: POWER, shape: SHAPE}
"""


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    """Return force over stretch by exponent and shape."""
    path = tmp_path_factory.mktemp("damper") / "damper.yaml"

    def pull(exponent, shape, duration="1 s"):
        path.write_text(TEXT.replace("POWER", str(exponent)).replace("SHAPE", str(shape)))
        found = vd.simulate(path, duration=duration, solver={"kind": "rk4", "step": "1 ms"})
        return found["b.x"].values, found["d.force"].values

    return pull


@pytest.mark.parametrize(("exponent", "law"), [(1, lambda s: 1.0 - np.exp(-s)), (2, np.tanh)])
@pytest.mark.parametrize("shape", [0.5, 0.8])
def test_virgin_curve(pulled, exponent, law, shape):
    stretch, force = pulled(exponent, shape)
    assert stretch[-1] == pytest.approx(0.02, rel=1e-3)
    assert force == pytest.approx(1e3 * law(stretch / 0.01), abs=1e-6)


def test_turned_back_it_unloads_along_a_straight_line_at_equal_shares(pulled):
    """With γ = 1/2 and z > 0, L̇ < 0 the two terms cancel: ż = L̇/u."""
    stretch, force = pulled(1, 0.5, "1.5 s")
    back = slice(int(np.argmax(stretch)), None)
    fall = 1e3 * (stretch[back] - stretch.max()) / 0.01
    held = force[back] > 0.0
    assert held.sum() > 20
    assert (force[back] - force[back][0])[held] == pytest.approx(fall[held], abs=1e-6)
