from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vehicledyn.base.units import to_si
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


@pytest.mark.parametrize("quarters", [*range(-9, 10), 123, -4002])
@pytest.mark.parametrize("axis", [1, 2, 3])
def test_quarter_turns_are_exact(axis, quarters):
    """Neither π/2 times a number nor degrees leave a residue in place of a zero."""
    exact = np.linalg.matrix_power(np.rint(numbers(rotations.turn(axis, np.pi / 2))), quarters % 4)
    for angle in (quarters * (np.pi / 2.0), to_si(f"{90 * quarters} deg", "rad")):
        turned = rotations.turn(axis, angle)
        assert numbers(turned).tolist() == exact.tolist()
        assert sum(not turned[i, j].is_zero() for i in range(3) for j in range(3)) == 3
        assert numbers(rotations.turn(axis, ops.scalar(angle))).tolist() == exact.tolist()


@pytest.mark.parametrize("angle", [1e-300, -1e-17, np.pi / 2 + 1e-13, 2.0 * np.pi - 1e-12, 1.0])
def test_other_angles_are_not_rounded(angle):
    assert float(ops.sin(angle)) == np.sin(angle)
    assert float(ops.cos(angle)) == np.cos(angle)
    assert float(ops.sin(ops.scalar(angle))) == np.sin(angle)


def test_symbols_stay_symbols():
    """The residue belongs to numbers alone: a parameter may take any value later."""
    angle = ops.symbol("angle")
    found = ops.numeric([angle], rotations.turn(3, angle))
    assert found(np.pi / 2)[0, 0] == np.cos(np.pi / 2)
    assert np.isnan(float(ops.sin(float("nan"))))
