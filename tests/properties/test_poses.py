"""Poses by quaternions agree with the symbolic kinematics of matrices, on random systems."""

import numpy as np
import pytest
from random_systems import CLOSED, tree
from scipy.spatial.transform import Rotation

from vehicledyn.base.numbers.quaternions import continuous
from vehicledyn.multibody.equations.system_shapes import appearance
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion.numeric_kinematics import skeleton_from
from vehicledyn.symbolic import ops

SAMPLES = 5


@pytest.mark.parametrize("make", [tree, *CLOSED])
@pytest.mark.parametrize("seed", range(6))
def test_poses(make, seed):
    system = make(seed)
    values = [entry.value for entry in system.table.entries]
    skeleton = skeleton_from(appearance(system, values))
    names = [joint.name for joint in system.joints()]
    rng = np.random.default_rng(seed)
    q = rng.uniform(-7.0, 7.0, size=(len(names), SAMPLES))
    poses = skeleton.poses(dict(zip(names, q, strict=True)))

    symbols = {name: ops.symbol(name) for name in names}
    kinematics = Kinematics(unfold(system.bodies), symbols, symbols)
    inputs = [
        ops.column(list(symbols.values())),
        ops.column([entry.symbol for entry in system.table.entries]),
    ]
    for place, body in enumerate(system.bodies):
        position = ops.numeric(inputs, kinematics.position(body.name))
        rotation = ops.numeric(inputs, kinematics.rotation(body.name))
        known = skeleton.bodies[place]
        assert known["name"] == body.name
        for k in range(SAMPLES):
            assert poses.position[k, place] == pytest.approx(
                position(q[:, k], values)[:, 0], abs=1e-12
            )
            found = Rotation.from_quat(poses.quaternion[k, place], scalar_first=True)
            if known["axis"] and known["axes_spin"]:
                axis = np.eye(3)[known["axis"] - 1]
                found = found * Rotation.from_rotvec(poses.turn[k, place] * axis)
            difference = found.as_matrix() - rotation(q[:, k], values)
            assert np.abs(difference).max() < 1e-12


def test_wheels_keep_their_turns():
    system = tree(0)
    skeleton = skeleton_from(appearance(system, [entry.value for entry in system.table.entries]))
    names = [joint.name for joint in system.joints()]
    turns = np.array([0.0, 40.0, 400.0])
    values = {name: np.zeros(3) for name in names} | {"wheel.spin": turns}
    place = [body["name"] for body in skeleton.bodies].index("wheel")
    poses = skeleton.poses(values)
    assert not skeleton.bodies[place]["axes_spin"]
    assert np.array_equal(poses.turn[:, place], turns)
    assert np.ptp(poses.quaternion[:, place], axis=0).max() == 0.0


def test_signs_do_not_jump():
    turns = Rotation.from_euler("y", np.linspace(0.0, 9.0, 50)[:, None]).as_quat(scalar_first=True)
    jumping = turns * np.random.default_rng(0).choice([-1.0, 1.0], size=(50, 1))
    smooth = continuous(jumping[:, None, :])[:, 0]
    assert np.abs(np.diff(smooth, axis=0)).max() < 0.1
    assert np.array_equal(np.abs(smooth), np.abs(turns))
    assert continuous(turns[:1]).shape == (1, 4)
