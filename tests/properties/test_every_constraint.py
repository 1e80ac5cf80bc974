"""Laws of mechanics for every joint and every constraint, at many random states.

Two dozen random trees and as many random closed systems, and fifty states of each system that has
the constraints of every kind. A structure is derived once; its parameters and states are
random. States of closed systems stay near the assembled one, so that the loops are on their
branch; trees take any.
"""

from functools import cache

import numpy as np
import pytest
from absolute_constraints import Rows, add_rows
from absolute_coordinates import Absolute
from every_constraint import LOOPS, RANDOM_LOOPS, RANDOM_TREES, SEEDS, TREES, WRITTEN
from many_states import ManyStates
from random_systems import JOINT_KINDS

from vehicledyn.base.registry import kinds
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.multibody.elements.rolling import RollingWheel
from vehicledyn.multibody.equations.inverse_dynamics import derive_inverse
from vehicledyn.symbolic import ops

pytestmark = pytest.mark.long

IDENTITY = 1e-10
FEW = 4
# The absolute matrix has a condition number of 1e5 and more.
ABSOLUTE = 1e-9
ALL_TREES, ALL_LOOPS = {**RANDOM_TREES, **TREES}, {**RANDOM_LOOPS, **LOOPS}
ALL = {**ALL_TREES, **ALL_LOOPS}


@cache
def structure(name):
    return ManyStates(ALL[name](), 2.0 if name in ALL_TREES else 0.05)


@cache
def states(name):
    seeds = SEEDS if name in {**TREES, **LOOPS} else range(FEW)
    return [structure(name).at(seed) for seed in seeds]


def every(names):
    return pytest.mark.parametrize("name", list(names))


@every(ALL)
def test_kinetic_energy_is_half_the_mass_matrix_between_the_rates(name):
    for v in states(name):
        energy = v["channel"]["energy.kinetic"]
        assert 0.5 * v["qd"] @ v["mass"] @ v["qd"] == pytest.approx(energy, rel=IDENTITY)


@every(ALL)
def test_the_mass_matrix_is_symmetric_and_positive_definite(name):
    for v in states(name):
        mass = v["mass"]
        assert np.abs(mass - mass.T).max() <= 1e-12 * np.abs(mass).max()
        assert np.linalg.eigvalsh(mass)[0] > 0.0


@every(ALL)
def test_power_balance(name):
    """Kinetic energy and that of weights grow by the power of all other forces and drives."""
    for v in states(name):
        scale = max(1.0, np.abs(v["power"]).max())
        balance = v["power"].sum() - v["channel"]["power.forces"]
        assert abs(balance) < IDENTITY * scale


@every(ALL_LOOPS)
def test_constraints_hold_in_position_velocity_and_acceleration(name):
    for v in states(name):
        assert np.abs(v["gap"]).max(initial=0.0) < 1e-13
        assert np.abs(v["opening"]).max(initial=0.0) < 1e-13
        size = max(1.0, np.abs(v["qdd"]).max())
        assert np.abs(v["bend"]).max(initial=0.0) < 1e-12 * size
        assert v["channel"]["constraints.position_error"] < 1e-13
        assert v["channel"]["constraints.velocity_error"] < 1e-13


FLOATING = [*(n for n in RANDOM_TREES if int(n.split()[1]) % 2 == 0), "named"]


@every([*FLOATING, "sections", "transmitted"])
def test_momentum_rate_is_the_outer_force(name):
    """Joints, cuts, transmissions, inner links, motors and drives change no momentum.

    Links of the trees to the ground are among the wrenches, with all others.
    """
    for v in states(name):
        scale = max(np.abs(v["outer"]).max(), np.abs(v["qdd"]).max())
        assert np.abs(v["momentum rate"] - v["outer"]).max() < IDENTITY * scale


def test_momentum_rate_of_rolling_wheels():
    """The forces of the ground act at the lowest points; the skate's is told by the power."""
    s = structure("rolling")
    for seed in range(FEW):
        v, absolute = states("rolling")[seed], in_absolute_coordinates("rolling", seed)
        force = outer_forces(s, absolute, v)
        scale = max(np.abs(v["outer"]).max(), np.abs(v["qdd"]).max())
        assert np.abs(v["momentum rate"] - v["outer"] - force).max() < IDENTITY * scale


def outer_forces(s, absolute, v):
    """Force and torque about the world's origin of two wheels' contacts and of the edge."""
    total = np.zeros(6)
    for c in s.system.constraints:
        frame = absolute.frames[absolute.of_body[getattr(c, "body", "trailer")]]
        if isinstance(c, RollingWheel):
            e = frame.turn[:, c.axis - 1]
            flat = np.hypot(e[0], e[1])
            left = np.array([e[0], e[1], 0.0]) / flat
            radius, crown = (
                float(absolute.values(ops.scalar(x))[0, 0]) for x in (c.radius, c.crown)
            )
            point = frame.r + radius * np.array([*(e[2] * left[:2]), -flat])
            point = point - np.array([0.0, 0.0, crown])
            axes = {
                "normal": np.array([0.0, 0.0, 1.0]),
                "longitudinal": np.array([left[1], -left[0], 0.0]),
                "lateral": left,
            }
            force = sum(v["channel"][f"{c.name}.{w}_force"] * d for w, d in axes.items())
        else:
            point = frame.at(np.array([-0.8, 0.0, 0.1]))[1]
            force = v["channel"][f"{c.name}.multiplier"] * frame.turn[:, 1]
        total += np.r_[force, np.cross(point, force)]
    return total


@every(ALL_TREES)
def test_forward_dynamics_undo_inverse_dynamics_of_trees(name):
    s = structure(name)
    for v in states(name):
        scale = max(1.0, np.abs(v["needed"]).max())
        for k, coordinate in enumerate(s.coordinate_names):
            given = v["joint forces"][k] + v["channel"].get(f"{coordinate}_force", 0.0)
            assert abs(v["needed"][k] - given) < IDENTITY * scale, coordinate


@cache
def inverse(name):
    found = derive_inverse(ALL[name]())
    e = found.equations
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    return found, ops.numeric(inputs, e.output), [c.name for c in e.channels]


@every(LOOPS)
def test_forward_dynamics_undo_inverse_dynamics_of_closed_systems(name):
    """Along the motion that the equations give no independent coordinate lacks a force."""
    s = structure(name)
    found, outputs, channels = inverse(name)
    for seed, v in zip(SEEDS, states(name), strict=True):
        s.go_to(seed)
        motion = [dict(zip(s.coordinate_names, v[k], strict=True)) for k in ("q", "qd", "qdd")]
        rows = [np.array([m[n] for n in found.coordinates]) for m in motion]

        def forces(push, rows=rows, motion=motion, s=s):
            state = found.state(rows[0], rows[1], rows[2] + push)
            given = dict(zip((x.name for x in s.equations.states), s.point[1], strict=True))
            state = [
                given.get(x.name, value)
                for x, value in zip(found.equations.states, state, strict=True)
            ]
            unknowns = [motion[0][u.name] for u in found.equations.unknowns]
            values = outputs(s.point[0], state, unknowns, s.parameters)[:, 0]
            by_name = dict(zip(channels, values, strict=True))
            return np.array([by_name[n] for n in found.force_channels])

        free, moved = forces(0.0), forces(1.0)
        scale = max(np.abs(moved).max(), np.abs(v["needed"]).max())
        assert np.abs(free).max() < IDENTITY * scale
        assert np.abs(moved).max() > 1e-3


@cache
def in_absolute_coordinates(name, seed):
    """The system of a seed as frames and rows, solved for accelerations and multipliers."""
    s, v = structure(name), states(name)[seed]
    s.go_to(seed)

    def values(expression):
        return ops.numeric([s.equations.parameter], expression)(s.parameters)

    q, qd, qdd, forces = (
        dict(zip(s.coordinate_names, v[k], strict=True)) for k in ("q", "qd", "qdd", "joint forces")
    )
    wrenches = [
        (body, v[f"wrench {k}"][:3], v[f"wrench {k}"][3:]) for k, body in enumerate(s.wrench_bodies)
    ]
    driven = {j.name: qdd[j.name] for j in s.system.joints() if j.role == "driven"}
    forces = {n: f for n, f in forces.items() if f != 0.0}
    absolute = Absolute(
        s.system, values, q, qd, wrenches=wrenches, driven=driven, joint_forces=forces
    )
    for constraint in s.system.constraints:
        add_rows(constraint, Rows(absolute, s.point[0]))
    return absolute.solve()


@pytest.mark.parametrize("seed", range(FEW))
@every(LOOPS)
def test_absolute_coordinates_give_the_same_accelerations_and_multipliers(name, seed):
    s, v = structure(name), states(name)[seed]
    absolute = in_absolute_coordinates(name, seed)
    opening = absolute.jacobian[absolute.cut_rows :] @ absolute.velocities
    scale = max(1.0, np.abs(v["qdd"]).max())
    for coordinate, acceleration in zip(s.coordinate_names, v["qdd"], strict=True):
        found = absolute.acceleration_of(coordinate)
        assert abs(found - acceleration) < ABSOLUTE * scale, coordinate
    channels = v["channel"]
    size = max(1.0, np.abs(absolute.multipliers).max())
    tags = [tag for tag in absolute.tags if isinstance(tag, str) and "." in tag]
    found = {tag: absolute.multiplier_of(tag) for tag in tags} | cut_forces(s, absolute)
    # Every multiplier has its channel, but those of redundant rows, of which there are none.
    assert not s.equations.structure["redundant"]
    assert len(found) == len(absolute.rows) - absolute.cut_rows
    for channel, value in found.items():
        assert abs(channels[channel] - value) < ABSOLUTE * size, channel
    for joint in s.system.joints():
        if joint.role == "driven":
            force = absolute.multiplier_of(("drive", joint.name))
            assert abs(channels[f"{joint.name}_force"] - force) < ABSOLUTE * size, joint.name
    if name in ("sections", "transmitted"):
        assert np.abs(opening).max(initial=0.0) < 1e-12


def cut_forces(s, absolute):
    """Forces and torques of the cuts by channel, in the axes that the channels are in."""
    frames = {c.name: c.frame for c in s.equations.channels}
    found = {}
    for cut in s.system.cuts:
        if f"{cut.name}.axial_force" in frames:
            found[f"{cut.name}.axial_force"] = -absolute.multiplier_of((cut.name, "axial"))
            continue
        for word in ("force", "torque"):
            world = np.array([absolute.multiplier_of((cut.name, f"{word}{k}")) for k in range(3)])
            for k, axis in enumerate("xyz"):
                channel = f"{cut.name}.{word}_{axis}"
                if channel in frames:
                    frame = absolute.frames[absolute.of_body[frames[channel]]]
                    found[channel] = (frame.turn.T @ world)[k]
    return found


def test_every_kind_was_there():
    """All kinds of joints, cuts, constraints and drives of system files are in some structure."""
    load_kinds()
    for names in (["named", "tree 0"], LOOPS):
        kinds_of = {j.kind for n in names for j in structure(n).system.joints()}
        assert kinds_of == set(JOINT_KINDS)
    text = WRITTEN.read_text(encoding="utf-8")
    # Track frames are in tests/unit/files/test_track_frames.py, quaternions in
    # tests/unit/multibody/test_quaternion_joint.py, Geneva drives in tests/validation/test_cams.py.
    elsewhere = {
        "geneva",
        "rolling",  # tests/unit/multibody/test_joint_types.py
        "universal_wheel",  # tests/validation/test_universal_wheels.py
        "spherical_quaternion",
        "track_frame",
        "rolling_wheel",
        "body",
        "ball",
        "T1",
        "R2",
        "R1",
        "R3",
        "T2",
        "T3",
        "free",
    }
    for family in ("joint", "cut", "constraint"):
        missing = {k for k in kinds(family) if f"kind: {k}" not in text} - elsewhere
        assert not missing, family
