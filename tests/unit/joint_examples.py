"""An example of each type of joint, for the tests of the catalogue."""

from dataclasses import fields, is_dataclass

from vehicledyn.base.registry import find
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, Turn, quaternion_joint
from vehicledyn.multibody.joints.joint_type import FAMILY
from vehicledyn.symbolic import rotations

SETTINGS = {
    "rolling": {"axis": 2, "normal": 3, "radius": 0.4},
    "screw": {"axis": 2, "lead": 0.7},
    "spherical_quaternion": {"element": 4},
}
"""Settings of the types that need some."""

RIGID = {"mass": 2.0, "com": (0.2, -0.1, 0.3), "inertia": (0.6, 0.5, 0.7, 0.05, -0.02, 0.03)}


def joint(kind, name="tried.q", **more):
    """Return a joint of a type, with the settings of its example."""
    return Joint(kind, name, settings=SETTINGS.get(kind, {}), **more)


def described(kind, **more):
    """Return the same joint as a system file writes it, its numbers with units."""
    of = find(FAMILY, kind)
    units = {f.name: f.metadata.get("unit") for f in fields(of)} if is_dataclass(of) else {}
    settings = SETTINGS.get(kind, {})
    written = {n: f"{v} {units[n]}" if units.get(n) else v for n, v in settings.items()}
    return {"kind": kind, **more, **written}


def train(kind, role="auto"):
    """Return a pendulum, a body on it by the joint, and an arm on that, all oblique."""
    turn, other = Turn(rotations.turn(1, 0.4)), Turn(rotations.turn(3, 0.9))
    is_ball = kind == "spherical_quaternion"
    tried = quaternion_joint("tried") if is_ball else (joint(kind, role=role),)
    bodies = (
        Body("arm", GROUND, (0.1, 0.2, 0.3), (Joint("R2", "arm.angle", 0.3),), **RIGID),
        Body("tried", "arm", (0.5, 0.1, -0.4), (turn, *tried, other), **RIGID),
        Body("hand", "tried", (0.2, -0.6, 0.1), (turn, Joint("R1", "hand.angle", -0.4)), **RIGID),
    )
    return System("train", ParameterTable(), bodies)
