from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vehicledyn.symbolic import ops, rotations


def numbers(expression):
    return ops.numeric([], expression)()


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_turn_agrees_with_scipy(axis):
    expected = Rotation.from_euler("xyz"[axis - 1], 0.7).as_matrix()
    assert numbers(rotations.turn(axis, 0.7)) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("sequence", list(permutations((1, 2, 3))))
@pytest.mark.parametrize("angles", [(0.3, -0.9, 2.1), (-2.8, 1.2, -0.4), (0.0, 0.0, 0.0)])
def test_tait_bryan_undoes_three_turns(sequence, angles):
    product = rotations.identity()
    for axis, angle in zip(sequence, angles, strict=True):
        product = product @ rotations.turn(axis, angle)
    found = numbers(ops.column(list(rotations.tait_bryan(product, sequence))))[:, 0]
    assert found == pytest.approx(angles, abs=1e-14)


def test_yaw_pitch_roll_signs():
    """Yaw to the left, pitch nose down and roll to the right are positive (ISO 8855)."""
    nose = rotations.turn(3, 0.1) @ rotations.axis_vector(1)
    assert float(nose[1]) > 0.0
    assert float((rotations.turn(2, 0.1) @ rotations.axis_vector(1))[2]) < 0.0
    assert float((rotations.turn(1, 0.1) @ rotations.axis_vector(2))[2]) > 0.0


def test_congruent_is_the_product_of_three():
    rng = np.random.default_rng(4)
    r = Rotation.random(random_state=rng).as_matrix()
    t = rng.normal(size=(3, 3))
    t = t + t.T
    found = rotations.congruent(rotations.matrix(r.tolist()), rotations.matrix(t.tolist()))
    assert numbers(found) == pytest.approx(r @ t @ r.T, abs=1e-14)


def test_columns_and_symmetric():
    eye = [rotations.axis_vector(k) for k in (1, 2, 3)]
    assert numbers(rotations.columns(*eye)) == pytest.approx(np.eye(3))
    expected = [[1.0, 4.0, 5.0], [4.0, 2.0, 6.0], [5.0, 6.0, 3.0]]
    assert numbers(rotations.symmetric((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))) == pytest.approx(
        np.array(expected)
    )
