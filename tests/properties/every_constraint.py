"""Systems that have between them every joint, cut, constraint and drive, few to derive."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from random_systems import (
    CLOSED,
    Builder,
    Motor,
    Wind,
    ball_cut,
    body_cut,
    pull,
    rod_cut,
    start_kinematics,
    tree,
)

from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody.elements.drives import ConstantRate, TimeLaw
from vehicledyn.multibody.elements.point_forces import Attachment, PointForce
from vehicledyn.multibody.elements.rolling import RollingWheel
from vehicledyn.multibody.elements.transmissions import Belt, Gears, LeadScrew, Rack
from vehicledyn.multibody.model.constraints import RateConstraint, UserConstraint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.symbolic import ops

FREE = ("T1", "T2", "T3", "R3", "R2", "R1")
NAMED = {
    "spherical": ("R1", "R2", "R3"),
    "universal": ("R3", "R1"),
    "cylindrical": ("T3", "R3"),
    "planar": ("T1", "T3", "R2"),
}
WRITTEN = Path(__file__).parent / "written_system.yaml"


def sections():
    """A floating ring of named joints closed by a body cut, a ball cut and a rod beside it."""
    b = Builder(31)
    b.add("base", GROUND, FREE, role="independent")
    b.add("one", "base", NAMED["universal"])
    b.add("two", "one", NAMED["spherical"])
    b.add("three", "two", NAMED["cylindrical"])
    b.add("four", "base", NAMED["planar"])
    b.add("frame", "four", ("R3",), massless=True)
    b.add("five", "frame", ("R2", "R1"))
    b.add("six", "base", NAMED["spherical"])
    b.add("seven", "six", ("T2", "R1"))
    b.add("eight", "base", NAMED["universal"])
    b.add_wheel("wheel", "six", 3)
    cuts = (
        body_cut(b, "three", "five"),
        ball_cut(b, "seven", "two"),
        rod_cut(b, "eight", "six"),
    )
    parts = (
        Wind("wind", "two"),
        Motor("motor", "four.q0"),
        PointForce(
            "spring", Attachment("base", b.point()), Attachment("seven", (0.9, 0.8, 0.3)), pull
        ),
    )
    # Ten constraints are entangled; off them only partitioned coordinates solve for the others.
    return replace(b.system("sections", cuts, parts), constraint_method="partitioning")


def transmitted():
    """A floating body with a screw, a rack, gears, belts, a planetary gear and two drives."""
    b = Builder(32)
    add = b.table.add
    b.add("base", GROUND, FREE, role="independent")
    b.add("nut", "base", ("T3", "R3"))
    b.add("pinion", "nut", ("R2",))
    b.add("slide", "base", ("T1",))
    for name in ("sun", "arm", "ring"):
        b.add(name, "base", ("R3",), turns=False)
    b.add("driver", "base", ("R1",))
    b.add("straight", "base", ("R2",))
    b.add("crossed", "pinion", ("R1", "T2"))
    b.add("crank", "base", ("R2", "T1"), driven=True)
    b.add("turned", "crank", ("R3",), driven=True)
    b.add_wheel("wheel", "slide", 1)
    constraints = (
        LeadScrew("thread", "nut.q0", "nut.q1", add("pitch", 0.4, "m", "pitch"), offset=0.1),
        Rack("rack", "slide.q0", "pinion.q0", add("radius", 0.23, "m", "radius")),
        Gears("mesh", "wheel.spin", "driver.q0", add("ratio", -1.7, "1", "ratio"), offset=0.2),
        Belt("open", "straight.q0", "driver.q0", 0.3, add("pulley", 0.4, "m", "radius")),
        Belt("cross", "crossed.q0", "pinion.q0", 0.2, 0.3, crossed=True),
        UserConstraint(
            "planets",
            lambda g: (
                g.coordinate("sun.q0")
                - 3.1 * g.coordinate("arm.q0")
                + 2.1 * g.coordinate("ring.q0")
            ),
            "rad",
            "N*m",
        ),
    )
    parts = (
        Wind("wind", "crossed"),
        Motor("motor", "ring.q0"),
        TimeLaw("drive", "crank.q1", _law(b, "crank.q1")),
        ConstantRate("steady", "turned.q0", add("speed", 0.7, "rad/s", "rate")),
    )
    return replace(b.system("transmitted", parts=parts), constraints=constraints)


def _law(builder, coordinate):
    joints = [j for body in builder.bodies for j in body.joints if hasattr(j, "start")]
    start = next(j.start for j in joints if j.name == coordinate)
    return lambda t: start + 0.2 * ops.tanh(t) * ops.exp(-0.5 * t) + 0.1 * ops.sin(2.0 * t)


STRING = {"near": (0.2, 0.1, -0.1), "far": (-0.1, 0.3, 0.2)}
SKATE = (0.3, -0.1, 0.2)


def surface(p, time):
    """Height of a moving uneven surface less that of a point: zero when the point is on it."""
    return p[2] - 0.2 * ops.sin(2.0 * p[0] + 0.3) * p[1] - 0.1 * ops.sin(time) - p[1] * p[1]


def lawful():
    """User constraints as Python functions: a string, a moving surface, a skate, a rate law."""
    b = Builder(33)
    b.add("base", GROUND, FREE)
    b.add("upper", "base", ("R1", "R2"))
    b.add("lower", "upper", ("R3", "T1"))
    b.add("other", "base", ("R2", "R1"))
    b.add_wheel("wheel", "lower", 2)
    k = start_kinematics(b)
    start_values = [e.value for e in b.table.entries]
    gap = k.position("lower", STRING["near"]) - k.position("other", STRING["far"])
    table = ops.column([e.symbol for e in b.table.entries])
    span = float(ops.numeric([table], ops.dot(gap, gap))(start_values)[0, 0])
    across = ops.vector(0.48, 0.6, 0.64)

    def string(g):
        d = g.position("lower", STRING["near"]) - g.position("other", STRING["far"])
        return ops.dot(d, d) - span - 0.1 * ops.sin(3.0 * g.time)

    def skate(m):
        return ops.dot(m.rotation("other") @ across, m.velocity("other", SKATE))

    def law(m):
        return (
            (2.0 + ops.cos(m.time)) * m.velocity("lower", SKATE)[0]
            + 0.4 * m.rate("upper.q0")
            - 0.2 * ops.sin(m.coordinate("other.q1"))
            - 0.1 * m.time
        )

    constraints = (
        UserConstraint("string", string, "m^2", "N/m"),
        UserConstraint("surface", lambda g: surface(g.position("upper", SKATE), g.time)),
        RateConstraint("skate", skate),
        RateConstraint("law", law),
    )
    parts = (Wind("wind", "lower"), Motor("motor", "upper.q0"))
    return replace(b.system("lawful", parts=parts), constraints=constraints)


def rolling():
    """A torus and a sharp wheel on one oblique axle frame, an edge that trails behind."""
    b = Builder(34)
    b.add("frame", GROUND, FREE, turns=False)
    b.add("fork", "frame", ("R3", "R1"))
    for name, parent in (("torus", "frame"), ("disc", "fork")):
        b.add_wheel(name, parent, 2)
    # The wheel on the frame stands nearly upright.
    place = next(k for k, body in enumerate(b.bodies) if body.name == "torus")
    body = b.bodies[place]
    b.bodies[place] = replace(body, joints=body.joints[-1:])
    frame = b.bodies[0]
    joints = tuple(replace(j, start=0.5) if j.kind == "T3" else j for j in frame.joints)
    b.bodies[0] = replace(frame, joints=joints)
    add = b.table.add
    b.add("trailer", "frame", ("R3",), turns=False)
    edge = ops.vector(0.0, 1.0, 0.0)
    constraints = (
        RollingWheel(
            "rear", "torus", 2, add("r", 0.3, "m", "radius"), add("c", 0.05, "m", "crown")
        ),
        RollingWheel("front", "disc", 2, add("f", 0.35, "m", "radius")),
        RateConstraint(
            "trail",
            lambda m: ops.dot(
                m.rotation("trailer") @ edge, m.velocity("trailer", (-0.8, 0.0, 0.1))
            ),
        ),
    )
    parts = (Wind("wind", "frame"), Motor("motor", "torus.spin"))
    return replace(b.system("rolling", parts=parts), constraints=constraints)


def written():
    """The system of the file beside this one."""
    model, problems = read_system(WRITTEN, {})
    assert not problems
    return build_system(model)


def named_tree():
    """A tree of all named joints, a massless frame, a spinning wheel and a drive."""
    b = Builder(35)
    b.add("base", GROUND, FREE)
    b.add("one", "base", NAMED["spherical"])
    b.add("two", "one", NAMED["universal"])
    b.add("frame", "two", ("R3",), massless=True)
    b.add("three", "frame", NAMED["cylindrical"])
    b.add("four", "base", NAMED["planar"])
    b.add("five", "four", ("T2", "R1"), driven=True)
    b.add_wheel("wheel", "three", 1)
    parts = (
        Wind("wind", "three"),
        Motor("motor", "four.q0"),
        TimeLaw("drive", "five.q1", _law(b, "five.q1")),
    )
    return b.system("named tree", parts=parts)


SEEDS = range(50)
STRUCTURES = range(24)
"""Seeds of random systems, which repeat their kinds of joints and loops every twelve."""


def closed(seed):
    """A random closed system: spatial, a ring with a body cut, rods, or in the plane."""
    return CLOSED[seed % len(CLOSED)](seed)


TREES = {"named": named_tree}
LOOPS = {f.__name__: f for f in (sections, transmitted, lawful, rolling, written)}
RANDOM_TREES = {f"tree {k}": partial(tree, k) for k in STRUCTURES}
RANDOM_LOOPS = {f"closed {k}": partial(closed, k) for k in STRUCTURES}
