"""Constraints that are no cuts: transmissions, user constraints, rates, body cuts, redundancy."""

import logging

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    Body,
    BodyCut,
    ConstantRate,
    Joint,
    ParameterTable,
    RodCut,
    System,
    TimeLaw,
    Turn,
    derive,
)
from vehicledyn.multibody.elements.transmissions import Belt, Gears, LeadScrew, Rack
from vehicledyn.multibody.model.constraints import (
    BaseConstraint,
    LinearConstraint,
    RateConstraint,
    UserConstraint,
)
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.symbolic import ops, rotations

EXACT = 1e-12
BALL = (0.1, 0.1, 0.1)


def system(bodies, *constraints, table=None, **more):
    return System("test", table or ParameterTable(), tuple(bodies), constraints=constraints, **more)


def wheel(name, inertia, *, axis=3, parent=GROUND, **joint):
    joints = (Joint(f"R{axis}", f"{name}.angle", **joint),)
    return Body(name, parent, joints=joints, mass=1.0, inertia=(inertia,) * 3)


def slider(name, mass, *, axis=3, **joint):
    joints = (Joint(f"T{axis}", f"{name}.z", **joint),)
    return Body(name, GROUND, joints=joints, mass=mass, inertia=BALL)


class Point:
    """Rates and outputs of equations at a state, by name."""

    def __init__(self, equations, time=0.0, **changes):
        e = self.equations = equations
        x = [changes.get(s.name, s.start) for s in e.states]
        z = [u.start for u in e.unknowns]
        inputs = [e.time, e.state, e.algebraic, e.parameter]
        at = (time, x, z, [p.value for p in e.parameters])
        names = [c.name for c in e.channels]
        self.out = dict(zip(names, ops.numeric(inputs, e.output)(*at)[:, 0], strict=True))
        rates = ops.numeric(inputs, e.rate)(*at)[:, 0]
        self.rate = dict(zip((s.name for s in e.states), rates, strict=True))


# -- transmissions -------------------------------------------------------------------------


def test_a_nut_falls_along_its_screw():
    """(m + J (2π/p)²) z̈ = -m g; the multiplier is the force of the thread on the nut."""
    table = ParameterTable()
    pitch = table.add("pitch", 0.02, "m", "Pitch")
    mass, inertia, lead = 2.0, 3e-4, 0.02 / (2.0 * np.pi)
    turned = Joint("R3", "nut.angle", role="dependent")
    nut = Body("nut", GROUND, joints=(Joint("T3", "nut.z", 0.1, "independent"), turned), mass=mass)
    nut = Body(**{**nut.__dict__, "inertia": (inertia,) * 3})
    e = derive(system([nut], LeadScrew("thread", "nut.z", "nut.angle", pitch), table=table))
    point = Point(e, **{"nut.z_rate": 0.3})
    acceleration = -mass * 9.81 / (mass + inertia / lead**2)
    assert point.rate["nut.z_rate"] == pytest.approx(acceleration, rel=EXACT)
    assert point.out["nut.angle"] == pytest.approx(0.1 / lead, rel=EXACT)
    assert point.out["nut.angle_rate"] == pytest.approx(0.3 / lead, rel=EXACT)
    force = mass * (acceleration + 9.81)
    assert point.out["thread.force"] == pytest.approx(force, rel=1e-11)


@pytest.mark.parametrize(
    ("make", "ratio"),
    [
        (lambda: Gears("mesh", "b.angle", "a.angle", 2.5), -2.5),
        (lambda: Gears("mesh", "b.angle", "a.angle", -2.5), 2.5),
        (lambda: Belt("mesh", "b.angle", "a.angle", 0.2, 0.5), 2.5),
        (lambda: Belt("mesh", "b.angle", "a.angle", 0.2, 0.5, crossed=True), -2.5),
    ],
)
def test_gears_and_belts_share_a_torque(make, ratio):
    """A driven wheel follows with the ratio; torque on the driver from the power balance."""
    driven = wheel("a", 0.3, role="driven")
    drive = TimeLaw("drive", "a.angle", lambda t: 0.2 + 1.5 * t + 2.0 * t * t)
    e = derive(system([driven, wheel("b", 0.7)], make(), parts=(drive,)))
    assert e.structure["degrees_of_freedom"] == 0
    point = Point(e)
    assert point.out["b.angle"] == pytest.approx(0.2 * ratio, rel=EXACT)
    assert point.out["b.angle_rate"] == pytest.approx(1.5 * ratio, rel=EXACT)
    assert point.out["mesh.torque"] == pytest.approx(0.7 * 4.0 * ratio, rel=EXACT)
    assert point.out["a.angle_force"] == pytest.approx((0.3 + 0.7 * ratio**2) * 4.0, rel=EXACT)


def test_a_load_on_a_rope_unwinds_the_drum():
    drum = wheel("drum", 0.4, axis=1)
    rope = Rack("rope", "load.z", "drum.angle", -0.25, offset=-3.0)
    point = Point(derive(system([drum, slider("load", 5.0, start=-2.9)], rope)))
    fall = -5.0 * 9.81 / (5.0 + 0.4 / 0.25**2)
    for name, factor in (("load.z", 1.0), ("drum.angle", -4.0)):
        if f"{name}_rate" in point.rate:
            assert point.rate[f"{name}_rate"] == pytest.approx(fall * factor, rel=EXACT)
    pull = point.out["rope.force"]
    assert abs(pull) == pytest.approx(5.0 * (fall + 9.81), rel=1e-11)


def test_a_planetary_gear_by_three_coordinates():
    """Willis: the sum of speeds weighted by teeth; the three torques stand in their ratio."""
    names = ("sun", "ring", "carrier")
    bodies = [wheel(n, i, role="auto") for n, i in zip(names, (0.1, 0.3, 0.2), strict=True)]
    terms = (("sun.angle", 1.0), ("ring.angle", 3.0), ("carrier.angle", -4.0))
    e = derive(system(bodies, LinearConstraint("planets", terms)))
    assert e.structure["degrees_of_freedom"] == 2
    independent = e.structure["independent"]
    point = Point(e, **{f"{name}_rate": 1.0 for name in independent})
    rates = [point.out[f"{n}.angle_rate"] for n in names]
    assert rates == pytest.approx([1.0, 1.0, 1.0], rel=EXACT)


def test_the_ratio_stays_a_parameter():
    table = ParameterTable()
    ratio = table.add("ratio", 2.0, "1", "Ratio")
    bodies = [wheel("a", 0.3), wheel("b", 0.7)]
    e = derive(system(bodies, Gears("mesh", "b.angle", "a.angle", ratio), table=table))
    assert ops.depends_on(e.residual, e.parameter)


# -- user constraints ----------------------------------------------------------------------


def bead(*constraints, **start):
    joints = tuple(
        Joint(k, f"bead.{n}", start=start.get(n, 0.0))
        for k, n in (("T1", "x"), ("T2", "y"), ("T3", "z"))
    )
    return system([Body("bead", GROUND, joints=joints, mass=0.5)], *constraints)


def test_a_bead_on_a_sphere_is_a_spherical_pendulum():
    """Tension of a pendulum at its lowest point with speed v: m (g + v²/l)."""

    def sphere(geometry):
        p = geometry.position("bead")
        return 0.5 * (ops.dot(p, p) / 2.0 - 2.0)

    e = derive(bead(UserConstraint("sphere", sphere), x=0.1, z=-1.9))
    assert e.structure["dependent"] == ["bead.z"]
    place = {s.name: 0.0 for s in e.states}
    moving = {**place, "bead.x_rate": 3.0}
    found = at_bottom(e, moving)
    assert abs(found["sphere.multiplier"]) == pytest.approx(0.5 * (9.81 + 4.5), rel=1e-11)


def at_bottom(e, states):
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    x = [states[s.name] for s in e.states]
    values = ops.numeric(inputs, e.output)(0.0, x, [-2.0], [])[:, 0]
    return dict(zip((c.name for c in e.channels), values, strict=True))


def test_a_rising_platform_does_work():
    """A rheonomic constraint z = a t²/2: the platform carries weight and inertia."""
    law = UserConstraint("lift", lambda g: g.coordinate("bead.z") - 1.5 * g.time * g.time)
    e = derive(bead(law))
    assert "bead.z" in e.structure["dependent"]
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    values = ops.numeric(inputs, e.output)(2.0, [0.0] * 4, [6.0], [])[:, 0]
    found = dict(zip((c.name for c in e.channels), values, strict=True))
    assert found["bead.z_rate"] == pytest.approx(6.0, rel=EXACT)
    assert found["lift.multiplier"] == pytest.approx(0.5 * (9.81 + 3.0), rel=EXACT)
    assert found["power.forces"] == pytest.approx(0.5 * (9.81 + 3.0) * 6.0, rel=EXACT)


def test_a_constraint_may_give_several_scalars():
    weld = UserConstraint("weld", lambda g: [g.coordinate("bead.x"), g.coordinate("bead.y")])
    e = derive(bead(weld))
    assert e.structure["degrees_of_freedom"] == 1
    assert {"weld.multiplier_1", "weld.multiplier_2"} <= {c.name for c in e.channels}


def test_a_vector_is_several_scalars():
    e = derive(bead(UserConstraint("fix", lambda g: g.position("bead"))))
    assert e.structure["degrees_of_freedom"] == 0


class Crooked(BaseConstraint):
    """Demands of coordinates what depends on rates."""

    def residuals(self, geometry):
        rate = geometry.kinematics.rate("bead.x")
        return [Residual(rate, "m/s", "force", "N", "Force")]


@pytest.mark.parametrize(
    ("constraint", "message"),
    [
        (Crooked("bent"), "'bent' depends on rates"),
        (RateConstraint("bent", lambda m: m.rate("bead.x") ** 2), "'bent' is not linear"),
        (UserConstraint("bent", lambda g: ops.symbol("fog") * g.coordinate("bead.x")), "'fog'"),
    ],
)
def test_what_a_constraint_may_not_be(constraint, message):
    with pytest.raises(InputError, match=message):
        derive(bead(constraint))


# -- non-holonomic -------------------------------------------------------------------------


def skate(*, slope=0.0, heading=0.3):
    joints = (
        Joint("T1", "x"),
        Joint("T2", "y"),
        Joint("R3", "heading", start=heading, role="independent"),
    )
    body = Body("skate", GROUND, joints=joints, mass=2.0, inertia=(0.05,) * 3)
    gravity = (9.81 * np.sin(slope), 0.0, -9.81 * np.cos(slope))
    edge = RateConstraint("edge", lambda m: (m.rotation("skate").T @ m.velocity("skate"))[1])
    return System("skate", ParameterTable(), (body,), gravity=gravity, constraints=(edge,))


def test_a_knife_edge_keeps_all_coordinates():
    e = derive(skate())
    assert [s.name for s in e.states] == ["x", "heading", "x_rate", "heading_rate", "y"]
    assert e.structure["rate_dependent"] == ["y"]
    assert e.structure["degrees_of_freedom"] == 2
    assert not e.unknowns
    assert [e.states[k].name for k in (*e.positions, *e.velocities)] == [
        "x",
        "heading",
        "x_rate",
        "heading_rate",
    ]


def test_a_knife_edge_holds_across_its_heading():
    """At speed v and yaw rate ω the edge gives m v ω across, and nothing along."""
    speed, turning = 3.0, 0.7
    point = Point(derive(skate()), x_rate=speed * np.cos(0.3), heading_rate=turning)
    assert point.rate["y"] == pytest.approx(speed * np.sin(0.3), rel=EXACT)
    assert point.out["edge.multiplier"] == pytest.approx(2.0 * speed * turning, rel=EXACT)
    assert point.rate["x_rate"] == pytest.approx(-speed * turning * np.sin(0.3), rel=EXACT)
    assert point.out["constraints.velocity_error"] < EXACT


def test_a_rate_constraint_with_time():
    """A belt runs under the bead: ẋ = 2 t drives it with m ẍ."""
    e = derive(bead(RateConstraint("belt", lambda m: m.rate("bead.x") - 2.0 * m.time)))
    point = Point(e, time=3.0)
    assert point.rate["bead.x"] == pytest.approx(6.0)
    assert point.out["belt.multiplier"] == pytest.approx(0.5 * 2.0, rel=EXACT)
    assert point.out["power.forces"] == pytest.approx(0.5 * 2.0 * 6.0, rel=EXACT)


# -- body cuts -----------------------------------------------------------------------------


def welded(angle, axis, base):
    """A free body that is turned against the frame it is to be welded to."""
    kinds = ("T1", "T2", "T3", "R1", "R2", "R3")
    start = Rotation.from_rotvec(angle * np.array(axis)).as_euler("XYZ")
    starts = [0.1, -0.2, 0.3, *start]
    joints = tuple(Joint(k, k.lower(), q) for k, q in zip(kinds, starts, strict=True))
    turn = Turn(rotations.matrix(base.as_matrix().tolist()))
    frame = Body("frame", GROUND, (0.4, 0.5, 0.6), (turn,))
    beam = Body("beam", "frame", joints=joints, mass=2.0, inertia=BALL)
    return system([frame, beam], cuts=(BodyCut("weld", "frame", (0, 0, 0), "beam", (0, 0, 0)),))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("angle", [0.5, 1.6, 2.5, 3.0])
def test_body_cuts_close_from_any_rotation(seed, angle):
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    e = derive(welded(angle, axis / np.linalg.norm(axis), Rotation.random(random_state=rng)))
    found = Rotation.from_euler("XYZ", [u.start for u in _by_name(e, ("r1", "r2", "r3"))])
    assert found.magnitude() < 1e-11


def _by_name(e, names):
    return sorted((u for u in e.unknowns if u.name in names), key=lambda u: u.name)


@pytest.mark.parametrize("angle", [np.pi / 2, np.pi - 1e-3, np.pi])
def test_body_cuts_are_open_at_half_a_turn(angle):
    """A hinge half a turn away from its weld is turned back, not taken for closed."""
    leaf = Body("leaf", GROUND, joints=(Joint("R3", "hinge", angle),), mass=1.0, inertia=BALL)
    cut = BodyCut("weld", GROUND, (0, 0, 0), "leaf", (0, 0, 0))
    e = derive(system([leaf], cuts=(cut,)))
    turns = e.unknowns[0].start / (2.0 * np.pi)
    assert turns == pytest.approx(round(turns), abs=EXACT)


@pytest.mark.parametrize("seed", range(4))
def test_the_gradient_of_a_closed_body_cut_is_the_angular_velocity(seed):
    """The multipliers are a torque: at rest they hold the weight that overhangs."""
    base = Rotation.random(random_state=np.random.default_rng(seed))
    e = derive(_overhanging(base))
    found = Point(e).out
    lever = base.inv().apply([0.0, 0.0, -2.0 * 9.81])
    torque = -np.cross([0.5, 0.0, 0.0], lever)
    for axis, value in zip("xyz", torque, strict=True):
        assert found[f"weld.torque_{axis}"] == pytest.approx(value, abs=1e-10)


def _overhanging(base):
    whole = welded(0.4, (0.6, 0.0, 0.8), base)
    frame, beam = whole.bodies
    beam = Body(**{**beam.__dict__, "com": (0.5, 0.0, 0.0)})
    return System("test", whole.table, (frame, beam), whole.cuts)


# -- redundancy and contradiction ----------------------------------------------------------


def bars(angles, roles=("auto",) * 3, lengths=(1.0, 1.0, 1.0)):
    """A four-bar in the plane, cut at the end of the coupler."""
    a, b, c = lengths
    names = ("crank", "coupler", "rocker")
    parents, places = (GROUND, "crank", GROUND), ((0, 0, 0), (a, 0, 0), (1.0, 0, 0))
    bodies = [
        Body(n, p, at, (Joint("R3", n, q, r),), mass=1.0, inertia=BALL)
        for n, p, at, q, r in zip(names, parents, places, angles, roles, strict=True)
    ]
    return bodies, BallCut("pin", "coupler", (b, 0, 0), "rocker", (c, 0, 0))


def test_a_redundant_row_is_named_with_its_joints():
    bodies, cut = bars((0.7, -0.7, 0.7))
    (found,) = derive(system(bodies, cuts=(cut,))).structure["redundancies"]
    assert found == {
        "constraint": "pin.force_z",
        "follows_from": [],
        "joints": ["crank", "coupler", "rocker"],
    }


def test_a_redundant_row_is_named_with_the_rows_it_repeats():
    bodies, cut = bars((0.7, -0.7, 0.7))
    rod = RodCut("rod", GROUND, (0, 0, 0), "crank", (1, 0, 0), 1.0)
    twin = RodCut("twin", GROUND, (1, 0, 0), "coupler", (1, 0, 0), 1.0)
    found = derive(system(bodies, cuts=(cut, rod, twin))).structure["redundancies"]
    follows = {item["constraint"]: item["follows_from"] for item in found}
    assert follows == {
        "pin.force_z": [],
        "rod.axial_force": [],
        "twin.axial_force": ["pin.force_x", "pin.force_y"],
    }


def test_a_singular_start_names_the_coordinate():
    bodies, cut = bars((0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"singular.*'pin'.*leave '\w+' undetermined"):
        derive(system(bodies, cuts=(cut,)))


def test_a_nearly_singular_start_warns(caplog):
    bodies, cut = bars((1e-6, -1e-6, 1e-6), roles=("independent", "auto", "auto"))
    with caplog.at_level(logging.WARNING):
        derive(system(bodies, cuts=(cut,)))
    assert "nearly singular" in caplog.text
    assert "'rocker'" in caplog.text or "'coupler'" in caplog.text


def test_a_drive_that_contradicts_a_constraint():
    hinge = Body("leaf", GROUND, joints=(Joint("R3", "hinge", 0.0, "driven"),), mass=1.0)
    rod = RodCut("rod", GROUND, (1.0, 1.0, 0.0), "leaf", (1.0, 0.0, 0.0), 1.0)
    drive = ConstantRate("motor", "hinge", 1.0)
    with pytest.raises(InputError, match=r"contradictory.*'hinge' is driven.*'rod'"):
        derive(system([hinge], cuts=(rod,), parts=(drive,)))


def test_a_coordinate_declared_independent_without_freedom():
    hinge = Body("leaf", GROUND, joints=(Joint("R3", "hinge", 0.0, "independent"),), mass=1.0)
    rod = RodCut("rod", GROUND, (1.0, 1.0, 0.0), "leaf", (1.0, 0.0, 0.0), 1.0)
    with pytest.raises(InputError, match=r"'hinge' is declared independent"):
        derive(system([hinge], cuts=(rod,)))


def test_constraints_that_drift_apart():
    one = UserConstraint("one", lambda g: g.coordinate("bead.x") - g.time)
    two = UserConstraint("two", lambda g: g.coordinate("bead.x") - 2.0 * g.time)
    with pytest.raises(InputError, match=r"'two'.*'one'.*contradict|'one'.*'two'.*contradict"):
        derive(bead(one, two))


def test_names_are_unique_among_constraints():
    one = LinearConstraint("one", (("bead.x", 1.0),))
    with pytest.raises(InputError, match="'one' names two parts"):
        derive(bead(one, one))
