"""Random multibody systems with every joint, turns, massless bodies, spinning wheels and cuts."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.elements.point_forces import Attachment, PointForce
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.cuts import BallCut, BodyCut, RodCut
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Loads, Wrench
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.parameters import ParameterTable

CHAIN = ((), ("T1",), ("R3",), ("R1", "R2"), ("T3", "R2"), ("R2", "T2"), ("R3", "R1", "T2"))


@dataclass(frozen=True)
class Wind(BasePart):
    """Load a body with a force and torque that depend on its motion, time and a state."""

    body: str

    def states(self):
        return (Variable("gust", "N", "Slow force", 0.3),)

    def loads(self, situation):
        k = situation.kinematics
        gust = situation.states["gust"]
        relative = k.rotation(self.body).T @ k.velocity(self.body)
        force = ops.vector(gust - relative[0], ops.sin(situation.time), -(relative[2] ** 3))
        torque = -0.4 * k.angular_velocity(self.body) + ops.vector(0.0, gust, 0.1)
        return Loads(wrenches=(Wrench(self.body, force, torque),), rates={"gust": -0.5 * gust})


@dataclass(frozen=True)
class Motor(BasePart):
    """Turn a coordinate with a torque (or force) that falls with its rate."""

    coordinate: str

    def loads(self, situation):
        rate = situation.kinematics.rate(self.coordinate)
        return Loads(joint_forces={self.coordinate: 2.0 - 0.7 * rate})


JOINT_KINDS = ("T1", "T2", "T3", "R1", "R2", "R3")
"""The elementary joints."""


def wave(time):
    return 0.3 + 0.2 * ops.sin(2.0 * time) + 0.1 * time * time


class Builder:
    """Grow a system whose numbers are all parameters."""

    def __init__(self, seed, gravity=(0.3, -0.2, -9.81)):
        self.rng = np.random.default_rng(seed)
        self.table = ParameterTable()
        self.bodies = []
        self.gravity = self.numbers("gravity", gravity)

    def numbers(self, name, values):
        return tuple(self.table.add(f"{name}.{k}", v, "1", name) for k, v in enumerate(values))

    def turn(self):
        return Turn(rotations.matrix(Rotation.random(random_state=self.rng).as_matrix().tolist()))

    def joints(self, body, kinds, driven=False, turns=True, role="auto"):
        chain = []
        for index, kind in enumerate(kinds):
            if turns and self.rng.random() < 0.4:
                chain.append(self.turn())
            last = index == len(kinds) - 1
            chain.append(
                Joint(
                    kind,
                    f"{body}.q{index}",
                    start=self.rng.uniform(-0.6, 0.6),
                    role="driven" if driven and last else role,
                )
            )
        if turns and self.rng.random() < 0.4:
            chain.append(self.turn())
        return tuple(chain)

    def rigid(self, name):
        """Mass properties of a solid of a few masses, so that every inertia is possible."""
        points = self.rng.normal(size=(6, 3)) * 0.3
        masses = self.rng.uniform(0.2, 1.0, size=6)
        com = (masses @ points) / masses.sum()
        r = points - com
        m = np.einsum("k,kij->ij", masses, [np.eye(3) * (p @ p) - np.outer(p, p) for p in r])
        inertia = (m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2])
        return {
            "mass": self.table.add(f"{name}.mass", masses.sum(), "kg", "mass"),
            "com": self.numbers(f"{name}.com", com),
            "inertia": self.numbers(f"{name}.inertia", inertia),
        }

    def disc(self, name, axis):
        """Mass properties of a body of revolution about an axis."""
        across = self.table.add(f"{name}.across", 0.11, "kg*m^2", "inertia")
        along = self.table.add(f"{name}.along", 0.17, "kg*m^2", "inertia")
        place = self.table.add(f"{name}.place", 0.07, "m", "place on the axis")
        return {
            "mass": self.table.add(f"{name}.mass", 1.3, "kg", "mass"),
            "com": tuple(place if k == axis else 0.0 for k in (1, 2, 3)),
            "inertia": tuple(along if k == axis else across for k in (1, 2, 3)),
        }

    def at(self, name):
        return self.numbers(f"{name}.at", self.rng.uniform(-0.5, 0.5, size=3))

    def add(self, name, parent, kinds, *, massless=False, driven=False, turns=True, role="auto"):
        joints = self.joints(name, kinds, driven, turns, role)
        mass = {} if massless else self.rigid(name)
        self.bodies.append(Body(name, parent, self.at(name), joints, **mass))
        return name

    def add_wheel(self, name, parent, axis):
        joints = (self.turn(), Joint(f"R{axis}", f"{name}.spin", start=0.4))
        body = Body(name, parent, self.at(name), joints, spins_about=axis)
        self.bodies.append(replace(body, **self.disc(name, axis)))
        return name

    def point(self):
        return tuple(self.rng.uniform(-0.4, 0.4, size=3))

    def system(self, name, cuts=(), parts=()):
        return System(name, self.table, tuple(self.bodies), cuts, parts, self.gravity)


def tree(seed):
    """A random tree of eight bodies with links, wind, a motor and a driven joint."""
    b = Builder(seed)
    b.add("root", GROUND, [("T1", "T2", "T3", "R3", "R2", "R1"), ("R1", "T3", "R2")][seed % 2])
    # Every kind of elementary joint has its turn as the seeds go by.
    b.add("first", "root", (JOINT_KINDS[seed % 6],))
    b.add("frame", "first", (f"R{1 + seed % 3}",), massless=True)
    b.add("second", "frame", (f"R{1 + (seed + 1) % 3}",))
    names = ["root", "first", "second"]
    for name in ("third", "fourth"):
        kinds = CHAIN[b.rng.integers(len(CHAIN))]
        names.append(b.add(name, names[b.rng.integers(len(names))], kinds))
    names.append(b.add("driven", "root", ("R2", ("T1", "R3")[seed % 2]), driven=True))
    names.append(b.add_wheel("wheel", "second", 1 + seed % 3))
    parts = (
        Wind("wind", "second"),
        Motor("motor", "second.q0"),
        TimeLaw("drive", "driven.q1", wave),
        PointForce(
            "spring",
            Attachment("third", b.point()),
            Attachment("fourth", (1.3, 0.2, 0.1)),
            lambda z, v: 30.0 * (z - 0.6) + 4.0 * v + 0.5 * v * v * v,
        ),
        PointForce(
            "rope", Attachment(GROUND, b.point()), Attachment("second", (0.1, 0.2, 0.9)), pull
        ),
        PointForce(
            "guide",
            Attachment("first", b.point()),
            Attachment("driven", b.point()),
            pull,
            direction=(0.6, 0.0, 0.8),
        ),
    )
    return b.system(f"tree {seed}", parts=parts)


def pull(length, rate):
    return 12.0 * ops.tanh(length) + 3.0 * rate


def start_kinematics(builder):
    """Numeric kinematics of the bodies so far, at their start values."""
    system = builder.system("start")
    q = {j.name: ops.scalar(j.start) for j in system.joints()}
    return Kinematics(unfold(system.bodies), q, {n: ops.scalar(0.0) for n in q})


def numbers_of(builder, expression):
    """Values of an expression of the parameters, as an array of its shape."""
    table = builder.table.entries
    symbols = ops.column([entry.symbol for entry in table])
    return ops.numeric([symbols], expression)([entry.value for entry in table])


def meeting_point(builder, body, other, point):
    """The point of ``other`` that coincides with a point of ``body`` at the start."""
    k = start_kinematics(builder)
    world = k.position(body, point)
    local = k.rotation(other).T @ (world - k.position(other))
    return tuple(numbers_of(builder, local)[:, 0])


def ball_cut(builder, a, b, name="ball"):
    point = builder.point()
    return BallCut(
        name,
        a,
        builder.numbers(f"{name}.a", point),
        b,
        builder.numbers(f"{name}.b", meeting_point(builder, a, b, point)),
    )


def rod_cut(builder, a, b, name="rod"):
    ends = builder.point(), builder.point()
    k = start_kinematics(builder)
    gap = numbers_of(builder, k.position(b, ends[1]) - k.position(a, ends[0]))[:, 0]
    length = builder.table.add(f"{name}.length", float(np.linalg.norm(gap)), "m", "length")
    return RodCut(name, a, ends[0], b, ends[1], length)


def body_cut(builder, a, b, name="section"):
    """Cut between a new massless frame on ``a`` and one on ``b`` that coincide at the start."""
    point = builder.point()
    k = start_kinematics(builder)
    turn = numbers_of(builder, k.rotation(b).T @ k.rotation(a))
    where = meeting_point(builder, a, b, point)
    end = Body(f"{name}.end", b, where, (Turn(rotations.matrix(turn.tolist())),))
    builder.bodies.append(end)
    return BodyCut(name, a, point, end.name, (0.0, 0.0, 0.0))


def spatial_loop(seed):
    """Two random chains on a floating base that share a ball joint, and a rod to the ground."""
    b = Builder(seed)
    b.add("base", GROUND, ("T1", "T2", "T3", "R3", "R2", "R1"), role="independent")
    b.add("left", "base", ("R1", ("R2", "T3")[seed % 2]))
    b.add("left_tip", "left", ("R3",), massless=seed % 3 == 0)
    b.add("left_end", "left_tip", ("R2", "R1"))
    b.add("right", "base", ("R2",))
    b.add("right_end", "right", ("R3", ("R1", "T2")[seed % 2]))
    b.add("driven", "base", ("R1",), driven=True)
    b.add_wheel("wheel", "right_end", 2)
    cuts = (ball_cut(b, "left_end", "right_end"), rod_cut(b, "driven", "left"))
    parts = (
        TimeLaw("drive", "driven.q0", _law_from(b, "driven.q0")),
        Wind("wind", "right_end"),
        PointForce(
            "spring", Attachment("base", b.point()), Attachment("left_end", (0.9, 0.9, 0.2)), pull
        ),
    )
    return b.system(f"spatial loop {seed}", cuts, parts)


def _law_from(builder, coordinate):
    """A law of time that begins at the coordinate's start value."""
    joints = [j for body in builder.bodies for j in body.joints if isinstance(j, Joint)]
    start = next(j.start for j in joints if j.name == coordinate)
    return lambda time: start + 0.2 * ops.sin(2.0 * time) + 0.1 * time * time


def body_loop(seed):
    """A ring of nine joints between ground and ground, closed by a body cut."""
    b = Builder(seed)
    b.add("one", GROUND, ("R1", "R2"))
    b.add("two", "one", ("R3", "R2"))
    b.add("three", "two", ("R1",))
    b.add("four", GROUND, ("R3", ("T1", "R1")[seed % 2]))
    b.add("five", "four", ("R2", "R3"))
    cut = body_cut(b, "three", "five")
    parts = (Wind("wind", "two"), Motor("motor", "four.q0"))
    return b.system(f"body loop {seed}", (cut,), parts)


def rod_loops(seed):
    """Two separate loops, each closed by two rods, on one cart: independent blocks."""
    b = Builder(seed)
    b.add("cart", GROUND, ("T1", "R3"), role="independent")
    cuts = []
    for side in ("a", "b"):
        b.add(f"arm_{side}", "cart", ("R1",))
        b.add(f"hub_{side}", f"arm_{side}", ("R2", "R3"), massless=seed % 2 == 0)
        b.add_wheel(f"wheel_{side}", f"hub_{side}", 2)
        cuts += [rod_cut(b, "cart", f"hub_{side}", f"rod_{side}{k}") for k in (1, 2)]
    return b.system(f"rod loops {seed}", tuple(cuts), (Wind("wind", "hub_a"),))


def planar_loop(seed):
    """A four-bar in the plane, closed by a ball cut: the gap across the plane is redundant."""
    b = Builder(seed)
    for name, parent in (("crank", GROUND), ("rod", "crank"), ("rocker", GROUND)):
        length = b.rng.uniform(0.5, 1.0)
        at = (0.0, 0.0, 0.0) if name == "crank" else (length, 0.1, 0.0)
        start = {"crank": 1.3, "rod": -0.9, "rocker": 1.7}[name] + b.rng.uniform(-0.2, 0.2)
        joint = Joint("R3", f"{name}.angle", start=start)
        b.bodies.append(Body(name, parent, b.numbers(f"{name}.at", at), (joint,), **b.rigid(name)))
    point = b.numbers("tip", (0.6, 0.0, 0.0))
    k = start_kinematics(b)
    world = k.position("rod", point)
    local = numbers_of(b, k.rotation("rocker").T @ (world - k.position("rocker")))[:, 0]
    cut = BallCut("ball", "rod", point, "rocker", b.numbers("tip_rocker", local))
    return b.system(f"planar loop {seed}", (cut,), (Motor("motor", "crank.angle"),))


CLOSED = [spatial_loop, body_loop, rod_loops, planar_loop]


def each_with_seeds(systems):
    """Return pairs of a system and a seed: a tree with every kind of joint, others three times."""
    seeds = {tree: range(len(JOINT_KINDS))}
    return [(make, seed) for make in systems for seed in seeds.get(make, (0, 3, 5))]
